"""Versions of the software that computes a result."""

from __future__ import annotations

import platform

import numpy as np
import scipy

from flexsid import __version__

METHODS = "9"
"""Version of the numerical methods: raised with every change that changes results.

Equal requests have equal results only by the same methods: it is part of the identity of runs
and of all other requests. Results of earlier versions stay stored under their own hashes.
"""


def read_versions() -> dict[str, str]:
    """Return the versions of the software of this process."""
    return {
        "flexsid": __version__,
        "methods": METHODS,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }
