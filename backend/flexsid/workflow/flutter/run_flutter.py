"""Models of one run for flutter prediction: as estimated, with further modes, with one fewer."""

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
from flexsid.sysid.stability.bands import UncertainDerivatives
from flexsid.sysid.stability.flight_evidence import FlownPoint
from flexsid.sysid.stability.prediction import (
    MODAL_FREQUENCY,
    IdentifiedModes,
    StiffnessError,
)
from flexsid.sysid.stability.speeds import Aeroelastic
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_prediction,
    select_prediction,
)
from flexsid.workflow.cache import list_run_contents, load_or_compute
from flexsid.workflow.modal_data.aligned_modes import AircraftModes, find_modal_tables, load_modes
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.runs.identified_models import load_identified_model
from flexsid.workflow.runs.out_of_band_refits import (
    extend_with_predicted_modes,
    find_omitted_modes,
    refit,
    remove_highest_mode,
)


class UnmodelledModes(StrEnum):
    """Treatment of the modes omitted by a run."""

    PREDICTED = "predicted"
    RESIDUALIZED = "residualized"


@dataclass(frozen=True, slots=True)
class Root:
    """An identified root with positive imaginary part. [rad/s]"""

    value: complex
    damping_std: float | None


@dataclass(frozen=True, slots=True)
class RunModel:
    """Identified model of one run.

    ``source`` is the prediction of further modes in a second fit, None for the run as estimated,
    and ``gain`` the increase in log likelihood per measured value by them; ``omitted_modes`` are
    modes of a prediction that the model lacks. ``check`` is a second fit with one mode fewer.
    ``evidence`` are all roots of the fit at the flown condition.
    """

    run: EstimationRun
    maneuver: Maneuver
    found: IdentifiedModes
    roots: Mapping[str, Root]
    evidence: FlownPoint
    source: str | None
    omitted_modes: tuple[int, ...]
    gain: float = 0.0
    check: bool = False

    @property
    def poles(self) -> dict[str, complex]:
        """Roots by name. [rad/s]"""
        return {name: root.value for name, root in self.roots.items()}


def load_run_models(
    store: Store, run_id: int, unmodelled_modes: UnmodelledModes
) -> tuple[RunModel, ...]:
    """Load a run as estimated, and with omitted modes of a prediction where requested."""
    contents = list_run_contents(store, (run_id,))
    return load_or_compute(
        ("flown", unmodelled_modes, contents),
        lambda: _build_models(store, run_id, unmodelled_modes),
    )


def scale_to_fuel(store: Store, part: RunModel, fuel: float) -> IdentifiedModes:
    """Scale derivatives of a run to another fuel weight by the ratio of predicted values.

    Mode shapes change with fuel, and with them every generalised force; a prediction with a wrong
    level is assumed right in proportion. A derivative that passes through zero is multiplied by a
    large factor, and its error with it, so that its weight is small.
    """
    before = part.maneuver.condition.fuel_fraction
    table = part.found.aircraft.derivatives
    prediction_id = part.run.prediction_id or get_result(part.run).prediction_id
    prediction = select_prediction(
        store, part.maneuver.aircraft_id, prediction_id, table.modes, table.inputs
    )
    if prediction is None or fuel == before:
        return part.found
    there, here = (interpolate_prediction(store, prediction, f) for f in (fuel, before))
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


def _build_models(
    store: Store, run_id: int, unmodelled_modes: UnmodelledModes
) -> tuple[RunModel, ...]:
    run = store.runs.get(run_id)
    maneuver = store.maneuvers.get(run.maneuver_id)
    model = load_identified_model(store, run)
    result = get_result(run)
    modes = load_run_modes(store, run, maneuver)
    own = model.model.modes.numbers
    alone = RunModel(
        run,
        maneuver,
        _build_identified_modes(
            model.model,
            model.derivatives,
            tuple(parameter.name for parameter in result.parameters),
            np.asarray(store.arrays.get(result.covariance)),
        ),
        {p.name: Root(complex(p.real, p.imag), p.damping_std) for p in result.poles if p.imag > 0},
        _collect_roots(
            [(complex(p.real, p.imag), p.real_std) for p in result.poles],
            maneuver,
            _find_band(store, run),
            f"run {run_id}",
        ),
        None,
        find_omitted_modes(store, run, modes, own),
    )
    wider = (
        extend_with_predicted_modes(store, run, model, modes)
        if unmodelled_modes is UnmodelledModes.PREDICTED
        else None
    )
    around = None if wider is None else _refit(store, alone, wider.run)
    if wider is None or around is None:
        return (alone,)
    return (replace(around, source=wider.source, omitted_modes=()), alone)


def refit_with_fewer_modes(store: Store, part: RunModel) -> RunModel | None:
    """Fit a run again with one mode fewer; None where not possible."""
    fewer = remove_highest_mode(part.run)
    if fewer is None:
        return None
    contents = list_run_contents(store, (part.run.id or 0,))
    found = load_or_compute(("checked", contents), lambda: _refit(store, part, fewer))
    return None if found is None else replace(found, check=True)


def _refit(store: Store, alone: RunModel, run: EstimationRun) -> RunModel | None:
    """Fit a run again with another model; None where the fit has no optimum."""
    again = refit(store, run)
    if again is None or not again[1].estimate.outcome.is_optimum:
        return None
    fitted, computed = again
    estimate = computed.estimate
    values = computed.held | dict(zip(estimate.names, estimate.values.tolist(), strict=True))
    model = replace(fitted, modes=fitted.modes.tuned(values))
    table = DerivativeTable.from_names(model.modes.numbers, model.inputs, values)
    before = get_result(alone.run).fit
    gain = 0.0
    if before.cost is not None and estimate.steps:
        gain = (before.cost - estimate.steps[-1].cost) / (before.n_lines * len(before.r_squared))
    return replace(
        alone,
        found=_build_identified_modes(model, table, estimate.names, estimate.corrected_covariance),
        roots={p.name: Root(p.value, p.damping_std) for p in computed.poles if p.value.imag > 0},
        evidence=_collect_roots(
            [(p.value, p.real_std) for p in computed.poles],
            alone.maneuver,
            alone.evidence.band,
            alone.evidence.name,
        ),
        gain=gain,
    )


def _collect_roots(
    poles: Sequence[tuple[complex, float | None]],
    maneuver: Maneuver,
    band: tuple[float, float],
    name: str,
) -> FlownPoint:
    """Return the roots of a fit at the flown condition; unknown standard errors are NaN."""
    upper = [(root, std) for root, std in poles if root.imag >= 0.0]
    return FlownPoint(
        maneuver.condition.airspeed_m_s,
        np.array([root for root, _ in upper], dtype=complex),
        np.array([np.nan if std is None else std for _, std in upper]),
        band,
        name,
    )


def _find_band(store: Store, run: EstimationRun) -> tuple[float, float]:
    """Return the lowest and highest frequency of the data of a run. [rad/s]"""
    every = [store.arrays.get(block.arrays["omega"]) for block in get_result(run).blocks]
    return float(min(omega.min() for omega in every)), float(max(omega.max() for omega in every))


def _build_identified_modes(
    model: AeroelasticModel,
    derivatives: DerivativeTable,
    names: tuple[str, ...],
    covariance: np.ndarray,
) -> IdentifiedModes:
    """Build identified modes from derivatives and their part of the covariance."""
    rows = coefficients(derivatives.modes)
    columns = variables(derivatives.modes, derivatives.inputs)
    places = {f"{r}_{c}": (i, j) for i, r in enumerate(rows) for j, c in enumerate(columns)}
    selected = [k for k, name in enumerate(names) if name in places]
    where = np.array([places[names[k]] for k in selected], dtype=int).reshape(-1, 2)
    relative_std = [
        float(np.sqrt(covariance[names.index(f"omega_{number}"), names.index(f"omega_{number}")]))
        if f"omega_{number}" in names
        else MODAL_FREQUENCY
        for number in derivatives.modes
    ]
    return IdentifiedModes(
        Aeroelastic(model.condition, model.modes, derivatives),
        UncertainDerivatives(where[:, 0], where[:, 1], covariance[np.ix_(selected, selected)]),
        StiffnessError(np.array(relative_std), model.condition.dynamic_pressure),
    )


def load_run_modes(store: Store, run: EstimationRun, maneuver: Maneuver) -> AircraftModes:
    """Load the modes of the tables with which a run was estimated."""
    tables = find_modal_tables(
        store, maneuver.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    return load_modes(store, *tables)
