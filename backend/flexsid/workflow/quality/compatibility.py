"""Compatibility of the sensors of maneuvers: faults by kinematics, and their corrections."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records import finite_or_none
from flexsid.records.maneuver import GROUND, Maneuver
from flexsid.records.quality import (
    CompatibilityReport,
    CompatibilityState,
    FindingKind,
    SensorEstimate,
    SensorFault,
)
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.compatibility.fault_search import (
    MOST_MISFIT,
    Compatibility,
    Fault,
    check_compatibility,
)
from flexsid.sysid.compatibility.likelihood import SensorFaultKind
from flexsid.sysid.model.sensor_models import VANE
from flexsid.sysid.preparation.fault_detection import OTHER_SENSORS
from flexsid.sysid.preparation.redundancy import SensorFaults
from flexsid.text import count_noun, join_names
from flexsid.workflow.measurements.flight_records import RecordedSensors, read_flight_record
from flexsid.workflow.quality.quality_warnings import (
    ask_between,
    describe_fault,
    describe_frozen,
    describe_held,
)
from flexsid.workflow.quality.sensor_skews import RedundancyCheck
from flexsid.workflow.runs.run_identity import list_run_contents

_MOST_MANEUVERS = 50
_LEAST = {SensorFaultKind.DELAY: 1e-3, SensorFaultKind.SCALE: 0.02, SensorFaultKind.AIRSPEED: 0.02}
"""Smallest faults that matter: delay [s] and logarithms of ratios."""

_LEAST_ARM = 0.02  # of the chord, as locations are known
_MAX_MISFIT_FRACTION = 1.0 / 3.0  # of the sensors: above, nothing is concluded
_UNEXPLAINED = (
    "more than a third of the sensors depart from the motion of a rigid aircraft; if the "
    "structure moves, import a modal table"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CompatibilityQuery:
    """Maneuvers of one aircraft and recorder, sorted by id; a fault is common to all."""

    maneuver_ids: Annotated[
        tuple[Id, ...],
        Allowed(
            min_length=1,
            max_length=_MOST_MANEUVERS,
            text="Ids of maneuvers of one aircraft and recorder.",
        ),
    ]

    def __post_init__(self) -> None:
        """Sort the ids: the same set is the same request."""
        object.__setattr__(self, "maneuver_ids", tuple(sorted(set(self.maneuver_ids))))


def identify_compatibility(store: Store, query: CompatibilityQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the maneuvers are of several aircraft or of one with a modal table, or one is a ground
        record.
    UnknownRecord
        If a maneuver does not exist.
    """
    maneuvers = [store.maneuvers.get(number) for number in query.maneuver_ids]
    if len({one.aircraft_id for one in maneuvers}) > 1:
        raise BadInput("the maneuvers are of several aircraft; select those of one",
                       code="wrong-aircraft")  # fmt: skip
    if store.modal_tables.find(aircraft_id=maneuvers[0].aircraft_id):
        raise BadInput(
            "kinematics compare sensors of a rigid aircraft, and this one has a modal table; its "
            "data quality compares them with the structural modes",
            code="flexible-aircraft",
        )
    if any(one.axis == GROUND for one in maneuvers):
        raise BadInput(
            "a ground record has no motion of the aircraft to compare sensors by; select "
            "maneuvers in flight",
            code="ground-record",
        )
    return list_run_contents(store, (), query.maneuver_ids)


def compute_compatibility(
    store: Store, query: CompatibilityQuery, report: ReportProgress = lambda progress: None
) -> CompatibilityReport:
    """Compare all sensors of maneuvers by kinematics, and name those at fault.

    Raises
    ------
    BadInput
        If no sensor was recorded that kinematics relate.
    """
    report(Progress(fraction=0.1, message="Reading the sensors"))
    recorded = [
        read_flight_record(store, store.maneuvers.get(number)) for number in query.maneuver_ids
    ]
    report(Progress(fraction=0.2, message="Comparing the sensors"))
    return describe_compatibility(query.maneuver_ids, recorded)


def describe_compatibility(
    maneuver_ids: tuple[int, ...], recorded: Sequence[RecordedSensors]
) -> CompatibilityReport:
    """Compare the sensors of records, and describe what was found."""
    kinds = {one.name: one.kind for r in recorded for one in r.record.sensors}
    samples = list(_describe_samples(recorded))
    try:
        found = check_compatibility([one.record for one in recorded])
    except NotIdentifiable as error:
        reason = error.message
        sensors = tuple(
            SensorEstimate(name=name, kind=kind, not_checked=reason) for name, kind in kinds.items()
        )
        state = CompatibilityState.FAULTY if samples else CompatibilityState.UNCHECKED
        sentences = [one.finding.sentence for one in samples]
        return CompatibilityReport(
            maneuver_ids=maneuver_ids,
            state=state,
            sentence=" ".join([*sentences, f"Not compared: {reason}."]),
            faults=tuple(samples),
            sensors=(*sensors, *_list_excluded(recorded)),
        )
    poor = {
        name: float(misfit)
        for name, misfit in zip(found.sensors, found.misfit, strict=True)
        if misfit > MOST_MISFIT
    }
    is_unexplained = len(poor) > _MAX_MISFIT_FRACTION * len(found.sensors)
    faults = (
        []
        if is_unexplained
        else [
            _describe_fault(one, kinds, recorded)
            for one in found.faults
            if _matters(one, recorded) and one.candidate.channel not in poor
        ]
    )
    every = (*samples, *faults)
    unchecked = (
        dict.fromkeys(found.sensors, _UNEXPLAINED)
        if is_unexplained
        else _explain_unchecked(found, poor, kinds)
    )
    sensors = (*_list_estimates(found, kinds, unchecked), *_list_excluded(recorded))
    state, sentence = _summarise(every, sensors, len(maneuver_ids))
    return CompatibilityReport(
        maneuver_ids=maneuver_ids,
        state=state,
        sentence=sentence,
        faults=every,
        sensors=sensors,
        band_hz=found.band_hz,
        n_frequencies=found.n_frequencies,
    )


def _describe_samples(recorded: Sequence[RecordedSensors]) -> Iterator[SensorFault]:
    """Describe what the samples alone show: channels that are held or frozen."""
    held = {one.name: one for r in recorded for one in r.held}
    for one in held.values():
        yield SensorFault(finding=describe_held(one))
    for interval in (one for r in recorded for one in r.frozen):
        yield SensorFault(finding=describe_frozen(interval))


def _describe_fault(
    fault: Fault, kinds: Mapping[str, str], recorded: Sequence[RecordedSensors]
) -> SensorFault:
    density = recorded[0].record.condition.density
    finding = describe_fault(fault, kinds, density)
    others = tuple(describe_fault(one, kinds, density) for one in fault.inseparable)
    if others and finding.kind not in (FindingKind.AIRSPEED, FindingKind.UNIT, FindingKind.SIGN):
        # The data do not separate them, but the kind of airspeed has a value of its own.
        known = [one for one in others if "calibrated" in one.sentence]
        if known:
            finding, others = known[0], (finding, *(one for one in others if one != known[0]))
    return SensorFault(finding=finding, inseparable=others, question=ask_between(finding, others))


def _matters(fault: Fault, recorded: Sequence[RecordedSensors]) -> bool:
    """Whether a fault is large enough to matter."""
    one, value = fault.candidate, fault.value
    if one.kind is SensorFaultKind.ARM:
        return abs(value) > _LEAST_ARM * recorded[0].record.condition.chord
    if one.is_ratio:
        return value <= 0.0 or abs(np.log(value)) > _LEAST[one.kind]
    return abs(value) > _LEAST[one.kind]


def _explain_unchecked(
    found: Compatibility, poor: Mapping[str, float], kinds: Mapping[str, str]
) -> dict[str, str]:
    reasons = {}
    for name in found.sensors:
        if name in poor:
            turbulence = " (a vane also measures turbulence)" if kinds[name] == VANE.kind else ""
            reasons[name] = (
                f"it departs from the other sensors by {poor[name]:.2g} times its noise, which "
                f"no single fault explains{turbulence}"
            )
        elif not found.checked[name]:
            reasons[name] = "no other sensor determines what it measures"
    return reasons


def _list_estimates(
    found: Compatibility, kinds: Mapping[str, str], unchecked: Mapping[str, str]
) -> Iterator[SensorEstimate]:
    by_sensor: dict[str, dict[SensorFaultKind, Fault]] = {name: {} for name in found.sensors}
    for one in (*found.faults, *found.estimates):
        by_sensor.get(one.candidate.channel, {})[one.candidate.kind] = one
    for k, name in enumerate(found.sensors):
        delay, scale, arm = (
            by_sensor[name].get(kind)
            for kind in (SensorFaultKind.DELAY, SensorFaultKind.SCALE, SensorFaultKind.ARM)
        )
        yield SensorEstimate(
            name=name,
            kind=kinds[name],
            delay_s=_get_value(delay),
            delay_std_s=_get_std(delay),
            scale=_get_value(scale),
            scale_std=_get_std(scale),
            arm_axis="" if arm is None else arm.candidate.axis,
            arm_m=_get_value(arm),
            arm_std_m=_get_std(arm),
            misfit=float(found.misfit[k]),
            coherence=finite_or_none(found.coherence[k]),
            not_checked=unchecked.get(name),
        )


def _get_value(fault: Fault | None) -> float | None:
    return None if fault is None or not np.isfinite(fault.std) else fault.value


def _get_std(fault: Fault | None) -> float | None:
    return None if fault is None else finite_or_none(fault.std)


def _list_excluded(recorded: Sequence[RecordedSensors]) -> Iterator[SensorEstimate]:
    excluded = {name: reason for one in recorded for name, reason in one.excluded.items()}
    compared = {one.name for r in recorded for one in r.record.sensors}
    for name, reason in excluded.items():
        if name not in compared:
            yield SensorEstimate(name=name, kind="", not_checked=reason)


def _summarise(
    faults: Sequence[SensorFault], sensors: Sequence[SensorEstimate], n_maneuvers: int
) -> tuple[CompatibilityState, str]:
    if faults:
        text = " ".join(one.finding.sentence for one in faults[:2])
        more = len(faults) - 2
        return CompatibilityState.FAULTY, text + (f" And {more} more." if more > 0 else "")
    checked = [one for one in sensors if one.not_checked is None]
    left = [one for one in sensors if one.not_checked is not None and one.kind]
    if not checked or 2 * len(left) > len(checked) + len(left):
        reason = left[0].not_checked if left else "no sensor was compared"
        name = f"{left[0].name}: " if left else ""
        return CompatibilityState.UNCHECKED, f"Not checked. {name}{reason}."
    text = (
        f"{count_noun(len(checked), 'sensor')} agree on one motion over "
        f"{count_noun(n_maneuvers, 'maneuver')}."
    )
    if left:
        text += f" Not checked: {join_names([one.name for one in left])}."
    return CompatibilityState.COMPATIBLE, text


def check_kinematics(
    store: Store, maneuver: Maneuver
) -> tuple[CompatibilityReport, RedundancyCheck | None]:
    """Check the sensors of one maneuver by kinematics alone, for its data quality.

    The check is None where the sensors could not be compared, of which the report has the reason.

    Raises
    ------
    BadInput
        If no sensor was recorded that kinematics relate.
    """
    assert maneuver.id is not None
    query = CompatibilityQuery(maneuver_ids=(maneuver.id,))
    identify_compatibility(store, query)
    report = compute_compatibility(store, query)
    compared = [one for one in report.sensors if one.kind]
    if report.band_hz is None:
        return report, None

    def gather(values: Sequence[float | None]) -> np.ndarray:
        return np.array([np.nan if value is None else value for value in values], dtype=float)

    scale, scale_std = (
        gather([one.scale for one in compared]),
        gather([one.scale_std for one in compared]),
    )
    faults = SensorFaults(
        names=tuple(one.name for one in compared),
        reference=OTHER_SENSORS,
        delay_s=gather([one.delay_s for one in compared]),
        delay_std=gather([one.delay_std_s for one in compared]),
        scale=np.where(np.isfinite(scale), scale, 1.0),
        scale_std=np.where(np.isfinite(scale_std), scale_std, 0.0),
        noise=np.full(len(compared), np.nan),
        band_hz=report.band_hz,
    )
    check = RedundancyCheck(
        faults=faults,
        coherence=gather([one.coherence for one in compared]),
        noise_excess=gather([one.misfit for one in compared]),
        inputs=None,
        not_checked={},
    )
    return report, check
