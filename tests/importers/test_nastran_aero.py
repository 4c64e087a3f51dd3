"""Aerodynamic decks of Nastran; flutter of mAEWing1 from its deck."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from flexsid.errors import UnreadableFile
from flexsid.importers.nastran.aero import AeroDeck, read_aero_deck
from flexsid.sysid.aerodynamics.boxes import Panel, mesh_panels
from flexsid.sysid.aerodynamics.coefficients import UnsteadyCoefficients, compute_coefficients
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry
from flexsid.sysid.aerodynamics.pk_flutter import build_modal_system, track_pk_roots
from flexsid.sysid.aerodynamics.splines import (
    BoxShapes,
    Reference,
    SplinedSurface,
    interpolate_shapes,
)

MAEWING1 = Path(__file__).parents[3] / "shared" / "data" / "maewing1"
needs_maewing1 = pytest.mark.skipif(
    not (MAEWING1 / "aero").exists(), reason="mAEWing1 is not beside the project"
)
INCH_S_PER_KNOT = 20.254  # VREF of its flutter run

DECK = """$ two panels, lists after the entries that refer to them
AERO    0               2.      1.2-7
CAERO1  1001    1       0       4                       7       1
        0.0     0.0     0.0     2.0     1.0     4.0     0.0     1.0
CAERO1  2001    1               2       3                       1
        1.0     4.0     0.0     1.0     1.5     4.0     2.0     .5
SPLINE4 5       1001    11              12              IPS     BOTH
SPLINE1 6       2001    2001    2006    13
SPLINE1 8       2001    2002    2006    13
SPLINE1 9       1001    1001    1005    13
AELIST  11      1001    THRU    1008
SET1    12      101     102     THRU    104     110
SET1    13      201     202     203
AEFACT  7       0.      .25     1.
"""


def test_panels_and_splines_of_a_deck_are_read():
    deck = read_aero_deck([DECK])
    assert deck.chord == 2.0
    assert deck.density == pytest.approx(1.2e-7)
    wing = deck.panels[1001]
    assert wing.chordwise.tolist() == [0.0, 0.25, 1.0]
    assert wing.spanwise.size == 5
    assert wing.right == (1.0, 4.0, 0.0)
    assert deck.number_boxes([1001, 2001]) == [*range(1001, 1009), *range(2001, 2007)]
    assert deck.splines[0].boxes == tuple(range(1001, 1009))
    assert deck.splines[0].nodes == (101, 102, 103, 104, 110)
    assert deck.splines[1].boxes == tuple(range(2001, 2007))
    # Of rectangles within a panel: boxes are numbered along the chord first.
    assert deck.splines[2].boxes == (2002, 2003, 2005, 2006)
    assert deck.splines[3].boxes == (1001, 1003, 1005)
    assert mesh_panels(list(deck.panels.values())).corners.shape == (14, 4, 3)


@pytest.mark.parametrize(
    ("deck", "message"),
    [
        (DECK.replace("AEFACT  7", "AEFACT  8"), "line 3: CAERO1 1001.*AEFACT 7"),
        (DECK.replace("CAERO1  1001    1       0", "CAERO1  1001    1       4"), "basic system"),
        (DECK.replace("SET1    12", "SET1    14"), "SPLINE4 5"),
        (DECK.replace("1.0     4.0     0.0     1.0", "1.0     x.0     0.0     1.0"), "CAERO1 1001"),
        (DECK.replace("1.0     4.0     0.0     1.0", "1.0     nan     0.0     1.0"), "CAERO1 1001"),
        (DECK.replace("2001    2001    2006", "2001    2001    2007"), "SPLINE1 6.*box 2007"),
        (DECK.replace("2001    2001    2006", "3001    2001    2006"), "SPLINE1 6.*CAERO1 3001"),
        (DECK.replace("1001    1001    1005", "1001    1005    1001"), "SPLINE1 9.*outboard"),
    ],
)
def test_entries_that_cannot_be_read_are_named(deck, message):
    with pytest.raises(UnreadableFile, match=message):
        read_aero_deck([deck])


def coarsen(number: int, panel: Panel) -> Panel:
    """Every second chordwise edge and fewer strips: 670 boxes for the 2652 of the deck."""
    if (panel.chordwise.size - 1) % 2 == 0:
        panel = replace(panel, chordwise=panel.chordwise[::2])
    match number // 1000 % 1000:
        case 301:
            return replace(panel, spanwise=np.linspace(0.0, 1.0, 21))
        case 101 | 102:
            return replace(panel, spanwise=panel.spanwise[::2])
        case 401:
            return replace(panel, spanwise=panel.spanwise[::3])
    return panel


@pytest.fixture(scope="module")
def deck() -> AeroDeck:
    return read_aero_deck(
        path.read_text(encoding="latin-1") for path in sorted((MAEWING1 / "aero").iterdir())
    )


@pytest.fixture(scope="module")
def modes() -> dict[str, np.ndarray]:
    """Modes of the FEM of the flutter run: frequencies, nodes, shapes of unit mass (inches)."""
    stored = loadmat(MAEWING1 / "flight/Geri_Database.mat", squeeze_me=True, struct_as_record=False)
    nodes, shapes = stored["FEM"].points_coordinates, stored["ModeShape"]
    return {
        "omega": 2.0 * np.pi * shapes.natural_frequency,
        "node": nodes[:, 0].astype(int),
        "place": nodes[:, 1:4],
        "shape": np.array([getattr(shapes, f"modeshape{i}") for i in range(1, 21)])[:, :, 1:],
    }


REFERENCE = Reference(1681.78, 15.6, 120.0, np.array([8.18, 0.0, 0.0]))  # inches


@pytest.fixture(scope="module")
def coefficients(deck: AeroDeck, modes: dict[str, np.ndarray]) -> UnsteadyCoefficients:
    numbers = np.array(list(deck.panels))
    boxes = mesh_panels([coarsen(number, panel) for number, panel in deck.panels.items()])
    first_box = numbers[boxes.panel]
    surfaces = []
    for spline in deck.splines:
        own = numbers[np.searchsorted(numbers, spline.boxes, side="right") - 1]
        nodes = [modes["node"].tolist().index(node) for node in spline.nodes]
        shape = modes["shape"][:, nodes]
        inside = np.isin(first_box, own)
        surfaces.append(
            SplinedSurface(inside, modes["place"][nodes], shape[..., :3], shape[..., 3:])
        )
    return compute_coefficients(
        boxes,
        interpolate_shapes(boxes, surfaces),
        [],
        REFERENCE,
        mach=0.0,
        symmetry=Symmetry.NONE,
        k=np.array([0.0, 0.1, 0.2, 0.3, 0.4]),
    )


@needs_maewing1
def test_maewing1_flutters_at_the_speeds_of_its_nastran_printout(deck, modes, coefficients):
    assert deck.chord is not None
    assert deck.density is not None
    assert len(deck.number_boxes(list(deck.panels))) == 2652
    system = build_modal_system(coefficients, REFERENCE, np.ones(20), modes["omega"], np.zeros(20))
    airspeed = np.linspace(50.0, 72.0, 12) * INCH_S_PER_KNOT
    symmetric, antisymmetric = track_pk_roots(system, airspeed, deck.density).crossings
    # SOL 145: 62.84 kn at 5.83 Hz, and 66.67 kn at 8.98 Hz.
    assert symmetric.airspeed / INCH_S_PER_KNOT == pytest.approx(62.84, rel=0.01)
    assert symmetric.omega / (2.0 * np.pi) == pytest.approx(5.83, rel=0.01)
    assert antisymmetric.airspeed / INCH_S_PER_KNOT == pytest.approx(66.67, rel=0.05)
    assert antisymmetric.omega / (2.0 * np.pi) == pytest.approx(8.98, rel=0.01)


@needs_maewing1
@pytest.mark.parametrize(
    ("row", "column", "published"),
    [("CZ", "alpha", -4.590), ("Cm", "alpha", -0.1542), ("Cm", "q", -1.8685)],
)
def test_maewing1_has_its_published_rigid_derivatives(coefficients, row, column, published):
    # With all 2652 boxes Cm_alpha is -0.162, 5.2 % off; CZ_q is 8 % off with every mesh.
    value = coefficients.values[0, coefficients.rows.index(row), coefficients.column(column)]
    assert value.real == pytest.approx(published, rel=0.05)


@needs_maewing1
def test_maewing1_has_its_published_roll_damping(deck):
    right = [coarsen(n, panel) for n, panel in deck.panels.items() if n > 2_000_000]
    boxes = mesh_panels(right)
    shapes = BoxShapes(*(np.empty((0, len(boxes))) for _ in range(3)))
    result = compute_coefficients(
        boxes,
        shapes,
        [],
        REFERENCE,
        mach=0.0,
        symmetry=Symmetry.ANTISYMMETRIC,
        k=np.array([0.0]),
    )
    value = result.values[0, result.rows.index("Cl"), result.column("p")]
    assert value.real == pytest.approx(-0.549, rel=0.05)
