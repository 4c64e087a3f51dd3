"""A flight with a mode in the band that hardly any sensor sees, through the port.

Seven outputs, a quiet in-plane mode between first bending and first torsion, and a modal table that
lacks modes: residuals are large, and the frequencies of the table are 3 % wrong.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from campaign import Flight, draw_flight
from doors import Faults, import_flight, wait_for_end
from shipped import Client, serving
from user_files import write_files

SEED, INDEX = 2, 3
UNSEEN = "SFA1"


@dataclass(frozen=True)
class Flown:
    """The flight with its maneuver on a server."""

    client: Client
    flight: Flight
    maneuver: int

    def number(self, name: str) -> int:
        shapes = [shape.name for shape in self.flight.aircraft.shapes]
        return self.flight.aircraft.truth.numbers[shapes.index(name)]

    def estimate(self, method: str, **settings: Any) -> dict[str, Any]:
        body = {"maneuver_id": self.maneuver, "method": method, **settings}
        run = self.client.send("post", "runs", body)
        return wait_for_end(self.client, f"runs/{run['id']}")


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flown]:
    folder = tmp_path_factory.mktemp("unseen")
    flight = draw_flight(SEED, INDEX)
    with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
        client, faults = server.connect(), Faults([])
        with tempfile.TemporaryDirectory() as name:
            files = write_files(Path(name), flight.aircraft, flight.knowledge, flight.record)
            maneuver = import_flight(client, faults, *files)
        assert maneuver is not None, faults.found
        yield Flown(client, flight, maneuver)


def test_a_fit_whose_steps_overshoot_converges(flown: Flown) -> None:
    """The curvature that the steps rest on is half of the true one here."""
    modes = [flown.number("SW1B"), flown.number("SW1T")]
    run = flown.estimate("OE", structure={"modes": modes, "fixed": {}})
    assert run["fit"]["outcome"] == "converged", run["fit"]["message"]
    assert all(one["std_error"] for one in run["parameters"])


def test_an_unseen_mode_in_the_band_is_retained_with_the_reason(flown: Flown) -> None:
    unseen = flown.number(UNSEEN)
    proposal = flown.client.get(f"maneuvers/{flown.maneuver}/run-proposal")
    (mode,) = [one for one in proposal["modes"] if one["number"] == unseen]
    assert mode["in_band"]
    assert not mode["proposed"]
    assert mode["determined_share"] < 0.3
    run = flown.estimate("FRE")
    assert run["structure"]["modes"] == [flown.number("SW1B"), flown.number("SW1T")]
    assert unseen in run["retained"]["modes"]
    (reason,) = [text for text in run["proposal"]["reasons"] if "nuisance" in text]
    assert UNSEEN in reason
    assert run["fit"]["outcome"] == "converged", run["fit"]["message"]
    assert run["adequacy"]["state"] != "not tested"


@pytest.mark.long
def test_a_run_with_fewer_modes_does_not_widen_the_interval_of_flutter(flown: Flown) -> None:
    """What one run estimates another retains: they have the same modes, and are fused."""
    modes = [flown.number("SW1B"), flown.number("SW1T")]
    runs = [
        flown.estimate("OE", structure={"modes": own, "fixed": {}}) for own in (modes, modes[:1])
    ]
    assert modes[1] in runs[1]["retained"]["modes"]
    widths = []
    for ids in ([runs[0]["id"]], [run["id"] for run in runs]):
        query = f"run_ids={','.join(map(str, ids))}"
        job = flown.client.send("post", f"flutter/results?{query}")
        wait_for_end(flown.client, f"jobs/{job['id']}")
        found = flown.client.get(f"flutter?{query}")
        widths.append(found["high_m_s"] - found["low_m_s"])
    assert widths[1] < 1.2 * widths[0]
    assert len(found["structures"]) == 1
