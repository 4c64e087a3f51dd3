"""Prompt: settings of the interpreter for a process that others wait for."""

from __future__ import annotations

import gc
import sys

_OLD_GENERATION = 200
_SWITCH_S = 5e-4  # or one thread waits 5 ms for each step that another is in the middle of


def be_prompt() -> None:
    """Let threads take turns sooner, and what is loaded by now be collected no more.

    Looking through all of it takes a tenth of a second, in which nobody is answered; the rest
    is looked through less often.
    """
    sys.setswitchinterval(_SWITCH_S)
    gc.collect()
    gc.freeze()
    gc.set_threshold(*gc.get_threshold()[:2], _OLD_GENERATION)
