"""Structural modes that a design is meant to excite, and which of them its band holds."""

from __future__ import annotations

import numpy as np

from flexsid.records.excitation import ExcitationDesign
from flexsid.records.views import TargetMode, TargetModes
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import ELASTIC_GROUPS, FlightTestAid
from flexsid.sysid.excitation.designer import Wish
from flexsid.workflow.excitation.excitation_designs import row_of
from flexsid.workflow.modal_data.aligned_modes import AircraftModes, find_modal_tables, load_modes

_ABOVE = 1.05  # of a mode's frequency without air: lines on both sides of its peak
_RIGID_HZ = 0.1  # free-free models give rigid modes as numerical zeros
_ALL = "all"  # group of the structural modes of a design that is no row of Table 1


def reach_of(store: Store, fta: int, aircraft_id: int) -> float | None:
    """Frequency that a row of Table 1 has to reach on an aircraft. [Hz]

    None where the row targets no structural mode of the aircraft.

    Raises
    ------
    BadInput
        If Table 1 has no such row, or the aircraft no modal table.
    """
    aid = row_of(fta)
    modes = load_modes(store, *find_modal_tables(store, aircraft_id, None, None))
    highest = [target[3] for target in _targets(modes, aid)]
    return _ABOVE * max(highest) if highest else None


def target_modes(store: Store, design: ExcitationDesign, aircraft_id: int) -> TargetModes:
    """Compare the band of a design with the structural modes that it targets on an aircraft.

    A design that is no row of Table 1 is compared with all structural modes.

    Raises
    ------
    BadInput
        If the aircraft has no modal table.
    """
    store.aircraft.get(aircraft_id)
    modes = load_modes(store, *find_modal_tables(store, aircraft_id, None, None))
    aid = None if design.fta is None else row_of(design.fta)
    low, high = band_of(design.wish)
    found = tuple(
        TargetMode(
            number=number,
            name=modes.names[number],
            group=group,
            low_hz=lowest,
            high_hz=highest,
            in_band=low <= lowest and highest <= high,
        )
        for group, number, lowest, highest in _targets(modes, aid)
    )
    return TargetModes(
        low_hz=low, high_hz=high, modes=found, sentence=_sentence(low, high, found, aid)
    )


def band_of(wish: Wish) -> tuple[float, float]:
    """Lowest and highest frequency of any input. [Hz]"""
    every = [harmonic for own in wish.inputs for harmonic in own.harmonics]
    return min(every) / wish.duration_s, max(every) / wish.duration_s


def _targets(
    modes: AircraftModes, aid: FlightTestAid | None
) -> list[tuple[str, int, float, float]]:
    """Group, number, and lowest and highest frequency over fuel [Hz] of the targets."""
    hz = modes.table.omega / (2.0 * np.pi)
    order = [
        int(column) for column in np.argsort(hz.mean(axis=0)) if hz[:, column].min() > _RIGID_HZ
    ]
    groups, axis = {_ALL: slice(None)}, ""
    if aid is not None:
        groups, axis = {group: ELASTIC_GROUPS[group] for group in aid.elastic_targets}, aid.axis
    wanted = {"symmetric": True, "antisymmetric": False}.get(axis)
    found = []
    for group, places in groups.items():
        for column in order[places]:
            number = modes.table.numbers[column]
            if wanted is None or modes.symmetric[number] == wanted:
                low, high = float(hz[:, column].min()), float(hz[:, column].max())
                found.append((group, number, low, high))
    return found


def _sentence(
    low: float, high: float, found: tuple[TargetMode, ...], aid: FlightTestAid | None
) -> str:
    band = f"The harmonics span {low:.3g} to {high:.4g} Hz"
    if aid is not None and not found:
        return f"{band}; the row targets no structural mode of this aircraft."
    outside = [mode for mode in found if not mode.in_band]
    if aid is None:
        within = ", ".join(mode.name for mode in found if mode.in_band) or "none"
        return f"{band}. Structural modes in this band: {within}."
    if not outside:
        return f"{band} and hold all structural modes that the row targets."
    missing = ", ".join(
        f"{mode.group} {mode.name} ({mode.low_hz:.4g} Hz)"
        if f"{mode.low_hz:.4g}" == f"{mode.high_hz:.4g}"
        else f"{mode.group} {mode.name} ({mode.low_hz:.4g} to {mode.high_hz:.4g} Hz over fuel)"
        for mode in outside
    )
    return (
        f"{band} and do not reach these target modes of the row: {missing}. Design the row for this"
        " aircraft, or shorten the period."
    )
