"""mAEWing1: a flight maneuver, modes and derivatives are imported by the shipped mapping.

Published values: eigenvalues and flutter speeds computed from the authors' own
matrices (states u, w, theta, q, h and six modes; ours leaves out u and h).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_files
from scipy.io import loadmat
from scipy.optimize import brentq

from flexsid.records.maneuver import Role
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs
from flexsid.workflow.importing.flight_import import Imported
from flexsid.workflow.modal_data.modal_tables import load_modes

ROOT = Path(__file__).parents[2]
FLIGHT = ROOT / "../shared/data/maewing1/flight"
FILES = (
    "geri_flight_raw.csv",
    "Geri_Database.mat",
    "GerimassProp.mat",
    "GericoeffsNOM.mat",
    "geri_coeffsPIDfull.mat",
)
INPUTS = ("bfs", "wf1s", "wf2s", "wf3s")
MODES = (7, 8, 9, 10, 11, 12)

pytestmark = pytest.mark.skipif(
    not FLIGHT.is_dir(), reason="the mAEWing1 data are not here; see examples/maewing1"
)


@pytest.fixture
def imported(store: Store) -> Imported:
    mapping = ROOT / "examples/maewing1/maewing1.toml"
    return import_files(store, [FLIGHT / name for name in FILES], mapping)


def derivatives(store: Store, imported: Imported, source: int) -> DerivativeTable:
    prediction = imported.predictions[source]
    values = store.arrays.get(prediction.values)[0]
    named = dict(zip(prediction.names, map(float, values), strict=True))
    return DerivativeTable.from_names(MODES, INPUTS, named)


def build(
    store: Store, imported: Imported, airspeed: float, outputs: tuple[str, ...] = ("q",)
) -> AeroelasticModel:
    assert imported.maneuver is not None
    (table,) = imported.modal_tables
    modes = load_modes(store, table, None).table.at(0.0)
    condition = replace(imported.maneuver.condition, airspeed_m_s=airspeed)
    return build_model(
        imported.aircraft, condition, modes, INPUTS, define_outputs(imported.aircraft, outputs)
    )


def test_channels_condition_and_excitation(store: Store, imported: Imported) -> None:
    maneuver = imported.maneuver
    assert maneuver is not None
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    assert [n for n, c in channels.items() if c.role is Role.INPUT] == ["wf2s", "wf3s"]
    assert [n for n, c in channels.items() if c.role is Role.OUTPUT] == [
        "theta",
        "q",
        "az_cf",
        "az_cr",
        "az_lf",
        "az_lr",
        "az_rf",
        "az_rr",
    ]
    assert channels["q"].n_samples == 1879
    assert channels["q"].rate_hz == pytest.approx(151.5155, abs=1e-4)
    assert maneuver.condition.airspeed_m_s == 23.0
    assert maneuver.condition.mass_kg == pytest.approx(6.2513, abs=1e-4)
    assert maneuver.airspeed_ratio == pytest.approx(0.742, abs=1e-3)
    assert maneuver.max_input_correlation == pytest.approx(0.033, abs=1e-3)
    # In trim an accelerometer with its axis down reads -1 g.
    for name in ("az_cf", "az_cr", "az_lf", "az_lr", "az_rf", "az_rr"):
        assert store.arrays.get(channels[name].array).mean() == pytest.approx(-9.81, rel=0.03)


def test_each_input_has_its_harmonics(store: Store, imported: Imported) -> None:
    maneuver = imported.maneuver
    assert maneuver is not None
    excitation = maneuver.excitation
    assert excitation is not None
    command = store.arrays.get(store.channels.find(maneuver_id=maneuver.id, name="wf3s")[0].array)
    np.testing.assert_array_equal(np.flatnonzero(command)[[0, -1]], [26, 1842])
    period = command[26 : 26 + round(excitation.period_s * 151.5154523)]
    assert period.size == 1816
    energy = np.abs(np.fft.rfft(period)) ** 2
    own = energy[list(excitation.harmonics["wf3s"])].sum()
    assert own / energy.sum() > 0.98


@pytest.mark.parametrize(
    ("source", "short_period", "first_bending", "flutter_speed"),
    [
        (0, -9.0777 + 9.0565j, -3.6474 + 41.2803j, 31.01),
        (1, -10.3042 + 10.9206j, -5.8005 + 43.5822j, 33.28),
    ],
    ids=["nominal", "flight-updated"],
)
def test_derivatives_rebuild_published_eigenvalues_and_flutter(
    store: Store,
    imported: Imported,
    source: int,
    short_period: complex,
    first_bending: complex,
    flutter_speed: float,
) -> None:
    table = derivatives(store, imported, source)

    def eigenvalues(airspeed: float) -> list[complex]:
        model = build(store, imported, airspeed).state_space(table)
        return [complex(value) for value in np.linalg.eigvals(model.A)]

    at_23 = eigenvalues(23.0)
    assert min(abs(value - short_period) for value in at_23) < 0.02
    assert min(abs(value - first_bending) for value in at_23) < 0.02

    def growth(airspeed: float) -> float:
        return max(value.real for value in eigenvalues(airspeed) if 15.0 < value.imag < 50.0)

    assert brentq(growth, 28.0, 38.0) == pytest.approx(flutter_speed, abs=0.02)


def test_wing_sensors_match_the_published_model(store: Store, imported: Imported) -> None:
    """D depends on locations, mode shapes, axes and signs.

    Our C cannot equal theirs, which also rolls: the FEM is not quite symmetric.
    """
    published = loadmat(FLIGHT / "geri_ss23_NOM.mat")["D"]
    theirs = published[[17, 15, 16, 14], :4] * 0.3048
    table = derivatives(store, imported, 0)
    model = build(store, imported, 23.0, ("az_lf", "az_lr", "az_rf", "az_rr"))
    np.testing.assert_allclose(model.state_space(table).D, theirs, rtol=1e-4)


def test_pitch_rate_response_matches_the_published_model(store: Store, imported: Imported) -> None:
    published = loadmat(FLIGHT / "geri_ss23_NOM.mat")
    A, B, C = (published[name] for name in "ABC")
    ours = build(store, imported, 23.0).state_space(derivatives(store, imported, 0))
    for hertz in (1.0, 2.0, 4.0, 6.0, 8.0, 14.0):
        s = 2j * np.pi * hertz
        expected = C[9] @ np.linalg.solve(s * np.eye(A.shape[0]) - A, B[:, :4])
        found = ours.C[0] @ np.linalg.solve(s * np.eye(ours.A.shape[0]) - ours.A, ours.B)
        np.testing.assert_allclose(found, expected, rtol=0.06)


def test_conditioned_record_and_stored_waveforms_are_imported(
    store: Store, imported: Imported
) -> None:
    examples = ROOT / "examples/maewing1"
    record = FLIGHT / "geri_flight_conditioned.csv"
    maneuver = import_files(store, [record], examples / "conditioned.toml").maneuver
    assert maneuver is not None
    (theta,) = store.channels.find(maneuver_id=maneuver.id, name="theta")
    column = np.genfromtxt(record, delimiter=",", names=True)["theta"]
    np.testing.assert_array_equal(store.arrays.get(theta.array), column)
    assert theta.sensor == "theta"

    names = ("playback_OMS2_1.csv", "playback_OMS2_2.csv")
    files = [FLIGHT / "flown_multisines" / name for name in names]
    flight = import_files(store, files, examples / "playback.toml")
    assert [(c.name, c.rate_hz, c.source_file) for c in flight.flight_channels] == [
        ("OMS2_1", 150.0, names[0]),
        ("OMS2_2", 150.0, names[1]),
    ]
    stored = store.arrays.get(flight.flight_channels[1].array)
    np.testing.assert_array_equal(stored, np.loadtxt(files[1]))
