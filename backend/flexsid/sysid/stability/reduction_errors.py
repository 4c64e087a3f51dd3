"""Errors of a reduced model; without scipy, as records have them."""

from __future__ import annotations

from dataclasses import dataclass

BAND = 0.10
"""Within this share of the full model's a derivative counts as unbiased (Fig. 13)."""

POLE_BAND = 0.05
"""Within this relative distance of the full model's a pole counts as unbiased."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReductionErrors:
    """Errors of a model with the first modes of the full one.

    ``worst`` is the rigid-body derivative with the largest relative error
    ``bias``; ``pole_error`` is the largest relative distance of a pole in the band from
    the full model's (None where the reduced model lacks a pole), ``response_error`` the relative
    rms error of the responses there (None without sensors). ``sufficient`` is whether derivatives
    and poles are those of the full model, within ``BAND`` and ``POLE_BAND``.
    """

    modes: tuple[int, ...]
    worst: str
    bias: float
    pole_error: float | None
    response_error: float | None
    sufficient: bool
