"""Import of recordings: stored unchanged, once, with the metadata of the mapping."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_imports import import_files, import_maneuver

from flexsid import units
from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Role
from flexsid.storage.store import Store
from flexsid.workflow.importing.flight_import import compute_largest_correlation, read_upload
from flexsid.workflow.importing.parsed_files import find_guesses
from flexsid.workflow.modal_data.modal_tables import load_modes
from flexsid.workflow.views.modes import list_modes_at

ROOT = Path(__file__).parents[2]
RECORDS = ROOT / "../shared/data/flex28/records"
EXAMPLES = ROOT / "examples"

MAPPING = """
[aircraft]
name = "Kite"
[aircraft.geometry]
area = { value = 10.0, unit = "ft2" }
chord = { value = 1.0, unit = "ft" }
span = { value = 10.0, unit = "ft" }
[aircraft.mass]
fuel = [0.0, 1.0]
mass = { values = [0.4, 0.6], unit = "slug" }
pitch_inertia = { values = [0.3, 0.5], unit = "slug*ft2" }
x_cg = { values = [8.0, 9.0], unit = "in" }
[[aircraft.surfaces]]
name = "bfs"
instrument = "pot"
[[aircraft.sensors]]
name = "q"
kind = "gyro"
instrument = "pot"
[aircraft.instruments.pot]
delay = { value = 4.0, unit = "ms" }
elements = [{ type = "butterworth", order = 4, corner = { value = 50.0, unit = "Hz" } }]
[aircraft.polar]
cd_min = 0.02
oswald = 0.9
aspect_ratio = 10.0
lift_slope = 4.5
[aircraft.flutter]
fuel = [0.0, 1.0]
speed = { values = [100.0, 120.0], unit = "ft/s" }
[flight]
number = 7
date = "2026-05-31"
[maneuver]
label = "multisine"
start = { value = 0.1, unit = "s" }
stop = { value = 0.5, unit = "s" }
[maneuver.condition]
airspeed = { field = "tas", unit = "ft/s" }
altitude = { value = 0.0, unit = "ft" }
fuel_fraction = { value = 50, unit = "%" }
[excitation]
period = { value = 0.2, unit = "s" }
harmonics = { bfs = [1, 3] }
[time]
column = "t_ms"
unit = "ms"
[[channels]]
column = "bf"
name = "bfs"
unit = "deg"
role = "input"
sign = -1
[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""


def write_flight(folder: Path) -> Path:
    file = folder / "flight.csv"
    rows = [f"{20 * k},{k},{k * k},{50 + k}" for k in range(40)]
    file.write_text("t_ms,bf,q,tas\n" + "\n".join(rows) + "\n")
    return file


def test_a_text_file_becomes_a_maneuver_of_a_new_aircraft(store: Store, tmp_path: Path) -> None:
    done = import_files(store, [write_flight(tmp_path)], MAPPING)
    maneuver = done.maneuver
    assert maneuver is not None
    assert maneuver.id is not None
    assert (maneuver.label, maneuver.start_s, maneuver.duration_s) == ("multisine", 0.1, 0.4)
    assert maneuver.excitation is not None
    assert maneuver.excitation.harmonics == {"bfs": (1, 3)}
    assert maneuver.source_file == "flight.csv"
    assert done.flight is not None
    assert done.flight.number == 7
    channels = store.channels.find(maneuver_id=maneuver.id)
    assert [(c.name, c.unit, c.role, c.rate_hz, c.start_s) for c in channels] == [
        ("bfs", "deg", Role.INPUT, 50.0, 0.1),
        ("q", "deg/s", Role.OUTPUT, 50.0, 0.1),
        ("airspeed", "ft/s", Role.CONDITION, 50.0, 0.1),
    ]
    samples = np.arange(5, 25)
    np.testing.assert_array_equal(store.arrays.get(channels[0].array), -samples)
    np.testing.assert_array_equal(store.arrays.get(channels[1].array), samples**2)


def test_the_condition_is_completed_from_the_aircraft(store: Store, tmp_path: Path) -> None:
    maneuver = import_maneuver(store, [write_flight(tmp_path)], MAPPING)
    condition = maneuver.condition
    # Mean of the airspeed inside the maneuver, not of the whole file.
    airspeed = units.to_si(np.arange(55, 75).mean(), "ft/s")
    assert condition.airspeed_m_s == pytest.approx(float(airspeed))
    assert condition.density_kg_m3 == pytest.approx(1.225, rel=1e-4)
    assert condition.mass_kg == pytest.approx(float(units.to_si(0.5, "slug")))
    assert condition.x_cg_m == pytest.approx(float(units.to_si(8.5, "in")))
    assert condition.flutter_speed_m_s == pytest.approx(float(units.to_si(110.0, "ft/s")))
    assert maneuver.airspeed_ratio == pytest.approx(64.5 / 110.0)
    area = units.to_si(10.0, "ft2")
    lift = condition.mass_kg * 9.80665 / (condition.dynamic_pressure_pa * area)
    drag = 0.02 + lift**2 / (np.pi * 0.9 * 10.0)
    assert condition.alpha_rad == pytest.approx(lift / 4.5)
    assert condition.thrust_n == pytest.approx(drag * condition.dynamic_pressure_pa * area)


def test_the_same_maneuver_is_imported_once(store: Store, tmp_path: Path) -> None:
    file = write_flight(tmp_path)
    import_files(store, [file], MAPPING)
    with pytest.raises(Conflict, match="was imported from this file before") as caught:
        import_files(store, [file], MAPPING)
    assert caught.value.code == "already-imported"
    import_files(store, [file], MAPPING.replace('"multisine"', '"another part"'))
    assert len(store.maneuvers.find()) == 2
    assert len(store.flights.find()) == 1


def test_an_aircraft_is_not_redefined_in_passing(store: Store, tmp_path: Path) -> None:
    file = write_flight(tmp_path)
    import_files(store, [file], MAPPING)
    other = MAPPING.replace("[0.3, 0.5]", "[0.3, 0.6]").replace('"multisine"', '"two"')
    with pytest.raises(Conflict, match="another definition"):
        import_files(store, [file], other)


def test_selected_aircraft_must_be_that_of_the_mapping(
    store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    with pytest.raises(BadInput, match="The mapping is for 'Kite', but 'X-1' was selected"):
        import_files(store, [write_flight(tmp_path)], MAPPING, aircraft.id)


def test_files_without_a_mapping_must_have_a_known_form(store: Store, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="give a mapping"):
        import_files(store, [write_flight(tmp_path)])


def test_correlation_is_the_largest_of_all_pairs() -> None:
    t = np.linspace(0.0, 1.0, 1000, endpoint=False)
    sine, cosine = np.sin(2 * np.pi * t), np.cos(2 * np.pi * t)
    assert compute_largest_correlation([sine]) is None
    assert compute_largest_correlation([sine, cosine]) == pytest.approx(0.0, abs=1e-12)
    assert compute_largest_correlation([sine, cosine, -sine - cosine]) == pytest.approx(0.5**0.5)
    assert compute_largest_correlation([sine, np.full(1000, 3.0)]) == 0.0


@pytest.fixture
def flex28(store: Store) -> Aircraft:
    return store.aircraft.add(describe_aircraft(load_truth()))


needs_records = pytest.mark.skipif(
    not RECORDS.is_dir(), reason="the independently simulated FLEX-28 records are not here"
)


@needs_records
def test_a_simulated_record_is_recognised(store: Store, flex28: Aircraft) -> None:
    file = RECORDS / "065Vf_n4_fta506.npz"
    with pytest.raises(BadInput, match="not confirmed"):
        import_files(store, [file])
    kinds = {str(guess.kind) for guess in find_guesses(store, read_upload([file]))}
    assert kinds == {"aircraft", "flight", "clock", "unit"}
    done = import_files(store, [file], confirmed=True)
    maneuver = done.maneuver
    assert maneuver is not None
    assert (maneuver.label, maneuver.fta, maneuver.start_s) == ("065Vf_n4_fta506", 506, -2.0)
    assert maneuver.duration_s == pytest.approx(29.0)
    assert maneuver.airspeed_ratio == pytest.approx(0.65, abs=1e-3)
    assert maneuver.condition.mass_kg == pytest.approx(float(units.to_si(12.623, "slug")), rel=1e-6)
    assert maneuver.max_input_correlation is not None
    assert maneuver.max_input_correlation < 0.1
    excitation = maneuver.excitation
    assert excitation is not None
    assert excitation.period_s == 24.0
    assert excitation.harmonics["bfs"][:3] == (6, 11, 16)
    assert excitation.harmonics["wf3s"][0] == 7
    assert excitation.harmonics["wf2s"][-1] == 330
    record = np.load(file)
    channels = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    assert len(channels) == 5 + 5 + 45
    assert channels["wf3s"].role is Role.INPUT
    assert channels["wf3s_command"].role is Role.COMMAND
    assert channels["az_egi"].unit == "g"
    assert channels["s_ros2l_p45"].unit == "ustrain"
    stored = store.arrays.get(channels["q"].array)
    assert stored.dtype == np.float32
    np.testing.assert_array_equal(stored, record["outputs"][:, 1])
    # Every sensor of the aircraft was recorded under its own name.
    assert {sensor.name for sensor in flex28.sensors} <= set(channels)


@needs_records
def test_the_same_record_gives_its_noise_free_channels_by_another_mapping(
    store: Store, flex28: Aircraft
) -> None:
    file = RECORDS / "065Vf_n4_fta506.npz"
    import_files(store, [file], confirmed=True)
    quiet = import_maneuver(store, [file], EXAMPLES / "flex28/record-noise-free.toml")
    assert quiet.label == "065Vf_n4_fta506-noise-free"
    channel = store.channels.find(maneuver_id=quiet.id, name="q")[0]
    expected = np.load(file)["outputs_noise_free"][:, 1]
    np.testing.assert_array_equal(store.arrays.get(channel.array), expected)


@needs_records
def test_upload_has_its_built_in_aircraft(store: Store) -> None:
    upload = read_upload([RECORDS / "080Vf_n8_fta503.npz"])
    assert upload.builtin == "FLEX-28"
    with pytest.raises(UnknownRecord, match="There is no aircraft 'FLEX-28'"):
        import_files(store, [RECORDS / "080Vf_n8_fta503.npz"], confirmed=True)


def test_a_record_of_the_known_form_of_another_aircraft_is_refused(
    store: Store, flex28: Aircraft, tmp_path: Path
) -> None:
    rng = np.random.default_rng(1)
    file = tmp_path / "other.npz"
    np.savez(
        file,
        t_s=np.arange(400) / 200.0,
        outputs=0.1 * rng.standard_normal((400, 2)),
        output_names=["alpha", "az_pod"],
        inputs=0.05 * rng.standard_normal((400, 1)),
        input_names=["elevon"],
        multisine_command=0.05 * rng.standard_normal((400, 1)),
        airspeed_ft_s=60.0,
        rho=0.0023,
        fuel_fraction=0.5,
        period_s=2.0,
        first_harmonic=1,
        harmonics_per_input=2,
        interleaving=["elevon"],
    )
    with pytest.raises(BadInput, match=r"elevons.* no surface or sensor of it") as refused:
        import_files(store, [file], confirmed=True)
    assert refused.value.code == "other-aircraft"
    assert store.maneuvers.find() == []


def test_the_shipped_example_is_the_built_in_mapping_with_nothing_guessed() -> None:
    known = ROOT / "backend/flexsid/importers/known/flex28-record.toml"
    lines = known.read_text().splitlines(keepends=True)
    stated = "".join(line for line in lines if not line.startswith("guessed = "))
    assert stated == (EXAMPLES / "flex28/record.toml").read_text()


def test_modal_tables_and_predictions_come_in_si_and_body_axes(
    store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    nodes = np.array([[11.0, 10.0, -50.0, 2.0], [12.0, 20.0, 50.0, 2.0]])
    shape = np.array([[11.0, 1.0, 2.0, 3.0, 0.1, 0.2, 0.3], [12.0, 4.0, 5.0, 6.0, 0.4, 0.5, 0.6]])
    np.savez(
        tmp_path / "fem.npz",
        nodes=nodes,
        mode7=shape,
        hz=np.array([5.0]),
        CQ=np.array([[0.4, -0.2, 9.0]]),
        CZ=np.array([-4.5, -2.0]),
    )
    mapping = """
[aircraft]
name = "X-1"
[[modal_tables]]
name = "FEM"
kind = "FEM"
numbers = [7]
names = ["SW1B"]
symmetric = [true]
frequency = { field = "hz", unit = "Hz" }
damping = { value = 0.02 }
mass = { value = 1.0, unit = "slug*ft2" }
[modal_tables.shape]
field = "mode{number}"
translation_columns = [2, 3, 4]
rotation_columns = [5, 6, 7]
unit = "in"
coordinates = "nodes"
coordinate_columns = [2, 3, 4]
coordinate_unit = "in"
points = { az_l = 11 }
[[predictions]]
source = "vortex lattice"
[[predictions.terms]]
field = "CQ"
coefficients = ["CQ7"]
variables = ["etadot7", "q", ""]
reference_length = { value = 0.6, unit = "m" }
[[predictions.terms]]
field = "CZ"
coefficients = ["CZ"]
variables = ["alpha", "q"]
"""
    done = import_files(store, [tmp_path / "fem.npz"], mapping)
    (table,) = done.modal_tables
    arrays = store.arrays.get_many(table.arrays.values())
    assert arrays[table.arrays["omega"]] == pytest.approx(2 * np.pi * 5.0)
    at_sensor = arrays[table.arrays["shape"]][0, 0, 0]
    np.testing.assert_allclose(at_sensor[:3], np.array([-1.0, 2.0, -3.0]) * 0.0254)
    np.testing.assert_allclose(at_sensor[3:], [-0.1, 0.2, -0.3])
    np.testing.assert_allclose(arrays[table.arrays["nodes"]], nodes[:, 1:] * 0.0254)
    (prediction,) = done.predictions
    values = store.arrays.get(prediction.values)[0]
    named = dict(zip(prediction.names, values, strict=True))
    # The source refers rates to 0.6 m, we refer them to half of the chord of 0.3 m.
    expected = {"CQ7_etadot7": 1.6, "CQ7_q": -0.8, "CZ_alpha": -4.5, "CZ_q": -2.0}
    assert named == pytest.approx(expected)
    # The same tables again add nothing; others under the same name are refused.
    again = import_files(store, [tmp_path / "fem.npz"], mapping)
    assert replace(again.modal_tables[0], id=table.id) == table
    assert len(store.modal_tables.find()) == 1
    with pytest.raises(Conflict, match="'FEM' is there already with other content"):
        import_files(store, [tmp_path / "fem.npz"], mapping.replace("0.02", "0.03"))


def test_modes_over_fuel_have_strains_and_standard_deviations(
    store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    """Fields with a row for each fuel weight, and fields named after it; predictions too."""
    rng = np.random.default_rng(3)
    hertz, strain = np.array([[5.0, 8.0], [4.0, 7.0]]), rng.normal(size=(2, 2, 3))
    shapes = rng.normal(size=(1, 2, 4, 6)) * [[[[1.0]]], [[[-1.1]]]]
    ids = np.arange(1.0, 5.0)[:, None]
    arrays = {
        f"phi_{fuel + 1}_{mode}": np.hstack([ids, shapes[fuel, k]])
        for fuel in range(2)
        for k, mode in enumerate((7, 8))
    }
    arrays |= {"hz": hertz, "eps": strain, "nodes": np.hstack([ids, rng.normal(size=(4, 3))])}
    arrays |= {"CZ_1": np.array([-4.5, -2.0]), "CZ_2": np.array([-4.4, -2.1])}
    save: Any = np.savez  # whose stubs take an array by name for an option
    save(tmp_path / "gvt.npz", **arrays)
    mapping = """
[aircraft]
name = "X-1"
[[modal_tables]]
name = "GVT"
kind = "GVT"
fuel = [0, 1]
numbers = [7, 8]
names = ["SW1B", "AW1B"]
symmetric = [true, false]
frequency = { field = "hz", unit = "Hz" }
frequency_std = { values = [0.01, 0.02], unit = "Hz" }
damping = { value = 0.02 }
damping_std = { value = 0.001 }
shape_std = { value = 0.03 }
mass = { value = 1.0, unit = "kg*m2" }
[modal_tables.shape]
field = "phi_{fuel}_{number}"
translation_columns = [2, 3, 4]
rotation_columns = [5, 6, 7]
unit = "m"
coordinates = "nodes"
coordinate_columns = [2, 3, 4]
coordinate_unit = "m"
points = { az_l = 2 }
[modal_tables.strain]
field = "eps"
gauges = ["root", "mid", "tip"]
unit = "ustrain"
[[predictions]]
source = "vortex lattice"
fuel = [0, 1]
[[predictions.terms]]
field = "CZ_{fuel}"
coefficients = ["CZ"]
variables = ["alpha", "q"]
"""
    done = import_files(store, [tmp_path / "gvt.npz"], mapping)
    (table,), (prediction,) = done.modal_tables, done.predictions
    assert (table.fuel, table.gauges) == ((0.0, 1.0), ("root", "mid", "tip"))
    found = {name: store.arrays.get(key) for name, key in table.arrays.items()}
    assert found["omega"] == pytest.approx(2.0 * np.pi * hertz)
    assert found["omega_std"] == pytest.approx(2.0 * np.pi * np.array([[0.01, 0.02]] * 2))
    assert found["strain"] == pytest.approx(1e-6 * strain)
    assert found["node_shape"][1, 0, :, 0] == pytest.approx(-shapes[1, 0, :, 0])
    assert store.arrays.get(prediction.values) == pytest.approx(
        np.array([[-4.5, -2.0], [-4.4, -2.1]])
    )
    assert prediction.fuel == (0.0, 1.0)
    assert table.id is not None
    seventh = {mode.number: mode for mode in list_modes_at(store, table.id, 0.5)}[7]
    assert seventh.frequency_std_hz == pytest.approx(0.01)
    assert (seventh.damping_std, seventh.shape_std) == pytest.approx((0.001, 0.03))
    modes = load_modes(store, table, None)
    assert modes.frequency_std[7] == pytest.approx(np.hypot(0.005, 0.01 / 4.0))
    for old, new, reason in (
        ("fuel = [0, 1]\nnumbers", "fuel = [1, 0]\nnumbers", "rising order"),
        ("phi_{fuel}_", "phi_1_", "must contain {fuel}"),
        ('field = "eps"', 'field = "hz"', "3 gauges are expected"),
        ('"CZ_{fuel}"', '"CZ_1"', "2 rows are expected, one for each fuel weight"),
    ):
        with pytest.raises(BadInput, match=reason):
            import_files(store, [tmp_path / "gvt.npz"], mapping.replace(old, new))
