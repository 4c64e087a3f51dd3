"""Structural modes of an aircraft: alignment of stored tables over fuel."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.modal_table import ModalKind, ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.modes import ModeTable
from flexsid.sysid.modes.table import align_modes
from flexsid.sysid.modes.tracking import Tracking
from flexsid.workflow.aircraft.derivative_predictions import list_predicted_modes
from flexsid.workflow.modal_data.mode_corrections import apply_corrections
from flexsid.workflow.modal_data.tested_damping import match_test_damping

ASSUMED_DAMPING = 0.02
_READ = ("omega", "zeta", "mass", "shape", "strain", "order", "sign", "assurance", "mixed")


@dataclass(frozen=True, slots=True)
class AircraftModes:
    """Modes against fuel with their names; ``warnings`` list assumptions."""

    table: ModeTable
    names: dict[int, str]
    symmetric: dict[int, bool]
    warnings: tuple[str, ...]


def find_modal_tables(
    store: Store, aircraft_id: int, modal_table_id: int | None, damping_table_id: int | None
) -> tuple[ModalTable, ModalTable | None]:
    """Find the requested tables, or the latest FEM with predicted modes and the latest GVT.

    Raises
    ------
    BadInput
        If the aircraft has no table with frequencies, or the table belongs to another one.
    """
    tables = store.modal_tables.find(aircraft_id=aircraft_id)
    proposed = tables if modal_table_id is not None else _select_predicted(store, tables)
    modal = _select(proposed, modal_table_id, ModalKind.FEM, "omega")
    if modal is None:
        raise BadInput(
            "the aircraft has no modal table with frequencies and shapes; import one first",
            code="no-modal-table",
        )
    if damping_table_id is None:  # damping of another model is not measured
        tables = [table for table in tables if table.kind is ModalKind.GVT]
    return modal, _select(tables, damping_table_id, ModalKind.GVT, "zeta")


def load_modes(store: Store, modal: ModalTable, damping: ModalTable | None) -> AircraftModes:
    """Read a modal table, align it over fuel and give it the damping of the GVT."""
    modal = apply_corrections(store, modal)
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
    zeta, warnings = _find_damping(store, modal, damping, aligned)
    if "mass" not in modal.arrays:
        warnings = (*warnings, "Generalised masses are not in the table: 1 kg m2 assumed.")
    return AircraftModes(replace(aligned, zeta=zeta), names, symmetric, warnings)


def select_out_of_band_modes(
    modes: AircraftModes,
    fuel: float,
    modes_of_model: tuple[int, ...],
    highest: float,
    n_outputs: int,
) -> tuple[int, ...]:
    """Select out-of-band symmetric modes with static response within the band.

    Parameters
    ----------
    modes, fuel
        Table and where to read it.
    modes_of_model
        Modes of the model.
    highest
        Highest frequency of the band; modes up to three times as high are included. [rad/s]
    n_outputs
        Number of outputs; at least 1.5 outputs are required per motion.
    """
    omega = modes.table.at(fuel).omega
    near = [
        number
        for frequency, number in sorted(zip(omega, modes.table.numbers, strict=True))
        if modes.symmetric[number] and number not in modes_of_model and frequency <= 3.0 * highest
    ]
    room = int(n_outputs / 1.5) - 2 - len(modes_of_model)
    return tuple(near[: max(0, room)])


def _select(
    tables: list[ModalTable], table_id: int | None, kind: ModalKind, array: str
) -> ModalTable | None:
    if table_id is not None:
        for table in tables:
            if table.id == table_id:
                return table
        raise BadInput(
            f"modal table {table_id} does not belong to the aircraft of the maneuver",
            code="wrong-modal-table",
            modal_table_id=table_id,
        )
    usable = [table for table in tables if array in table.arrays]
    of_kind = [table for table in usable if table.kind is kind]
    return (of_kind or usable or [None])[-1]


def _select_predicted(store: Store, tables: list[ModalTable]) -> list[ModalTable]:
    """Select tables with most modes of one prediction; all without prediction.

    Modal data imported under another name, with other modes, do not replace those for which
    derivatives are predicted.
    """
    usable = [table for table in tables if "omega" in table.arrays]
    fem = [table for table in usable if table.kind is ModalKind.FEM] or usable
    if not fem:
        return tables
    predictions = store.predictions.find(aircraft_id=fem[0].aircraft_id)

    def count_predicted(table: ModalTable) -> int:
        return max((len(list_predicted_modes(p, table.numbers)) for p in predictions), default=0)

    most = max(count_predicted(table) for table in fem)
    return [table for table in fem if count_predicted(table) == most]


def _find_damping(
    store: Store, modal: ModalTable, damping: ModalTable | None, aligned: ModeTable
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return damping in tracked order: of the test, else of the table."""
    zeta = aligned.zeta.copy()
    warnings: tuple[str, ...] = ()
    if damping is not None and damping.id != modal.id and "zeta" in damping.arrays:
        tested, warnings = match_test_damping(store, modal, damping, aligned)
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
