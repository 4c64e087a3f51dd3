"""Real parts of sums of complex products, by products of real matrices."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Complex, Float


def sum_products(
    A: Complex[np.ndarray, "*rows n_a"], B: Complex[np.ndarray, "*rows n_b"]
) -> Float[np.ndarray, "n_a n_b"]:
    """Compute Re A^H B, the sum over all rows.

    Two real products are half of the complex one, and a quarter where A and B are the same.
    """
    real, imaginary = (_flatten(part) for part in (np.real(A), np.imag(A)))
    if B is A:
        return real.T @ real + imaginary.T @ imaginary
    return real.T @ _flatten(np.real(B)) + imaginary.T @ _flatten(np.imag(B))


def _flatten(part: np.ndarray) -> np.ndarray:
    """Return contiguous rows, as products of matrices need them."""
    return np.ascontiguousarray(part.reshape(math.prod(part.shape[:-1]), part.shape[-1]))
