"""What was known of a stream when: estimates of its maneuvers, defects of the data, alarms."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.records.live import (
    Acknowledgement,
    LiveAlarm,
    LiveHistory,
    LiveStream,
    LiveTestPoint,
    RecordedState,
)
from flexsid.storage.live_history import list_alarms, list_states
from flexsid.storage.store import Store

_MOST_STATES = 100_000  # more than a day, of one per second


@dataclass(frozen=True, slots=True, kw_only=True)
class FlownStream:
    """All that was recorded of a stream, in the order of time.

    ``estimates`` are the states with an estimate of their own second.
    """

    stream: LiveStream
    states: tuple[RecordedState, ...]
    estimates: tuple[RecordedState, ...]
    test_points: tuple[LiveTestPoint, ...]
    alarms: tuple[LiveAlarm, ...]
    acknowledgements: tuple[Acknowledgement, ...]


def read_sortie(store: Store, stream_id: int) -> FlownStream:
    """Read what was recorded of a stream.

    Raises
    ------
    UnknownRecord
        If there is no stream of this id.
    """
    stream = store.live_streams.get(stream_id)
    states, _ = list_states(store, stream_id, None, _MOST_STATES)
    points = store.live_test_points.find(stream_id=stream_id)
    return FlownStream(
        stream=stream,
        states=tuple(states),
        estimates=tuple(
            one
            for one in states
            if one.state.estimate is not None and one.state.estimate.time_s == one.time_s
        ),
        test_points=tuple(sorted(points, key=lambda point: point.start_s)),
        alarms=list_alarms(store, stream_id),
        acknowledgements=tuple(store.live_acknowledgements.find(stream_id=stream_id)),
    )


def read_live_history(store: Store, stream_id: int) -> LiveHistory:
    """Read the flutter speed and the damping of each mode as they were known; raises as above."""
    sortie = read_sortie(store, stream_id)
    found = [one.state.estimate for one in sortie.estimates if one.state.estimate is not None]
    names = dict.fromkeys(mode.name for estimate in found for mode in estimate.modes)
    by_name = [{mode.name: mode for mode in estimate.modes} for estimate in found]
    return LiveHistory(
        time_s=tuple(estimate.time_s for estimate in found),
        airspeed_m_s=tuple(
            None if estimate.condition is None else estimate.condition.airspeed_m_s
            for estimate in found
        ),
        flutter_m_s=tuple(estimate.flutter_m_s for estimate in found),
        flutter_std_m_s=tuple(estimate.flutter_std_m_s for estimate in found),
        damping={
            name: tuple(own[name].damping if name in own else None for own in by_name)
            for name in names
        },
        damping_std={
            name: tuple(own[name].damping_std if name in own else None for own in by_name)
            for name in names
        },
    )
