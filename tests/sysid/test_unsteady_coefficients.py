"""C(k) of FLEX-28U from its boxes and from its planform; surfaces, splines and derivatives."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.sysid.aerodynamics.boxes import Boxes, Panel, mesh_panels
from flexsid.sysid.aerodynamics.coefficients import (
    NOT_PREDICTED,
    UnsteadyCoefficients,
    compute_coefficients,
    tabulate_derivatives,
)
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry
from flexsid.sysid.aerodynamics.splines import (
    BeamSurface,
    BoxShapes,
    Reference,
    SplinedSurface,
    interpolate_shapes,
    place_surface,
)

DATA = Path(__file__).parents[3] / "shared" / "data"
needs_flex28 = pytest.mark.skipif(
    not (DATA / "flex28_unsteady").exists(), reason="FLEX-28U is not beside the project"
)
FUEL = 2  # half fuel
SURFACES = {
    "bf": (0.267, 2.44),
    "wf1": (3.0, 5.75),
    "wf2": (5.75, 8.5),
    "wf3": (8.5, 11.25),
    "wf4": (11.25, 14.0),
}
TO_STRUCTURE = np.array([-1.0, 1.0, -1.0, -1.0, 1.0, -1.0])  # from body axes


@pytest.fixture(scope="module")
def truth() -> dict[str, np.ndarray]:
    return dict(np.load(DATA / "flex28_unsteady" / "flex28_unsteady.npz"))


@pytest.fixture(scope="module")
def flex28() -> dict:
    return json.loads((DATA / "flex28" / "flex28.json").read_text())


def reference(truth: dict[str, np.ndarray]) -> Reference:
    cg = np.array([truth["xcg"][FUEL], 0.0, truth["zcg"][FUEL]])
    return Reference(float(truth["S"]), float(truth["cbar"]), 28.0, cg)


def compute(boxes: Boxes, shapes: BoxShapes, truth: dict, indices: list[int]):
    surfaces = [place_surface(boxes, name, span, 0.75) for name, span in SURFACES.items()]
    k = truth["k"][indices]
    return compute_coefficients(
        boxes, shapes, surfaces, reference(truth), mach=0.1, symmetry=Symmetry.SYMMETRIC, k=k
    )


def row_error(values: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Error of each row, as part of its norm."""
    return np.linalg.norm(values - expected, axis=-1) / np.linalg.norm(expected, axis=-1)


@pytest.fixture(scope="module")
def from_boxes(truth) -> UnsteadyCoefficients:
    boxes = Boxes(truth["box_corners"], np.zeros(320, int), np.repeat(np.arange(40), 8))
    N = boxes.normal
    d, turn, load = (truth[n][FUEL].astype(float) for n in ("d_control", "rot_control", "d_load"))
    slope = turn[..., 2] * N[:, 1] - turn[..., 1] * N[:, 2]
    shapes = BoxShapes((d * N).sum(axis=2), slope, (load * N).sum(axis=2))
    return compute(boxes, shapes, truth, [0, 4, 8, 14, 18])


@needs_flex28
def test_box_geometry_gives_the_coefficients_of_an_independent_code(truth, from_boxes):
    expected = truth["C"][FUEL][[0, 4, 8, 14, 18]]
    assert row_error(from_boxes.values, expected).max() < 1e-6
    assert from_boxes.columns == tuple(truth["columns"])


@needs_flex28
def test_steady_derivatives_are_those_of_an_independent_vortex_lattice(flex28, from_boxes):
    table = flex28["derivatives"][flex28["fuel_fraction"].index(0.5)]
    rows = [table["CZ"], table["Cm"], *_rows(table["CQ"])]
    expected = [
        [row["alpha"], row["q"], *row["eta"], *row["etadot"], *row["delta"]] for row in rows
    ]
    # 0.37 % of it is the Mach number, 0.1 here and 0 there.
    assert row_error(from_boxes.values[0].real, np.array(expected)).max() < 0.006


def _rows(table: dict | list) -> list[dict]:
    if isinstance(table, list):
        return table
    n = len(table["alpha"])
    return [{key: values[i] for key, values in table.items()} for i in range(n)]


def flex28_planform(flex28: dict) -> list[Panel]:
    def divide(n: int) -> np.ndarray:
        return np.linspace(0.0, 1.0, n + 1)

    plan = flex28["design"]["plan"]
    panels = [
        Panel((x0, y0, 0.0), c0, (x1, y1, 0.0), c1, divide(8), divide(strips))
        for (y0, x0, c0), (y1, x1, c1), strips in zip(plan, plan[1:], (6, 5, 24), strict=False)
    ]
    tip = plan[-1][1]
    low, high = (tip + 0.05, 14.0, 0.0), (tip + 0.95, 14.0, 2.2)
    return [*panels, Panel(low, 2.0, high, 1.3, divide(8), divide(5))]


def flex28_beams(boxes: Boxes, flex28: dict) -> list[BeamSurface]:
    """Centre body along X, wing along Y and winglet along Z, from the published mode shapes."""
    grid = np.load(DATA / "flex28" / "modeshape_grid.npz")
    modes = [list(grid["mode_number"]).index(number) for number in flex28["sym_modes"]]
    shapes = grid["phi_body"][list(grid["fuel"]).index(0.5)][modes].astype(float) * TO_STRUCTURE
    points = grid["points_struct"]
    x, y, z = points.T

    def beam(inside: np.ndarray, nodes: np.ndarray, axis: int) -> BeamSurface:
        nodes = nodes[np.argsort(points[nodes, axis])]
        motion = shapes[:, nodes]
        return BeamSurface(inside, points[nodes], motion[..., :3], motion[..., 3:], axis)

    def one_per(values: np.ndarray, of: np.ndarray, rank: int) -> np.ndarray:
        groups = [np.flatnonzero(of & np.isclose(values, value)) for value in set(values[of])]
        return np.array([group[np.argsort(x[group])][rank] for group in groups])

    wing = boxes.normal[:, 2] > 0.5
    body = wing & (boxes.control[:, 1] < 1.6)
    wing_nodes = one_per(y, (z == 0.0) & (y >= 1.6), 1)
    tip_nodes = one_per(z, y == 14.0, 1)
    # The centre body of the FEM is linear between its own nodes, which are recovered from the
    # published points between them.
    own = np.array(flex28["design"]["cb_nodes_x"])
    names = ("cf", "egi", "ca")
    known = np.concatenate([x[y == 0.0], [flex28["points_struct"][name][0] for name in names]])
    at_sensors = np.array([flex28["modeshape_at"][name] for name in names])
    fuel = flex28["fuel_fraction"].index(0.5)
    sensors = at_sensors[:, fuel, modes].transpose(1, 0, 2) * TO_STRUCTURE
    motion = np.concatenate([shapes[:, y == 0.0], sensors], axis=1)
    shares = np.array([np.interp(known, own, row) for row in np.eye(own.size)]).T
    recovered = np.linalg.lstsq(shares, motion.transpose(1, 0, 2).reshape(known.size, -1))[0]
    recovered = recovered.reshape(own.size, len(modes), 6).transpose(1, 0, 2)
    places = np.column_stack([own, 0.0 * own, 0.0 * own])
    return [
        BeamSurface(body, places, recovered[..., :3], recovered[..., 3:], 0),
        beam(wing & ~body, wing_nodes, 1),
        beam(~wing, tip_nodes, 2),
    ]


@needs_flex28
def test_planform_and_mode_shapes_give_the_coefficients_within_two_percent(truth, flex28):
    boxes = mesh_panels(flex28_planform(flex28))
    assert np.allclose(boxes.corners, truth["box_corners"], atol=1e-12)
    shapes = interpolate_shapes(boxes, flex28_beams(boxes, flex28))
    indices = [0, 6, 14]
    result = compute(boxes, shapes, truth, indices)
    assert row_error(result.values, truth["C"][FUEL][indices]).max() < 0.02


@needs_flex28
def test_quasi_steady_tables_are_those_of_the_data_set(truth):
    columns = tuple(map(str, truth["columns"]))
    rows = tuple(map(str, truth["rows"]))
    C = UnsteadyCoefficients(truth["k"], rows, columns, truth["C"][FUEL])
    tables = json.loads((DATA / "flex28_unsteady" / "flex28_unsteady.json").read_text())
    for table in tables["quasi_steady_tables"]["tables"]:
        if table["aircraft"] == "dlm" and table["fuel"] == 0.5:
            names, values = tabulate_derivatives(C, table["k"])
            assert names == (*columns, "alphadot")
            assert np.allclose(values[:, :-1], table["table"], rtol=1e-6, atol=1e-6)
            assert np.allclose(values[:, -1], table["alphadot"], rtol=1e-6, atol=1e-6)


def rectangle(chordwise: int = 8) -> Boxes:
    divisions = np.linspace(0.0, 1.0, chordwise + 1)
    wing = Panel((0.0, 0.0, 0.0), 1.0, (0.5, 4.0, 0.0), 1.0, divisions, np.linspace(0, 1, 9))
    return mesh_panels([wing])


def test_surfaces_snap_to_boxes_and_report_where():
    boxes = rectangle()
    flap = place_surface(boxes, "flap", (1.1, 3.1), 0.72)
    assert flap.hinge_fraction == pytest.approx(0.75)
    assert flap.span_range == pytest.approx((1.0, 3.0))
    assert flap.boxes.sum() == 4 * 2
    assert flap.hinge[flap.boxes][0] == pytest.approx(0.5 * 1.25 / 4.0 + 0.75)
    with pytest.raises(BadInput, match="contains no box") as refused:
        place_surface(boxes, "flap", (5.0, 6.0), 0.75)
    assert refused.value.code == "empty-surface"


def rigid_motion(places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Translations and rotations of heave, pitch and roll about a point."""
    turns = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    rotation = np.broadcast_to(turns[:, None], (3, *places.shape)).copy()
    translation = np.cross(rotation, np.broadcast_to(places - 0.3, rotation.shape))
    translation[0] += np.array([0.0, 0.0, 1.0])
    return translation, rotation


@pytest.mark.parametrize("in_line", [False, True])
def test_splines_reproduce_rigid_motion_also_from_nodes_in_a_line(in_line):
    boxes = rectangle()
    y = np.linspace(0.2, 3.8, 7)
    places = np.column_stack([0.4 + 0.1 * y, y, 0.0 * y])
    if not in_line:
        places = np.concatenate([places, places + np.array([0.5, 0.0, 0.0])])
    translation, rotation = rigid_motion(places)
    shapes = interpolate_shapes(
        boxes, [SplinedSurface(np.ones(len(boxes), bool), places, translation, rotation)]
    )
    exact = rigid_motion(boxes.control)[0][..., 2]
    assert np.allclose(shapes.control, exact, atol=1e-9)
    assert np.allclose(shapes.load, rigid_motion(boxes.load)[0][..., 2], atol=1e-9)
    assert np.allclose(shapes.slope, np.array([[0.0], [-1.0], [0.0]]), atol=1e-9)


def test_modes_of_rigid_motion_have_the_columns_of_alpha_and_q():
    # Heave: -(i k/b) C_alpha, pitch about the c.g.: C_alpha + i k C_q.
    boxes = rectangle(4)
    heave = np.ones(len(boxes))
    shapes = BoxShapes(
        np.stack([heave, -boxes.control[:, 0]]),
        np.stack([0.0 * heave, -heave]),
        np.stack([heave, -boxes.load[:, 0]]),
    )
    k = np.array([0.0, 0.4])
    reference = Reference(8.0, 1.0, 8.0, np.zeros(3))
    C = compute_coefficients(
        boxes, shapes, [], reference, mach=0.2, symmetry=Symmetry.SYMMETRIC, k=k
    ).values[1]
    alpha, q, eta, etadot = C[:, 0], C[:, 1], C[:, 2:4], C[:, 4:6]
    total = eta + 0.4j * etadot
    assert np.allclose(total[:, 0], -0.4j / 0.5 * alpha, rtol=1e-10)
    assert np.allclose(total[:, 1], alpha + 0.4j * q, rtol=1e-10)
    assert np.allclose(C[3], C[1], rtol=1e-10)  # the generalised force of pitch is the moment
    assert np.allclose(C[2], -C[0], rtol=1e-10)  # that of heave the lift


def test_splines_refuse_what_they_cannot_interpolate():
    boxes = rectangle()
    everything = np.ones(len(boxes), bool)
    places = np.column_stack([np.zeros(3), np.arange(3.0), np.zeros(3)])
    shapes = np.zeros((1, 3, 3))
    with pytest.raises(BadInput, match="exactly one") as refused:
        interpolate_shapes(boxes, [SplinedSurface(~everything, places, shapes, shapes)])
    assert refused.value.code == "bad-splines"
    with pytest.raises(BadInput, match="in a line") as refused:
        interpolate_shapes(boxes, [SplinedSurface(everything, places, shapes)])
    assert refused.value.code == "nodes-in-line"
    C = UnsteadyCoefficients(np.array([0.0, 1.0]), ("CZ",), ("alpha",), np.ones((2, 1, 1), complex))
    with pytest.raises(BadInput, match="highest k") as refused:
        C.at(1.5)
    assert refused.value.code == "frequency-out-of-range"


def test_geometry_that_is_no_number_is_refused_by_name():
    boxes = rectangle()
    corners = boxes.corners.copy()
    corners[5, 2, 1] = np.nan
    with pytest.raises(BadInput, match="box 6, of panel 1"):
        Boxes(corners, boxes.panel, boxes.strip)
    with pytest.raises(BadInput, match="surface flap"):
        place_surface(boxes, "flap", (1.0, np.nan), 0.75)
    with pytest.raises(BadInput, match=r"c\.g\."):
        Reference(1.0, 1.0, 1.0, np.array([np.nan, 0.0, 0.0]))
    places = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 3.0, 0.0]])
    moved = np.zeros((1, 3, 3))
    moved[0, 2, 2] = np.nan
    with pytest.raises(BadInput, match="translation of node 3 of splined surface 1"):
        interpolate_shapes(boxes, [SplinedSurface(np.ones(len(boxes), bool), places, moved)])
    with pytest.raises(BadInput, match="mode 1 at box 1"):
        BoxShapes(*(np.full((1, len(boxes)), np.nan) for _ in range(3)))


def test_derivatives_that_a_lattice_lacks_are_marked_and_not_zero():
    boxes = rectangle(4)
    none = np.zeros((0, len(boxes)))
    C = compute_coefficients(
        boxes,
        BoxShapes(none, none, none),
        [],
        Reference(8.0, 1.0, 8.0, np.zeros(3)),
        mach=0.2,
        symmetry=Symmetry.ANTISYMMETRIC,
        k=np.array([0.0, 0.1, 0.2]),
    )
    names, table = tabulate_derivatives(C, 0.1)
    lacking = {(C.rows[i], names[j]) for i, j in np.argwhere(np.isnan(table)).tolist()}
    assert lacking == set(NOT_PREDICTED)
    assert table[C.rows.index("Cl"), names.index("p")] < -0.3
