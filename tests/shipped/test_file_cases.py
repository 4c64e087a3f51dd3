"""Files of producers and of faults, from an upload to what is read, repaired or refused."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_fields import draw_numpy, find_lost
from scipy.io import savemat
from shipped import Client, serving

CASES = Path(__file__).parents[1] / "importers" / "cases"
AIRCRAFT = """
[aircraft]
name = "Cases"
surfaces = [{ name = "elevator" }]
sensors = [{ name = "q", kind = "gyro" }]
geometry.area = { value = 0.8, unit = "m2" }
geometry.chord = { value = 0.3, unit = "m" }
geometry.span = { value = 2.6, unit = "m" }
mass.fuel = [0]
mass.mass = { values = [10], unit = "kg" }
mass.pitch_inertia = { values = [1.2], unit = "kg*m2" }
mass.x_cg = { values = [0], unit = "m" }
"""
UNITS = {"length_unit": "m", "mass_unit": "kg"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("server")
    with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
        connected = server.connect()
        connected.send("post", "aircraft", {"text": AIRCRAFT})
        yield connected


def import_modes(client: Client, *names: str) -> Any:
    """Import the modes of files; return the table, or the text of the refusal."""
    sent = [("files", (name, (CASES / name).read_bytes())) for name in names]
    response = client.request("post", "uploads", files=sent)
    if response.is_success:
        upload = response.json()["upload"]["id"]
        body = {"aircraft_id": 1, "name": names[0], "generalized_mass": "file", **UNITS}
        response = client.request("post", f"uploads/{upload}/modal-data", body)
    if response.is_success:
        return response.json()
    assert 400 <= response.status_code < 500, response.text
    return response.text


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["universal-nan-55.unv"], "row 17: 'NaN' is not a number, node 1"),
        (["universal-stars-55.unv"], "is not a number, node 1"),
        (["universal-decimal-comma-55.unv"], "row 3: '0,00000E+00' is not a number"),
        (["universal-three-digit-exponent-mass-55.unv"], "'0.17977+309' is too large"),
        (["nastran-nan.f06", "nastran-two-grids.bdf"], "'NaN' is not a number"),
        (
            ["nastran-buckling-sol106.f06", "nastran-buckling-sol106.bdf"],
            "whose eigenvalues are load factors",
        ),
        (
            ["nastran-flutter-sol145.f06", "nastran-flutter-sol145.bdf"],
            "roots of a flutter analysis",
        ),
    ],
)
def test_what_is_no_mode_is_refused_with_the_reason(
    client: Client, names: list[str], reason: str
) -> None:
    assert reason in import_modes(client, *names)


@pytest.mark.parametrize(
    ("names", "hertz"),
    [
        (["universal-three-digit-exponent-55.unv"], [5.0]),
        (["universal-node-comments-55.unv"], [5.0]),
        (["nastran95-cyclic-frequency.f06", "wing-six-grids.bdf"], [3.5, 11.25]),
        (["msc-nastran-modes.h5"], [3.5, 11.25]),
        (["mystran-modes.f06", "nastran-two-grids.bdf"], [5.0, 9.0]),
    ],
)
def test_modes_are_read(client: Client, names: list[str], hertz: list[float]) -> None:
    upload = client.upload(*(CASES / name for name in names))["upload"]["id"]
    found = client.get(f"uploads/{upload}/modal-data")
    assert found["frequencies_hz"] == pytest.approx(hertz)
    assert len(import_modes(client, *names)["numbers"]) == len(hertz)


@pytest.mark.parametrize(
    ("model", "names", "symmetric"),
    [
        ("half-clamped", ["W1B", "W2B", "W1T"], [None, None, None]),
        ("half-symmetric", ["SW1B", "AW1B"], [True, False]),
        ("with-tail", ["SW1B", ""], [True, False]),
        ("one-sided-pair", ["W1B", "W2B"], [None, None]),
        (
            "suspended",
            ["R1", "R2", "R3", "SW1B", "SW2B", "AW1B"],
            [True, True, False, True, True, False],
        ),
    ],
)
def test_modes_are_named_by_supports_and_symmetry(
    client: Client, model: str, names: list[str], symmetric: list[bool | None]
) -> None:
    table = import_modes(client, f"wing-{model}.bdf", f"wing-{model}.f06")
    assert (table["names"], table["symmetric"]) == (names, symmetric)
    assert sum("symmetry unknown" in reason for reason in table["reasons"]) == symmetric.count(None)
    modes = client.get(f"modal-tables/{table['id']}/modes", params={"fuel": 0.0})["items"]
    assert [mode["symmetric"] for mode in modes] == symmetric


def test_the_force_unit_of_a_file_is_not_contradicted(client: Client) -> None:
    upload = client.upload(CASES / "universal-frf-per-lbf.unv")["upload"]["id"]
    body = {"aircraft_id": 1, "name": "x", "response_unit": "m/s2", "force_unit": "N"}
    refused = client.request("post", f"uploads/{upload}/responses", body)
    assert refused.status_code == 422
    assert "its forces in lbf, N was given" in refused.text


def sine(n_samples: int, rate_hz: float, sign: float = 1.0) -> np.ndarray:
    """Return the pitch rate of the recordings, sin 3t."""
    return sign * np.sin(3.0 * np.arange(n_samples) / rate_hz)


SINE, LONG = sine(200, 50.0), sine(300, 100.0)
READ = {  # field, samples of it
    "table-bom-quoted-header.csv": {"q_degs": SINE},
    "table-carriage-returns.csv": {"q_degs": SINE},
    "table-decimal-comma.csv": {"q_degs": SINE},
    "table-quoted-decimal-comma.csv": {"q_degs": SINE},
    "table-summer-time.csv": {"q_degs": SINE},
    "table-trailing-comma.csv": {"q_degs": SINE},
    "table-utf16.csv": {"q_degs": SINE},
    "matlab-nested-structs.mat": {"a.b.c.d.e.f.q": SINE},
    "matlab-version-4.mat": {"q": SINE},
    "matlab-struct-array.mat": {"run(1).q": SINE, "run(2).q": -SINE, "s.sig.values": SINE},
    "hdf5-compound.h5": {"log.q": SINE},
    "hdf5-number-types.h5": {"q_big_endian": SINE, "q_half": SINE},
    "hdf5-units-as-array.h5": {"p": SINE, "q": SINE, "r": SINE},
    "parquet-duration.parquet": {"q": SINE},
    "dataflash-two-instances.bin": {"IMU.GyrY": LONG, "IMU.1.GyrY": -LONG},
    "dataflash-two-instances-fmtu.bin": {"IMU.GyrY": LONG, "IMU.1.GyrY": -LONG},
    "ulog-truncated.ulg": {"att.q": LONG[:167]},
    "mdf-linear-conversion.mf4": {"q": np.array([-4.99, 14.99])},
}
REFUSED = {
    "table-midnight.csv": "row 102, column 'utc': time does not increase",
    "table-sentinel.csv": "row 52, column 'q_degs' holds -9999",
    "table-quoted-thousands.csv": "row 2, column 'alt_ft' holds '1,000.0'",
    "table-narrow-blank-thousands.csv": "row 2, column 'alt_ft' holds '1\u202f000'",
    "table-three-digit-exponent.csv": "row 2, column 'q_degs' holds '1.0000-101'",
    "table-repeated-name.csv": "'q_degs' is also the name of column 2",
    "hdf5-fill-value.h5": "row 51, column 'q' holds nan",
    "hdf5-unallocated.h5": "larger than the file by far",
    "matlab73-cell-to-external-dataset.mat": "field 'names' is external or virtual",
    "parquet-null.parquet": "row 51, column 'q' is empty",
    "dataflash-huge-stamp.bin": "row 151, column 'IMU.TimeUS' holds",
    "dataflash-nan.bin": "column 'IMU.GyrY' holds nan",
    "dataflash-restart.bin": "row 151, column 'IMU.TimeUS': time does not increase",
    "ulog-dropout.ulg": "row 101, column 'att.timestamp': the time step is 0.51 s",
    "ulog-stamp-back.ulg": "row 101, column 'att.timestamp': time does not increase",
    "mdf-invalid-samples.mf4": "channel 'q' holds 290 of 300 samples",
}
NOT_READ = {
    "table-trailing-comma.csv": "the empty cell after the last delimiter",
    "matlab-sparse.mat": "q: a sparse matrix",
    "ulog-truncated.ulg": "the log ends within a message",
    "ulog-dropout.ulg": "gaps of the recorder",
    "chapter10-wrong-data-checksum.ch10": "12 packets whose data checksum is wrong",
}


def read_samples(client: Client, upload: str, mapping: str) -> dict[str, np.ndarray]:
    """Return the channels of an upload as they are drawn, by field; in SI times 180 / pi."""
    checked = check(client, upload, mapping)
    assert checked["problem"] is None
    names = {one["name"]: one["field"] for one in checked["channels"]}
    shown = client.send(
        "post", f"uploads/{upload}/preview", {"mapping": mapping, "channels": [*names]}
    )
    decode = base64.b64decode
    return {
        names[one["name"]]: np.frombuffer(decode(one["y"]["bdata"]), one["y"]["dtype"])
        for one in shown["data"]
        if one.get("name") in names
    }


@pytest.mark.parametrize("name", sorted({*READ, *REFUSED, *NOT_READ}))
def test_recordings_are_read_or_refused_as_their_producers_mean_them(
    client: Client, name: str
) -> None:
    sent = [("files", (name, (CASES / name).read_bytes()))]
    response = client.request("post", "uploads", files=sent)
    upload = mapping = ""
    if response.is_success:
        found = response.json()
        upload, mapping = found["upload"]["id"], found["proposal"]["text"]
        mapping = mapping.replace('name = "?"', 'name = "Cases"')
        left = [text for file in found["files"] for text in file["not_read"]]
        assert NOT_READ.get(name, "") in " | ".join(left)
        assert name in NOT_READ or not left
    if name in REFUSED:
        message = response.text
        if response.is_success:
            message = check(client, upload, mapping)["problem"]["message"]
        assert REFUSED[name] in message
        return
    fields = {one["field"]: one for one in response.json()["fields"]}
    for field, expected in READ.get(name, {}).items():
        assert fields[field]["smallest"] == pytest.approx(expected.min(), abs=1e-3)
        assert fields[field]["largest"] == pytest.approx(expected.max(), abs=1e-3)
        if expected.size > 2:
            samples = read_samples(client, upload, mapping)[field]
            assert samples.size == expected.size
            if not field.endswith("values"):  # whose unit is not known
                scale = (samples @ expected) / (expected @ expected)  # of the unit that is shown
                assert scale > 0.0
                assert np.abs(samples / scale - expected).max() < 1e-3


def test_a_sound_recording_of_chapter_10_is_read(client: Client) -> None:
    found = client.upload(CASES / "chapter10-sound.ch10")
    fields = {one["field"]: one for one in found["fields"]}
    assert fields["Q"]["first"] == [0.5, 2.0, 3.5, 4.96]
    assert (fields["Q"]["n_samples"], fields["AZ"]["n_samples"]) == (299, 598)


@pytest.mark.parametrize(
    ("name", "node", "values"),
    [
        ("universal-three-digit-exponent-55", 1, [1.0, 1.23456e-101, 0.5]),
        ("universal-three-digit-exponent-55", 2, [2.0, 1e-120, 0.7]),
        ("universal-three-digit-exponent-2414", 1, [1.0, 1e-110, 0.5]),
        ("universal-node-comments-55", 2, [2.0, 0.3, 0.7]),
        ("universal-inch-164", 2, [0.0508, 0.00762, 0.01778]),
        ("universal-two-frames-2420", 2, [0.0, 1.0, 0.0]),
        ("universal-two-frames-2420", 3, [1.0, 0.0, 0.0]),
    ],
)
def test_shapes_have_the_numbers_of_their_file(
    client: Client, name: str, node: int, values: list[float]
) -> None:
    upload = client.upload(CASES / f"{name}.unv")["upload"]["id"]
    stated = {} if "inch" in name else UNITS
    body = {"aircraft_id": 1, "name": f"{name} {node}", "generalized_mass": "file", **stated}
    table = client.send("post", f"uploads/{upload}/modal-data", body)
    written = client.request("get", f"modal-tables/{table['id']}/file", params={"form": "csv"})
    header, *rows = (line.split(",") for line in written.text.splitlines())
    (row,) = [row for row in rows if int(row[header.index("node")]) == node]
    at = header.index("phi_x_m")
    assert list(map(float, row[at : at + 3])) == pytest.approx(values, rel=1e-6, abs=1e-200)
    assert float(row[header.index("frequency_hz")]) == pytest.approx(5.0)


def test_modes_are_followed_over_fuel_weights(client: Client) -> None:
    files = {f"wing-fuel-{part}.f06": fuel for part, fuel in (("000", 0), ("050", 0.5), ("100", 1))}
    upload = client.upload(*(CASES / name for name in ("wing-fuel.bdf", *files)))["upload"]["id"]
    body = {"aircraft_id": 1, "name": "fuel", "generalized_mass": "file", "fuel": files}
    units = {"length_unit": "in", "mass_unit": "slinch"}
    table = client.send("post", f"uploads/{upload}/modal-data", body | units)
    assert table["names"] == ["SW1B", "AW1B", "SW2B", "SW1T", "AW1T", "AFA"]
    orders = []
    for fuel in files.values():
        modes = client.get(f"modal-tables/{table['id']}/modes", params={"fuel": fuel})["items"]
        orders.append([one["name"] for one in sorted(modes, key=lambda one: one["frequency_hz"])])
    assert [order.index("SW2B") for order in orders] == [2, 3, 4]  # it crosses both torsions
    assert [order.index("SW1T") for order in orders] == [3, 2, 2]


def test_parts_of_a_deck_are_read(client: Client) -> None:
    names = ("nastran-with-include.bdf", "nastran-part-mkaero.bdf", "optistruct-bulk-data.fem")
    for files, nodes in ((names[:2], 6), (names[2:], 2)):
        upload = client.upload(*(CASES / name for name in files))["upload"]["id"]
        assert client.get(f"uploads/{upload}/modal-data")["n_nodes"] == nodes


@pytest.mark.parametrize(
    ("name", "force_unit", "given", "hertz"),
    [
        ("type-0", "N", "m/s2", [1.0, 6.0]),
        ("type-4", "N", "m/s2", [1.0, 6.0]),
        ("58b-big-endian", "N", "m/s2", [1.0, 6.0]),
        ("58b-extra-line-end", "N", "m/s2", [1.0, 6.0]),
        ("uneven-padded", "N", "m/s2", [1.0, 1.2]),
        ("per-lbf", "lbf", "m/s2", [1.0, 6.0]),
        ("rad-per-s", "N", "m/s2", [0.159155, 0.95493]),
        ("in-g", "N", "m/s2", "its responses in g, m/s2 was given"),
        ("displacement", "N", "m/s2", "are of displacement by the file"),
    ],
)
def test_frequency_responses_are_those_of_their_file(
    client: Client, name: str, force_unit: str, given: str, hertz: Any
) -> None:
    upload = client.upload(CASES / f"universal-frf-{name}.unv")["upload"]["id"]
    body = {"aircraft_id": 1, "name": name, "response_unit": given, "force_unit": force_unit}
    response = client.request("post", f"uploads/{upload}/responses", body | {"length_unit": "m"})
    if isinstance(hertz, str):
        assert response.status_code == 422
        assert hertz in response.text
        return
    stored = response.json()
    assert any("type 0" in note for note in stored["notes"]) == (name == "type-0")
    where = f"measured-responses/{stored['id']}/function"
    found = client.get(where, params={"response_dof": "1+z", "reference_dof": "1+z"})
    assert np.array(found["frequency_hz"])[[0, -1]] == pytest.approx(hertz, rel=1e-5)


RATE_HZ, N_SAMPLES, AT = 50.0, 400, 100
MAPPING = """
[aircraft]
name = "Cases"
[flight]
number = 1
{part}
[time]
column = "t"
[[channels]]
column = "elevator"
unit = "deg"
role = "input"
[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""
MANEUVER = """
[maneuver]
condition.airspeed = { value = 20, unit = "m/s" }
condition.altitude = { value = 100, unit = "m" }
condition.fuel_fraction = { value = 0 }
"""
CONDITION = """
[[channels]]
column = "V"
name = "airspeed"
unit = "m/s"
role = "condition"
[[channels]]
column = "h"
name = "altitude"
unit = "m"
role = "condition"
"""
Table = list[list[float]]


def make_table() -> Table:
    """Rows of time, elevator and pitch rate."""
    t = np.arange(N_SAMPLES) / RATE_HZ
    return np.column_stack([t, 3.0 * np.sin(2.0 * t), 5.0 * np.sin(3.0 * t)]).tolist()


def lose_sample(rows: Table) -> None:
    rows[AT][2] = float("nan")


def mark_sample(rows: Table) -> None:
    rows[AT][2] = -9999.0


def lose_stamp(rows: Table) -> None:
    rows[AT][0] = rows[AT - 1][0]


def repeat_row(rows: Table) -> None:
    rows.insert(AT, list(rows[AT - 1]))


def exchange_rows(rows: Table) -> None:
    rows[AT], rows[AT - 1] = rows[AT - 1], rows[AT]


def exchange_stamps(rows: Table) -> None:
    rows[AT][0], rows[AT - 1][0] = rows[AT - 1][0], rows[AT][0]


def roll_over(period_s: float) -> Callable[[Table], None]:
    def change(rows: Table) -> None:
        for at, row in enumerate(rows):
            row[0] += period_s - AT / RATE_HZ - (period_s if at >= AT else 0.0)

    return change


def write_record(folder: Path, change: Callable[[Table], None]) -> Path:
    rows = make_table()
    change(rows)
    lines = ["t,elevator,q", *(",".join(f"{value:.6f}" for value in row) for row in rows)]
    path = folder / "record.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


DAMAGE = [
    (lose_sample, "single-nan", "row 102, 'q': a missing sample is interpolated"),
    (mark_sample, "single-nan", "row 102, 'q': a missing sample is interpolated"),
    (lose_stamp, "repeated-stamps", "row 102, 't': a repeated stamp is replaced by 2"),
    (repeat_row, "repeated-stamps", "row 102, 't': the row repeats the row before it"),
    (exchange_rows, "exchanged-stamps", "row 102, 't': the row and the row before it"),
    (exchange_stamps, "exchanged-stamps", "row 102, 't': its stamp and that before"),
    (roll_over(86_400.0), "midnight", "row 102, 't': the clock begins anew; 86400 s"),
    (roll_over(604_800.0), "gps-week", "row 102, 't': the clock begins anew; 604800 s"),
]


def check(client: Client, upload: str, mapping: str) -> Any:
    return client.send("post", f"uploads/{upload}/check", {"mapping": mapping})


@pytest.mark.parametrize(("change", "repair", "what"), DAMAGE)
def test_damage_is_refused_until_the_mapping_repairs_it(
    client: Client,
    tmp_path: Path,
    change: Callable[[Table], None],
    repair: str,
    what: str,
) -> None:
    upload = client.upload(write_record(tmp_path, change))["upload"]["id"]
    mapping = MAPPING.format(part=MANEUVER)
    refused = check(client, upload, mapping)["problem"]
    assert f'repair = ["{repair}"]' in refused["message"]
    assert "row 10" in refused["message"]
    mapping = f'repair = ["{repair}"]\n' + mapping
    repaired = check(client, upload, mapping)
    assert repaired["problem"] is None
    assert [text for text in repaired["repairs"] if what in text] == repaired["repairs"]
    sizes = {channel["n_samples"] for channel in repaired["channels"]}
    assert sizes == {N_SAMPLES}
    assert {channel["rate_hz"] for channel in repaired["channels"]} == {RATE_HZ}
    body = {"mapping": mapping, "channels": ["q"]}
    trace = client.send("post", f"uploads/{upload}/preview", body)["data"][0]
    samples = np.frombuffer(base64.b64decode(trace["y"]["bdata"]), trace["y"]["dtype"])
    true = 5.0 * np.sin(3.0 * np.arange(N_SAMPLES) / RATE_HZ)
    scale = (samples @ true) / (true @ true)  # of the unit that is shown
    assert np.abs(samples / scale - true).max() < 1e-4


def test_what_was_repaired_is_on_the_stored_record(client: Client, tmp_path: Path) -> None:
    record = write_record(tmp_path, lose_sample)
    upload = client.upload(record)["upload"]["id"]
    body = {"mapping": 'repair = ["single-nan"]\n' + MAPPING.format(part=MANEUVER)}
    job = client.send("post", f"uploads/{upload}/import", body)
    assert client.wait_for_end(f"jobs/{job['id']}")["state"] == "succeeded"
    (listed,) = client.get("maneuvers")["items"]
    stored = client.get(f"maneuvers/{listed['id']}")
    assert "Repaired: record.csv: row 102, 'q': a missing sample" in str(stored)

    lines = record.read_text().splitlines()
    record.write_text("\n".join([f"{lines[0]},V,h", *(f"{line},20,100" for line in lines[1:])]))
    flight = MAPPING.format(part="").replace("number = 1", "number = 2") + CONDITION
    upload = client.upload(record)["upload"]["id"]
    body = {"mapping": 'repair = ["single-nan"]\n' + flight}
    job = client.send("post", f"uploads/{upload}/import", body)
    assert client.wait_for_end(f"jobs/{job['id']}")["state"] == "succeeded"
    (stored,) = [one for one in client.get("flights")["items"] if one["number"] == 2]
    assert "Repaired: record.csv: row 102" in stored["description"]

    cut = {"label": "cut", "start_s": 1.0, "stop_s": 6.0, "note": "Calm."}
    made = client.send("post", f"flights/{stored['id']}/maneuvers", cut)
    assert made["note"].startswith("Calm.\nRepaired: record.csv: row 102, 'q': a missing sample")


def lose_two(rows: Table) -> None:
    rows[AT][2] = rows[AT + 1][2] = float("nan")


def stop_clock(rows: Table) -> None:
    for row in rows[AT:]:
        row[0] -= 1.0


@pytest.mark.parametrize("change", [lose_two, stop_clock])
def test_other_damage_is_not_repaired(
    client: Client, tmp_path: Path, change: Callable[[Table], None]
) -> None:
    upload = client.upload(write_record(tmp_path, change))["upload"]["id"]
    steps = ", ".join(f'"{repair}"' for repair in dict.fromkeys(case[1] for case in DAMAGE))
    checked = check(client, upload, f"repair = [{steps}]\n" + MAPPING.format(part=MANEUVER))
    assert "repair =" not in checked["problem"]["message"]
    unknown = check(client, upload, 'repair = ["all"]\n' + MAPPING.format(part=MANEUVER))
    assert unknown["problem"]["code"] == "bad-mapping"


def test_a_clock_passes_midnight(client: Client) -> None:
    upload = client.upload(CASES / "table-midnight.csv")["upload"]["id"]
    mapping = MAPPING.format(part="").replace('"t"', '"utc"').replace('"elevator"', '"q_degs"')
    mapping = mapping.partition('[[channels]]\ncolumn = "q"')[0]
    refused = check(client, upload, mapping)["problem"]
    assert "row 102, column 'utc'" in refused["message"]
    assert 'repair = ["midnight"]' in refused["message"]
    checked = check(client, upload, 'repair = ["midnight"]\n' + mapping)
    assert checked["channels"][0]["rate_hz"] == RATE_HZ
    assert checked["channels"][0]["start_s"] == 86_398.0
    assert checked["channels"][0]["n_samples"] == 200


def test_the_time_of_a_gps_week_is_a_clock(client: Client, tmp_path: Path) -> None:
    record = write_record(tmp_path, roll_over(604_800.0))
    record.write_text(record.read_text().replace("t,elevator", "gps_tow_s,elevator"))
    found = client.upload(record)
    proposal = found["proposal"]["text"].replace('name = "?"', 'name = "Cases"')
    assert '[time]\ncolumn = "gps_tow_s"' in proposal
    problem = check(client, found["upload"]["id"], proposal)["problem"]
    assert 'repair = ["gps-week"]' in problem["message"]


def restart_clock(rows: Table) -> None:
    for row in rows[AT:]:
        row[0] -= AT / RATE_HZ


def leave_gap(rows: Table) -> None:
    for row in rows[AT:]:
        row[0] += 60.0


@pytest.mark.parametrize(
    ("change", "start", "stop", "found"),
    [
        (leave_gap, 0.5, 1.5, (0.5, 50)),
        (leave_gap, 63.0, 66.0, (63.0, 150)),
        (leave_gap, 1.0, 64.0, "Of a record in several segments"),
        (leave_gap, 20.0, 30.0, "in none of the segments: 0 to 1.98 s (rows 2 to 101), 62 to"),
        (restart_clock, 3.0, 5.0, (3.0, 100)),
        (restart_clock, 0.5, 1.0, "0 to 1.98 s (rows 2 to 101), 0 to 5.98 s (rows 102 to 401)"),
    ],
)
def test_start_and_stop_select_one_segment_of_a_record(
    client: Client,
    tmp_path: Path,
    change: Callable[[Table], None],
    start: float,
    stop: float,
    found: Any,
) -> None:
    upload = client.upload(write_record(tmp_path, change))["upload"]["id"]
    ends = "".join(
        f'{name} = {{ value = {value}, unit = "s" }}\n'
        for name, value in (("start", start), ("stop", stop))
    )
    part = MANEUVER.replace("[maneuver]\n", f"[maneuver]\n{ends}")
    checked = check(client, upload, MAPPING.format(part=part))
    if isinstance(found, str):
        assert found in checked["problem"]["message"]
        return
    assert checked["problem"] is None
    channel = checked["channels"][0]
    assert (channel["start_s"], channel["n_samples"]) == pytest.approx(found)
    assert channel["rate_hz"] == RATE_HZ


PAGE = """1    WING                      NOVEMBER  28, 2026  MSC Nastran  1/1/20   PAGE {page:6d}
0                                                                                          SUBCASE 1
                                              R E A L   E I G E N V A L U E S
   MODE    EXTRACTION      EIGENVALUE            RADIANS             CYCLES            GENERALIZED
    NO.       ORDER                                                                       MASS
"""


@pytest.mark.long
def test_a_printout_of_91_megabytes_is_read(client: Client, tmp_path: Path) -> None:
    path, n_modes = tmp_path / "large.f06", 710_000
    with path.open("w") as file:
        for mode in range(1, n_modes + 1):
            if mode % 50 == 1:
                file.write(PAGE.format(page=mode // 50 + 1))
            omega = 10.0 + 0.01 * mode
            values = (omega**2, omega, omega / (2.0 * np.pi), 1.0, omega**2)
            file.write(
                f"{mode:9d}{mode:10d}" + "".join(f"{value:20.6E}" for value in values) + "\n"
            )
    assert path.stat().st_size > 91e6
    upload = client.upload(path)["upload"]["id"]
    (found,) = client.get(f"uploads/{upload}/modal-data")["files"]
    assert found["holds"] == [f"{n_modes} frequencies"]


def damage(content: bytes, rng: np.random.Generator) -> bytes:
    """Cut a file off, or change some of its bits, bytes, words or tokens."""
    raw = bytearray(content)
    at, length = int(rng.integers(len(raw))), int(rng.integers(1, 200))
    match int(rng.integers(6)):
        case 0:
            del raw[max(at, 1) :]
        case 1:
            del raw[at : at + length]
        case 2:
            raw[at:at] = raw[: 4 * length]
        case 3:
            raw[at : at + 4] = (b"\xff\xff\xff\x7f", b"\xff" * 4, bytes(4))[length % 3]
        case 4:
            raw[at : at + length % 12] = (b"NaN", b"1.5+309", b"****", b"", b"9" * 400)[length % 5]
        case _:
            for place in rng.integers(min(len(raw), 700), size=8):
                raw[place] ^= 1 << int(rng.integers(8))
    return bytes(raw) or b"0"


@pytest.mark.parametrize(
    ("seed", "n_files"), [(1, 32), pytest.param(7, 3000, marks=pytest.mark.long)]
)
def test_damaged_files_are_refused_or_read(client: Client, seed: int, n_files: int) -> None:
    """Every response is one of the interface, whatever a file of any format holds."""
    rng = np.random.default_rng(seed)
    by_suffix: dict[str, list[Path]] = {}
    for path in sorted(CASES.iterdir()):
        by_suffix.setdefault(path.suffix, []).append(path)
    for number in range(n_files):
        paths = list(by_suffix.values())[number % len(by_suffix)]
        path = paths[int(rng.integers(len(paths)))]
        sent = [("files", (path.name, damage(path.read_bytes(), rng)))]
        response = client.request("post", "uploads", files=sent)
        assert response.status_code in (201, 413, 422), (number, path.name, response.text)
        if response.status_code != 201:
            continue
        upload = response.json()["upload"]["id"]
        mapping = response.json()["proposal"]["text"].replace('name = "?"', 'name = "Cases"')
        client.get(f"uploads/{upload}/modal-data")
        checked = check(client, upload, mapping)
        body = {"mapping": mapping, "channels": [one["name"] for one in checked["channels"]]}
        shown = client.request("post", f"uploads/{upload}/preview", body)
        assert shown.status_code in (200, 422), (number, path.name, shown.text)
        client.send("delete", f"uploads/{upload}")


def test_every_field_of_an_upload_is_listed_or_named(client: Client, tmp_path: Path) -> None:
    path = tmp_path / "record.npz"
    names = draw_numpy(np.random.default_rng(1), path)
    found = client.upload(path)
    read = {field["field"] for field in found["fields"]}
    left = [text for file in found["files"] for text in file["not_read"]]
    assert not set(find_lost(names, read, left)) - {"texts", "number", "empty", "table.d"}
    assert {"moments", "durations", "complex imaginary", "table.a"} & read
    assert any(text.startswith("bytes: data of type") for text in left)


def test_a_row_of_a_matrix_is_a_clock(client: Client, tmp_path: Path) -> None:
    time, elevator, rate = np.array(make_table()).T
    path = tmp_path / "record.mat"
    savemat(path, {"t": time, "elevator": elevator, "boom": rate}, oned_as="row")
    proposal = client.upload(path)["proposal"]["text"]
    assert '[time]\ncolumn = "t"' in proposal
