"""Reduced models at a condition: derivatives, poles and responses against the full model."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass, replace
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Altitude, Fuel, Id
from flexsid.errors import BadInput
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.modal_data import ModalTable, ModelOrder, OrderStep, ReducedResponses
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import GRAVITY, compute_standard_density
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.modes.shapes import may_be
from flexsid.sysid.stability.order import (
    OrderStudy,
    ReducedModel,
    compute_reduced_response,
    study_order,
)
from flexsid.sysid.stability.reduction_errors import BAND, POLE_BAND
from flexsid.workflow.aircraft.aircraft_models import (
    build_model,
    define_outputs,
    list_default_outputs,
)
from flexsid.workflow.aircraft.axes import list_axis_surfaces
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_values,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.modal_data.modal_tables import AircraftModes, find_modal_tables, load_modes

BAND_HZ = (0.25, 15.0)
_FREQUENCIES = 240
_FORCE = re.compile(r"CQ(\d+)_alpha")
_UNITS = {
    "m/s2": ("g/rad", 1.0 / GRAVITY),
    "strain": ("ustrain/rad", 1e6),
    "rad/s": ("1/s", 1.0),
    "rad": ("1", 1.0),
    "rad/s2": ("1/s2", 1.0),
}
"""Unit of a response to a surface by the SI unit of the sensor, and its factor."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderQuery:
    """Aircraft, flight condition and source of derivatives of an order study.

    Raises
    ------
    BadInput
        If the band is empty.
    """

    aircraft_id: Id
    airspeed_m_s: Annotated[float, Allowed(ge=1.0, le=1000.0)]
    fuel: Fuel = 0.5
    altitude_m: Altitude = 0.0
    modal_table_id: Id | None = None
    prediction_id: Id | None = None
    low_hz: Annotated[float, Allowed(ge=0.01, le=100.0)] = BAND_HZ[0]
    high_hz: Annotated[float, Allowed(gt=0.01, le=1000.0)] = BAND_HZ[1]

    def __post_init__(self) -> None:
        if self.high_hz <= self.low_hz:
            raise BadInput(
                f"the band is {self.low_hz:g} to {self.high_hz:g} Hz; "
                "expected low_hz below high_hz",
                code="bad-band",
            )


@dataclass(frozen=True, slots=True, eq=False)
class _Full:
    model: AeroelasticModel
    derivatives: DerivativeTable
    modes: AircraftModes
    modal_table_id: int
    prediction_id: int
    units: dict[str, str]
    notes: tuple[str, ...]


def study_model_order(store: Store, query: OrderQuery) -> ModelOrder:
    """Determine the number of modes needed at a condition, with the evidence."""
    full = _build_full_model(store, query)
    study = study_order(full.model, full.derivatives, _select_frequencies(query))
    names = full.modes.names
    return ModelOrder(
        aircraft_id=query.aircraft_id,
        modal_table_id=full.modal_table_id,
        prediction_id=full.prediction_id,
        airspeed_m_s=query.airspeed_m_s,
        fuel=query.fuel,
        needed=study.needed,
        evidence=(*_describe_evidence(study, names, query), *full.notes),
        full=study.full.named(),
        steps=tuple(_build_step(step, names) for step in study.steps),
    )


def compute_reduced_responses(
    store: Store, query: OrderQuery, output: str, surface: str, counts: tuple[int, ...]
) -> ReducedResponses:
    """Compute a response with all modes, some modes, and rigid-body sensors (Fig. 11).

    Raises
    ------
    BadInput
        If the model lacks the output or the input.
    """
    full = _build_full_model(store, query)
    for name, known in ((output, full.model.outputs), (surface, full.model.inputs)):
        if name not in known:
            raise BadInput(
                f"the model has no '{name}'; it has {', '.join(known)}", code="unknown-name"
            )
    omega = _select_frequencies(query)
    y, u = full.model.outputs.index(output), full.model.inputs.index(surface)
    measured = full.units[output]
    unit, factor = _UNITS.get(measured, (f"{measured}/rad", 1.0))
    numbers = full.derivatives.modes
    curves = [(f"all {len(numbers)} modes", full.model.response(full.derivatives, omega)[:, y, u])]
    for count in counts:
        if 0 <= count < len(numbers):
            reduced = compute_reduced_response(full.model, full.derivatives, numbers[:count], omega)
            curves.append((_format_title(numbers[:count], full.modes.names), reduced[:, y, u]))
    rigid = replace(full.model, sensors=full.model.sensors.rigid_only(full.model.n_rigid))
    curves.append(
        ("rigid-body sensors (C_e = 0)", rigid.response(full.derivatives, omega)[:, y, u])
    )
    return ReducedResponses(
        output=output,
        input=surface,
        unit=unit,
        frequency_hz=omega / (2.0 * np.pi),
        curves=tuple((name, factor * values) for name, values in curves),
    )


def _build_full_model(store: Store, query: OrderQuery) -> _Full:
    aircraft = store.aircraft.get(query.aircraft_id)
    modal, damping = find_modal_tables(store, query.aircraft_id, query.modal_table_id, None)
    modes = load_modes(store, modal, damping)
    inputs = list_axis_surfaces(aircraft, LONGITUDINAL)
    symmetric = tuple(n for n in modes.table.numbers if may_be(modes.symmetric[n], True))
    prediction = select_prediction(store, query.aircraft_id, query.prediction_id, symmetric, inputs)
    if prediction is None:
        raise BadInput(
            "the aircraft has no predicted derivatives; import a prediction, since a reduced "
            "model needs derivatives of residualised modes",
            code="no-prediction",
        )
    at_fuel = modes.table.at(query.fuel)
    covered = list_predicted_modes(prediction, symmetric)
    if symmetric and not covered:
        raise BadInput(
            f"prediction '{prediction.source}' has no generalised force of the modes of modal "
            f"table '{modal.name}', version {modal.version} ({', '.join(map(str, symmetric))}); "
            "select the modal table of the prediction, or import a prediction for this one",
            code="modes-not-predicted",
            modal_table_id=modal.id,
            prediction_id=prediction.id,
        )
    order = sorted(covered, key=lambda n: float(at_fuel.omega[at_fuel.numbers.index(n)]))
    values = interpolate_values(store, prediction, query.fuel)
    condition = complete_condition(
        aircraft,
        {
            "airspeed": query.airspeed_m_s,
            "density": compute_standard_density(query.altitude_m),
            "fuel_fraction": query.fuel,
        },
    )
    moved = {sensor.point for sensor in aircraft.sensors if sensor.point in modes.table.points}
    seen = [s.name for s in aircraft.sensors if s.point in moved or s.point in modes.table.gauges]
    if not seen:
        raise BadInput(
            f"no sensor of {aircraft.name} is in the modal table {modal.name!r}; select a table "
            "with shapes at the sensors",
            code="no-sensors",
        )
    outputs = define_outputs(aircraft, list_default_outputs(aircraft, seen))
    selected = at_fuel.select(tuple(order))
    model = build_model(aircraft, condition, selected, inputs, outputs)
    assert modal.id is not None
    assert prediction.id is not None
    return _Full(
        model,
        DerivativeTable.from_names(tuple(order), inputs, values),
        modes,
        modal.id,
        prediction.id,
        {output.name: output.model.units[0] for output in outputs},
        _describe_differences(prediction, modal, symmetric, covered),
    )


def _describe_differences(
    prediction: DerivativePrediction,
    modal: ModalTable,
    symmetric: tuple[int, ...],
    covered: tuple[int, ...],
) -> tuple[str, ...]:
    """Describe modes of the prediction or the table only."""
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
            notes.append(f"Modes {listed} {text}: the full model omits them.")
    return tuple(notes)


def _select_frequencies(query: OrderQuery) -> np.ndarray:
    return 2.0 * np.pi * np.geomspace(query.low_hz, query.high_hz, _FREQUENCIES)


def _format_title(numbers: tuple[int, ...], names: dict[int, str]) -> str:
    return " + ".join(["SP", *(names[number] for number in numbers)])


def _describe_evidence(
    study: OrderStudy, names: dict[int, str], query: OrderQuery
) -> tuple[str, ...]:
    needed = study.steps[study.needed].errors
    assert needed.pole_error is not None  # it has all poles of the full model
    high = query.high_hz
    sentences = [
        f"With {_format_title(needed.modes, names)} every derivative of the rigid body is within "
        f"{100 * max(needed.bias, 0.0):.0f} % of the full model's"
        + (f" (worst {needed.worst})" if needed.worst else "")
        + f", and every pole below {high:g} Hz within {100 * needed.pole_error:.1f} %."
    ]
    if study.needed > 0:
        before = study.steps[study.needed - 1].errors
        reasons = []
        if before.bias > BAND:
            reasons.append(f"{before.worst} is {100 * before.bias:.0f} % off")
        if before.pole_error is None:
            reasons.append(f"a pole below {high:g} Hz is missing")
        elif before.pole_error > POLE_BAND:
            reasons.append(f"a pole is {100 * before.pole_error:.0f} % off")
        sentences.append(f"With one mode fewer {' and '.join(reasons)}.")
    if needed.response_error is not None:
        sentences.append(
            f"Responses to the surfaces are {100 * needed.response_error:.1f} % off on average."
        )
    return tuple(sentences)


def _build_step(step: ReducedModel, names: dict[int, str]) -> OrderStep:
    return OrderStep(
        **asdict(step.errors),
        names=tuple(names[number] for number in step.errors.modes),
        poles=_split_complex(step.residualized.poles),
        truncated_poles=_split_complex(step.truncated.poles),
        residualized=step.residualized.derivatives.named(),
        truncated=step.truncated.derivatives.named(),
    )


def _split_complex(poles: np.ndarray) -> tuple[tuple[float, float], ...]:
    return tuple((float(np.real(pole)), float(np.imag(pole))) for pole in poles)
