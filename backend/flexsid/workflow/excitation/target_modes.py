"""Target modes of a design, and which of them lie within its band."""

from __future__ import annotations

import numpy as np

from flexsid.records.excitation import ExcitationDesign
from flexsid.records.views import TargetMode, TargetModes
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import ELASTIC_GROUPS, FlightTestAid
from flexsid.sysid.excitation.designer import DesignSpecification
from flexsid.workflow.excitation.excitation_designs import find_flight_test_aid
from flexsid.workflow.modal_data.modal_tables import AircraftModes, find_modal_tables, load_modes

_ABOVE = 1.05  # of a mode's in-vacuo frequency: harmonics on both sides of its peak
_RIGID_HZ = 0.1  # free-free models give rigid modes as numerical zeros
_ALL = "all"  # group of the structural modes of a design outside Table 1


def find_reach(store: Store, fta: int, aircraft_id: int) -> float | None:
    """Return the frequency that a row of Table 1 has to reach on an aircraft. [Hz]

    None where the row targets no structural mode of the aircraft.

    Raises
    ------
    BadInput
        If Table 1 lacks the row, or the aircraft has no modal table.
    """
    aid = find_flight_test_aid(fta)
    modes = load_modes(store, *find_modal_tables(store, aircraft_id, None, None))
    highest = [target[3] for target in _list_targets(modes, aid)]
    return _ABOVE * max(highest) if highest else None


def compare_target_modes(store: Store, design: ExcitationDesign, aircraft_id: int) -> TargetModes:
    """Compare the band of a design with the structural modes that it targets on an aircraft.

    A design outside Table 1 is compared with all structural modes.

    Raises
    ------
    BadInput
        If the aircraft has no modal table.
    """
    store.aircraft.get(aircraft_id)
    modes = load_modes(store, *find_modal_tables(store, aircraft_id, None, None))
    aid = None if design.fta is None else find_flight_test_aid(design.fta)
    low, high = find_band(design.specification)
    found = tuple(
        TargetMode(
            number=number,
            name=modes.names[number],
            group=group,
            low_hz=lowest,
            high_hz=highest,
            in_band=low <= lowest and highest <= high,
        )
        for group, number, lowest, highest in _list_targets(modes, aid)
    )
    return TargetModes(
        low_hz=low, high_hz=high, modes=found, sentence=_describe(low, high, found, aid)
    )


def find_band(specification: DesignSpecification) -> tuple[float, float]:
    """Return the lowest and highest frequency of any input. [Hz]"""
    every = [harmonic for own in specification.inputs for harmonic in own.harmonics]
    return min(every) / specification.duration_s, max(every) / specification.duration_s


def _list_targets(
    modes: AircraftModes, aid: FlightTestAid | None
) -> list[tuple[str, int, float, float]]:
    """List group, number, lowest and highest frequency over fuel [Hz] of the target modes."""
    hz = modes.table.omega / (2.0 * np.pi)
    order = [
        int(column) for column in np.argsort(hz.mean(axis=0)) if hz[:, column].min() > _RIGID_HZ
    ]
    groups, axis = {_ALL: slice(None)}, ""
    if aid is not None:
        groups, axis = {group: ELASTIC_GROUPS[group] for group in aid.elastic_targets}, aid.axis
    symmetric = {"symmetric": True, "antisymmetric": False}.get(axis)
    found = []
    for group, columns in groups.items():
        for column in order[columns]:
            number = modes.table.numbers[column]
            if symmetric is None or modes.symmetric[number] == symmetric:
                low, high = float(hz[:, column].min()), float(hz[:, column].max())
                found.append((group, number, low, high))
    return found


def _describe(
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
        return f"{band} and cover all target modes of the row."
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
