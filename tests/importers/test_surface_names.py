"""Recorded surfaces by the surfaces of a stored aircraft."""

from __future__ import annotations

import numpy as np
import pytest

from flexsid.importers.column_names import Meaning
from flexsid.importers.mapping import parse_mapping
from flexsid.importers.proposal import write_proposal
from flexsid.importers.source import SourceFile, Sources
from flexsid.importers.surface_names import SurfaceColumn, assign_surfaces, find_surfaces
from flexsid.records.maneuver import Role
from flexsid.workflow.importing.parsed_files import parse_upload

WAVE = np.sin(np.arange(50))


def column(field: str, surface: str, role: Role = Role.INPUT, sign: int = 1) -> SurfaceColumn:
    own = Meaning(name=field, unit="deg", role=role, sure=False, known=False, surface=surface)
    return SurfaceColumn(field=field, samples=sign * WAVE, meaning=own)


@pytest.mark.parametrize(
    ("name", "surfaces", "expected"),
    [
        ("POS_TEF4(deg)", ("wf3s", "wf4s"), {"wf4s"}),
        ("pos_wingflap05_lh", ("wf5s", "bfs"), {"wf5s"}),
        ("POS_WF1_LH", ("wf1l", "wf1r", "wf1s"), {"wf1l"}),
        ("ELEV", ("elevator", "wf1s"), {"elevator"}),
        ("BodyFlap", ("bfs", "wf1s"), {"bfs"}),
        ("CH012", ("elevator", "wf1s"), set()),
        ("POS_WF1", ("wf1s", "wf1a"), {"wf1s", "wf1a"}),
    ],
)
def test_the_words_of_a_column_fit_surfaces(name: str, surfaces: tuple[str, ...], expected: set):
    assert find_surfaces(name, surfaces) == expected


def test_what_moves_together_is_one_surface_and_the_last_one_is_left_over():
    found = assign_surfaces(
        [
            column("CH2", "CH2", sign=-1),
            column("CH1", "CH2"),
            column("CMD_WF1", "CH2", Role.COMMAND),
            column("CH7", "CH7"),
        ],
        ("wf1s", "elevator"),
    )
    assert {field: own.name for field, own in found.meanings.items()} == {
        "CH2": "wf1s",
        "CMD_WF1": "wf1s_command",
        "CH7": "elevator",
    }
    assert (found.other_sides["CH2"].column, found.other_sides["CH2"].sign) == ("CH1", -1)


def test_what_moves_with_a_surface_and_is_none_is_no_side_of_it():
    engine = Meaning(name="N1_R_PCT", unit="%", role=Role.INPUT, known=False, surface="ELEV_DEG")
    elevator = column("ELEV_DEG", "ELEV_DEG")
    others = [
        SurfaceColumn(field="N1_R_PCT", samples=WAVE, meaning=engine),
        column("AIL_R_DEG", "ELEV_DEG"),
        SurfaceColumn(field="CH1", samples=WAVE[1:], meaning=elevator.meaning),
    ]
    for other in others:
        assert not assign_surfaces([elevator, other], ("elevator",)).other_sides, other.field
    alone = SurfaceColumn(field="N1", samples=WAVE, meaning=engine)
    assert not assign_surfaces([alone], ("elevator",)).meanings, "an engine is no surface"
    other = column("ELEV_RH", "ELEV_DEG")
    assert assign_surfaces([elevator, other], ("elevator",)).other_sides
    assert not assign_surfaces([elevator, other], ("rudder", "aileron")).other_sides


def test_independent_sides_of_the_aircraft_stay_apart():
    sides = [column("POS_WF1_LH", "POS_WF1_LH"), column("POS_WF1_RH", "POS_WF1_LH")]
    found = assign_surfaces(sides, ("wf1l", "wf1r"))
    assert [own.name for own in found.meanings.values()] == ["wf1l", "wf1r"]
    assert not found.other_sides


def test_left_and_right_become_their_mean_in_one_unit():
    time = np.arange(200) / 50
    left = 3.0 * np.sin(5 * time) + 0.1
    arrays = {
        "t": time,
        "POS_ELEV_LH": left,
        "POS_ELEV_RH": -np.radians(left + 0.2),
        "q": np.cos(time),
    }
    sources = Sources((SourceFile(name="flight.csv", sha256="0" * 64, arrays=arrays),))
    text = write_proposal(sources, "X-1", 1, {"elevator": Role.INPUT})
    assert text.count('name = "elevator"') == 1
    assert "other_side" in text
    upload = parse_upload(sources, parse_mapping(text))
    elevator = next(one for one in upload.channels if one.name == "elevator")
    assert elevator.samples == pytest.approx(left + 0.1)
    assert {"other_side", "unit"} <= {one.path.rpartition(".")[2] for one in upload.mapping.guessed}
