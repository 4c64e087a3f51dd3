"""Models of one run for flutter prediction: as estimated, and as refitted to bound its errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Progress, RetainedModes
from flexsid.storage.store import Store
from flexsid.sysid.estimation.priors import Priors, build_information
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, coefficients, variables
from flexsid.sysid.model.reduction import compute_modal_errors
from flexsid.sysid.stability.derivative_fusion import (
    DerivativePrior,
    IdentifiedModes,
    StiffnessError,
)
from flexsid.sysid.stability.flutter_extrapolation import FlownPoint
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_prediction,
    select_prediction,
)
from flexsid.workflow.modal_data.modal_tables import AircraftModes, find_modal_tables, load_modes
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.derived_runs import (
    DerivedRuns,
    coarsen_mesh,
    extend_with_predicted_modes,
    find_omitted_modes,
    remove_highest_mode,
)
from flexsid.workflow.runs.exports import IdentifiedModel, load_identified_model, read_covariance


class UnmodelledModes(StrEnum):
    """Treatment of the modes omitted by a run."""

    PREDICTED = "predicted"
    RESIDUALIZED = "residualized"


@dataclass(frozen=True, slots=True)
class Root:
    """An identified root with positive imaginary part. [rad/s]"""

    value: complex
    damping_std: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunModel:
    """Identified model of one run, or of a refit of it.

    ``fitted`` is the refit, or the run itself. ``source`` is the prediction of further modes in a
    refit, and ``gain`` the increase in log likelihood per measured value by them;
    ``omitted_modes`` are modes of a prediction that the model lacks. ``check`` is a refit that only
    bounds an error: with one mode fewer, or with the shape of a ``coarse_mesh``. ``evidence`` are
    all roots of the fit at the flown condition.
    """

    run: EstimationRun
    fitted: EstimationRun
    maneuver: Maneuver
    found: IdentifiedModes
    roots: Mapping[str, Root]
    evidence: FlownPoint
    source: str | None = None
    omitted_modes: tuple[int, ...] = ()
    gain: float = 0.0
    check: bool = False
    coarse_mesh: bool = False

    @property
    def retained_modes(self) -> tuple[int, ...]:
        """Out-of-band modes that the fit retained as nuisance parameters."""
        retained = get_result(self.fitted).retained
        return () if retained is None else retained.modes

    @property
    def poles(self) -> dict[str, complex]:
        """Roots by name. [rad/s]"""
        return {name: root.value for name, root in self.roots.items()}


def scale_to_fuel(store: Store, part: RunModel, fuel: float) -> IdentifiedModes:
    """Scale derivatives of a run to another fuel weight by the ratio of predicted values.

    Mode shapes change with fuel, and with them every generalised force; a prediction with a wrong
    level is assumed right in proportion. A derivative that passes through zero is multiplied by a
    large factor, and its error with it, so that its weight is small.
    """
    factor = compute_fuel_factors(store, part, fuel)
    table = part.found.aircraft.derivatives
    moved = replace(table, values=table.values * factor)
    known = part.found.uncertain
    own, prior = factor[known.rows, known.columns], part.found.prior
    outer = np.outer(own, own)
    modal = table.body.size + np.arange(len(table.modes))
    stiffness = part.found.stiffness
    if stiffness is not None and stiffness.slopes is not None:
        stiffness = replace(stiffness, slopes=stiffness.slopes * factor[modal, modal])
    if stiffness is not None and stiffness.damping_slopes is not None:
        of_rate = factor[modal, modal + modal.size]
        stiffness = replace(stiffness, damping_slopes=stiffness.damping_slopes * of_rate)
    return replace(
        part.found,
        aircraft=replace(part.found.aircraft, derivatives=moved),
        uncertain=replace(known, covariance=known.covariance * outer),
        stiffness=stiffness,
        prior=prior
        and replace(prior, mean=own * prior.mean, precision=prior.precision / np.outer(own, own)),
    )


def compute_fuel_factors(store: Store, part: RunModel, fuel: float) -> np.ndarray:
    """Compute the ratios of all predicted derivatives at a fuel weight to those as flown.

    They are one where the run has no prediction.
    """
    before = part.maneuver.condition.fuel_fraction
    table = part.found.aircraft.derivatives
    factor = np.ones(table.values.shape)
    prediction_id = part.run.prediction_id or get_result(part.run).prediction_id
    prediction = select_prediction(
        store, part.maneuver.aircraft_id, prediction_id, table.modes, table.inputs, table.body
    )
    if prediction is None or fuel == before:
        return factor
    there, here = (interpolate_prediction(store, prediction, f) for f in (fuel, before))
    rows = coefficients(table.modes, table.body)
    columns = variables(table.modes, table.inputs, table.body)
    for i, row in enumerate(rows):
        for j, column in enumerate(columns):
            name = f"{row}_{column}"
            if name in there and name in here and here[name][0] != 0.0:
                factor[i, j] = there[name][0] / here[name][0] or 1.0
    return factor


def load_run_models(
    store: Store,
    run_id: int,
    unmodelled_modes: UnmodelledModes,
    derived: DerivedRuns,
    at: Progress,
) -> tuple[RunModel, ...]:
    """Load a run as estimated, and its refit with omitted modes of a prediction if requested.

    The refit precedes the run. It is omitted if it failed, as ``derived`` then lists.
    """
    run = store.runs.get(run_id)
    maneuver = store.maneuvers.get(run.maneuver_id)
    model = load_identified_model(store, run)
    modes = load_run_modes(store, run, maneuver)
    omitted = find_omitted_modes(store, run, modes, model.model)
    alone = replace(_build_model(store, run, maneuver, model), omitted_modes=omitted)
    if unmodelled_modes is UnmodelledModes.RESIDUALIZED or get_result(run).retained is not None:
        return (alone,)
    wider = extend_with_predicted_modes(store, run, model, modes)
    if wider is None:
        return (alone,)
    purpose = f"include modes {', '.join(map(str, wider.modes))} as predicted by {wider.source}"
    fitted = derived.fit(run, wider.run, purpose, at)
    if fitted is None:
        return (alone,)
    wide = replace(_load_refit(store, alone, fitted), source=wider.source, omitted_modes=())
    return wide, alone


def load_model_with_fewer_modes(
    store: Store, part: RunModel, derived: DerivedRuns, at: Progress
) -> RunModel | None:
    """Load the refit of a run with one mode fewer; None where no mode remains, or it failed."""
    fewer = remove_highest_mode(part.run)
    if fewer is None:
        return None
    purpose = "bound the effect of omitted modes by one mode fewer"
    fitted = derived.fit(part.run, fewer, purpose, at)
    return None if fitted is None else replace(_load_refit(store, part, fitted), check=True)


def load_model_of_coarse_mesh(
    store: Store, part: RunModel, derived: DerivedRuns, at: Progress
) -> RunModel | None:
    """Load the refit of a run with the frequency shape of a coarser mesh; None without one."""
    coarse = coarsen_mesh(store, part.run, part.fitted)
    if coarse is None:
        return None
    purpose = "bound the effect of the mesh of the frequency shape by a coarser one"
    fitted = derived.fit(part.run, coarse, purpose, at)
    if fitted is None:
        return None
    return replace(_load_refit(store, part, fitted), check=True, coarse_mesh=True)


def _load_refit(store: Store, part: RunModel, fitted: EstimationRun) -> RunModel:
    """Load a refit of a run, with its gain in log likelihood over the run."""
    before, now = (get_result(one).fit for one in (part.run, fitted))
    gain = 0.0
    if before.cost is not None and now.cost is not None:
        gain = (before.cost - now.cost) / (before.n_lines * len(before.r_squared))
    model = load_identified_model(store, fitted)
    return replace(
        _build_model(store, fitted, part.maneuver, model),
        run=part.run,
        omitted_modes=part.omitted_modes,
        gain=gain,
    )


def _build_model(
    store: Store, run: EstimationRun, maneuver: Maneuver, identified: IdentifiedModel
) -> RunModel:
    result = get_result(run)
    names, covariance = read_covariance(store, result)
    return RunModel(
        run=run,
        fitted=run,
        maneuver=maneuver,
        found=_build_identified_modes(
            identified.model,
            identified.derivatives,
            names,
            covariance,
            load_run_modes(store, run, maneuver),
            result.retained,
            identified.priors,
        ),
        roots={
            p.name: Root(complex(p.real, p.imag), p.damping_std) for p in result.poles if p.imag > 0
        },
        evidence=_collect_roots(
            [(complex(p.real, p.imag), p.real_std) for p in result.poles],
            maneuver,
            _find_band(store, run),
            f"run {run.derived_from_run_id or run.id}",
        ),
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
    known: AircraftModes,
    retained: RetainedModes | None = None,
    priors: Mapping[str, tuple[float, float]] | None = None,
) -> IdentifiedModes:
    """Build identified modes from derivatives and their part of the covariance.

    Modes and derivatives have the order of the modal table, whichever modes a run retained: runs
    of the same modes are fused.
    """
    modes = model.modes
    if model.shape is None:
        modes = modes.select(tuple(sorted(modes.numbers)))
        derivatives = derivatives.select(modes.numbers, derivatives.inputs)
    rows = coefficients(derivatives.modes, derivatives.body)
    columns = variables(derivatives.modes, derivatives.inputs, derivatives.body)
    places = {f"{r}_{c}": (i, j) for i, r in enumerate(rows) for j, c in enumerate(columns)}
    selected = [k for k, name in enumerate(names) if name in places]
    selected.sort(key=lambda k: places[names[k]])
    where = np.array([places[names[k]] for k in selected], dtype=int).reshape(-1, 2)
    order = [model.modes.numbers.index(number) for number in modes.numbers]
    slopes, damping_slopes = (found[order] for found in _compute_modal_slopes(model))

    def collect(kind: str, of_table: Mapping[int, float]) -> np.ndarray:
        std = dict(zip(names, np.sqrt(np.diag(covariance)).tolist(), strict=True))
        return np.array([std.get(f"{kind}_{n}", of_table[n]) for n in derivatives.modes])

    at = model.condition
    return IdentifiedModes(
        Aeroelastic(model.condition, modes, derivatives, model.shape),
        UncertainDerivatives(where[:, 0], where[:, 1], covariance[np.ix_(selected, selected)]),
        StiffnessError(
            collect("omega", known.frequency_std),
            at.dynamic_pressure,
            slopes,
            collect("zeta", known.damping_std),
            at.density * at.airspeed,
            damping_slopes,
        ),
        _get_prior(retained, priors or {}, [names[k] for k in selected]),
    )


def _compute_modal_slopes(model: AeroelasticModel) -> tuple[np.ndarray, np.ndarray]:
    """Compute the changes of each C_Qi_etai and C_Qi_etadoti with errors of the modal table.

    The relative errors are those of the mode's frequency and of its damping ratio.
    """
    n = len(model.modes.numbers)
    row = model.body.size + np.arange(n)
    of_frequency = compute_modal_errors(model, np.ones(n), np.zeros(n)).values
    of_damping = compute_modal_errors(model, np.zeros(n), np.ones(n)).values
    return of_frequency[row, row], of_damping[row, row + n]


def _get_prior(
    retained: RetainedModes | None, priors: Mapping[str, tuple[float, float]], names: list[str]
) -> DerivativePrior | None:
    """Return the priors of derivatives of a run, of the analyst and of retained modes."""
    of_retained = () if retained is None else retained.parameters
    nuisance = {row.name: (row.prior, row.prior_std) for row in of_retained}
    known = Priors(dict(priors) | nuisance, getattr(priors, "joint", None))
    if not known:
        return None
    mean = np.array([known.get(name, (0.0, np.inf))[0] for name in names])
    precision = 2.0 * build_information(names, known)
    return DerivativePrior(mean, precision, np.array([name in nuisance for name in names]))


def load_run_modes(store: Store, run: EstimationRun, maneuver: Maneuver) -> AircraftModes:
    """Load the modes of the tables with which a run was estimated."""
    tables = find_modal_tables(
        store, maneuver.aircraft_id, run.modal_table_id, run.damping_table_id
    )
    return load_modes(store, *tables)
