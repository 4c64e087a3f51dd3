"""Structural modes of an aircraft: stored tables to one aligned table."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.modal_table import ModalKind, ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.modes import ModeTable
from flexsid.sysid.modes.table import align_modes
from flexsid.sysid.modes.tracking import Tracking
from flexsid.workflow.aircraft.derivative_predictions import predicted_modes
from flexsid.workflow.modal_data.mode_corrections import corrected
from flexsid.workflow.modal_data.tested_damping import damping_of_test

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
    """The tables asked for, or the aircraft's latest FEM with predicted modes and latest GVT.

    Raises
    ------
    BadInput
        If the aircraft has no table with frequencies, or the table is another's.
    """
    tables = store.modal_tables.find(aircraft_id=aircraft_id)
    proposed = tables if modal_table_id is not None else _with_predicted_modes(store, tables)
    modal = _pick(proposed, modal_table_id, ModalKind.FEM, "omega")
    if modal is None:
        raise BadInput(
            "the aircraft has no modal table with frequencies and shapes; import one first",
            code="no-modal-table",
        )
    if damping_table_id is None:  # damping of another model is no measurement
        tables = [table for table in tables if table.kind is ModalKind.GVT]
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
    table = ModeTable(
        fuel=fuel,
        numbers=modal.numbers,
        omega=read("omega", np.empty((n_fuel, n))),
        zeta=own,
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
    aligned = align_modes(table, tracking)
    zeta, warnings = _damping(store, modal, damping, aligned)
    if "mass" not in modal.arrays:
        warnings = (*warnings, "Generalised masses are not in the table: 1 kg m2 assumed.")
    return AircraftModes(replace(aligned, zeta=zeta), names, symmetric, warnings)


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


def _with_predicted_modes(store: Store, tables: list[ModalTable]) -> list[ModalTable]:
    """Tables that have the most modes of one prediction; all where there is no prediction.

    A structure that is imported under another name, with modes of its own, does not take the
    place of the one that derivatives are predicted for.
    """
    usable = [table for table in tables if "omega" in table.arrays]
    fem = [table for table in usable if table.kind is ModalKind.FEM] or usable
    if not fem:
        return tables
    predictions = store.predictions.find(aircraft_id=fem[0].aircraft_id)

    def covered(table: ModalTable) -> int:
        return max((len(predicted_modes(p, table.numbers)) for p in predictions), default=0)

    most = max(covered(table) for table in fem)
    return [table for table in fem if covered(table) == most]


def _damping(
    store: Store, modal: ModalTable, damping: ModalTable | None, aligned: ModeTable
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Damping in the order in which modes are followed: the test's, else the table's own."""
    zeta = aligned.zeta.copy()
    warnings: tuple[str, ...] = ()
    if damping is not None and damping.id != modal.id and "zeta" in damping.arrays:
        tested, warnings = damping_of_test(store, modal, damping, aligned)
        zeta = np.where(np.isfinite(tested), tested, zeta)
    missing = [
        number
        for number, column in zip(modal.numbers, zeta.T, strict=True)
        if np.isnan(column).any()
    ]
    zeta[np.isnan(zeta)] = ASSUMED_DAMPING
    if missing:
        warnings = (
            *warnings,
            f"No damping is known for modes {', '.join(map(str, missing))}: "
            f"{ASSUMED_DAMPING:g} assumed.",
        )
    return zeta, warnings
