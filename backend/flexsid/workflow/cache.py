"""Cache of results that take seconds, by the hash of their inputs."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Callable
from typing import TypeVar, cast

from flexsid.storage.store import Store

Result = TypeVar("Result")

_MOST = 256  # cached results; the least recently used is dropped first


class _Slot:
    """One result, and the lock under which it is computed once."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.is_computed = False
        self.result: object = None


_slots: OrderedDict[str, _Slot] = OrderedDict()
_guard = threading.Lock()


def load_or_compute(key: tuple[object, ...], compute: Callable[[], Result]) -> Result:
    """Return the cached result of the same contents, or compute it.

    Parameters
    ----------
    key
        Records and settings, compared by content.
    compute
        Computes the result, which must not be modified. Exceptions are not cached.
    """
    digest = hashlib.sha256(repr(key).encode()).hexdigest()
    with _guard:
        slot = _slots.setdefault(digest, _Slot())
        _slots.move_to_end(digest)
        while len(_slots) > _MOST:
            _slots.popitem(last=False)
    with slot.lock:
        if not slot.is_computed:
            slot.result = compute()
            slot.is_computed = True
        return cast(Result, slot.result)


def list_run_contents(store: Store, run_ids: tuple[int, ...]) -> tuple[object, ...]:
    """List all records on which models of these runs depend."""
    runs = [store.runs.get(number) for number in run_ids]
    maneuvers = [store.maneuvers.get(run.maneuver_id) for run in runs]
    aircraft_ids = sorted({maneuver.aircraft_id for maneuver in maneuvers})
    return (
        str(store.database.url),
        runs,
        maneuvers,
        [store.aircraft.get(number) for number in aircraft_ids],
        [store.modal_tables.find(aircraft_id=number) for number in aircraft_ids],
        [store.predictions.find(aircraft_id=number) for number in aircraft_ids],
        store.mode_corrections.find(),
    )
