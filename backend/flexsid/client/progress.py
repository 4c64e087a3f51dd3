"""How far runs are, on one line of a terminal or notebook."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, TextIO

_WIDTH = 30


class ProgressLine:
    """Rewrites one line; says nothing where nobody watches."""

    def __init__(self, shown: bool, out: TextIO | None = None) -> None:
        self._out = sys.stderr if out is None else out
        self._shown = shown and _watched(self._out)

    def show(self, runs: Sequence[dict[str, Any]]) -> None:
        """Say how far these runs are."""
        if not self._shown:
            return
        share = sum(map(fraction, runs)) / len(runs)
        bar = "█" * round(_WIDTH * share)
        print(f"\r{bar:<{_WIDTH}} {share:4.0%} {_words(runs):<50.50}", end="", file=self._out)
        self._out.flush()

    def end(self) -> None:
        """Leave the line as it stands."""
        if self._shown:
            print(file=self._out)


def fraction(run: dict[str, Any]) -> float:
    """Share of a run that is done."""
    if run["finished_at"] is not None:
        return 1.0
    return 0.0 if run["progress"] is None else run["progress"]["fraction"]


def _words(runs: Sequence[dict[str, Any]]) -> str:
    if len(runs) == 1:
        (run,) = runs
        message = "" if run["progress"] is None else run["progress"]["message"]
        return f"run {run['id']} {run['state']} {message}"
    done = sum(run["finished_at"] is not None for run in runs)
    return f"{done} of {len(runs)} runs"


def _watched(out: TextIO) -> bool:
    """A terminal, or the output of a notebook, which is none but rewrites lines as well."""
    return out.isatty() or type(out).__module__.startswith("ipykernel")
