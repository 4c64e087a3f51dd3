"""Cause of a rejected fit: the fault of the data that explains why tests reject the model.

Kinematics compare the sensors of a rigid aircraft whatever the aerodynamics, so that their faults
come first. Of a flexible one, and of the inputs of both, the model is fitted again with one fault
corrected: of few channels, those whose tests find more than those of other errors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.maneuver import Channel, Correction, StepKind
from flexsid.records.quality import FindingKind, SensorFault, SensorFinding
from flexsid.records.run import AdequacyState, AdequacyTest, ModelAdequacy
from flexsid.sysid.adequacy.model_tests import Hypothesis
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import LONGEST_DELAY_S
from flexsid.sysid.preparation.recorder_range import (
    compute_clipped_share,
    find_rounding_step,
    smooth_rounded,
)
from flexsid.sysid.preparation.resampling import BetweenSamples, find_new_samples
from flexsid.sysid.preparation.spikes_and_dropouts import bridge_samples
from flexsid.units import dimension, to_si
from flexsid.workflow.fits.estimation_task import EstimationTask, ManeuverTask
from flexsid.workflow.measurements.sensor_faults import describe_compatibility, format_with_std

_CHANCE = 1e-3  # adjusted p above which few rejecting tests are searched for no cause
_FEW = 3  # rejecting tests
_EXPLAINED = 0.125  # of the tests that rejected may still do so
_LEADING = 0.5  # of the largest statistic: a cause with a lower one explains less than another
_ROUNDS = 5  # of a delay
_CONVERGED_S = 2e-4  # of a delay
_LEAST_DELAY_S = 1e-3  # that matters
_LEAST_SIGMAS = 4.0  # of a delay or scale factor
_LEAST_SCALE = 0.2  # of a scale factor that is no dead sensor
_LEAST_SCALE_CHANGE = 0.02  # of a scale factor: calibration is known no better
_CONVERGED_SCALE = 2e-3  # of a scale factor
_DIRECTIONS = frozenset(
    {
        *(Hypothesis.OUTPUT_DELAY, Hypothesis.OUTPUT_SCALE, Hypothesis.INPUT_DELAY),
        *(Hypothesis.AERODYNAMIC_LAG, Hypothesis.DERIVATIVE, Hypothesis.FURTHER_MODE),
    }
)
"""Errors with a score test: the statistic of the one that is there exceeds those of the others."""

_LOST = (FindingKind.FROZEN, FindingKind.ROUNDED, FindingKind.CLIPPED)
"""Faults whose samples no correction restores."""

_REFINED = {
    FindingKind.SCALE: Hypothesis.OUTPUT_SCALE,
    FindingKind.DELAY: Hypothesis.OUTPUT_DELAY,
}
"""Test of the remaining error of a correction, by its kind."""

_WITHIN = 3.0  # standard errors of a correction by kinematics, within which a fit refines it
_SIGN = 0.3  # of a reversed sign, whose first step is from the wrong side
_ORDER = (BetweenSamples.SMOOTH, BetweenSamples.LINEAR, BetweenSamples.HELD)  # of equal fits


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

    @property
    def may_be_chance(self) -> bool:
        """Whether so few tests reject as of sound data now and then: any change removes it."""
        return 0 < self.n_rejecting < _FEW and all(
            one.adjusted_p > _CHANCE for one in self.adequacy.tests
        )


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
    rejecting = {one.hypothesis for one in fit.adequacy.tests if one.rejects}
    if fit.adequacy.tests and rejecting <= {Hypothesis.REGRESSOR_NOISE}:
        return fit.adequacy, frozenset()  # no fault of the data, but of the method, or feedback
    causes = [*_describe_drift(task), *_compare_sensors(task)]
    held = {one.finding.channel for one in causes if one.finding.kind is FindingKind.HELD}
    inputs = held.intersection(_list_input_channels(task))
    last = fit
    found = [one.finding.correction for one in causes]
    taken = [one for one in found if one is not None and one.channel not in inputs]
    if taken or any(one.finding.kind is FindingKind.FROZEN for one in causes):
        task = _correct(_bridge_frozen(task), taken)
        last = _refit(refit, task) or fit
        causes, task, last = _refine(causes, task, last, refit)
    searches = (_search_outputs, _search_inputs) if task.model.modes.numbers else (_search_inputs,)
    for search in searches:
        if last.adequacy.state is AdequacyState.CONSISTENT or last.may_be_chance:
            break
        fault, trial = search(task, last, refit)
        if fault is not None:
            causes = [one for one in causes if one.finding.channel != fault.finding.channel]
            causes.insert(0, fault) if not causes else causes.append(fault)
        if trial is not None:
            task, last = trial.task, trial.fit
    if not causes:
        return fit.adequacy, frozenset()
    words = [causes[0].finding.sentence, causes[0].finding.remedy, causes[0].question]
    words += [one.finding.sentence for one in causes[1:]]
    # Samples that were not recorded are replaced for the comparison alone.
    lost = any(one.finding.kind in _LOST for one in causes)
    words.append(_state_effect(fit, last, len(causes), is_settled=not lost))
    adequacy = replace(
        fit.adequacy,
        state=AdequacyState.SUSPECT,
        reason=" ".join(filter(None, words)),
        causes=tuple(causes),
    )
    moved = _find_moved(fit.estimate, last.estimate)
    clipped = {one.finding.channel for one in causes if one.finding.kind is FindingKind.CLIPPED}
    return adequacy, moved.union(n for n in fit.estimate.names if n.partition("_")[2] in clipped)


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


def _state_effect(fit: TestedFit, last: TestedFit, n_causes: int, *, is_settled: bool) -> str:
    if last is fit or not is_settled:
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


def _bridge_frozen(task: EstimationTask) -> EstimationTask:
    """Replace the samples of frozen intervals by a curve, to see what these move."""
    if len(task.maneuver_tasks) > 1:
        return task  # each has samples of its own
    one = task.maneuver_tasks[0]
    channels = {channel.name: channel for channel, _ in one.measurement.recording.channels}
    for interval in () if one.sensors is None else one.sensors.frozen:
        for name in channels.keys() & set(interval.channels):
            channel = channels[name]
            first = round((interval.start_s - channel.start_s) * channel.rate_hz)
            stop = round((interval.stop_s - channel.start_s) * channel.rate_hz)
            bridge = partial(bridge_samples, stretches=((first, stop),))
            task = _replace_samples(task, name, bridge)
    return task


def _compare_sensors(task: EstimationTask) -> tuple[SensorFault, ...]:
    recorded = [one.sensors for one in task.maneuver_tasks if one.sensors is not None]
    if len(recorded) < len(task.maneuver_tasks):
        return ()
    return describe_compatibility(tuple(range(len(recorded))), recorded).faults


def _refine(
    causes: list[SensorFault], task: EstimationTask, fit: TestedFit, refit: Refit
) -> tuple[list[SensorFault], EstimationTask, TestedFit]:
    """Refine lags and scale factors within their errors, where the fit determines them better.

    Kinematics take noise of all sensors as motion that is to be explained; a model that fits does
    not, so that its tests reject a correction by a fraction of its error.
    """
    refined = []
    for cause in causes:
        trial = _refine_one(cause.finding, task, fit, refit)
        if trial is not None:
            cause = replace(cause, finding=trial.finding)
            task, fit = trial.task, trial.fit
        refined.append(cause)
    return refined, task, fit


def _refine_one(
    finding: SensorFinding, task: EstimationTask, fit: TestedFit, refit: Refit
) -> _Trial | None:
    correction, hypothesis = finding.correction, _REFINED.get(finding.kind)
    if correction is None or hypothesis is None or finding.std is None or fit.may_be_chance:
        return None
    test = _find_test(fit, hypothesis, finding.channel)
    if test is None or test.estimate is None or not test.rejects:
        return None
    std = abs(test.estimate) / np.sqrt(test.statistic)
    name, before = finding.channel, finding.value
    if hypothesis is Hypothesis.OUTPUT_SCALE:
        value, std = before * (1.0 + test.estimate), abs(before) * std
        rest = replace(correction, scale=1.0 + test.estimate, std=std)
        whole = replace(correction, scale=value, std=std)
        sentence = _state_scale(name, value, std)
    else:
        value = before + test.estimate
        rest = replace(correction, delay_s=test.estimate, std=std)
        whole = replace(correction, delay_s=value, std=std)
        sentence = _state_delay(name, value, std)
    if abs(value - before) > _WITHIN * finding.std:
        return None
    better = replace(finding, value=value, std=std, sentence=sentence, correction=whole)
    for trial in _try(task, refit, better, rest):
        if trial.fit.n_rejecting < fit.n_rejecting:
            return trial
    return None


def _state_scale(name: str, scale: float, std: float) -> str:
    return f"{name} reads {format_with_std(scale, std)} times the true value."


def _state_delay(name: str, late_s: float, std: float) -> str:
    size = format_with_std(1e3 * abs(late_s), 1e3 * std)
    return f"{name} is recorded {size} ms {'late' if late_s > 0.0 else 'early'}."


# --- Faults of the sensors of flexible aircraft, by fits with one of them corrected ---------------


def _search_outputs(
    task: EstimationTask, fit: TestedFit, refit: Refit
) -> tuple[SensorFault | None, _Trial | None]:
    """Search for the fault of a sensor that explains why tests reject a flexible model.

    Lag, sign and scale factor of a sensor, where no test finds more of another error.
    """
    parts = task.maneuver_tasks[0].measurement.recording.parts
    single = [name for name in task.model.outputs if parts[name] == ((name, 1.0),)]
    most = _EXPLAINED * min(fit.n_rejecting, 1e6)
    trials: list[_Trial] = []
    found = _find_leading(fit, single, (Hypothesis.OUTPUT_DELAY, Hypothesis.OUTPUT_SCALE))
    for test in found:
        if test.subject != found[0].subject:
            continue
        if test.hypothesis == Hypothesis.OUTPUT_SCALE:
            trials += _try_scale(task, fit, refit, test.subject)
        else:
            trials += _try_delay(task, fit, refit, test.subject, Hypothesis.OUTPUT_DELAY)
    explaining = [one for one in trials if one.fit.n_rejecting <= most]
    if not explaining:
        return None, None
    first = min(explaining, key=lambda one: one.fit.n_rejecting)
    others = tuple(one.finding for one in explaining if one is not first)
    return (
        SensorFault(
            finding=first.finding,
            inseparable=others,
            question=" ".join(
                ["The data do not separate this from:", *(o.sentence for o in others)]
            )
            if others
            else "",
        ),
        first,
    )


def _try_scale(task: EstimationTask, fit: TestedFit, refit: Refit, name: str) -> list[_Trial]:
    """Fit with the scale factor of a sensor that its test finds, or with the opposite sign."""
    scale, trials = 1.0, []
    for _ in range(_ROUNDS):
        test = _find_test(fit, Hypothesis.OUTPUT_SCALE, name)
        if test is None or test.estimate is None:
            break
        change = 1.0 + test.estimate
        if abs(change) < _LEAST_SCALE or abs(scale * change) > 1.0 / _LEAST_SCALE:
            break
        scale *= change
        std = abs(scale * test.estimate) / max(np.sqrt(test.statistic), 1e-6)
        is_sign = abs(scale + 1.0) < max(_SIGN, 3.0 * std)
        scale = -1.0 if is_sign else scale
        correction = Correction(
            channel=name,
            kind=StepKind.CALIBRATION,
            scale=scale,
            std=std,
            basis="fit of the model with a scale factor of this sensor",
        )
        finding = SensorFinding(
            kind=FindingKind.SIGN if is_sign else FindingKind.SCALE,
            channel=name,
            axis="",
            value=scale,
            std=std,
            gain=None,
            sentence=f"The sign of {name} is reversed."
            if is_sign
            else _state_scale(name, scale, std),
            remedy=f"Reverse {name} in the mapping, or by a calibration with scale factor -1."
            if is_sign
            else f"Calibrate {name}.",
            correction=correction,
        )
        trials = _try(task, refit, finding, correction)
        if not trials or is_sign:
            break
        fit = trials[0].fit
        if abs(test.estimate) < _CONVERGED_SCALE:
            break
    return [
        one
        for one in trials
        if abs(one.finding.value - 1.0)
        > max(_LEAST_SCALE_CHANGE, _LEAST_SIGMAS * (one.finding.std or 0.0))
    ]


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
    names, is_rigid = _list_input_channels(task), not task.model.modes.numbers
    trials: list[_Trial] = []
    for name in names:
        channel, samples = channels[name]
        corrected = recording.conditioning.get(name)
        repeats = find_new_samples(samples) is not None
        if (corrected is None or corrected.between is None) and (repeats or is_rigid):
            held = _try_between(task, refit, channel, samples)
            if held and repeats:
                best = min(held, key=lambda one: one.fit.n_rejecting)
                if best.fit.n_rejecting < fit.n_rejecting:
                    return SensorFault(finding=best.finding), best
            trials += held
    most = _EXPLAINED * min(fit.n_rejecting, 1e6)
    late: Sequence[str] = names
    if not is_rigid:
        late = [one.subject for one in _find_leading(fit, names, (Hypothesis.INPUT_DELAY,))[:1]]
    trials += chain.from_iterable(_try_delay(task, fit, refit, name) for name in late)
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
            channel, _ = channels[name]
            step = finding.value / float(to_si(1.0, channel.unit))
            smooth = _replace_samples(task, name, partial(smooth_rounded, step=step))
            found = _refit(refit, smooth)
            trial = None if found is None else _Trial(finding, smooth, found)
            return SensorFault(finding=finding), trial
    for name in names:
        finding = _describe_limits(*channels[name])
        if finding is not None:
            return SensorFault(finding=finding), None
    return None, None


def _replace_samples(
    task: EstimationTask, name: str, change: Callable[[np.ndarray], np.ndarray]
) -> EstimationTask:
    """Replace the samples of a channel, for a comparison alone."""

    def replace_in(one: ManeuverTask) -> ManeuverTask:
        recording = one.measurement.recording
        channels = tuple(
            (channel, change(np.asarray(samples, dtype=float)) if channel.name == name else samples)
            for channel, samples in recording.channels
        )
        measurement = replace(one.measurement, recording=replace(recording, channels=channels))
        return replace(one, measurement=measurement)

    return replace(task, maneuver_tasks=tuple(replace_in(one) for one in task.maneuver_tasks))


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


def _try_delay(
    task: EstimationTask,
    fit: TestedFit,
    refit: Refit,
    name: str,
    hypothesis: Hypothesis = Hypothesis.INPUT_DELAY,
) -> list[_Trial]:
    """Fit with a delay of a channel removed, by the test of it until that finds none.

    An input that acts later is as one that is recorded earlier.
    """
    sign = -1.0 if hypothesis is Hypothesis.INPUT_DELAY else 1.0
    late_s, trials = 0.0, []
    for _ in range(_ROUNDS):
        test = _find_test(fit, hypothesis, name)
        if test is None or test.estimate is None:
            break
        late_s += test.estimate
        if abs(late_s) > LONGEST_DELAY_S or late_s == 0.0:
            break
        std = abs(test.estimate) / max(np.sqrt(test.statistic), 1e-6)
        correction = Correction(
            channel=name,
            kind=StepKind.DELAY,
            delay_s=sign * late_s,
            std=std,
            basis="fit of the model with a delay of this channel",
        )
        if hypothesis is Hypothesis.INPUT_DELAY:
            size = format_with_std(1e3 * abs(late_s), 1e3 * std)
            way = "after" if late_s > 0.0 else "before"
            sentence = f"{name} acts {size} ms {way} its recorded deflection."
            where = "that of its actuator"
        else:
            sentence = _state_delay(name, late_s, std)
            where = "it in its instrument"
        finding = SensorFinding(
            kind=FindingKind.DELAY,
            channel=name,
            axis="",
            value=sign * late_s,
            std=std,
            gain=None,
            sentence=sentence,
            remedy=f"Correct the delay of {name}, or declare {where}.",
            correction=correction,
        )
        trials = _try(task, refit, finding, correction)
        if not trials:
            break
        fit = trials[0].fit
        if abs(test.estimate) < _CONVERGED_S:
            break
    return [one for one in trials if _matters(one.finding)]


def _find_test(fit: TestedFit, hypothesis: Hypothesis, name: str) -> AdequacyTest | None:
    """Find the test of a hypothesis about a channel."""
    tests = (t for t in fit.adequacy.tests if t.hypothesis == hypothesis and t.subject == name)
    return next(tests, None)


def _find_leading(
    fit: TestedFit, names: Sequence[str], hypotheses: Sequence[Hypothesis]
) -> list[AdequacyTest]:
    """Find the tests of channels that reject with nearly the largest statistic, largest first."""
    tests = sorted(fit.adequacy.tests, key=lambda one: -one.statistic)
    found = [one for one in tests if one.rejects and one.hypothesis in _DIRECTIONS]
    return [
        one
        for one in found
        if one.subject in names
        and one.hypothesis in hypotheses
        and one.statistic >= _LEADING * found[0].statistic
    ]


def _matters(finding: SensorFinding) -> bool:
    return abs(finding.value) > max(_LEAST_DELAY_S, _LEAST_SIGMAS * (finding.std or 0.0))


def _describe_limits(channel: Channel, samples: np.ndarray) -> SensorFinding | None:
    """Describe a channel that stops abruptly at its largest or smallest value, and stays there."""
    share = compute_clipped_share(np.asarray(samples, dtype=float))
    if not share > 0.0:
        return None
    return SensorFinding(
        kind=FindingKind.CLIPPED,
        channel=channel.name,
        axis="",
        value=share,
        std=None,
        gain=None,
        sentence=f"{channel.name} stops abruptly at its limits, for {100.0 * share:.2g} % of its "
        "samples, as if it was clipped.",
        remedy=f"Record {channel.name} with a larger range if its surface moves further.",
    )


def _describe_steps(channel: Channel, samples: np.ndarray) -> SensorFinding | None:
    """Describe the steps of a coarsely rounded channel."""
    step = find_rounding_step(to_si(np.asarray(samples, dtype=float), channel.unit))
    if step is None:
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
