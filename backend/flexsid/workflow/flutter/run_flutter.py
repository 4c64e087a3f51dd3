"""What one run says of flutter: as it is, around modes carried as predicted, with one fewer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, coefficients, variables
from flexsid.sysid.stability.bands import Uncertain
from flexsid.sysid.stability.flight_evidence import FlownPoint
from flexsid.sysid.stability.prediction import (
    MODAL_FREQUENCY,
    IdentifiedModes,
    StiffnessError,
)
from flexsid.sysid.stability.speeds import Aeroelastic
from flexsid.workflow.aircraft.derivative_predictions import best_prediction, prediction_at
from flexsid.workflow.cache import contents_of_runs, remembered
from flexsid.workflow.modal_data.aligned_modes import AircraftModes, find_modal_tables, load_modes
from flexsid.workflow.model_structures.run_results import result_of
from flexsid.workflow.runs.identified_models import identified
from flexsid.workflow.runs.out_of_band_refits import (
    carrying,
    fit_again,
    left_out,
    with_one_mode_fewer,
)


class Others(StrEnum):
    """What becomes of the modes that a run left out."""

    PREDICTED = "predicted"
    RESIDUALIZED = "residualized"


@dataclass(frozen=True, slots=True)
class Root:
    """A root above the real axis that a run identified. [rad/s]"""

    value: complex
    damping_std: float | None


@dataclass(frozen=True, slots=True)
class FlownRun:
    """One run put together again.

    ``source`` names the prediction that modes were carried from in a second fit, None of
    the run as it is, and ``gain`` is how much likelier a measured value is with them (log
    likelihood); ``left_out`` are the modes that a prediction knows beyond it. ``check`` is a
    second fit with one mode fewer. ``evidence`` are all roots that the fit has where it was flown.
    """

    run: EstimationRun
    maneuver: Maneuver
    found: IdentifiedModes
    roots: Mapping[str, Root]
    evidence: FlownPoint
    source: str | None
    left_out: tuple[int, ...]
    gain: float = 0.0
    check: bool = False

    @property
    def poles(self) -> dict[str, complex]:
        """Roots by name. [rad/s]"""
        return {name: root.value for name, root in self.roots.items()}


def flown(store: Store, run_id: int, others: Others) -> tuple[FlownRun, ...]:
    """A run as it is, and with the modes it left out as predicted where that is asked for."""
    contents = contents_of_runs(store, (run_id,))
    return remembered(("flown", others, contents), lambda: _put_together(store, run_id, others))


def at_fuel(store: Store, part: FlownRun, fuel: float) -> IdentifiedModes:
    """A run's derivatives carried to another fuel weight by how the prediction changes.

    Mode shapes change with fuel, and with them every generalised force; what a prediction
    gets wrong in level it still gets right in proportion. A derivative that passes through
    zero grows by a large factor, and its error with it, so that it weighs little.
    """
    before = part.maneuver.condition.fuel_fraction
    table = part.found.aircraft.derivatives
    wanted = part.run.prediction_id or result_of(part.run).prediction_id
    prediction = best_prediction(
        store, part.maneuver.aircraft_id, wanted, table.modes, table.inputs
    )
    if prediction is None or fuel == before:
        return part.found
    there, here = (prediction_at(store, prediction, f) for f in (fuel, before))
    rows, columns = coefficients(table.modes), variables(table.modes, table.inputs)
    factor = np.ones(table.values.shape)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            name = f"{row}_{column}"
            if name in there and name in here and here[name][0] != 0.0:
                factor[i, j] = there[name][0] / here[name][0] or 1.0
    moved = DerivativeTable(table.modes, table.inputs, table.values * factor)
    known = part.found.uncertain
    own = factor[known.rows, known.columns]
    return replace(
        part.found,
        aircraft=replace(part.found.aircraft, derivatives=moved),
        uncertain=replace(known, covariance=known.covariance * np.outer(own, own)),
    )


def _put_together(store: Store, run_id: int, others: Others) -> tuple[FlownRun, ...]:
    run = store.runs.get(run_id)
    maneuver = store.maneuvers.get(run.maneuver_id)
    model = identified(store, run)
    result = result_of(run)
    modes = modes_of(store, run, maneuver)
    own = model.model.modes.numbers
    alone = FlownRun(
        run,
        maneuver,
        _identified(
            model.model,
            model.derivatives,
            tuple(parameter.name for parameter in result.parameters),
            np.asarray(store.arrays.get(result.covariance)),
        ),
        {p.name: Root(complex(p.real, p.imag), p.damping_std) for p in result.poles if p.imag > 0},
        _evidence(
            [(complex(p.real, p.imag), p.real_std) for p in result.poles],
            maneuver,
            _band(store, run),
            f"run {run_id}",
        ),
        None,
        left_out(store, run, modes, own),
    )
    wider = carrying(store, run, model, modes) if others is Others.PREDICTED else None
    around = None if wider is None else _again(store, alone, wider.run)
    if wider is None or around is None:
        return (alone,)
    return (replace(around, source=wider.source, left_out=()), alone)


def with_fewer(store: Store, part: FlownRun) -> FlownRun | None:
    """The run fitted again with one mode fewer; None where that cannot be."""
    fewer = with_one_mode_fewer(part.run)
    if fewer is None:
        return None
    contents = contents_of_runs(store, (part.run.id or 0,))
    found = remembered(("checked", contents), lambda: _again(store, part, fewer))
    return None if found is None else replace(found, check=True)


def _again(store: Store, alone: FlownRun, run: EstimationRun) -> FlownRun | None:
    """What a second fit of a run makes of its data."""
    again = fit_again(store, run)
    if again is None or not again[1].estimate.outcome.is_optimum:
        return None
    fitted, computed = again
    estimate = computed.estimate
    values = computed.held | dict(zip(estimate.names, estimate.values.tolist(), strict=True))
    model = replace(fitted, modes=fitted.modes.tuned(values))
    table = DerivativeTable.from_names(model.modes.numbers, model.inputs, values)
    before = result_of(alone.run).fit
    gain = 0.0
    if before.cost is not None and estimate.steps:
        gain = (before.cost - estimate.steps[-1].cost) / (before.n_lines * len(before.r_squared))
    return replace(
        alone,
        found=_identified(model, table, estimate.names, estimate.corrected_covariance),
        roots={p.name: Root(p.value, p.damping_std) for p in computed.poles if p.value.imag > 0},
        evidence=_evidence(
            [(p.value, p.real_std) for p in computed.poles],
            alone.maneuver,
            alone.evidence.band,
            alone.evidence.name,
        ),
        gain=gain,
    )


def _evidence(
    poles: Sequence[tuple[complex, float | None]],
    maneuver: Maneuver,
    band: tuple[float, float],
    name: str,
) -> FlownPoint:
    """The roots of a fit where it was flown; standard errors that are unknown are NaN."""
    upper = [(root, std) for root, std in poles if root.imag >= 0.0]
    return FlownPoint(
        maneuver.condition.airspeed_m_s,
        np.array([root for root, _ in upper], dtype=complex),
        np.array([np.nan if std is None else std for _, std in upper]),
        band,
        name,
    )


def _band(store: Store, run: EstimationRun) -> tuple[float, float]:
    """Lowest and highest frequency of the data that a run was fitted to. [rad/s]"""
    every = [store.arrays.get(block.arrays["omega"]) for block in result_of(run).blocks]
    return float(min(omega.min() for omega in every)), float(max(omega.max() for omega in every))


def _identified(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    names: tuple[str, ...],
    covariance: np.ndarray,
) -> IdentifiedModes:
    """Derivatives with the part of a covariance that belongs to them."""
    rows = coefficients(derivatives.modes)
    columns = variables(derivatives.modes, derivatives.inputs)
    places = {f"{r}_{c}": (i, j) for i, r in enumerate(rows) for j, c in enumerate(columns)}
    chosen = [k for k, name in enumerate(names) if name in places]
    where = np.array([places[names[k]] for k in chosen], dtype=int).reshape(-1, 2)
    relative_std = [
        float(np.sqrt(covariance[names.index(f"omega_{number}"), names.index(f"omega_{number}")]))
        if f"omega_{number}" in names
        else MODAL_FREQUENCY
        for number in derivatives.modes
    ]
    return IdentifiedModes(
        Aeroelastic(model.condition, model.modes, derivatives),
        Uncertain(where[:, 0], where[:, 1], covariance[np.ix_(chosen, chosen)]),
        StiffnessError(np.array(relative_std), model.condition.dynamic_pressure),
    )


def modes_of(store: Store, run: EstimationRun, maneuver: Maneuver) -> AircraftModes:
    """The modal and damping tables that a run was estimated with."""
    tables = find_modal_tables(
        store, maneuver.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    return load_modes(store, *tables)
