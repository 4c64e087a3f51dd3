"""Progress of runs on one line of a terminal or notebook."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, TextIO

_WIDTH = 30


class ProgressLine:
    """Progress bar on one line; silent unless the output is a terminal or notebook."""

    def __init__(self, shown: bool, out: TextIO | None = None) -> None:
        self._out = sys.stderr if out is None else out
        self._shown = shown and _is_interactive(self._out)

    def show(self, runs: Sequence[dict[str, Any]]) -> None:
        """Show the progress of runs."""
        if not self._shown:
            return
        share = sum(map(get_fraction, runs)) / len(runs)
        bar = "█" * round(_WIDTH * share)
        print(f"\r{bar:<{_WIDTH}} {share:4.0%} {_describe(runs):<50.50}", end="", file=self._out)
        self._out.flush()

    def end(self) -> None:
        """End the line."""
        if self._shown:
            print(file=self._out)


def get_fraction(run: dict[str, Any]) -> float:
    """Return the completed fraction of a run."""
    if run["finished_at"] is not None:
        return 1.0
    return 0.0 if run["progress"] is None else run["progress"]["fraction"]


def _describe(runs: Sequence[dict[str, Any]]) -> str:
    if len(runs) == 1:
        (run,) = runs
        message = "" if run["progress"] is None else run["progress"]["message"]
        return f"run {run['id']} {run['state']} {message}"
    done = sum(run["finished_at"] is not None for run in runs)
    return f"{done} of {len(runs)} runs"


def _is_interactive(out: TextIO) -> bool:
    """Return whether the output is a terminal or a notebook."""
    return out.isatty() or type(out).__module__.startswith("ipykernel")
