"""Boxes of a computed prediction: pressure, splined modes, quality, and the layout of sensors."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Lattice, UnsteadyPrediction
from flexsid.records.views import LatticeQuantity, LatticeView
from flexsid.storage.store import Store
from flexsid.sysid.aerodynamics.boxes import Boxes
from flexsid.sysid.model.lateral import LATERAL
from flexsid.workflow.modal_data.modal_tables import find_modal_tables, load_modes

_LARGEST_DISPLACEMENT = 0.1  # of the span

RESOLVED = 12.5
"""Boxes per wavelength from which pressures of a lattice are accurate: chords below 0.08 V/f
(Rodden and Johnson, MSC/Nastran Aeroelastic Analysis User's Guide, 1994)."""


def view_lattice(
    store: Store,
    prediction_id: int,
    quantity: LatticeQuantity = LatticeQuantity.LAYOUT,
    column: str | None = None,
) -> LatticeView:
    """Return one quantity on the boxes of a computed prediction, mirrored to both halves.

    Parameters
    ----------
    store
        Store of the prediction.
    prediction_id
        Prediction computed from a planform.
    quantity
        What the boxes show.
    column
        Variable of a pressure, such as ``alpha``, ``eta7`` or ``wf1s``, or number of a mode; the
        first by default.

    Raises
    ------
    BadInput
        If the prediction has no lattice, or the variable or mode is not one of it.
    """
    prediction = store.predictions.get(prediction_id)
    unsteady = prediction.unsteady
    if unsteady is None or unsteady.lattice is None:
        raise BadInput(
            f"prediction '{prediction.source}' has no stored boxes; compute it again from the "
            "planform",
            code="no-lattice",
        )
    lattice = unsteady.lattice
    aircraft = store.aircraft.get(prediction.aircraft_id)
    corners = np.asarray(store.arrays.get(lattice.corners), dtype=float)
    surface = np.asarray(store.arrays.get(lattice.surface), dtype=float)
    boxes = _build_boxes(corners)
    # Antisymmetric motion has the opposite pressure and displacement on the left half.
    sign = -1.0 if LATERAL.motions[0] in lattice.columns else 1.0
    left, parameter, note, mirrored = corners, "", "", 1.0
    if quantity is LatticeQuantity.PRESSURE:
        parameter = _select(lattice.columns, column, "variable")
        pressures = np.asarray(store.arrays.get(lattice.pressures))
        values = np.real(pressures[lattice.columns.index(parameter)])
        note = (
            f"real part at k = {unsteady.reference_k:g}, fuel {100.0 * lattice.fuel:g} %, "
            f"Mach {unsteady.mach:g}"
        )
        mirrored = sign
    elif quantity is LatticeQuantity.MODE:
        names = _name_modes(store, prediction.aircraft_id, unsteady, lattice)
        numbers = [str(mode) for mode in lattice.modes]
        place = numbers.index(_select(numbers, column, "mode"))
        displacement = np.asarray(store.arrays.get(lattice.displacements), dtype=float)[place]
        values = displacement / max(float(np.abs(displacement).max()), 1e-30)
        moved = _LARGEST_DISPLACEMENT * aircraft.geometry.span_m * values[:, None] * boxes.normal
        left = corners + sign * moved[:, None]
        corners = corners + moved[:, None]
        parameter, mirrored = names[lattice.modes[place]], sign
        note = f"as splined to the boxes, fuel {100.0 * lattice.fuel:g} %"
    elif quantity is LatticeQuantity.ASPECT_RATIO:
        values = boxes.span / boxes.chord
        note = "span over chord of each box"
    elif quantity is LatticeQuantity.RESOLUTION:
        highest = unsteady.k[-1]
        values = np.pi * aircraft.geometry.chord_m / (highest * boxes.chord)
        note = (
            f"boxes per wavelength at the highest k = {highest:g}; {RESOLVED:g} are required for "
            f"accurate pressures, which these boxes have up to k = "
            f"{highest * values.min() / RESOLVED:.2g}"
        )
    else:
        values = np.where(surface < 0.0, np.nan, surface)
        note = "surfaces as snapped to boxes; sensors except strain gauges"
    mirror = np.array([1.0, -1.0, 1.0])
    return LatticeView(
        quantity=quantity,
        parameter=parameter,
        corners=np.concatenate([corners, left * mirror]),
        values=np.concatenate([values, mirrored * values]),
        surfaces=lattice.surfaces,
        sensors=tuple(
            (one.name, *one.location_m[:2])
            for one in aircraft.sensors
            if one.model.senses != "strain"
        ),
        note=note,
    )


def _build_boxes(corners: np.ndarray) -> Boxes:
    n = corners.shape[0]
    return Boxes(corners, np.zeros(n, dtype=int), np.arange(n))


def _select(known: tuple[str, ...] | list[str], name: str | None, noun: str) -> str:
    if name is None and known:
        return known[0]
    if name is None or name not in known:
        raise BadInput(
            f"'{name}' is not a {noun} of the prediction; known are {', '.join(known) or 'none'}",
            code="unknown-variable",
        )
    return name


def _name_modes(
    store: Store, aircraft_id: int, unsteady: UnsteadyPrediction, lattice: Lattice
) -> dict[int, str]:
    modes = load_modes(store, *find_modal_tables(store, aircraft_id, unsteady.modal_table_id))
    return {number: modes.names.get(number, str(number)) for number in lattice.modes}
