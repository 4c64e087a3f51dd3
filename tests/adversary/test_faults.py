"""Faults of a record that the product must name, also where a fit does not converge."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from campaign import draw_flight
from doors import METHODS, Faults, import_flight, wait_for_end
from shipped import Client, serving
from simulated_flight import Record
from user_files import write_files

SEED, INDEX, ROWS = 1, 3, 3_000
LATE_S = 0.01


def record_surface_early(record: Record) -> Record:
    """Record the last surface 10 ms before it moves, so that it acts late."""
    inputs, last = record.inputs.copy(), record.inputs[:, -1]
    spectrum = np.fft.rfft(np.r_[last, last[::-1]])
    turn = np.exp(2j * np.pi * np.fft.rfftfreq(2 * len(last), 1 / record.rate) * LATE_S)
    inputs[:, -1] = np.fft.irfft(spectrum * turn, 2 * len(last))[: len(last)]
    return replace(record, inputs=inputs)


def swap_sign(record: Record, sensor: int) -> Record:
    outputs = record.outputs.copy()
    outputs[:, sensor] *= -1
    return replace(record, outputs=outputs)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("faults")
    with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
        yield server.connect()


def import_changed(client: Client, change: Callable[[Record], Record]) -> int:
    flight, faults = draw_flight(SEED, INDEX, ROWS), Faults([])
    with tempfile.TemporaryDirectory() as name:
        record = change(flight.record)
        files = write_files(Path(name), flight.aircraft, flight.knowledge, record)
        maneuver = import_flight(client, faults, *files)
    assert maneuver is not None, faults.found
    return maneuver


def estimate(client: Client, maneuver: int, method: str) -> dict[str, Any]:
    run = client.send("post", "runs", {"maneuver_id": maneuver, "method": method})
    return wait_for_end(client, f"runs/{run['id']}")


def test_a_late_surface_is_named_by_a_fit_that_does_not_converge(client: Client) -> None:
    late = draw_flight(SEED, INDEX, ROWS).aircraft.truth.inputs[-1]
    run = estimate(client, import_changed(client, record_surface_early), "EE")
    assert run["fit"]["outcome"] == "iteration limit"
    assert run["adequacy"]["state"] == "not tested"
    reason = run["adequacy"]["reason"]
    assert re.search(rf"{late} acts about (9\.\d|10) ms after", reason), reason


@pytest.mark.long
def test_a_sensor_of_the_opposite_sign_is_named_before_its_residuals(client: Client) -> None:
    sensors = draw_flight(SEED, INDEX, ROWS).aircraft.sensors
    wrong = next(k for k, sensor in enumerate(sensors) if sensor.name == "az_rear")
    maneuver = import_changed(client, lambda record: swap_sign(record, wrong))
    for method in METHODS:
        reason = estimate(client, maneuver, method)["adequacy"]["reason"]
        named, _, symptoms = reason.partition("az_rear has the opposite sign")
        assert symptoms, reason
        assert "residuals" not in named, reason
