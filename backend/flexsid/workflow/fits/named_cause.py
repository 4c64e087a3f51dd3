"""Cause of a rejected fit: the fault of the data that explains why tests reject the model.

Kinematics compare the sensors whatever the aerodynamics, so that their faults come first. What is
left is sought in the inputs: the model of a rigid aircraft is fitted again with one fault of theirs
corrected, which takes no longer than its tests.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.maneuver import Channel, Correction, StepKind
from flexsid.records.quality import FindingKind, SensorFault, SensorFinding
from flexsid.records.run import AdequacyState, ModelAdequacy
from flexsid.sysid.adequacy.model_tests import Hypothesis
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import LONGEST_DELAY_S
from flexsid.sysid.preparation.resampling import BetweenSamples, find_new_samples
from flexsid.units import dimension, to_si
from flexsid.workflow.fits.estimation_task import EstimationTask
from flexsid.workflow.measurements.sensor_faults import describe_compatibility, format_with_std

_EXPLAINED = 0.125  # of the tests that rejected may still do so
_ROUNDS = 5  # of a delay
_CONVERGED_S = 2e-4  # of a delay
_LEAST_DELAY_S = 1e-3  # that matters
_LEAST_SIGMAS = 4.0  # of a delay
_ORDER = (BetweenSamples.SMOOTH, BetweenSamples.LINEAR, BetweenSamples.HELD)  # of equal fits
_COARSE = 0.02  # of the range of a channel: a step of its numbers that matters
_MOST_LEVELS = 0.125  # of the samples: more different values are no steps
_EQUAL_STEPS = 1e-3  # of a step


@dataclass(frozen=True, slots=True)
class TestedFit:
    """An estimate with the tests of its model."""

    estimate: Estimate
    adequacy: ModelAdequacy

    @property
    def n_rejecting(self) -> float:
        """Number of tests that reject; infinite where none could be made."""
        if self.adequacy.state is AdequacyState.NOT_TESTED:
            return float("inf")
        return sum(one.rejects for one in self.adequacy.tests)


Refit = Callable[[EstimationTask], TestedFit]


@dataclass(frozen=True, slots=True)
class _Trial:
    """A fit with one fault corrected."""

    finding: SensorFinding
    task: EstimationTask
    fit: TestedFit


def name_cause(
    task: EstimationTask, fit: TestedFit, refit: Refit
) -> tuple[ModelAdequacy, frozenset[str]]:
    """Name the faults of the data behind a fit whose model is rejected, or that did not converge.

    Parameters
    ----------
    task, fit
        The estimation and its result.
    refit
        Estimates a task with corrected data.

    Returns
    -------
    adequacy, moved
        With the causes first in its reason, and the parameters that the corrections move by more
        than their standard errors: these are no errors of them. Unchanged where no fault is found.
    """
    rejecting = [one.hypothesis for one in fit.adequacy.tests if one.rejects]
    if rejecting == [Hypothesis.REGRESSOR_NOISE]:
        return fit.adequacy, frozenset()  # no fault of the data, but of the method
    causes = [*_describe_drift(task), *_compare_sensors(task)]
    is_rigid = not task.model.modes.numbers and not task.corrected
    held = {one.finding.channel for one in causes if one.finding.kind is FindingKind.HELD}
    inputs = held.intersection(_list_input_channels(task))
    last = fit
    if is_rigid:
        found = [one.finding.correction for one in causes]
        taken = [one for one in found if one is not None and one.channel not in inputs]
        if taken:
            task = _correct(task, taken)
            last = _refit(refit, task) or fit
        if last.adequacy.state is not AdequacyState.CONSISTENT:
            fault, trial = _search_inputs(task, last, refit)
            if fault is not None:
                causes = [one for one in causes if one.finding.channel != fault.finding.channel]
                causes.insert(0, fault) if not causes else causes.append(fault)
            last = last if trial is None else trial.fit
    if not causes:
        return fit.adequacy, frozenset()
    words = [causes[0].finding.sentence, causes[0].finding.remedy, causes[0].question]
    words += [one.finding.sentence for one in causes[1:]]
    words.append(_state_effect(fit, last, len(causes)))
    adequacy = replace(
        fit.adequacy,
        state=AdequacyState.SUSPECT,
        reason=" ".join(filter(None, words)),
        causes=tuple(causes),
    )
    return adequacy, _find_moved(fit.estimate, last.estimate)


def _refit(refit: Refit, task: EstimationTask) -> TestedFit | None:
    """Fit corrected data; None where they cannot be fitted."""
    try:
        return refit(task)
    except (BadInput, NotIdentifiable, np.linalg.LinAlgError):
        return None


def _correct(task: EstimationTask, corrections: Sequence[Correction]) -> EstimationTask:
    """Correct the channels of all maneuvers, which one recorder recorded."""
    return replace(
        task,
        maneuver_tasks=tuple(
            replace(one, measurement=one.measurement.with_corrections(corrections))
            for one in task.maneuver_tasks
        ),
    )


def _state_effect(fit: TestedFit, last: TestedFit, n_causes: int) -> str:
    if last is fit:
        return "" if fit.adequacy.state is AdequacyState.NOT_TESTED else fit.adequacy.reason
    what = "this" if n_causes == 1 else "these"
    if last.adequacy.state is AdequacyState.NOT_TESTED:
        return ""
    if last.adequacy.state is AdequacyState.CONSISTENT:
        return f"With {what} corrected no test rejects the model."
    n_tests, n_left = len(last.adequacy.tests), int(last.n_rejecting)
    verb = "rejects" if n_left == 1 else "reject"
    return f"With {what} corrected {n_left} of {n_tests} tests still {verb} the model."


def _find_moved(before: Estimate, after: Estimate) -> frozenset[str]:
    if not after.outcome.is_optimum:
        return frozenset()
    values = dict(zip(after.names, after.values.tolist(), strict=True))
    rows = zip(before.names, before.values.tolist(), before.std_errors.tolist(), strict=True)
    return frozenset(n for n, value, std in rows if abs(values.get(n, value) - value) > std)


# --- Faults that need no model of the aircraft: its condition, and its sensors by kinematics ------


def _describe_drift(task: EstimationTask) -> Iterator[SensorFault]:
    for text in task.drifts:
        yield SensorFault(
            finding=SensorFinding(
                kind=FindingKind.DRIFT,
                channel="airspeed",
                axis="",
                value=0.0,
                std=None,
                gain=None,
                sentence=text,
                remedy="",
            )
        )


def _compare_sensors(task: EstimationTask) -> tuple[SensorFault, ...]:
    recorded = [one.sensors for one in task.maneuver_tasks if one.sensors is not None]
    if len(recorded) < len(task.maneuver_tasks):
        return ()
    return describe_compatibility(tuple(range(len(recorded))), recorded).faults


# --- Faults of the inputs, by fits with one of them corrected -------------------------------------


def _list_input_channels(task: EstimationTask) -> tuple[str, ...]:
    measurement = task.maneuver_tasks[0].measurement
    parts = (measurement.recording.parts[name] for name in task.model.inputs)
    return tuple(dict.fromkeys(name for terms in parts for name, _ in terms))


def _search_inputs(
    task: EstimationTask, fit: TestedFit, refit: Refit
) -> tuple[SensorFault | None, _Trial | None]:
    """Search for the fault of an input that explains why tests reject, most plausible first."""
    recording = task.maneuver_tasks[0].measurement.recording
    channels = {channel.name: (channel, samples) for channel, samples in recording.channels}
    names = _list_input_channels(task)
    trials: list[_Trial] = []
    for name in names:
        channel, samples = channels[name]
        corrected = recording.conditioning.get(name)
        if corrected is None or corrected.between is None:
            held = _try_between(task, refit, channel, samples)
            if held and find_new_samples(samples) is not None:
                best = min(held, key=lambda one: one.fit.n_rejecting)
                if best.fit.n_rejecting < fit.n_rejecting:
                    return SensorFault(finding=best.finding), best
            trials += held
    most = _EXPLAINED * min(fit.n_rejecting, 1e6)
    trials += chain.from_iterable(_try_delay(task, fit, refit, name) for name in names)
    explaining = [one for one in trials if one.fit.n_rejecting <= most]
    if explaining:
        first = explaining[0]
        others = tuple(one.finding for one in explaining[1:])
        question = " ".join(["The data do not separate this from:", *(o.sentence for o in others)])
        if len(names) == 1:
            known = f"{question} " if others else "One surface does not separate this from: "
            question = (
                f"{known}The forces lag the motion by as much. All sensors are late by as much."
            )
        elif not others:
            question = ""
        return SensorFault(finding=first.finding, inseparable=others, question=question), first
    for name in names:
        finding = _describe_steps(*channels[name])
        if finding is not None:
            return SensorFault(finding=finding), None
    return None, None


def _try_between(
    task: EstimationTask, refit: Refit, channel: Channel, samples: np.ndarray
) -> list[_Trial]:
    """Fit with what an input may be between its samples."""
    new = find_new_samples(samples)
    trials = []
    for between in _ORDER if new is not None else (BetweenSamples.HELD,):
        rate = channel.rate_hz
        if new is not None:
            rate *= (new.size - 1) / float(new[-1] - new[0])
        meaning = (
            "the surface moves in steps"
            if between is BetweenSamples.HELD
            else "the recorder repeats samples of a surface that moves between them"
        )
        correction = Correction(
            channel=channel.name,
            kind=StepKind.INTERPOLATION,
            between_samples=between,
            basis="fit of the model with the lowest number of rejecting tests",
        )
        finding = SensorFinding(
            kind=FindingKind.HELD,
            channel=channel.name,
            axis="",
            value=rate,
            std=None,
            gain=None,
            sentence=f"{channel.name} is held at {rate:.3g} Hz: {meaning}.",
            remedy=f'Write between_samples = "{between}" for {channel.name} in the mapping, or '
            "take it as a correction.",
            correction=correction,
        )
        trials += _try(task, refit, finding, correction)
    return trials


def _try(
    task: EstimationTask, refit: Refit, finding: SensorFinding, correction: Correction
) -> list[_Trial]:
    corrected = _correct(task, [correction])
    found = _refit(refit, corrected)
    return [] if found is None else [_Trial(finding, corrected, found)]


def _try_delay(task: EstimationTask, fit: TestedFit, refit: Refit, name: str) -> list[_Trial]:
    """Fit with an input that acts later, by the test of its delay until that finds none."""
    late_s, trials = 0.0, []
    for _ in range(_ROUNDS):
        test = next(
            (
                one
                for one in fit.adequacy.tests
                if one.hypothesis == Hypothesis.INPUT_DELAY and one.subject == name
            ),
            None,
        )
        if test is None or test.estimate is None:
            break
        late_s += test.estimate
        if abs(late_s) > LONGEST_DELAY_S or late_s == 0.0:
            break
        std = abs(test.estimate) / max(np.sqrt(test.statistic), 1e-6)
        way = "after" if late_s > 0.0 else "before"
        size = format_with_std(1e3 * abs(late_s), 1e3 * std)
        correction = Correction(
            channel=name,
            kind=StepKind.DELAY,
            delay_s=-late_s,
            std=std,
            basis="fit of the model with a delay of this input",
        )
        finding = SensorFinding(
            kind=FindingKind.DELAY,
            channel=name,
            axis="",
            value=-late_s,
            std=std,
            gain=None,
            sentence=f"{name} acts {size} ms {way} its recorded deflection.",
            remedy=f"Correct the delay of {name}, or declare that of its actuator.",
            correction=correction,
        )
        trials = _try(task, refit, finding, correction)
        if not trials:
            break
        fit = trials[0].fit
        if abs(test.estimate) < _CONVERGED_S:
            break
    return [one for one in trials if _matters(one.finding)]


def _matters(finding: SensorFinding) -> bool:
    return abs(finding.value) > max(_LEAST_DELAY_S, _LEAST_SIGMAS * (finding.std or 0.0))


def _describe_steps(channel: Channel, samples: np.ndarray) -> SensorFinding | None:
    """Describe the steps of a coarsely rounded channel."""
    levels = np.unique(to_si(samples, channel.unit))
    if not 2 < levels.size < _MOST_LEVELS * samples.size:
        return None
    step = float(np.diff(levels).min())
    away = levels / step - np.rint(levels / step)
    if step < _COARSE * np.ptp(levels) or np.ptp(away) > _EQUAL_STEPS:
        return None
    size = f"{np.rad2deg(step):.3g} deg" if dimension(channel.unit) == "angle" else f"{step:.3g}"
    return SensorFinding(
        kind=FindingKind.ROUNDED,
        channel=channel.name,
        axis="",
        value=step,
        std=None,
        gain=None,
        sentence=f"{channel.name} is recorded in steps of {size}.",
        remedy=f"Record {channel.name} with finer steps, or repeat the maneuver with larger ones.",
    )
