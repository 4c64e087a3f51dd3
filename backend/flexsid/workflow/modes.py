"""Structural modes of an aircraft: stored tables to one aligned table."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.modal_table import ModalKind, ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.modes import ModeTable
from flexsid.sysid.modes.table import align_modes, interpolate
from flexsid.sysid.modes.tracking import Tracking

ASSUMED_DAMPING = 0.02
_READ = ("omega", "zeta", "mass", "shape", "strain", "order", "sign", "assurance", "mixed")


@dataclass(frozen=True, slots=True)
class AircraftModes:
    """Modes against fuel with their names; ``warnings`` tell what was assumed."""

    table: ModeTable
    names: dict[int, str]
    symmetric: dict[int, bool]
    warnings: tuple[str, ...]


def find_modal_tables(
    store: Store, aircraft_id: int, modal_table_id: int | None, damping_table_id: int | None
) -> tuple[ModalTable, ModalTable | None]:
    """The tables asked for, or the aircraft's latest FEM and GVT.

    Raises
    ------
    BadInput
        If the aircraft has no table with frequencies, or the table is another's.
    """
    tables = store.modal_tables.find(aircraft_id=aircraft_id)
    modal = _pick(tables, modal_table_id, ModalKind.FEM, "omega")
    if modal is None:
        raise BadInput(
            "the aircraft has no modal table with frequencies and shapes; import one first",
            code="no-modal-table",
        )
    return modal, _pick(tables, damping_table_id, ModalKind.GVT, "zeta")


def load_modes(store: Store, modal: ModalTable, damping: ModalTable | None) -> AircraftModes:
    """Read a modal table, align it over fuel and give it the damping of the GVT."""
    modal = corrected(store, modal)
    arrays = store.arrays.get_many([modal.arrays[k] for k in _READ if k in modal.arrays])

    def read(name: str, empty: np.ndarray) -> np.ndarray:
        return np.asarray(arrays[modal.arrays[name]], float) if name in modal.arrays else empty

    fuel = np.array(modal.fuel, dtype=float)
    n_fuel, n = fuel.size, len(modal.numbers)
    own = read("zeta", np.full((n_fuel, n), np.nan))
    zeta, warnings = _damping(store, modal, damping, fuel, own)
    if "mass" not in modal.arrays:
        warnings = (*warnings, "Generalised masses are not in the table: 1 kg m2 assumed.")
    table = ModeTable(
        fuel=fuel,
        numbers=modal.numbers,
        omega=read("omega", np.empty((n_fuel, n))),
        zeta=zeta,
        mass=read("mass", np.ones((n_fuel, n))),
        points=modal.points,
        shape=read("shape", np.zeros((n_fuel, n, 0, 6))),
        gauges=modal.gauges,
        strain=read("strain", np.zeros((n_fuel, n, 0))),
    )
    names = {
        number: name or f"mode {number}"
        for number, name in zip(modal.numbers, modal.names, strict=True)
    }
    symmetric = dict(zip(modal.numbers, modal.symmetric, strict=True))
    tracking = None
    if "order" in modal.arrays:  # found from all nodes when the table was imported
        order, sign, sure = (read(k, np.empty(0)) for k in ("order", "sign", "assurance"))
        mixed = read("mixed", np.zeros(order.shape)).astype(bool)
        tracking = Tracking(order.astype(np.intp), sign, sure, mixed)
    return AircraftModes(align_modes(table, tracking), names, symmetric, warnings)


def corrected(store: Store, table: ModalTable) -> ModalTable:
    """The table with names and symmetries as analysts have corrected them."""
    if table.id is None:
        return table
    names, symmetric, reasons = (
        list(part) for part in (table.names, table.symmetric, table.reasons)
    )
    reasons += [""] * (len(names) - len(reasons))
    for correction in store.mode_corrections.find(modal_table_id=table.id):
        if correction.number in table.numbers:
            place = table.numbers.index(correction.number)
            names[place], symmetric[place] = correction.name, correction.symmetric
            by = f", by {correction.author}" if correction.author else ""
            reasons[place] = f"{correction.reason} (corrected{by})"
    return replace(table, names=tuple(names), symmetric=tuple(symmetric), reasons=tuple(reasons))


def companion_modes(
    modes: AircraftModes, fuel: float, chosen: tuple[int, ...], highest: float, n_outputs: int
) -> tuple[int, ...]:
    """Further symmetric modes whose static response the sensors see within the band.

    Parameters
    ----------
    modes, fuel
        Table and where to read it.
    chosen
        Modes of the model.
    highest
        Highest line of the band; modes to three times as much count. [rad/s]
    n_outputs
        At least one and a half outputs are wanted for each motion.
    """
    omega = modes.table.at(fuel).omega
    near = [
        number
        for frequency, number in sorted(zip(omega, modes.table.numbers, strict=True))
        if modes.symmetric[number] and number not in chosen and frequency <= 3.0 * highest
    ]
    room = int(n_outputs / 1.5) - 2 - len(chosen)
    return tuple(near[: max(0, room)])


def _pick(
    tables: list[ModalTable], wanted: int | None, kind: ModalKind, array: str
) -> ModalTable | None:
    if wanted is not None:
        for table in tables:
            if table.id == wanted:
                return table
        raise BadInput(
            f"modal table {wanted} does not belong to the aircraft of the maneuver",
            code="wrong-modal-table",
            modal_table_id=wanted,
        )
    usable = [table for table in tables if array in table.arrays]
    of_kind = [table for table in usable if table.kind is kind]
    return (of_kind or usable or [None])[-1]


def _damping(
    store: Store,
    modal: ModalTable,
    damping: ModalTable | None,
    fuel: np.ndarray,
    own: np.ndarray,
) -> tuple[np.ndarray, tuple[str, ...]]:
    zeta = own.copy()
    if damping is not None and damping.id != modal.id and "zeta" in damping.arrays:
        values = np.asarray(store.arrays.get(damping.arrays["zeta"]), dtype=float)
        at = np.array(damping.fuel, dtype=float)
        over_fuel = np.stack([interpolate(at, values, f) for f in fuel])
        for column, number in enumerate(modal.numbers):
            if number in damping.numbers:
                zeta[:, column] = over_fuel[:, damping.numbers.index(number)]
    missing = [
        number
        for number, column in zip(modal.numbers, zeta.T, strict=True)
        if np.isnan(column).any()
    ]
    zeta[np.isnan(zeta)] = ASSUMED_DAMPING
    if not missing:
        return zeta, ()
    return zeta, (
        f"No damping is known for modes {', '.join(map(str, missing))}: "
        f"{ASSUMED_DAMPING:g} assumed.",
    )
