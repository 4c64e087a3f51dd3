"""Predictions computed from a planform: derivatives by reduced frequency from a doublet lattice."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Id, Name
from flexsid.errors import BadInput, Conflict
from flexsid.importers.nastran.aero import read_aero_deck
from flexsid.records.aircraft import Aircraft, DerivativePrediction, Lattice, UnsteadyPrediction
from flexsid.records.job import Job
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.aerodynamics.boxes import Boxes, Panel, Place, Trapezium, mesh_panels
from flexsid.sysid.aerodynamics.coefficients import (
    NOT_PREDICTED,
    REDUCED_FREQUENCIES,
    UnsteadyCoefficients,
    compute_loadings,
    compute_pressures,
)
from flexsid.sysid.aerodynamics.doublet_lattice import MAX_BOXES, Symmetry
from flexsid.sysid.aerodynamics.splines import (
    BoxShapes,
    ControlSurface,
    Reference,
    SplinedSurface,
    interpolate_shapes,
    place_surface,
    select_nodes,
)
from flexsid.sysid.model.derivatives import list_derivative_names, variables
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.modes.shapes import may_be
from flexsid.text import LONGEST_TEXT
from flexsid.units import factor
from flexsid.workflow.aircraft.axes import get_symmetry, require_axis_inputs
from flexsid.workflow.aircraft.derivative_predictions import select_by_id
from flexsid.workflow.modal_data.modal_tables import (
    TO_STRUCTURE,
    find_modal_tables,
    interpolate_shape,
    open_modes,
    read_nodes,
)

KIND = "doublet lattice"

_BODIES = {body.axis: body for body in (LONGITUDINAL, LATERAL)}
_MOST_MODES = 8  # lowest ones of the symmetry of the axis, unless modes are named
_MOST_FUELS = 17
_LARGEST_DIVISION = 200
_COARSE_SHARE = 0.2  # of the work: the coarser mesh of the spread has a quarter of the pairs

_SPREAD = {"alpha": 0.15, "q": 0.15, "p": 0.15, "eta": 0.15, "etadot": 0.25}
_SPREAD_OF_OTHERS = 0.20
"""Standard deviations relative to the value, beside that of the mesh (design notes of the project:
lattices and flight differ by so much for thickness, gaps and viscosity). Sideslip and yaw rate act
on bodies and winglets, of which a lattice represents as little as of surfaces with gaps."""
_SYMMETRIES = {
    LONGITUDINAL.symmetry: Symmetry.SYMMETRIC,
    LATERAL.symmetry: Symmetry.ANTISYMMETRIC,
}
_NOT_PREDICTED = {f"{row}_{column}" for row, column in NOT_PREDICTED}
_SMALL = 0.05  # of the largest derivative of its row: such an entry has a spread of that size


Division = Annotated[int, Allowed(ge=1, le=200)]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanformPanel(Trapezium):
    """A trapezium of the right half in structural axes (X aft, Y right, Z up). [m]

    ``left`` and ``right`` are leading edges, left to right as seen from behind; divisions are even.
    """

    chordwise: Division = 8
    spanwise: Division = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanformSurface:
    """A surface by Y of its ends [m] and its hinge line as fraction of the chord."""

    name: Name
    span: tuple[Place, Place]
    hinge: Annotated[float, Allowed(gt=0.0, lt=1.0)] = 0.75


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictionRequest:
    """Planform, modes, Mach number and reduced frequencies of a prediction to compute.

    Panels are given, or CAERO1 entries of a Nastran ``deck`` in ``deck_unit``. ``axis`` is that of
    the derivatives; ``modes`` are the lowest ones of its symmetry by default, and deflections of
    antisymmetric surfaces are positive with the right trailing edge down. ``reference_k`` is the
    reduced frequency of the tabulated derivatives: 0, or that of the mode that flutters; never an
    average over the band.
    """

    aircraft_id: Id
    source: Name
    axis: Annotated[str, Allowed(choices=("longitudinal", "lateral"))] = LONGITUDINAL.axis
    panels: Annotated[tuple[PlanformPanel, ...], Allowed(max_length=100)] = ()
    surfaces: Annotated[tuple[PlanformSurface, ...], Allowed(max_length=40)] = ()
    deck: Annotated[str, Allowed(max_length=LONGEST_TEXT)] = ""
    deck_unit: Name = "m"
    modal_table_id: Id | None = None
    modes: Annotated[tuple[Id, ...], Allowed(max_length=30)] = ()
    mach: Annotated[float, Allowed(ge=0.0, le=1.0)] = 0.0
    reference_k: Annotated[float, Allowed(ge=0.0, le=4.0)] = 0.0
    highest_k: Annotated[float, Allowed(ge=0.1, le=4.0)] = 2.0


@dataclass(frozen=True, slots=True)
class PredictionTask:
    """Numbers of a prediction for a worker without a database; shapes are per fuel weight."""

    request: PredictionRequest
    panels: tuple[Panel, ...]
    modal_table_id: int | None
    modes: tuple[int, ...]
    fuel: tuple[float, ...]
    references: tuple[Reference, ...]
    nodes: np.ndarray
    shapes: np.ndarray  # (fuel, modes, nodes, 6), structural axes

    @property
    def body(self) -> RigidBody:
        """Rigid body of the axis."""
        return _BODIES[self.request.axis]


@dataclass(frozen=True, slots=True)
class ComputedPrediction:
    """A prediction before it is stored: complex coefficients and standard deviations.

    ``values`` and ``std_errors`` of derivatives that a lattice does not predict are NaN.
    """

    task: PredictionTask
    names: tuple[str, ...]
    k: np.ndarray
    coefficients: np.ndarray  # (fuel, k, names)
    coarse_coefficients: np.ndarray | None  # the same, of half the divisions along the chord
    values: np.ndarray  # (fuel, names)
    std_errors: np.ndarray
    boxes: Boxes
    surfaces: tuple[ControlSurface, ...]
    displacements: np.ndarray  # (modes, boxes), at the fuel weight of the pressures
    pressures: np.ndarray  # (columns, boxes)


def prepare_prediction(store: Store, request: PredictionRequest) -> PredictionTask:
    """Read what a prediction needs.

    Raises
    ------
    BadInput
        If the planform, a surface or a mode is not valid, or the modal table has no nodes.
    Conflict
        If the aircraft has a prediction of that name.
    """
    aircraft = store.aircraft.get(request.aircraft_id)
    check_prediction(store, request)
    panels = _read_panels(request)
    tables = store.modal_tables.find(aircraft_id=request.aircraft_id)
    if request.modal_table_id is not None:
        modal = select_by_id(tables, request.modal_table_id, "modal table", code="wrong-table")
    else:
        modal = find_modal_tables(store, request.aircraft_id, None, None)[0]
    modes = open_modes(store, modal)
    nodes = read_nodes(store, modes.table)
    body = _BODIES[request.axis]
    symmetric = dict(zip(modes.table.numbers, modes.table.symmetric, strict=True))
    own = [n for n, known in symmetric.items() if may_be(known, body.symmetry == "symmetric")]
    numbers = request.modes or tuple(own[:_MOST_MODES])
    for number in numbers:
        if number not in symmetric:
            raise BadInput(
                f"mode {number} is not in modal table '{modes.table.name}'", code="unknown-mode"
            )
        if number not in own:
            raise BadInput(
                f"mode {number} has the other symmetry; a {body.axis} prediction has "
                f"{body.symmetry} modes, which are {', '.join(map(str, own)) or 'none'} in modal "
                f"table '{modes.table.name}'",
                code="axis-not-supported",
                mode=number,
            )
    fuel = modes.table.fuel
    if len(fuel) > _MOST_FUELS:
        raise BadInput(f"{len(fuel)} fuel weights; expected at most {_MOST_FUELS}")
    indices = [modes.table.numbers.index(number) for number in numbers]
    shapes = np.array(
        [[interpolate_shape(store, modes, mode, f) for mode in indices] for f in fuel]
    )
    shapes = shapes.reshape(len(fuel), len(numbers), len(nodes), 6) * TO_STRUCTURE
    references = tuple(_build_reference(aircraft, f) for f in fuel)
    return PredictionTask(
        request, panels, modal.id, numbers, tuple(fuel), references, nodes, shapes
    )


def check_prediction(store: Store, request: PredictionRequest) -> None:
    """Refuse a request that cannot be computed, before it is queued.

    Raises
    ------
    BadInput
        If the planform or a number is not valid.
    Conflict
        If the aircraft has a prediction of that name.
    """
    aircraft = store.aircraft.get(request.aircraft_id)
    if store.predictions.find(aircraft_id=request.aircraft_id, source=request.source):
        raise Conflict(
            f"Prediction '{request.source}' is there already; give this one another name.",
            code="already-exists",
        )
    if not 0.0 <= request.mach < 0.9:
        raise BadInput(
            f"the Mach number is {request.mach:g}; a lattice is valid from 0 to 0.9",
            code="bad-mach",
        )
    if not 0.1 <= request.highest_k <= 4.0 or not 0.0 <= request.reference_k <= request.highest_k:
        raise BadInput(
            "the highest k must be from 0.1 to 4, and the reference k at most as high",
            code="bad-frequency",
        )
    known = [surface.name for surface in aircraft.surfaces]
    for surface in request.surfaces:
        if surface.name not in known:
            raise BadInput(
                f"'{surface.name}' is not a surface of {aircraft.name}; surfaces are "
                f"{', '.join(known) or 'none'}",
                code="unknown-input",
            )
    body = _BODIES.get(request.axis)
    if body is None:
        raise BadInput(
            f"derivatives are computed for one axis, {' or '.join(_BODIES)}; "
            f"'{request.axis}' is neither",
            code="axis-not-supported",
        )
    require_axis_inputs(aircraft, [surface.name for surface in request.surfaces], body)
    for surface in request.surfaces:
        if get_symmetry(aircraft, surface.name) == "single":
            raise BadInput(
                f"'{surface.name}' moves on one side; compute the derivatives of both sides "
                f"together, as a {body.symmetry} surface of the aircraft",
                code="axis-not-supported",
                channel=surface.name,
            )
    boxes = mesh_panels(_read_panels(request))
    for surface in request.surfaces:
        _place(boxes, surface)


def compute_prediction(task: PredictionTask, report: ReportProgress) -> ComputedPrediction:
    """Compute C(k) of all fuel weights, and the spread of the derivatives.

    Notes
    -----
    The spread adds in squares: 15 to 25 % of each derivative (at least of 5 % of the largest of
    its row), and the difference from a mesh with half the divisions along the chord. That mesh is
    omitted where the panels have odd divisions, or a hinge line would move to another edge.
    """
    request = task.request

    def show(begin: float, share: float, message: str) -> Callable[[float], None]:
        return lambda part: report(Progress(fraction=begin + share * part, message=message))

    k = REDUCED_FREQUENCIES[request.highest_k > REDUCED_FREQUENCIES]
    k = np.append(k, request.highest_k)
    boxes = mesh_panels(task.panels)
    message = f"Influence of {len(boxes)} boxes"
    shapes = _interpolate(task, boxes)
    surfaces, found = _compute(task, boxes, shapes, k, show(0.0, 1.0 - _COARSE_SHARE, message))
    coarse_panels = [_halve_chordwise(panel) for panel in task.panels]
    message = "Coarser mesh for the spread"
    progress = show(1.0 - _COARSE_SHARE, _COARSE_SHARE, message)
    coarse_boxes = mesh_panels(coarse_panels)
    is_coarser = len(coarse_boxes) < len(boxes) and all(
        np.isclose(_place(coarse_boxes, asked).hinge_fraction, surface.hinge_fraction)
        for asked, surface in zip(request.surfaces, surfaces, strict=True)
    )
    coarse = found
    if is_coarser:
        coarse_shapes = _interpolate(task, coarse_boxes)
        coarse = _compute(task, coarse_boxes, coarse_shapes, k, progress)[1]
    # The lattice numbers modes from 1.
    inputs = tuple(surface.name for surface in request.surfaces)
    names = list_derivative_names(task.modes, inputs, task.body)
    values = np.array([np.real(C.at(request.reference_k)) for C in found])
    mesh = values - np.array([np.real(C.at(request.reference_k)) for C in coarse])
    std = np.hypot(compute_spread(values, variables(task.modes, inputs, task.body)), mesh)
    n_fuel = len(task.fuel)
    values, std = values.reshape(n_fuel, -1), std.reshape(n_fuel, -1)
    middle = n_fuel // 2
    not_predicted = [name in _NOT_PREDICTED for name in names]
    values[:, not_predicted] = std[:, not_predicted] = np.nan
    return ComputedPrediction(
        task,
        names,
        k,
        np.array([C.values for C in found]).reshape(n_fuel, k.size, -1),
        np.array([C.values for C in coarse]).reshape(n_fuel, k.size, -1) if is_coarser else None,
        values,
        std,
        boxes,
        tuple(surfaces),
        shapes[middle].control,
        compute_pressures(
            boxes,
            shapes[middle],
            surfaces,
            task.references[middle],
            mach=request.mach,
            symmetry=_SYMMETRIES[task.body.symmetry],
            k=request.reference_k,
        ),
    )


def compute_spread(values: np.ndarray, columns: Sequence[str]) -> np.ndarray:
    """Compute standard deviations of (fuel, rows, columns) by experience, without that of a mesh.

    15 to 25 % of each derivative, at least of 5 % of the largest of its row.
    """
    relative = [_SPREAD.get(c.rstrip("0123456789"), _SPREAD_OF_OTHERS) for c in columns]
    size = np.maximum(np.abs(values), _SMALL * np.abs(values).max(axis=2, keepdims=True))
    return size * np.array(relative)


def store_computed_prediction(
    store: Store, job: Job, request: PredictionRequest, found: ComputedPrediction
) -> dict[str, int | None]:
    """Store a computed prediction beside imported ones, and return its id.

    Raises
    ------
    Conflict
        If a prediction of that name was stored meanwhile.
    """
    task = found.task
    check_prediction(store, request)
    geometry = repr((request.panels, request.deck, request.deck_unit, request.surfaces))
    stored = store.predictions.add(
        DerivativePrediction(
            aircraft_id=request.aircraft_id,
            source=request.source,
            kind=KIND,
            fuel=task.fuel,
            names=found.names,
            values=store.arrays.put(found.values),
            std_errors=store.arrays.put(found.std_errors),
            note=_describe(found),
            unsteady=UnsteadyPrediction(
                k=tuple(found.k.tolist()),
                reference_k=request.reference_k,
                coefficients=store.arrays.put(found.coefficients),
                mach=request.mach,
                n_boxes=len(found.boxes),
                geometry=hashlib.sha256(geometry.encode()).hexdigest(),
                modal_table_id=task.modal_table_id,
                surfaces=tuple(
                    f"{s.name}: hinge {s.hinge_fraction:.3f}, Y {s.span_range[0]:.3f} to "
                    f"{s.span_range[1]:.3f} m"
                    for s in found.surfaces
                ),
                coarse_coefficients=None
                if found.coarse_coefficients is None
                else store.arrays.put(found.coarse_coefficients),
                lattice=_store_lattice(store, found),
            ),
        )
    )
    return {"prediction_id": stored.id}


def _store_lattice(store: Store, found: ComputedPrediction) -> Lattice:
    task = found.task
    names = tuple(surface.name for surface in found.surfaces)
    surface = np.full(len(found.boxes), -1.0)
    for index, one in enumerate(found.surfaces):
        surface[one.boxes] = index
    return Lattice(
        fuel=task.fuel[len(task.fuel) // 2],
        corners=store.arrays.put(found.boxes.corners),
        surfaces=names,
        surface=store.arrays.put(surface),
        columns=variables(task.modes, names, task.body),
        pressures=store.arrays.put(found.pressures),
        modes=task.modes,
        displacements=store.arrays.put(found.displacements),
    )


def _describe(found: ComputedPrediction) -> str:
    request = found.task.request
    lacking = [name for name in found.names if name in _NOT_PREDICTED]
    return (
        f"computed: {len(found.boxes)} boxes on the right half, {found.task.body.symmetry} motion, "
        f"Mach {request.mach:g}, derivatives at k = {request.reference_k:g}; no thickness, no drag"
    ) + (f"; not predicted: {', '.join(lacking)}" if lacking else "")


def _read_panels(request: PredictionRequest) -> tuple[Panel, ...]:
    if bool(request.panels) == bool(request.deck):
        raise BadInput("give either panels or a Nastran deck", code="no-panels")
    if request.deck:
        length = factor(request.deck_unit, "length")
        every = read_aero_deck([request.deck]).panels.values()
        panels = tuple(
            panel.scale(length)
            for panel in every
            if max(panel.left[1], panel.right[1]) > 0.0  # the left half is the mirror image
        )
    else:
        panels = tuple(
            Panel(
                one.left,
                one.left_chord,
                one.right,
                one.right_chord,
                np.linspace(0.0, 1.0, one.chordwise + 1),
                np.linspace(0.0, 1.0, one.spanwise + 1),
            )
            for one in request.panels
            if _check_divisions(one)
        )
    n_boxes = sum((p.chordwise.size - 1) * (p.spanwise.size - 1) for p in panels)
    if n_boxes > MAX_BOXES:
        raise BadInput(
            f"{n_boxes} boxes are more than {MAX_BOXES}; divide the panels less finely",
            code="too-many-boxes",
        )
    for number, panel in enumerate(panels, start=1):
        if min(panel.left[1], panel.right[1]) < -1e-9:
            raise BadInput(
                f"panel {number} crosses the plane of symmetry; give the right half",
                code="bad-panel",
            )
    return panels


def _check_divisions(panel: PlanformPanel) -> bool:
    for count in (panel.chordwise, panel.spanwise):
        if not 1 <= count <= _LARGEST_DIVISION:
            raise BadInput(
                f"a panel is divided into {count}; expected 1 to {_LARGEST_DIVISION}",
                code="bad-panel",
            )
    return True


def _halve_chordwise(panel: Panel) -> Panel:
    edges = panel.chordwise
    return replace(panel, chordwise=edges[::2] if edges.size % 2 and edges.size > 2 else edges)


def _build_reference(aircraft: Aircraft, fuel: float) -> Reference:
    geometry, mass = aircraft.geometry, aircraft.mass
    x, z = (float(np.interp(fuel, mass.fuel, values)) for values in (mass.x_cg_m, mass.z_cg_m))
    cg = np.array([x, 0.0, z])
    return Reference(geometry.area_m2, geometry.chord_m, geometry.span_m, cg)


def _place(boxes: Boxes, surface: PlanformSurface) -> ControlSurface:
    return place_surface(boxes, surface.name, surface.span, surface.hinge)


def _interpolate(task: PredictionTask, boxes: Boxes) -> list[BoxShapes]:
    """Interpolate the mode shapes of every fuel weight to the boxes."""
    if not task.modes:
        return [BoxShapes(*(np.zeros((0, len(boxes))) for _ in range(3)))] * len(task.fuel)
    planes = select_nodes(boxes, task.nodes)
    return [
        interpolate_shapes(
            boxes,
            [
                SplinedSurface(inside, task.nodes[own], shapes[:, own, :3], shapes[:, own, 3:])
                for inside, own in planes
            ],
        )
        for shapes in task.shapes
    ]


def _compute(
    task: PredictionTask,
    boxes: Boxes,
    shapes: Sequence[BoxShapes],
    k: np.ndarray,
    report: Callable[[float], None],
) -> tuple[list[ControlSurface], list[UnsteadyCoefficients]]:
    loadings = list(zip(shapes, task.references, strict=True))
    surfaces = [_place(boxes, asked) for asked in task.request.surfaces]
    found = compute_loadings(
        boxes,
        loadings,
        surfaces,
        mach=task.request.mach,
        symmetry=_SYMMETRIES[task.body.symmetry],
        k=k,
        report_progress=report,
    )
    return surfaces, found
