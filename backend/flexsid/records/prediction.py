"""Prediction: derivatives from a source other than flight."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativePrediction:
    """Derivatives by name against fuel; ``values`` is the hash of a (F, len(names)) array."""

    aircraft_id: int
    source: str
    kind: str  # "panel code", "wind tunnel", "simulation", "flight"
    fuel: tuple[float, ...]
    names: tuple[str, ...]
    values: str
    std_errors: str | None = None
    note: str = ""
    id: int | None = None
