"""Maneuvers of a campaign that repeat one multisine at several amplitudes, and their runs."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method
from flexsid.records.validation import ComparedLevel, RepeatedLevels
from flexsid.storage.content import hash_maneuvers, hash_record
from flexsid.storage.store import Store
from flexsid.sysid.adequacy.equal_levels import find_levels
from flexsid.workflow.review.condition_sheet import list_conditions
from flexsid.workflow.validation.amplitude_comparison import (
    LEAST_RATIO,
    combine_amplitudes,
    find_odd_inputs,
    get_compared_structure,
    measure_amplitudes,
)


def list_repeated_levels(store: Store, aircraft_id: int) -> list[RepeatedLevels]:
    """List maneuvers of one condition with the same harmonics at several amplitudes.

    Raises
    ------
    UnknownRecord
        If the aircraft does not exist.
    """
    store.aircraft.get(aircraft_id)
    found = []
    for condition in list_conditions(store, aircraft_id):
        maneuvers = [store.maneuvers.get(record.maneuver_id) for record in condition.records]
        for repeated in _group_by_multisine(maneuvers):
            by_input = _measure_once(store, aircraft_id, repeated)
            odd = find_odd_inputs(by_input)
            group = [one for k, one in enumerate(repeated) if k not in odd]
            amplitudes = np.array(
                [combine_amplitudes(own) for k, own in enumerate(by_input) if k not in odd]
            )
            if amplitudes.size < 2 or amplitudes.max() < LEAST_RATIO * amplitudes.min():
                continue
            runs = _select_runs(store, group)
            found.append(
                RepeatedLevels(
                    condition_id=condition.id,
                    label=group[0].label,
                    airspeed_m_s=condition.airspeed_m_s,
                    levels=tuple(_build_levels(group, amplitudes, runs)),
                )
            )
    return found


_MOST_MEASURED = 20_000  # of 200 bytes

# By a hash of what is measured: a campaign asks for the same amplitudes at every read, and
# transforming a record takes 12 ms.
_measured: dict[tuple[str, str], dict[str, float]] = {}


def _measure_once(
    store: Store, aircraft_id: int, maneuvers: Sequence[Maneuver]
) -> list[dict[str, float]]:
    """Measure the amplitudes of maneuvers; those that were measured before are not transformed."""
    of_aircraft = hash_record(store.database, "aircraft", [aircraft_id])
    hashes = hash_maneuvers(store.database, [one.id or 0 for one in maneuvers])
    found = []
    for one in maneuvers:
        key = hashes[one.id or 0][1], of_aircraft
        if key not in _measured:
            if len(_measured) >= _MOST_MEASURED:
                _measured.clear()
            _measured[key] = measure_amplitudes(store, one)
        found.append(_measured[key])
    return found


def _group_by_multisine(maneuvers: Sequence[Maneuver]) -> Iterator[list[Maneuver]]:
    """Group maneuvers by period and harmonics; only groups of several."""
    groups: dict[object, list[Maneuver]] = defaultdict(list)
    for one in maneuvers:
        if one.excitation is not None:
            key = one.excitation.period_s, tuple(sorted(one.excitation.harmonics.items()))
            groups[key].append(one)
    yield from (group for group in groups.values() if len(group) > 1)


def _select_runs(store: Store, maneuvers: Sequence[Maneuver]) -> Mapping[int, EstimationRun]:
    """Select the newest run of each maneuver with the structure that most maneuvers have."""
    newest: dict[object, dict[int, EstimationRun]] = defaultdict(dict)
    for maneuver in maneuvers:
        for run in store.runs.find(maneuver_id=maneuver.id, method=Method.OE, deleted_at=None):
            if run.result is None or run.settings.additional_maneuver_ids or run.derivation:
                continue
            own = newest[get_compared_structure(run)]
            before = own.get(run.maneuver_id)
            if before is None or (run.id or 0) > (before.id or 0):
                own[run.maneuver_id] = run
    if not newest:
        return {}
    counts = Counter({key: len(own) for key, own in newest.items()})
    return newest[counts.most_common(1)[0][0]]


def _build_levels(
    maneuvers: Sequence[Maneuver], amplitudes: np.ndarray, runs: Mapping[int, EstimationRun]
) -> Iterator[ComparedLevel]:
    for members in find_levels(amplitudes):
        own = [maneuvers[k] for k in members]
        yield ComparedLevel(
            amplitude_rad=float(amplitudes[members].mean()),
            run_ids=tuple(runs[one.id].id or 0 for one in own if one.id in runs),
            label=", ".join(one.label for one in own),
        )
