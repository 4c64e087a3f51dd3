"""Models of every order at a condition: derivatives, poles and responses against the full one."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import SensorKind
from flexsid.records.axes import symmetric_surfaces
from flexsid.records.modal_table import ModalTable
from flexsid.records.modal_views import ModelOrder, OrderStep, ReducedResponses
from flexsid.records.prediction import DerivativePrediction
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.stability.order import (
    BAND,
    POLE_BAND,
    OrderStudy,
    ReducedModel,
    reduced_response,
    study_order,
)
from flexsid.workflow.aircraft.aircraft_models import build_model, default_outputs, define_outputs
from flexsid.workflow.aircraft.derivative_predictions import (
    best_prediction,
    predicted_modes,
    prediction_at,
)
from flexsid.workflow.aircraft.flight_condition import complete_condition, standard_density
from flexsid.workflow.modal_data.aligned_modes import AircraftModes, find_modal_tables, load_modes

BAND_HZ = (0.25, 15.0)
_LINES = 240
_FORCE = re.compile(r"CQ(\d+)_alpha")
_UNITS = {
    SensorKind.ACCELEROMETER: ("g/rad", 1.0 / 9.80665),
    SensorKind.STRAIN: ("ustrain/rad", 1e6),
    SensorKind.GYRO: ("1/s", 1.0),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderQuestion:
    """Which aircraft, where it flies, and from whose derivatives."""

    aircraft_id: int
    airspeed_m_s: float
    fuel: float
    altitude_m: float | None = None
    modal_table_id: int | None = None
    prediction_id: int | None = None
    band_hz: tuple[float, float] = BAND_HZ


@dataclass(frozen=True, slots=True, eq=False)
class _Full:
    model: AeroelasticModel
    derivatives: DerivativeTable
    modes: AircraftModes
    modal_table_id: int
    prediction_id: int
    kinds: dict[str, SensorKind]
    left_out: tuple[str, ...]


def model_order(store: Store, question: OrderQuestion) -> ModelOrder:
    """Say how many modes a condition needs, and why."""
    full = _full_model(store, question)
    study = study_order(full.model, full.derivatives, _lines(question))
    names = full.modes.names
    return ModelOrder(
        aircraft_id=question.aircraft_id,
        modal_table_id=full.modal_table_id,
        prediction_id=full.prediction_id,
        airspeed_m_s=question.airspeed_m_s,
        fuel=question.fuel,
        needed=study.needed,
        evidence=(*_evidence(study, names, question), *full.left_out),
        full=study.full.named(),
        steps=tuple(_step(step, names) for step in study.steps),
    )


def reduced_responses(
    store: Store, question: OrderQuestion, output: str, surface: str, counts: tuple[int, ...]
) -> ReducedResponses:
    """One response with all modes, with some, and to sensors blind to the structure (Fig. 11).

    Raises
    ------
    BadInput
        If the output or the input is not one of the model.
    """
    full = _full_model(store, question)
    for name, known in ((output, full.model.outputs), (surface, full.model.inputs)):
        if name not in known:
            raise BadInput(
                f"'{name}' is not of the model, which has {', '.join(known)}", code="unknown-name"
            )
    omega = _lines(question)
    y, u = full.model.outputs.index(output), full.model.inputs.index(surface)
    unit, factor = _UNITS.get(full.kinds[output], ("1", 1.0))
    numbers = full.derivatives.modes
    curves = [(f"all {len(numbers)} modes", full.model.response(full.derivatives, omega)[:, y, u])]
    for count in counts:
        if 0 <= count < len(numbers):
            reduced = reduced_response(full.model, full.derivatives, numbers[:count], omega)
            curves.append((_title(numbers[:count], full.modes.names), reduced[:, y, u]))
    blind = AeroelasticModel(
        full.model.condition, full.model.modes, full.model.inputs, full.model.sensors.rigid_only()
    )
    curves.append(
        ("sensors blind to the structure", blind.response(full.derivatives, omega)[:, y, u])
    )
    return ReducedResponses(
        output=output,
        input=surface,
        unit=unit,
        frequency_hz=omega / (2.0 * np.pi),
        curves=tuple((name, factor * values) for name, values in curves),
    )


def _full_model(store: Store, question: OrderQuestion) -> _Full:
    aircraft = store.aircraft.get(question.aircraft_id)
    modal, damping = find_modal_tables(store, question.aircraft_id, question.modal_table_id, None)
    modes = load_modes(store, modal, damping)
    inputs = symmetric_surfaces(aircraft)
    symmetric = tuple(n for n in modes.table.numbers if modes.symmetric[n])
    prediction = best_prediction(
        store, question.aircraft_id, question.prediction_id, symmetric, inputs
    )
    if prediction is None:
        raise BadInput(
            "the aircraft has no predicted derivatives; import some, as a reduced model needs "
            "those of the modes that are left out",
            code="no-prediction",
        )
    at_fuel = modes.table.at(question.fuel)
    covered = predicted_modes(prediction, symmetric)
    if symmetric and not covered:
        raise BadInput(
            f"prediction '{prediction.source}' has no generalised force of the modes of modal "
            f"table '{modal.name}', version {modal.version} ({', '.join(map(str, symmetric))}); "
            "choose the modal table that it was made for, or import a prediction for this one",
            code="modes-not-predicted",
            modal_table_id=modal.id,
            prediction_id=prediction.id,
        )
    order = sorted(covered, key=lambda n: float(at_fuel.omega[at_fuel.numbers.index(n)]))
    values = {
        name: value for name, (value, _) in prediction_at(store, prediction, question.fuel).items()
    }
    condition = complete_condition(
        aircraft,
        {
            "airspeed": question.airspeed_m_s,
            "density": standard_density(question.altitude_m or 0.0),
            "fuel_fraction": question.fuel,
        },
    )
    moved = {sensor.point for sensor in aircraft.sensors if sensor.point in modes.table.points}
    seen = [s.name for s in aircraft.sensors if s.point in moved or s.point in modes.table.gauges]
    if not seen:
        raise BadInput(
            f"no sensor of {aircraft.name} has a place in the modal table {modal.name!r}; take one "
            "with shapes at the sensors",
            code="no-sensors",
        )
    outputs = define_outputs(aircraft, default_outputs(aircraft, seen))
    chosen = at_fuel.select(tuple(order))
    model = build_model(aircraft, condition, chosen, inputs, outputs)
    assert modal.id is not None
    assert prediction.id is not None
    return _Full(
        model,
        DerivativeTable.from_names(tuple(order), inputs, values),
        modes,
        modal.id,
        prediction.id,
        {output.name: output.kind for output in outputs},
        _left_out(prediction, modal, symmetric, covered),
    )


def _left_out(
    prediction: DerivativePrediction,
    modal: ModalTable,
    symmetric: tuple[int, ...],
    covered: tuple[int, ...],
) -> tuple[str, ...]:
    """What the prediction and the table do not share, in words."""
    known = {
        int(match[1]) for name in prediction.names if (match := _FORCE.fullmatch(name)) is not None
    }
    notes = []
    for numbers, text in (
        (set(symmetric) - set(covered), f"are not in prediction '{prediction.source}'"),
        (known - set(modal.numbers), f"are predicted and not in modal table '{modal.name}'"),
    ):
        if numbers:
            listed = ", ".join(map(str, sorted(numbers)))
            notes.append(f"Modes {listed} {text}: the full model is without them.")
    return tuple(notes)


def _lines(question: OrderQuestion) -> np.ndarray:
    low, high = question.band_hz
    return 2.0 * np.pi * np.geomspace(low, high, _LINES)


def _title(numbers: tuple[int, ...], names: dict[int, str]) -> str:
    return " + ".join(["SP", *(names[number] for number in numbers)])


def _evidence(study: OrderStudy, names: dict[int, str], question: OrderQuestion) -> tuple[str, ...]:
    needed = study.steps[study.needed]
    high = question.band_hz[1]
    sentences = [
        f"With {_title(needed.modes, names)} every derivative of the rigid body is within "
        f"{100 * max(needed.bias, 0.0):.0f} % of the full model's"
        + (f" (worst {needed.worst})" if needed.worst else "")
        + f", and every pole below {high:g} Hz within {100 * needed.pole_error:.1f} %."
    ]
    if study.needed > 0:
        before = study.steps[study.needed - 1]
        reasons = []
        if before.bias > BAND:
            reasons.append(f"{before.worst} is {100 * before.bias:.0f} % off")
        if not np.isfinite(before.pole_error):
            reasons.append(f"a pole below {high:g} Hz is missing")
        elif before.pole_error > POLE_BAND:
            reasons.append(f"a pole is {100 * before.pole_error:.0f} % off")
        sentences.append(f"With one mode fewer {' and '.join(reasons)}.")
    if needed.response_error is not None:
        sentences.append(
            f"Responses to the surfaces are {100 * needed.response_error:.1f} % off on average."
        )
    return tuple(sentences)


def _step(step: ReducedModel, names: dict[int, str]) -> OrderStep:
    return OrderStep(
        modes=step.modes,
        names=tuple(names[number] for number in step.modes),
        worst=step.worst,
        bias=step.bias,
        pole_error=step.pole_error if np.isfinite(step.pole_error) else None,
        response_error=step.response_error,
        poles=_pairs(step.poles),
        truncated_poles=_pairs(step.truncated_poles),
        residualized=step.residualized.named(),
        truncated=step.truncated.named(),
        sufficient=step.sufficient,
    )


def _pairs(poles: np.ndarray) -> tuple[tuple[float, float], ...]:
    return tuple((float(np.real(pole)), float(np.imag(pole))) for pole in poles)
