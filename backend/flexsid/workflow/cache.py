"""Memory: answers that take seconds, kept under the hash of all that they rest on."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import TypeVar, cast

from flexsid.storage.store import Store

Answer = TypeVar("Answer")

_MOST = 256  # answers kept, the least recently asked for forgotten first


class _Slot:
    """One answer, and the lock under which it is found once, however many ask."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.found = False
        self.answer: object = None


_slots: OrderedDict[str, _Slot] = OrderedDict()
_guard = threading.Lock()


def remembered(rests_on: tuple[object, ...], find: Callable[[], Answer]) -> Answer:
    """Return the answer found before for the same contents, or find it.

    Parameters
    ----------
    rests_on
        Records and settings; their contents decide, not their identity.
    find
        Makes the answer, which must not be changed afterwards. What it raises is not kept.
    """
    key = hashlib.sha256(repr(rests_on).encode()).hexdigest()
    with _guard:
        slot = _slots.setdefault(key, _Slot())
        _slots.move_to_end(key)
        while len(_slots) > _MOST:
            _slots.popitem(last=False)
    with slot.lock:
        if not slot.found:
            slot.answer = find()
            slot.found = True
        return cast(Answer, slot.answer)


def contents_of_runs(store: Store, run_ids: tuple[int, ...]) -> tuple[object, ...]:
    """All records that models of these runs are put together from."""
    runs = [store.runs.get(number) for number in run_ids]
    maneuvers = [store.maneuvers.get(run.maneuver_id) for run in runs]
    owners = sorted({maneuver.aircraft_id for maneuver in maneuvers})
    return (
        str(store.database.url),
        runs,
        maneuvers,
        [store.aircraft.get(number) for number in owners],
        [store.modal_tables.find(aircraft_id=number) for number in owners],
        [store.predictions.find(aircraft_id=number) for number in owners],
        store.mode_corrections.find(),
    )
