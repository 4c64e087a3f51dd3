"""Waiting until runs have ended, and saying why one did not succeed."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from flexsid.client.connection import Unreachable
from flexsid.client.progress import ProgressLine
from flexsid.errors import FlexsidError

_ENDED = frozenset({"succeeded", "failed", "cancelled"})
_PATIENCE_S = 60.0  # a server that restarts is waited for


class RunFailed(FlexsidError):
    """A run that was waited for did not succeed."""

    code = "run-failed"


def until_ended(
    ask: Callable[[Sequence[int]], list[dict[str, Any]]],
    run_ids: Sequence[int],
    timeout_s: float | None,
    line: ProgressLine,
) -> list[dict[str, Any]]:
    """Ask again and again until all runs have ended, and tell how far they are.

    Raises
    ------
    TimeoutError
        If they have not ended in time.
    Unreachable
        If nobody answered for a minute.
    """
    started = heard = time.monotonic()
    pause = 0.05
    runs: list[dict[str, Any]] = []
    while not all(run["state"] in _ENDED for run in runs) or len(runs) < len(run_ids):
        if timeout_s is not None and time.monotonic() - started > timeout_s:
            listed = ", ".join(map(str, run_ids))
            raise TimeoutError(f"runs {listed} have not ended in {timeout_s:g} s")
        time.sleep(pause if runs else 0.0)
        pause = min(1.2 * pause, 1.0)
        try:
            runs = ask(run_ids)
            heard = time.monotonic()
        except Unreachable:
            if time.monotonic() - heard > _PATIENCE_S:
                raise
            time.sleep(1.0)
            continue
        line.show(runs)
    return runs


def why(run: dict[str, Any]) -> str:
    """Why a run has no result, in a sentence."""
    said = "" if run["error"] is None else f": {run['error']['message']}"
    return f"run {run['id']} {run['state']}{said}"
