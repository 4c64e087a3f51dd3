"""Waiting for what other processes and threads do; nothing here measures how long it takes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

import pytest

# Ends a test that hangs. Nothing that works comes near it, however loaded the machine is.
PATIENCE_S = 240.0
PATIENCE_MS = 1000.0 * PATIENCE_S

_UNDER_WAY = ("waiting", "queued", "running", "importing")

T = TypeVar("T")


def wait_until(look: Callable[[], T | None], what: str = "what was waited for") -> T:
    """Look until something is found, and return it."""
    deadline = time.monotonic() + PATIENCE_S
    while not (found := look()):
        if time.monotonic() > deadline:
            pytest.fail(f"{what} did not happen; last seen: {found!r}")
        time.sleep(0.03)
    return found


def ended(client: Any, address: str) -> dict[str, Any]:
    """Wait until a job, task, search or upload is no longer under way; return its last state."""

    def look() -> dict[str, Any] | None:
        now = client.get(address).json()
        return None if now["state"] in _UNDER_WAY else now

    return wait_until(look, f"the end of {address}")
