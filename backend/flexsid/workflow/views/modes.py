"""Structural modes at the fuel of a maneuver, their shapes, and the boxes of predictions."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput, UnknownRecord
from flexsid.importers.modal_data.options import TO_BODY
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Lattice, UnsteadyPrediction
from flexsid.records.maneuver import Maneuver
from flexsid.records.modal_data import (
    CrossingMark,
    DrawnShape,
    ModalTable,
    ModeAtFuel,
    ModesAgainstFuel,
    SensorSight,
)
from flexsid.records.run import EstimationRun, Pole
from flexsid.records.views import LatticeQuantity, LatticeView, ModeMarker
from flexsid.storage.store import Store
from flexsid.sysid.aerodynamics.boxes import Boxes
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.modes.shapes import connect_neighbours, select_spread_nodes
from flexsid.sysid.modes.table import compute_fuel_weights, find_mode_crossings, sum_weighted_rows
from flexsid.sysid.signals import interpolate
from flexsid.workflow.aircraft.axes import list_bodies
from flexsid.workflow.modal_data.modal_import import SHOWN
from flexsid.workflow.modal_data.modal_tables import (
    DEVIATIONS,
    AircraftModes,
    Modes,
    find_modal_tables,
    format_title,
    interpolate_damping,
    interpolate_deviation,
    interpolate_quadrature,
    interpolate_shape,
    list_mode_names,
    load_modes,
    open_modes,
    read_nodes,
)

# --- Structural modes at the fuel of a maneuver: frequency markers, in-vacuo poles ----------------


def find_mode_markers(
    store: Store, maneuver: Maneuver, band_hz: tuple[float, float]
) -> tuple[ModeMarker, ...]:
    """Find in-vacuo frequencies of the modes of the maneuver's symmetry within a band."""
    try:
        known, at_fuel = _load(store, maneuver, None, None)
    except BadInput:  # without modal table the Bode plot has no markers
        return ()
    bodies = list_bodies(maneuver.axis)
    markers = (
        ModeMarker(name=known.names[number], frequency_hz=float(omega) / (2.0 * np.pi))
        for number, omega in zip(at_fuel.numbers, at_fuel.omega, strict=True)
        if any(known.belongs_to(number, body) for body in bodies)
    )
    return tuple(mark for mark in markers if band_hz[0] <= mark.frequency_hz <= band_hz[1])


def find_identified_markers(
    run: EstimationRun, band_hz: tuple[float, float]
) -> tuple[ModeMarker, ...]:
    """Find natural frequencies of oscillatory poles of a run's model within a band."""
    poles = () if run.result is None else run.result.poles
    markers = (
        ModeMarker(
            name=f"{pole.name or 'pole'} {run.method.value} {run.id}",
            frequency_hz=float(np.hypot(pole.real, pole.imag)) / (2.0 * np.pi),
            run_id=run.id,
        )
        for pole in poles
        if pole.imag > 0
    )
    return tuple(mark for mark in markers if band_hz[0] <= mark.frequency_hz <= band_hz[1])


def list_modal_poles(store: Store, run: EstimationRun) -> tuple[Pole, ...]:
    """List in-vacuo poles of the modes of a run's model. [rad/s]"""
    if not run.structure.modes:
        return ()
    maneuver = store.maneuvers.get(run.maneuver_id)
    known, at_fuel = _load(store, maneuver, run.modal_table_id, run.damping_table_id)
    selected = at_fuel.select(run.structure.modes)
    return tuple(
        Pole(
            real=float(-zeta * omega),
            imag=float(omega * np.sqrt(1.0 - zeta**2)),
            name=known.names[number],
        )
        for number, omega, zeta in zip(selected.numbers, selected.omega, selected.zeta, strict=True)
    )


def _load(
    store: Store, maneuver: Maneuver, modal_table_id: int | None, damping_table_id: int | None
) -> tuple[AircraftModes, StructuralModes]:
    tables = find_modal_tables(store, maneuver.aircraft_id, modal_table_id, damping_table_id)
    known = load_modes(store, *tables)
    return known, known.table.at(maneuver.condition.fuel_fraction)


# --- Mode shape for drawing, with the motion at each sensor ---------------------------------------


def read_shape(
    store: Store, modal_table_id: int, number: int, fuel: float, every_node: bool = False
) -> DrawnShape:
    """Read one mode shape for drawing, with the motion at each sensor.

    Raises
    ------
    BadInput
        If the table has no such mode or no shapes at nodes.
    """
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    mode = _get_index(table, number)
    nodes = read_nodes(store, table)
    shape = interpolate_shape(store, modes, mode, fuel)
    rows = np.arange(nodes.shape[0])
    if not every_node and "shown" in table.arrays:
        rows = np.asarray(store.arrays.get(table.arrays["shown"]))
    elif not every_node:
        rows = select_spread_nodes(nodes, SHOWN)
    if rows.size < nodes.shape[0] or "lines" not in table.arrays:
        known = table.arrays.get("shown_lines")
        lines = connect_neighbours(nodes[rows]) if known is None else store.arrays.get(known)
    else:
        lines = store.arrays.get(table.arrays["lines"])
        lines = lines if lines.size else connect_neighbours(nodes)
    displacement = shape[:, :3] * TO_BODY  # back to structural axes
    quadrature = interpolate_quadrature(store, modes, fuel)
    ahead = None if quadrature is None else quadrature[mode, :, :3] * TO_BODY
    largest = np.sum(displacement**2, axis=1) + (0.0 if ahead is None else np.sum(ahead**2, axis=1))
    weights = compute_fuel_weights(modes.fuel, fuel)
    omega = sum_weighted_rows(weights, modes.omega)[mode]
    return DrawnShape(
        modal_table_id=modal_table_id,
        number=number,
        name=list_mode_names(table)[mode],
        fuel=fuel,
        frequency_hz=float(omega) / (2.0 * np.pi),
        n_nodes=nodes.shape[0],
        nodes_m=nodes[rows],
        displacement_m=displacement[rows],
        lines=np.asarray(lines),
        largest_m=float(np.sqrt(largest.max())),
        span_m=float(np.ptp(nodes, axis=0).max()),
        sensors=_list_sensors(store, modes, mode, fuel),
        quadrature_m=None if ahead is None else ahead[rows],
        collinearity=finite_or_none(interpolate_deviation(modes, "collinearity", fuel)[mode]),
    )


def _list_sensors(store: Store, modes: Modes, mode: int, fuel: float) -> tuple[SensorSight, ...]:
    table = modes.table
    if "shape" not in table.arrays:
        return ()
    aircraft = store.aircraft.get(table.aircraft_id)
    points = modes.tracking.align(np.asarray(store.arrays.get(table.arrays["shape"]), float))
    weights = compute_fuel_weights(modes.fuel, fuel)
    shape = sum_weighted_rows(weights, points)[mode]
    ahead = None
    if "point_quadrature" in table.arrays:
        parts = np.asarray(store.arrays.get(table.arrays["point_quadrature"]), float)
        ahead = sum_weighted_rows(weights, modes.tracking.align(parts))[mode]
    return tuple(
        SensorSight(
            sensor=sensor.name,
            kind=sensor.kind,
            axis=sensor.axis,
            location_m=sensor.location_m,
            phi_m=_to_triple(shape[row, :3]),
            nu_rad=_to_triple(shape[row, 3:]),
            quadrature_m=None if ahead is None else _to_triple(ahead[row, :3]),
        )
        for sensor in aircraft.sensors
        if sensor.model.senses != "strain" and sensor.point in table.points
        for row in (table.points.index(sensor.point),)
    )


def _to_triple(values: np.ndarray) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])


def _get_index(table: ModalTable, number: int) -> int:
    if number not in table.numbers:
        raise UnknownRecord(
            f"table '{table.name}' has no mode {number}; it has "
            f"{', '.join(map(str, table.numbers))}"
        )
    return table.numbers.index(number)


# --- The modes of a table at one fuel weight and over all -----------------------------------------

_FINE = 101


def list_modes_at(store: Store, modal_table_id: int, fuel: float) -> tuple[ModeAtFuel, ...]:
    """List the modes of a table at a fuel fraction, in order of frequency there."""
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    weights = compute_fuel_weights(modes.fuel, fuel)
    omega = sum_weighted_rows(weights, modes.omega)
    zeta = interpolate_damping(store, modes, fuel)
    mass = None if modes.mass is None else interpolate(modes.fuel, modes.mass, fuel)
    deviations = [interpolate_deviation(modes, name, fuel) for name in DEVIATIONS]
    collinearity = interpolate_deviation(modes, "collinearity", fuel)
    followed = modes.tracking.assurance.min(axis=0)
    names = list_mode_names(table)
    reasons = [*table.reasons, *[""] * len(table.numbers)]
    listed = [
        ModeAtFuel(
            number=number,
            name=names[index],
            symmetric=table.symmetric[index],
            reason=reasons[index],
            frequency_hz=float(omega[index]) / (2.0 * np.pi),
            damping=finite_or_none(zeta[index]),
            frequency_std_hz=finite_or_none(deviations[0][index] / (2.0 * np.pi)),
            damping_std=finite_or_none(deviations[1][index]),
            shape_std=finite_or_none(deviations[2][index]),
            mass_kg_m2=None if mass is None else float(mass[index]),
            followed=float(followed[index]) if modes.fuel.size > 1 else None,
            collinearity=finite_or_none(collinearity[index]),
        )
        for index, number in enumerate(table.numbers)
    ]
    return tuple(sorted(listed, key=lambda mode: mode.frequency_hz))


def trace_modes(store: Store, modal_table_id: int) -> ModesAgainstFuel:
    """Trace frequency and damping of every mode over fuel, with crossings."""
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    names = list_mode_names(table)
    fine = np.linspace(modes.fuel[0], modes.fuel[-1], _FINE if modes.fuel.size > 1 else 1)
    omega = np.array(
        [sum_weighted_rows(compute_fuel_weights(modes.fuel, f), modes.omega) for f in fine]
    )
    marks = tuple(
        CrossingMark(
            fuel=mark.fuel,
            frequency_hz=mark.omega / (2.0 * np.pi),
            names=(names[mark.modes[0]], names[mark.modes[1]]),
        )
        for mark in find_mode_crossings(fine, omega)
    )
    low_mac = tuple(
        (float(modes.fuel[row]), float(modes.omega[row, mode]) / (2.0 * np.pi))
        for row, mode in modes.tracking.low_mac
    )
    return ModesAgainstFuel(
        title=format_title(table),
        names=names,
        symmetric=table.symmetric,
        fuel=fine,
        frequency_hz=omega / (2.0 * np.pi),
        damping=interpolate_damping(store, modes, fine),
        table_fuel=modes.fuel,
        table_hz=modes.omega / (2.0 * np.pi),
        crossings=marks,
        uncertain=low_mac,
    )


# --- Boxes of a computed prediction: pressure, splined modes, quality, and the layout of sensors

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
