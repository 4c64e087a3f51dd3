"""Waiting for other processes and threads, without measuring time."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

import pytest

# Ends a test that hangs; far above any time that a working test needs on a loaded machine.
PATIENCE_S = 240.0
PATIENCE_MS = 1000.0 * PATIENCE_S

_UNDER_WAY = ("queued", "running")

T = TypeVar("T")


def wait_until(check: Callable[[], T | None], what: str = "the condition") -> T:
    """Poll ``check`` until it returns a true value, and return that."""
    deadline = time.monotonic() + PATIENCE_S
    while not (found := check()):
        if time.monotonic() > deadline:
            pytest.fail(f"{what} did not happen; last seen: {found!r}")
        time.sleep(0.03)
    return found


def ended(client: Any, address: str) -> dict[str, Any]:
    """Wait until a job or search has ended; return its last state."""

    def check() -> dict[str, Any] | None:
        now = client.get(address).json()
        return None if now["state"] in _UNDER_WAY else now

    return wait_until(check, f"the end of {address}")


def assess(client: Any, maneuver_id: int) -> dict[str, Any]:
    """Assess the data quality of a maneuver and return it."""
    client.post("/api/v1/quality/assess", json={"maneuver_ids": [maneuver_id]})
    address = f"/api/v1/maneuvers/{maneuver_id}/quality"
    return wait_until(lambda: client.get(address).json()["quality"], "the assessment")
