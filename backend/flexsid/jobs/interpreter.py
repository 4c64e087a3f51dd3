"""Interpreter settings of a process that starts fast, and serves requests."""

from __future__ import annotations

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_OLD_GENERATION = 200
_SWITCH_S = 5e-4  # default 5 ms, which each step of another thread would cost a request


@contextmanager
def loading() -> Iterator[None]:
    """Load modules and routes without the garbage collector, a quarter of the time.

    They are not garbage, and there are a million of them for each collection to check.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def configure_interpreter() -> None:
    """Shorten the thread switch interval and freeze loaded objects for the garbage collector.

    A full collection takes a tenth of a second, during which no request is served; the
    oldest generation is collected less often.
    """
    sys.setswitchinterval(_SWITCH_S)
    gc.collect()
    gc.freeze()
    gc.set_threshold(*gc.get_threshold()[:2], _OLD_GENERATION)
