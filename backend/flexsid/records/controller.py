"""Controller: the law that closes the loop of an aircraft, at one airspeed or several."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

Matrix = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlLaw:
    """u = K y with the sign in K, in state-space form; SI and rad."""

    airspeed_m_s: float
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """A law reads outputs and drives surfaces by their names; linear between airspeeds."""

    aircraft_id: int
    name: str
    reads: tuple[str, ...]
    drives: tuple[str, ...]
    laws: tuple[ControlLaw, ...]
    delay_s: float = 0.0
    note: str = ""
    created_at: datetime | None = None
    id: int | None = None
