"""Whether one linear model holds at several amplitudes: runs of repeated levels of a multisine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexsid.allowed import RunIds
from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method, Progress, ReportProgress
from flexsid.records.validation import (
    AmplitudeComparison,
    AmplitudeQuantity,
    AmplitudeSubject,
    AmplitudeTest,
    ComparedLevel,
)
from flexsid.storage.store import Store
from flexsid.sysid.adequacy.amplitude_dependence import LevelData, LevelFit, fit_levels
from flexsid.sysid.adequacy.equal_levels import (
    SIGNIFICANCE,
    EqualityTest,
    LevelEstimates,
    Pattern,
    average_repeats,
    classify_frequency,
    compare_levels,
    estimate_change,
    estimate_effectiveness,
    find_levels,
)
from flexsid.sysid.adequacy.several_tests import adjust_by_holm
from flexsid.sysid.estimation.leakage import remove_leakage
from flexsid.sysid.stability.poles import NamedPole, compute_named_poles
from flexsid.workflow.aircraft.derivative_predictions import interpolate_prediction
from flexsid.workflow.fits.estimation_task import EstimationTask, build_experiments
from flexsid.workflow.fits.likelihood_fit import fit_without_feedback_noise
from flexsid.workflow.measurements.maneuver_spectra import read_spectra
from flexsid.workflow.measurements.recording import select_frequencies
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.review.condition_sheet import AIRSPEED_RANGE, FUEL_RANGE
from flexsid.workflow.runs.exports import collect_values
from flexsid.workflow.runs.run_identity import list_run_contents
from flexsid.workflow.validation.cross_prediction import build_identified_parameters
from flexsid.workflow.validation.cross_validation import prepare_refit

_MOST_RUNS = 20
LEAST_RATIO = 1.2
"""Ratio of the largest amplitude to the smallest; less is no other level."""
_OUT_OF_PROPORTION = 0.2  # motion of an input, relative: more is no level of the same multisine
_LEAST_RAD = 1e-12  # of an input that does not move
_FITTED = 0.8  # share of the work before the fits with common weights


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeComparisonQuery:
    """Output-error runs of maneuvers with one multisine at several amplitudes, sorted by id."""

    run_ids: RunIds

    def __post_init__(self) -> None:
        """Sort the ids: the same set is the same request."""
        object.__setattr__(self, "run_ids", tuple(sorted(set(self.run_ids))))


@dataclass(frozen=True, slots=True)
class _Flown:
    """A run with its maneuver and the rms deflection of its inputs. [rad]"""

    run: EstimationRun
    maneuver: Maneuver
    amplitude: float


def identify_amplitude_comparison(
    store: Store, query: AmplitudeComparisonQuery
) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the runs are not of output error, are of one maneuver or of several together, have other
        structures or conditions, or all maneuvers have the same amplitude.
    UnknownRecord
        If a run does not exist.
    Conflict
        If a run has no result, or it was altered.
    """
    _read_runs(store, query)
    return list_run_contents(store, query.run_ids)


def compare_amplitudes(
    store: Store, query: AmplitudeComparisonQuery, report: ReportProgress
) -> AmplitudeComparison:
    """Test whether derivatives, modes and inputs are the same at all amplitudes.

    Raises
    ------
    BadInput
        If runs cannot be compared, as ``identify_amplitude_comparison``, or differ in frequencies
        or channels.
    NotIdentifiable
        If a fit with the common weights has no optimum.

    Notes
    -----
    Derivatives are moved to the fuel of the largest level by the difference of the prediction, and
    poles are those at its condition.
    """
    flown = _read_runs(store, query)
    tasks, data = [], []
    for number, one in enumerate(flown):
        message = f"Reading {one.maneuver.label}"
        report(Progress(fraction=_FITTED * number / len(flown), message=message))
        task, level = _prepare_level(store, one, report)
        tasks.append(task)
        data.append(level)
    report(Progress(fraction=_FITTED, message="Fitting all levels with the same weights"))
    priors = tasks[-1].list_priors()
    fits = fit_levels(data, {n: v for n, v in priors.items() if n in data[-1].parameters.names})
    overlap = [max(m.measured.resolution_overlap for m in task.maneuvers) for task in tasks]
    moved = [
        LevelFit(
            fit.values + _find_moves(store, one, flown[-1], level.parameters.names),
            factor * fit.covariance,
        )
        for fit, one, level, factor in zip(fits, flown, data, overlap, strict=True)
    ]
    return _assess(flown, tasks[-1], data, moved)


def _read_runs(store: Store, query: AmplitudeComparisonQuery) -> list[_Flown]:
    """Read runs that can be compared, the smallest amplitude first."""
    if not 2 <= len(query.run_ids) <= _MOST_RUNS:
        raise BadInput(
            f"{len(query.run_ids)} runs selected; amplitudes are compared by 2 to {_MOST_RUNS} "
            "runs of maneuvers at several levels",
            code="number-of-runs",
        )
    runs = [store.runs.get(number) for number in query.run_ids]
    maneuvers = [store.maneuvers.get(run.maneuver_id) for run in runs]
    for run, maneuver in zip(runs, maneuvers, strict=True):
        get_result(run)
        _check_run(run, runs[0])
        _check_condition(maneuver, maneuvers[0])
    if len({one.id for one in maneuvers}) < len(maneuvers):
        raise BadInput(
            "two of these runs are of one maneuver; amplitudes are compared by one run of each",
            code="same-maneuver",
        )
    by_input = [measure_amplitudes(store, maneuver) for maneuver in maneuvers]
    odd = find_odd_inputs(by_input)
    if odd:
        index, (name, ratio) = next(iter(odd.items()))
        raise BadInput(
            f"{name} moves in {maneuvers[index].label} by {ratio:.0%} of its motion in the others, "
            "in proportion to the other inputs; levels of one multisine differ in its amplitude "
            "alone: leave this run out",
            code="different-inputs",
            maneuver_id=maneuvers[index].id,
            input=name,
        )
    flown = [
        _Flown(run, maneuver, combine_amplitudes(own))
        for run, maneuver, own in zip(runs, maneuvers, by_input, strict=True)
    ]
    flown.sort(key=lambda one: one.amplitude)
    if flown[-1].amplitude < LEAST_RATIO * flown[0].amplitude:
        raise BadInput(
            "all of these maneuvers have about the same amplitude, "
            f"{np.degrees(flown[0].amplitude):.3g} to {np.degrees(flown[-1].amplitude):.3g} deg "
            "rms; select runs of a smaller or larger level, e.g. of FTA 507 beside 506",
            code="one-amplitude",
        )
    return flown


def _check_run(run: EstimationRun, first: EstimationRun) -> None:
    if run.method is not Method.OE:
        raise BadInput(
            f"run {run.id} is of {run.method.value}; amplitudes are compared by output error: "
            "select OE runs",
            code="not-output-error",
            run_id=run.id,
        )
    if run.settings.additional_maneuver_ids:
        raise BadInput(
            f"run {run.id} is of several maneuvers together; select runs of one each",
            code="several-maneuvers",
            run_id=run.id,
        )
    if get_compared_structure(run) != get_compared_structure(first):
        raise BadInput(
            f"run {run.id} has another model structure than run {first.id}; estimate all maneuvers "
            "with one structure, as a batch does",
            code="different-structures",
            run_id=run.id,
        )


def get_compared_structure(run: EstimationRun) -> tuple[object, ...]:
    """Return what is equal in runs that are compared: axis, modes, free derivatives, channels."""
    own = run.structure
    return own.axis, own.modes, own.free, own.inputs, own.outputs


def _check_condition(maneuver: Maneuver, first: Maneuver) -> None:
    own, other = maneuver.condition, first.condition
    if (
        maneuver.aircraft_id != first.aircraft_id
        or abs(own.airspeed_m_s / other.airspeed_m_s - 1.0) > AIRSPEED_RANGE
        or abs(own.fuel_fraction - other.fuel_fraction) > FUEL_RANGE
    ):
        raise BadInput(
            f"{maneuver.label} was not flown at the condition of {first.label}: amplitudes are "
            f"compared of one aircraft within {AIRSPEED_RANGE:.0%} of airspeed and "
            f"{FUEL_RANGE:.0%} of fuel",
            code="different-conditions",
            maneuver_id=maneuver.id,
        )


def measure_amplitudes(store: Store, maneuver: Maneuver) -> dict[str, float]:
    """Measure the rms deflection of every excited input at the harmonics. [rad]

    Raises
    ------
    BadInput
        If the excitation is not known.
    """
    excitation = maneuver.excitation
    if excitation is None:
        raise BadInput(
            f"the excitation of {maneuver.label} is not known, and with it its amplitude",
            code="no-excitation",
            maneuver_id=maneuver.id,
        )
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    names = tuple(excitation.harmonics)
    found = read_spectra(store, maneuver, aircraft, names, select_frequencies(maneuver))
    duration_s = excitation.period_s * max(excitation.n_periods - 1, 1)
    rms = np.sqrt(2.0 * np.sum(np.abs(found.values) ** 2, axis=0)) / duration_s
    return dict(zip(found.names, rms.tolist(), strict=True))


def combine_amplitudes(by_input: Mapping[str, float]) -> float:
    """Return the rms deflection of all inputs together. [rad]"""
    return float(np.linalg.norm(list(by_input.values())))


def find_odd_inputs(amplitudes: Sequence[Mapping[str, float]]) -> dict[int, tuple[str, float]]:
    """Find maneuvers in which an input does not move in proportion to the others.

    As where a surface is stuck or limited. Motion is relative to the median of the inputs of a
    maneuver, and the usual one of an input is the median of the maneuvers.

    Returns
    -------
    dict
        Input that differs most and its motion over the usual one, by index of the maneuver.
    """
    names = list(amplitudes[0])
    values = np.array([[one.get(name, 0.0) for name in names] for one in amplitudes])
    relative = values / np.maximum(np.median(values, axis=1, keepdims=True), _LEAST_RAD)
    ratio = relative / np.maximum(np.median(relative, axis=0), _LEAST_RAD)
    worst = np.argmax(np.abs(ratio - 1.0), axis=1)
    return {
        index: (names[k], float(ratio[index, k]))
        for index, k in enumerate(worst.tolist())
        if abs(ratio[index, k] - 1.0) > _OUT_OF_PROPORTION
    }


def _prepare_level(
    store: Store, one: _Flown, report: ReportProgress
) -> tuple[EstimationTask, LevelData]:
    """Prepare the data of a level, corrected as those of its run."""
    run, result = one.run, get_result(one.run)
    values = collect_values(run)
    task = prepare_refit(store, run, values).with_spreads(result.retained, result.shape_spread)
    parameters = build_identified_parameters(task, values)
    corrected = fit_without_feedback_noise(task, report, {"": parameters})
    if corrected is not None:
        (experiment,) = corrected.experiments
    else:
        (experiment,) = build_experiments(task)
        experiment = remove_leakage(experiment, parameters, parameters.start)
    return task, LevelData(experiment, parameters, one.amplitude)


def _find_moves(store: Store, one: _Flown, to: _Flown, names: Sequence[str]) -> np.ndarray:
    """Find the predicted change of parameters from the fuel of a level to that of another."""
    moves = np.zeros(len(names))
    prediction_id = one.run.prediction_id or get_result(one.run).prediction_id
    fuel, other = one.maneuver.condition.fuel_fraction, to.maneuver.condition.fuel_fraction
    if prediction_id is None or fuel == other:
        return moves
    prediction = store.predictions.get(prediction_id)
    here, there = (interpolate_prediction(store, prediction, at) for at in (fuel, other))
    for k, name in enumerate(names):
        if name in here and name in there:
            moves[k] = there[name][0] - here[name][0]
    return moves


# --- Tests of all derivatives, modes and inputs ---------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Tested:
    subject: AmplitudeSubject
    name: str
    quantities: tuple[AmplitudeQuantity, ...]
    test: EqualityTest
    pattern: Pattern | None


def _assess(
    flown: Sequence[_Flown],
    task: EstimationTask,
    data: Sequence[LevelData],
    fits: Sequence[LevelFit],
) -> AmplitudeComparison:
    amplitudes = np.array([one.amplitude for one in flown])
    names = data[-1].parameters.names
    estimates = _join(amplitudes, [(fit.values, fit.covariance) for fit in fits])
    results = [one.name for one in get_result(flown[-1].run).parameters if one.std_error]
    tested = [
        *_test_derivatives(estimates, names, results),
        *_test_modes(amplitudes, task, data[-1], fits),
        *_test_inputs(estimates, names, results, task.model.inputs),
    ]
    adjusted = adjust_by_holm([one.test.p for one in tested])
    tests = [_build_test(one, p) for one, p in zip(tested, adjusted, strict=True)]
    tests.sort(key=lambda one: one.p)
    rejecting = [one for one in tests if one.rejects]
    return AmplitudeComparison(
        is_linear=not rejecting,
        sentence=_summarise(tests, rejecting),
        levels=tuple(
            ComparedLevel(
                amplitude_rad=float(amplitudes[members].mean()),
                run_ids=tuple(flown[k].run.id or 0 for k in members),
                label=", ".join(flown[k].maneuver.label for k in members),
            )
            for members in find_levels(amplitudes)
        ),
        tests=tuple(tests),
    )


def _join(
    amplitudes: np.ndarray, levels: Sequence[tuple[np.ndarray, np.ndarray]]
) -> LevelEstimates:
    """Join levels with independent errors, and average the repeats of each."""
    n_levels, n = len(levels), levels[0][0].size
    covariance = np.zeros((n_levels, n_levels, n, n))
    for k, (_, own) in enumerate(levels):
        covariance[k, k] = own
    values = np.array([own for own, _ in levels])
    return average_repeats(LevelEstimates(amplitudes, values, covariance))


def _test_derivatives(
    estimates: LevelEstimates, names: Sequence[str], results: Sequence[str]
) -> Iterator[_Tested]:
    for name in results:
        own = estimates.select([names.index(name)])
        quantity = _describe_quantity(name, describe(name).unit or "1", own)
        yield _Tested(AmplitudeSubject.DERIVATIVE, name, (quantity,), compare_levels(own), None)


def _test_modes(
    amplitudes: np.ndarray,
    task: EstimationTask,
    last: LevelData,
    fits: Sequence[LevelFit],
) -> Iterator[_Tested]:
    """Test frequency and damping of every oscillatory pole that all levels have."""
    poles = [
        {
            pole.name: pole
            for pole in compute_named_poles(
                task.model, last.parameters, fit.values, fit.covariance, task.mode_names
            )
            if pole.value.imag > 0.0 and np.isfinite([pole.frequency_std, pole.damping_std]).all()
        }
        for fit in fits
    ]
    retained = task.mode_names[len(task.structure.modes) :]
    for name in poles[0]:
        if name in retained or not all(name in own for own in poles):
            continue
        own = _join(amplitudes, [_read_pole(level[name]) for level in poles])
        frequency, damping = own.select([0]), own.select([1])
        yield _Tested(
            AmplitudeSubject.MODE,
            name,
            (
                _describe_quantity("frequency", "Hz", frequency),
                _describe_quantity("damping", "1", damping),
            ),
            compare_levels(own),
            classify_frequency(frequency),
        )


def _read_pole(pole: NamedPole) -> tuple[np.ndarray, np.ndarray]:
    """Return frequency [Hz] and damping; where that is light, their errors are independent."""
    std = np.array([pole.frequency_std / (2.0 * np.pi), pole.damping_std])
    return np.array([pole.frequency / (2.0 * np.pi), pole.damping]), np.diag(std**2)


def _test_inputs(
    estimates: LevelEstimates,
    names: Sequence[str],
    results: Sequence[str],
    inputs: Sequence[str],
) -> Iterator[_Tested]:
    """Test a factor on all control derivatives of every input."""
    for name in inputs:
        own = [names.index(one) for one in results if one.partition("_")[2] == name]
        if len(own) < 2:
            continue
        found = estimate_effectiveness(estimates.select(own))
        pattern = None
        if found.p_common > SIGNIFICANCE:
            pattern = Pattern.SATURATION if found.factor < 1.0 else Pattern.DEAD_BAND
        quantity = AmplitudeQuantity(
            name="effectiveness",
            unit="1",
            values=(),
            std_errors=(),
            change=found.factor - 1.0,
            change_std_error=found.std_error,
        )
        chi_square = ((found.factor - 1.0) / found.std_error) ** 2
        test = EqualityTest(chi_square, 1, found.p)
        yield _Tested(AmplitudeSubject.INPUT, name, (quantity,), test, pattern)


def _describe_quantity(name: str, unit: str, own: LevelEstimates) -> AmplitudeQuantity:
    change = estimate_change(own)
    variances = np.einsum("iikk->ik", own.covariance)[:, 0]
    return AmplitudeQuantity(
        name=name,
        unit=unit,
        values=tuple(own.values[:, 0].tolist()),
        std_errors=tuple(np.sqrt(variances).tolist()),
        change=change.value,
        change_std_error=change.std_error,
    )


# --- Sentences ------------------------------------------------------------------------------------

_NAMED = 5  # tests in the sentence

_LIKE = {
    Pattern.FREEPLAY: "as with freeplay: its stiffness rises towards a limit",
    Pattern.HARDENING: "as with a stiffness that hardens with deflection",
    Pattern.STIFFENING: "as with freeplay or a hardening stiffness, which these levels do not "
    "separate",
    Pattern.SOFTENING: "as with a stiffness that softens, or joints that slip",
    Pattern.SATURATION: "in all equations alike: as with saturation of the surface",
    Pattern.DEAD_BAND: "in all equations alike: as with freeplay of its linkage",
}


def _build_test(one: _Tested, adjusted: float) -> AmplitudeTest:
    rejects = adjusted < SIGNIFICANCE
    pattern = one.pattern if rejects else None
    return AmplitudeTest(
        subject=one.subject,
        name=one.name,
        quantities=one.quantities,
        chi_square=one.test.chi_square,
        degrees_of_freedom=one.test.degrees_of_freedom,
        p=one.test.p,
        adjusted_p=adjusted,
        rejects=rejects,
        pattern=pattern,
        meaning=_describe_test(one, pattern) if rejects else "The same at all amplitudes.",
    )


def _describe_test(one: _Tested, pattern: Pattern | None) -> str:
    """Describe the change at the largest amplitude with two standard errors."""
    parts = []
    for quantity in one.quantities:
        change, error = quantity.change, 2.0 * quantity.change_std_error
        if quantity.name == "damping" or not quantity.values:
            unit = "percentage points" if quantity.values else "%"
            parts.append(f"{quantity.name} {100 * change:+.2g} ± {100 * error:.2g} {unit}")
            continue
        reference = quantity.values[-1] - change
        relative = "" if not reference else f" ({change / abs(reference):+.1%})"
        unit = "" if quantity.unit == "1" else f" {quantity.unit}"
        named = "" if quantity.name == one.name else f"{quantity.name} "
        parts.append(f"{named}{change:+.3g} ± {error:.2g}{unit}{relative}")
    like = "" if pattern is None else f", {_LIKE[pattern]}"
    return f"At the largest amplitude: {'; '.join(parts)}{like}."


def _summarise(tests: Sequence[AmplitudeTest], rejecting: Sequence[AmplitudeTest]) -> str:
    if not rejecting:
        return (
            f"One linear model holds at all amplitudes: none of {len(tests)} tests of derivatives, "
            "modes and inputs rejects it."
        )
    return (
        f"No linear model holds at all amplitudes: {len(rejecting)} of {len(tests)} tests reject "
        f"it, of {', '.join(one.name for one in rejecting[:_NAMED])}"
        f"{' and others' if len(rejecting) > _NAMED else ''}."
    )
