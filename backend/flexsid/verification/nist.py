"""Linear regressions of the Statistical Reference Datasets of NIST, with certified values.

https://www.itl.nist.gov/div898/strd: a work of the United States government, in the public domain.
"""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

import numpy as np


def read_data_sets() -> dict[str, Any]:
    """Read all data sets by name."""
    return json.loads(
        files("flexsid.verification").joinpath("nist_linear_regression.json").read_text()
    )


def build_regression(data: dict[str, Any]) -> tuple[np.ndarray, np.ndarray, float]:
    """Build complex data points of two rows each, and the factor on variances that padding adds.

    A complex regression of real parameters is one of twice as many real rows.
    """
    rows = [np.array(row, dtype=float) for row in data["x"]]
    if len(rows) > 1:
        rows_of_x = np.stack([np.ones(rows[0].size), *rows], axis=1)
    else:
        rows_of_x = np.stack([rows[0] ** power for power in data["powers"]], axis=1)
    y = np.array(data["y"], dtype=float)
    n, p = rows_of_x.shape
    if n % 2:
        rows_of_x, y = np.vstack([rows_of_x, np.zeros(p)]), np.append(y, 0.0)
    return rows_of_x[::2] + 1j * rows_of_x[1::2], y[::2] + 1j * y[1::2], (y.size - p) / (n - p)


def count_digits(found: np.ndarray, certified: list[float]) -> float:
    """Count the decimal digits in which the worst value agrees."""
    right = np.array(certified)
    wrong = np.abs(found - right) / np.where(right == 0.0, 1.0, np.abs(right))
    return float(-np.log10(max(wrong.max(), 1e-15)))
