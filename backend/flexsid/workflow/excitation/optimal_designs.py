"""Optimal designs: power spectra for one objective within limits, and their gain in flight time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Annotated

import numpy as np
from scipy import linalg, optimize

from flexsid.allowed import Allowed, Id, Name
from flexsid.errors import BadInput
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.job import Job
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.excitation import designer
from flexsid.sysid.excitation.fisher_information import LOAD_FACTOR, FisherInformation
from flexsid.sysid.excitation.input_optimisation import (
    Candidate,
    Criterion,
    build_discrimination_criterion,
    build_variance_criterion,
    optimise_powers,
)
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import compute_crossing_slopes, compute_damping_slopes
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.workflow.excitation.classic_inputs import ExcitationPeaks, find_peaks
from flexsid.workflow.excitation.excitation_designs import build_multisine, check_amplitudes
from flexsid.workflow.excitation.predicted_accuracy import (
    Deflection,
    DesignQuery,
    Limit,
    PredictionModel,
    Rate,
    identify_design_query,
    load_prediction_model,
)
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.exports import build_identified_model, read_covariance
from flexsid.workflow.runs.run_identity import list_run_contents

_AIRSPEEDS = np.linspace(0.35, 2.0, 120)
"""Airspeeds of the search for a crossing, of the airspeed flown: as in a flutter prediction."""

_DRAWS = 6  # of the derivatives within their prior spread, in addition to their values
_LEVELS = (0.25, 0.5, 1.0)  # of the largest amplitude within the limits
_MOST_TIME = 1e3  # of the duration: longest flight time that is compared
_SEARCHED = 0.4  # share of the progress when the search for phases starts


class Objective(StrEnum):
    """What the maneuver is flown for."""

    FLUTTER = "flutter"
    DERIVATIVES = "derivatives"
    DAMPING = "damping"
    STRUCTURES = "structures"


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimalDesignQuery(DesignQuery):
    """Standard design, run with model and noise, objective, and limits.

    ``derivatives`` belong to the objective of the same name, ``mode`` is the name of the root for
    damping, ``other_run_id`` has the smaller of two model structures. Limits are those of the
    standard design at its level by default: [rad], [rad/s], [g]. ``spread`` is the relative
    standard deviation of the run's derivatives, over which the objective is averaged [1];
    with ``after_run`` the data of the run count as flown, and the design adds to them.
    """

    objective: Objective
    derivatives: Annotated[
        tuple[Name, ...], Allowed(max_length=500, text="Derivatives of the objective.")
    ] = ()
    mode: Annotated[
        str | None, Allowed(max_length=40, text="Name of the root whose damping is the objective.")
    ] = None
    other_run_id: Annotated[
        Id | None, Allowed(text="Id of the run with the smaller model structure.")
    ] = None
    deflection: Deflection | None = None
    rate: Rate | None = None
    load_factor: Annotated[
        Limit | None, Allowed(text="Largest load factor; by default that of the design. [g]")
    ] = None
    spread: Annotated[
        float,
        Allowed(
            ge=0.0,
            le=0.5,
            text="Relative standard deviation of the derivatives before the flight.",
        ),
    ] = 0.0
    after_run: Annotated[bool, Allowed(text="The data of the run count as flown.")] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitedPeak:
    """A limited quantity and its peaks with the standard and the optimal design.

    Deflections and rates are those of the surface that uses most. [rad], [rad/s], [g]
    """

    name: str
    limit: float
    standard: float
    optimal: float


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimalDesign:
    """An optimal design and what is gained over the standard design within the same limits.

    ``quantity`` names the figures of both. ``standard_time_s`` is the flight time in which the
    standard design reaches the figure of the optimal one; None beyond a thousand periods. Both
    have the largest amplitudes within the limits, the high ones of the stored optimal design.
    """

    quantity: str
    unit: str
    standard: float
    optimal: float
    duration_s: float
    standard_time_s: float | None
    limits: tuple[LimitedPeak, ...]
    optimal_design_id: int = 0


@dataclass(frozen=True, slots=True)
class FoundDesign:
    """An optimal design before storage, and its gain."""

    design: ExcitationDesign
    gain: OptimalDesign


def identify_optimal_design(store: Store, query: OptimalDesignQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the objective lacks its derivatives, mode or run, or names unknown ones.
    UnknownRecord, Conflict
        As ``identify_design_query``.
    """
    contents = identify_design_query(store, query)
    result = get_result(store.runs.get(query.run_id))
    given = {
        Objective.DERIVATIVES: bool(query.derivatives),
        Objective.DAMPING: query.mode is not None,
        Objective.STRUCTURES: query.other_run_id is not None,
    }
    needed = {
        Objective.DERIVATIVES: "derivatives",
        Objective.DAMPING: "mode",
        Objective.STRUCTURES: "other_run_id",
    }
    for objective, field in needed.items():
        if given[objective] != (query.objective is objective):
            raise BadInput(
                f"'{field}' belongs to the objective '{objective}'; give it with this objective"
                " only",
                code="bad-objective",
                field=field,
            )
    known = [row.name for row in result.parameters]
    for name in query.derivatives:
        if name not in known:
            raise BadInput(
                f"run {query.run_id} did not estimate '{name}'; it has {', '.join(known)}",
                code="unknown-derivative",
                name=name,
            )
    roots = [pole.name for pole in result.poles if pole.imag > 0.0]
    if query.mode is not None and query.mode not in roots:
        raise BadInput(
            f"run {query.run_id} has no oscillatory root '{query.mode}'; it has {', '.join(roots)}",
            code="unknown-mode",
            name=query.mode,
        )
    if query.other_run_id is not None:
        other = store.runs.get(query.other_run_id)
        smaller = {row.name for row in get_result(other).parameters}
        if not set(known) > smaller:
            raise BadInput(
                f"run {query.run_id} does not estimate all parameters of run"
                f" {query.other_run_id} and further ones; select the run with the larger model"
                " structure, and as the other one that with the smaller",
                code="not-nested",
            )
        contents = (*contents, *list_run_contents(store, (query.other_run_id,)))
    return contents


def compute_optimal_design(
    store: Store, query: OptimalDesignQuery, report: ReportProgress
) -> FoundDesign:
    """Optimise the powers of a design's harmonics for an objective, and search their phases.

    Raises
    ------
    BadInput
        If the model has no flutter within twice the airspeed flown, or a limit is missing.
    NotIdentifiable
        If the design does not determine the free parameters.
    OptimisationFailed
        If the optimum is not reached.
    """
    at, design = load_prediction_model(store, query.run_id), store.designs.get(query.design_id)
    multisine = build_multisine(design, query.level)
    standard = at.predict_multisine(multisine)
    own = find_peaks(standard, multisine.period_s)
    limits = own.override(query.deflection, query.rate, query.load_factor)
    report(Progress(fraction=0.05, message="Predicting the information of every harmonic"))
    prior = _build_prior(store, at, query)
    nominal = at.parameters.start
    criterion = _build_criterion(store, at, query, nominal)
    candidates = [
        Candidate(_collect_factors(standard, multisine), prior, criterion),
        *_draw_candidates(store, at, query, multisine, prior),
    ]
    report(Progress(fraction=0.2, message="Optimising the powers"))
    powers = optimise_powers(candidates, _compute_usage(standard, multisine, own, limits))
    made = _search_phases(design, multisine, powers, report)
    first = at.predict_multisine(build_multisine(made, 2))
    scale = limits.find_scale(find_peaks(first, multisine.period_s))
    peaks = tuple(level * scale * made.specification.peaks[2] for level in _LEVELS)
    # pyrefly: ignore[bad-argument-type]
    made = replace(made, specification=replace(made.specification, peaks=peaks))
    check_amplitudes(made.specification)
    best = at.predict_multisine(build_multisine(made, 2))
    factor = limits.find_scale(own)
    scaled = at.predict_multisine(multisine.scale(factor))
    figures = [criterion(_predict_covariance(one, prior))[0] for one in (scaled, best)]
    quantity, unit, describe = _describe(query)
    found, reached = (find_peaks(one, multisine.period_s) for one in (scaled, best))
    time_s = _find_standard_time(scaled, prior, criterion, figures[1], multisine.period_s)
    sizes = [describe(value) for value in figures]
    note = (
        f"Optimised for {quantity} with run {query.run_id}: {sizes[1]:.3g} {unit}, {design.name}"
        f" {sizes[0]:.3g} {unit} within the same limits at its high amplitude"
    )
    gain = OptimalDesign(
        quantity=quantity,
        unit=unit,
        standard=sizes[0],
        optimal=sizes[1],
        duration_s=multisine.period_s,
        standard_time_s=time_s,
        limits=tuple(
            LimitedPeak(
                name=name,
                limit=getattr(limits, name),
                standard=getattr(found, name),
                optimal=getattr(reached, name),
            )
            for name in ("deflection", "rate", "load_factor")
        ),
    )
    return FoundDesign(replace(made, note=note), gain)


def store_optimal_design(
    store: Store, job: Job, query: OptimalDesignQuery, found: FoundDesign
) -> OptimalDesign:
    """Store an optimal design, and return its gain with its id."""
    return replace(found.gain, optimal_design_id=store.designs.add(found.design).id or 0)


def _build_prior(store: Store, at: PredictionModel, query: OptimalDesignQuery) -> np.ndarray:
    """Build the prior information: of the run's data if they count as flown, else its priors."""
    if not query.after_run:
        return np.diag(
            [at.priors[n] ** -2.0 if n in at.priors else 0.0 for n in at.parameters.names]
        )
    names, covariance = read_covariance(store, get_result(at.run))
    order = [names.index(name) for name in at.parameters.names]
    C = covariance[np.ix_(order, order)]
    scale = np.sqrt(np.diag(C))
    factor = linalg.cho_factor(C / np.outer(scale, scale))
    return linalg.cho_solve(factor, np.eye(scale.size)) / np.outer(scale, scale)


def _build_criterion(
    store: Store, at: PredictionModel, query: OptimalDesignQuery, theta: np.ndarray
) -> Criterion:
    """Build the criterion of an objective for values of the parameters."""
    names, n = at.parameters.names, at.parameters.rows.size
    if query.objective is Objective.DERIVATIVES:
        columns = [names.index(name) for name in query.derivatives]
        slopes = np.zeros((len(names), len(columns)))
        slopes[columns, range(len(columns))] = 1.0 / theta[columns]
        return build_variance_criterion(slopes)
    if query.objective is Objective.STRUCTURES:
        smaller = get_result(store.runs.get(query.other_run_id or 0)).parameters
        common = {row.name for row in smaller} | at.nuisance
        terms = np.array([name not in common for name in names])
        return build_discrimination_criterion(theta[terms], terms)
    model = build_identified_model(at.model, at.run).model
    table = at.parameters.table(theta)
    aircraft = Aeroelastic(model.condition, model.modes, table, model.shape)
    places = at.parameters.rows, at.parameters.columns
    slopes = np.zeros((len(names), 1))
    if query.objective is Objective.DAMPING:
        if model.shape is not None:
            raise BadInput(
                f"run {at.run.id} has derivatives with a frequency shape, and the damping objective"
                " requires quasi-steady ones; select a quasi-steady run",
                code="not-with-shape",
                run_id=at.run.id,
            )
        pole = next(pole for pole in get_result(at.run).poles if pole.name == query.mode)
        root = complex(pole.real, pole.imag)
        slopes[:n, 0] = compute_damping_slopes(aircraft, root, *places)
        return build_variance_criterion(slopes)
    crossing = track_roots(aircraft, model.condition.airspeed * _AIRSPEEDS).flutter
    if crossing is not None:
        slopes[:n, 0] = compute_crossing_slopes(aircraft, crossing, *places)
    if crossing is None or not np.isfinite(slopes).all():
        raise BadInput(
            f"the model of run {at.run.id} has no flutter up to {_AIRSPEEDS[-1]:g} times the"
            " airspeed flown; select another objective, or a run with the modes of the flutter",
            code="no-flutter",
            run_id=at.run.id,
        )
    return build_variance_criterion(slopes)


def _draw_candidates(
    store: Store,
    at: PredictionModel,
    query: OptimalDesignQuery,
    multisine: Multisine,
    prior: np.ndarray,
) -> list[Candidate]:
    """Draw derivatives within their spread; values without flutter have no such objective."""
    found = []
    rng = np.random.default_rng(at.run.id or 0)
    for _ in range(_DRAWS if query.spread > 0.0 else 0):
        theta = at.parameters.start.copy()
        theta[: at.parameters.rows.size] *= 1.0 + query.spread * rng.standard_normal(
            at.parameters.rows.size
        )
        try:
            criterion = _build_criterion(store, at, query, theta)
        except BadInput:
            continue
        there = replace(at, parameters=replace(at.parameters, start=theta))
        information = there.predict_multisine(multisine)
        found.append(Candidate(_collect_factors(information, multisine), prior, criterion))
    return found


def _collect_factors(information: FisherInformation, multisine: Multisine) -> np.ndarray:
    """Collect factors of the information of every harmonic of unit power, by input."""
    found = []
    for spectra, tones in zip(information.lines, multisine.tones.values(), strict=True):
        J = spectra.sensitivity / tones.amplitudes[:, None, None]
        found.append(np.sqrt(2.0) * np.concatenate([np.real(J), np.imag(J)], axis=1))
    return np.concatenate(found)


def _compute_usage(
    information: FisherInformation,
    multisine: Multisine,
    peaks: ExcitationPeaks,
    limits: ExcitationPeaks,
) -> np.ndarray:
    """Compute the share of every limit that unit power of each harmonic uses.

    A row for the deflection of every surface, its rate, and the load factor. Peaks have the ratio
    to the root mean square that the largest ones have with the standard design.
    """
    found = []
    for wave, tones in zip(information.waves, multisine.tones.values(), strict=True):
        size = np.abs(np.fft.rfft(wave, axis=0)[tones.harmonics]) * 2.0 / len(wave)
        size /= tones.amplitudes[:, None]
        omega = 2.0 * np.pi * tones.harmonics[:, None] / multisine.period_s
        moving = [k for k, name in enumerate(information.limited) if name != LOAD_FACTOR]
        load = information.limited.index(LOAD_FACTOR)
        found.append(np.hstack([size[:, moving], omega * size[:, moving], size[:, [load]]]))
    response = 0.5 * np.concatenate(found) ** 2
    amplitudes = np.concatenate([tones.amplitudes for tones in multisine.tones.values()])
    power = amplitudes**2 @ response
    n = (response.shape[1] - 1) // 2
    groups = (slice(0, n), slice(n, 2 * n), slice(2 * n, None))
    usage = np.empty_like(response)
    for columns, peak, limit in zip(
        groups,
        (peaks.deflection, peaks.rate, peaks.load_factor),
        (limits.deflection, limits.rate, limits.load_factor),
        strict=True,
    ):
        crest = peak**2 / power[columns].max()
        usage[:, columns] = response[:, columns] * crest / limit**2
    return usage.T


def _search_phases(
    design: ExcitationDesign,
    multisine: Multisine,
    powers: np.ndarray,
    report: ReportProgress,
) -> ExcitationDesign:
    """Search the phases of optimal powers; the relative peaks are those of the powers."""
    ends = np.cumsum([tones.harmonics.size for tones in multisine.tones.values()])[:-1]
    of_input = dict(zip(multisine.inputs, np.split(powers, ends), strict=True))
    specification = replace(
        design.specification,
        peaks=(1.0, 1.0, 1.0),
        inputs=tuple(
            replace(own, relative_peak=1.0, power=tuple((p / p.sum()).tolist()))
            for own in design.specification.inputs
            for p in (of_input[own.name],)
        ),
    )

    def report_best(name: str, best: float, fraction: float) -> None:
        message = f"{name} at a relative peak factor of {best:.4f}"
        report(Progress(fraction=_SEARCHED + (0.9 - _SEARCHED) * fraction, message=message))

    made = designer.design(specification, report_best)
    sizes = {
        name: float(np.sqrt(of_input[name].sum() / np.sum(tones.amplitudes**2)))
        for name, tones in made.tones.items()
    }
    largest = max(sizes.values())
    inputs = tuple(
        replace(own, relative_peak=sizes[own.name] / largest) for own in specification.inputs
    )
    return ExcitationDesign(
        name=f"{design.name}, optimal"[:200],
        specification=replace(specification, inputs=inputs, peaks=(largest, largest, largest)),
        phases={name: tuple(tones.phases.tolist()) for name, tones in made.tones.items()},
        peak_factors=designer.compute_peak_factors(made),
    )


def _predict_covariance(
    information: FisherInformation, prior: np.ndarray, times: float = 1.0
) -> np.ndarray:
    """Predict the covariance of the parameters when the maneuver is flown a number of times."""
    total = times * information.information.sum(axis=0) + prior
    scale = np.sqrt(np.maximum(np.diag(total), 1e-300))
    factor = linalg.cho_factor(total / np.outer(scale, scale))
    return linalg.cho_solve(factor, np.eye(scale.size)) / np.outer(scale, scale)


def _find_standard_time(
    information: FisherInformation,
    prior: np.ndarray,
    criterion: Criterion,
    reached: float,
    period_s: float,
) -> float | None:
    """Find the flight time of the standard design to the figure of the optimal one. [s]"""

    def miss(log_times: float) -> float:
        return criterion(_predict_covariance(information, prior, np.exp(log_times)))[0] - reached

    low, high = -np.log(_MOST_TIME), np.log(_MOST_TIME)
    if miss(low) < 0.0 or miss(high) > 0.0:
        return None
    return period_s * float(np.exp(optimize.brentq(miss, low, high)))


def _describe(query: OptimalDesignQuery) -> tuple[str, str, Callable[[float], float]]:
    """Return quantity, unit and value of a criterion."""
    if query.objective is Objective.FLUTTER:
        return "standard error of the flutter speed", "m/s", lambda value: float(np.exp(value / 2))
    if query.objective is Objective.DAMPING:
        name = f"standard error of the damping ratio of {query.mode}"
        return name, "1", lambda value: float(np.exp(value / 2))
    if query.objective is Objective.DERIVATIVES:
        n = len(query.derivatives)
        name = "root mean square of the relative standard errors"
        return name, "1", lambda value: float(np.exp(value / 2) / np.sqrt(n))
    name = "distance of the two model structures in standard deviations"
    return name, "1", lambda value: float(np.exp(-value / 2))
