"""Interpreter settings of a process that serves requests."""

from __future__ import annotations

import gc
import sys

_OLD_GENERATION = 200
_SWITCH_S = 5e-4  # default 5 ms, which each step of another thread would cost a request


def configure_interpreter() -> None:
    """Shorten the thread switch interval and freeze loaded objects for the garbage collector.

    A full collection takes a tenth of a second, during which no request is served; the
    oldest generation is collected less often.
    """
    sys.setswitchinterval(_SWITCH_S)
    gc.collect()
    gc.freeze()
    gc.set_threshold(*gc.get_threshold()[:2], _OLD_GENERATION)
