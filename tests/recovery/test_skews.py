"""Skews, scale factors: put on the records of an independent simulation, and found again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_maneuver

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.maneuver import Flight
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyData
from flexsid.workflow.measurements.sensor_responses import gather_sensors
from flexsid.workflow.quality.sensor_skews import check_redundancy

PROJECT = Path(__file__).parents[2]
RECORDS = PROJECT.parent / "shared" / "data" / "flex28" / "records"
UNSEEN = {"ay_egi", "ay_cf"}  # on the centre line, and lateral

others = pytest.mark.skipif(
    not RECORDS.is_dir(), reason="independent FLEX-28 records are not beside the project"
)


@others
@pytest.mark.parametrize(
    "name",
    [
        "065Vf_n2_fta506",
        pytest.param("065Vf_n4_fta506", marks=pytest.mark.long),
        pytest.param("080Vf_n8_fta503", marks=pytest.mark.long),
        "109Vf_n8_fta506",
    ],
)
def test_skews_on_every_channel_come_back(store: Store, name: str):
    add_aircraft(store)
    mapping = PROJECT / "examples" / "flex28" / "record.toml"
    sensing = gather_sensors(store, import_maneuver(store, [RECORDS / f"{name}.npz"], mapping))
    rng = np.random.default_rng(len(name))
    measured, names = sensing.measured, sensing.measured.outputs.names
    delay, late = rng.uniform(0.0, 0.02, len(names)), rng.uniform(0.0, 0.02, 5)
    scale = np.ones(len(names))
    wrong = [names.index("alpha"), names.index("q")]
    scale[wrong] = 1.07, 0.95
    w = measured.omega
    outputs = measured.outputs.values * np.exp(-1j * w[:, None] * delay) * scale
    inputs = measured.inputs.values * np.exp(-1j * w[:, None] * late)
    spoiled = replace(
        measured,
        outputs=FrequencyData(w, outputs, names),
        inputs=FrequencyData(w, inputs, measured.inputs.names),
    )
    found = check_redundancy(replace(sensing, measured=spoiled))
    faults = found.faults
    origin = delay[names.index(faults.reference)]
    assert sensing.excluded.keys() == UNSEEN
    assert not found.not_checked
    error = np.abs(faults.delay_s - (delay - origin))
    assert np.all(error < np.maximum(1e-3, 3.0 * faults.delay_std))
    assert np.all(np.abs(faults.scale - scale)[wrong] < 3.0 * faults.scale_std[wrong])
    assert found.inputs is not None
    error = np.abs(found.inputs.delay_s - (late - origin))
    assert np.all(error < np.maximum(1e-3, 3.0 * found.inputs.delay_std))


FLOWN = (
    (0.56, 0.9, 503, 2.0),
    (0.65, 0.1, 506, 2.0),
    (0.72, 0.57, 503, 2.0),
    (1.05, 0.5, 506, 1.2),
)
"""Ratio to the flutter speed, fuel, flight test aid and peak of maneuvers. [1, 1, -, deg]"""


@pytest.mark.parametrize("places", [(1, 3), pytest.param((0, 1, 2, 3), marks=pytest.mark.long)])
def test_standard_errors_of_sound_channels_are_valid(store: Store, places: tuple[int, ...]):
    """Skews of sound channels are zero within their standard errors."""
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=61))
    assert flight.id is not None
    sensors, surfaces = [], []
    for seed in places:
        ratio, fuel, fta, peak = FLOWN[seed]
        flown = fly(airspeed_ratio=ratio, fuel=fuel, fta=fta, peak_deg=peak, seed=(61, seed))
        maneuver = add_maneuver(
            store, replace(flown, maneuver=replace(flown.maneuver, label=f"{seed}")), flight.id
        )
        found = check_redundancy(gather_sensors(store, maneuver))
        faults = found.faults
        resolved = [
            k
            for k, name in enumerate(faults.names)
            if name not in found.not_checked and name != faults.reference
        ]
        sensors.append(faults.delay_s[resolved] / faults.delay_std[resolved])
        assert found.inputs is not None
        surfaces.append(found.inputs.delay_s / found.inputs.delay_std)
    for scores in (np.concatenate(sensors), np.concatenate(surfaces)):
        assert 0.3 < np.sqrt(np.mean(scores**2)) < 1.3
        assert np.max(np.abs(scores)) < 4.0
