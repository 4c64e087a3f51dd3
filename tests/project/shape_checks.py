"""Array shapes of ``flexsid.sysid``, checked in the first calls of each test.

A wrong shape is found in the first calls. Statistics over hundreds of fits call the same functions
hundreds of thousands of times, and took 1.7 times as long with every call checked.
"""

from __future__ import annotations

from jaxtyping import config

CHECKED_CALLS = 2000


class _FirstCalls(type(config)):
    remaining = CHECKED_CALLS

    @property
    def jaxtyping_disable(self) -> bool:
        """Read by jaxtyping at each call of a function with shapes."""
        self.remaining -= 1
        return self.remaining < 0

    @jaxtyping_disable.setter
    def jaxtyping_disable(self, value: bool) -> None:
        raise AttributeError("shapes are checked in the first calls of each test")


def check_first_calls() -> None:
    """Check the next `CHECKED_CALLS` calls in this process, and none after them."""
    config.__class__ = _FirstCalls
    config.__dict__["remaining"] = CHECKED_CALLS
