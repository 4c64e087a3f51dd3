"""A short draw of the adversary: what holds today for an aircraft that nobody has seen.

``make adversary`` flies many and prints one table.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from campaign import AIRSPEEDS, draw_flight, go_through_doors
from doors import METHODS
from shipped import serving
from table import compute_coverage, format_table
from user_files import write_files

SEED, INDEX, ROWS = 4, 57, 3_000
# Of one flight, whose errors depend on each other; 0.954 is expected of many. A run below the
# first has to be suspect.
TRUSTED_COVERAGE, LEAST_COVERAGE = 0.8, 0.6


@pytest.mark.parametrize(
    ("predicted", "searched", "airspeeds"),
    [(("EE",), (), ()), pytest.param(METHODS, ("OE",), AIRSPEEDS, marks=pytest.mark.long)],
)
def test_a_drawn_aircraft_goes_through_the_doors(
    tmp_path: Path,
    predicted: tuple[str, ...],
    searched: tuple[str, ...],
    airspeeds: tuple[float, ...],
) -> None:
    flight = draw_flight(SEED, INDEX, ROWS)
    with serving(tmp_path, f"sqlite:///{tmp_path / 'flexsid.db'}") as server:
        client = server.connect()
        outcome = go_through_doors(client, flight, searched, predicted, airspeeds)
        runs = [run for run in client.get("runs")["items"] if run["maneuver_id"] == 1]
        kept = [client.get(f"runs/{run['id']}") for run in runs]
        numbers = ",".join(str(run["id"]) for run in kept)
        compared = client.get(f"comparisons?run_ids={numbers}")
    assert outcome.faults == ()
    assert {one.method for one in outcome.verdicts} == set(METHODS)
    assert {(run["method"], run["state"]) for run in kept} == {(m, "succeeded") for m in METHODS}
    assert compute_coverage(outcome.verdicts) >= LEAST_COVERAGE, format_table([outcome])
    check_assumptions(kept, compared)
    assert [one.method for one in outcome.flutter] == list(predicted)
    assert [one.method for one in outcome.searches] == list(searched)
    for one in outcome.searches:
        assert one.outcome != "failed"
        assert one.outcome == "undecided" or not one.missed, one
    assert len(outcome.values) == (3 if airspeeds else 0)
    assert {one.outcome for one in outcome.values} <= {"estimates", "no standard errors"}
    for one in outcome.verdicts:
        trusted = one.outcome == "consistent"
        assert not trusted or compute_coverage([one]) >= TRUSTED_COVERAGE, one


def check_assumptions(runs: list[dict[str, Any]], compared: dict[str, Any]) -> None:
    """Compare says of which estimates one assumption has more than half of the variance."""
    said = {(r["name"], one["key"]): one for r in compared["rows"] for one in r["values"] if one}
    found = set()
    for run in runs:
        for one in run["parameters"]:
            shares, cell = one["shares"], said[one["name"], f"run-{run['id']}"]
            largest = max((cause for cause in shares if cause != "noise"), key=lambda c: shares[c])
            assert (cell["rests_on"] is not None) == (shares[largest] > 0.5)
            assert cell["repeatability"] == pytest.approx(one["std_error"] * shares["noise"] ** 0.5)
            found.add(cell["rests_on"])
    assert any(found)
    assert all("that halves its error reduces σ by" in text for text in found if text)


def test_a_flight_does_not_depend_on_others_of_its_seed(tmp_path: Path) -> None:
    texts = []
    for folder in (tmp_path / "one", tmp_path / "two"):
        folder.mkdir()
        flight = draw_flight(SEED, INDEX, 1_000)
        files, mapping = write_files(folder, flight.aircraft, flight.knowledge, flight.record)
        texts.append((files[0].read_text(), mapping))
    assert texts[0] == texts[1]
