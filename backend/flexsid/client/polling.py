"""Polling of runs until they have ended."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from flexsid.client.connection import Unreachable
from flexsid.client.progress import ProgressLine
from flexsid.errors import FlexsidError

_ENDED = frozenset({"succeeded", "failed", "cancelled"})
_UNREACHABLE_S = 60.0  # longer than the restart of a server


class RunFailed(FlexsidError):
    """A run did not succeed."""

    code = "run-failed"


def poll_until_ended(
    fetch: Callable[[Sequence[int]], list[dict[str, Any]]],
    run_ids: Sequence[int],
    timeout_s: float | None,
    line: ProgressLine,
) -> list[dict[str, Any]]:
    """Poll until all runs have ended, show their progress, and return them.

    Raises
    ------
    TimeoutError
        If the runs have not ended within ``timeout_s``.
    Unreachable
        If the workbench did not respond for a minute.
    """
    started = responded = time.monotonic()
    pause = 0.05
    runs: list[dict[str, Any]] = []
    while not all(run["state"] in _ENDED for run in runs) or len(runs) < len(run_ids):
        if timeout_s is not None and time.monotonic() - started > timeout_s:
            listed = ", ".join(map(str, run_ids))
            raise TimeoutError(f"runs {listed} have not ended in {timeout_s:g} s")
        time.sleep(pause if runs else 0.0)
        pause = min(1.2 * pause, 1.0)
        try:
            runs = fetch(run_ids)
            responded = time.monotonic()
        except Unreachable:
            if time.monotonic() - responded > _UNREACHABLE_S:
                raise
            time.sleep(1.0)
            continue
        line.show(runs)
    return runs


def describe_failure(run: dict[str, Any]) -> str:
    """Return why a run has no result, as a sentence."""
    reason = "" if run["error"] is None else f": {run['error']['message']}"
    return f"run {run['id']} {run['state']}{reason}"
