"""Compatibility of the sensors of maneuvers: faults by kinematics, and their corrections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput
from flexsid.records.maneuver import GROUND, Maneuver
from flexsid.records.quality import (
    CompatibilityReport,
)
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.preparation.fault_detection import OTHER_SENSORS
from flexsid.sysid.preparation.redundancy import SensorFaults
from flexsid.workflow.measurements.flight_records import read_flight_record
from flexsid.workflow.measurements.sensor_faults import describe_compatibility
from flexsid.workflow.quality.sensor_skews import RedundancyCheck
from flexsid.workflow.runs.run_identity import list_run_contents

_MOST_MANEUVERS = 50


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
