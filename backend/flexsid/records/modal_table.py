"""ModalTable: structural modes against fuel, from a FEM or a GVT."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class ModalKind(StrEnum):
    """Where a modal table comes from."""

    FEM = "FEM"
    GVT = "GVT"


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalTable:
    """In-vacuo modes against fuel fraction; the numbers themselves are stored arrays.

    ``arrays`` names content hashes (F fuels, n modes, P points, G gauges, K nodes):
    ``omega`` (F, n) [rad/s], ``zeta`` (F, n), ``mass`` (F, n) [kg m2],
    ``shape`` (F, n, P, 6) translation [m] and rotation [rad] per unit eta in body
    axes, ``strain`` (F, n, G) per unit eta, ``nodes`` (K, 3) structural axes [m],
    ``node_shape`` (F, n, K, 6). Only ``omega`` or ``zeta`` must be there.
    """

    aircraft_id: int
    name: str
    kind: ModalKind
    fuel: tuple[float, ...]
    numbers: tuple[int, ...]
    names: tuple[str, ...]
    symmetric: tuple[bool, ...]
    points: tuple[str, ...] = ()
    gauges: tuple[str, ...] = ()
    arrays: dict[str, str]
    origin: str = ""
    id: int | None = None
