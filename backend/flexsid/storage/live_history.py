"""What was known of a stream, second by second."""

from __future__ import annotations

import sqlalchemy as sa

from flexsid.records.live import AlarmKind, LiveAlarm, RecordedState
from flexsid.storage.store import Store
from flexsid.storage.tables import live_states


def list_states(
    store: Store, stream_id: int, since_s: float | None, limit: int
) -> tuple[list[RecordedState], bool]:
    """List stored states after a time, oldest first, and whether there are more."""
    which = live_states.c.stream_id == stream_id
    if since_s is not None:
        which &= live_states.c.time_s > since_s
    query = sa.select(live_states).where(which).order_by(live_states.c.time_s).limit(limit + 1)
    with store.database.reading() as connection:
        found = store.live_states.decode(connection.execute(query).mappings().all())
    return found[:limit], len(found) > limit


def find_newest_state(store: Store, stream_id: int) -> RecordedState | None:
    """Find the last stored state of a stream."""
    which = live_states.c.stream_id == stream_id
    query = sa.select(live_states).where(which).order_by(live_states.c.time_s.desc()).limit(1)
    with store.database.reading() as connection:
        found = store.live_states.decode(connection.execute(query).mappings().all())
    return found[0] if found else None


def list_alarms(store: Store, stream_id: int) -> tuple[LiveAlarm, ...]:
    """List all alarms of a stream in the order of time.

    A state has those of its maneuver; others may be unacknowledged.
    """
    alarms = live_states.c.state["alarms"]
    which = (live_states.c.stream_id == stream_id) & (sa.cast(alarms, sa.Text) != "[]")
    query = sa.select(alarms).where(which).order_by(live_states.c.time_s)
    with store.database.reading() as connection:
        states = connection.scalars(query).all()
    # pyrefly: ignore[bad-argument-type]
    found = (LiveAlarm(**{**a, "kind": AlarmKind(a["kind"])}) for state in states for a in state)
    return tuple(sorted(dict.fromkeys(found), key=lambda alarm: alarm.time_s))
