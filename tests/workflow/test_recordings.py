"""Recordings of several files: clocks, sources, implausible units, whole flights."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_files
from scipy.io import savemat

from flexsid.errors import BadInput, Conflict, FlexsidError, UnreadableFile
from flexsid.importers.quantity import find_unit_warning
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Role
from flexsid.storage.recordings import read_flight_channels
from flexsid.storage.store import Store
from flexsid.workflow.importing import uploads
from flexsid.workflow.importing.flight_import import Imported, import_each

HEAD = """
[aircraft]
name = "X-1"
[flight]
number = 7
"""
MANEUVER = """
[maneuver]
label = "two recorders"
start = { value = 101.0, unit = "s" }
stop = { value = 103.0, unit = "s" }
[maneuver.condition]
airspeed = { field = "tas", unit = "kt" }
density = { value = 1.2, unit = "kg/m3" }
fuel_fraction = { value = 0.5 }
"""
CHANNELS = """
[time]
column = "t"
[[clocks]]
name = "fti"
column = "fti.mat:clock"
unit = "ms"
offset = { value = 100, unit = "s" }
[[channels]]
column = "bf"
name = "bfs"
unit = "deg"
role = "input"
[[channels]]
column = "tas"
unit = "kt"
role = "condition"
[[channels]]
array = "fdata"
column = 2
name = "q"
unit = "deg/s"
role = "output"
sensor = "q"
clock = "fti"
"""


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    """Recorders at 50 and 20 Hz, and instrumentation at 200 Hz with its own time."""
    fast, slow = np.arange(300) / 50.0 + 100.0, np.arange(120) / 20.0 + 100.0
    rows = np.stack([fast, 3 * np.sin(fast)], axis=1)
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header="t,bf", comments="")
    rows = np.stack([slow, 40 + slow - 100], axis=1)
    np.savetxt(tmp_path / "b.csv", rows, delimiter=",", header="t,tas", comments="")
    clock = np.arange(1000) * 5.0
    fdata = np.stack([clock, np.cos(clock / 500)], axis=1).astype(np.float32)
    savemat(tmp_path / "fti.mat", {"clock": clock, "fdata": fdata})
    return [tmp_path / name for name in ("a.csv", "b.csv", "fti.mat")]


def test_channels_retain_rate_unit_precision_and_source(
    store: Store, aircraft: Aircraft, files: list[Path]
) -> None:
    maneuver = import_files(store, files, HEAD + MANEUVER + CHANNELS).maneuver
    assert maneuver is not None
    assert (maneuver.start_s, maneuver.duration_s) == (101.0, 2.0)
    assert maneuver.source_file == "a.csv, b.csv, fti.mat"
    assert maneuver.condition.airspeed_m_s == pytest.approx(41.975 * 1852 / 3600)
    found = {c.name: c for c in store.channels.find(maneuver_id=maneuver.id)}
    assert {name: (c.rate_hz, c.start_s, c.n_samples) for name, c in found.items()} == {
        "bfs": (50.0, 101.0, 100),
        "tas": (20.0, 101.0, 40),
        "q": (200.0, 101.0, 400),
    }
    q = found["q"]
    assert (q.source_file, q.source_field, q.sensor, q.unit) == (
        "fti.mat",
        "fdata(2)",
        "q",
        "deg/s",
    )
    assert q.source_hash is not None
    assert q.source_hash != found["bfs"].source_hash
    samples = store.arrays.get(q.array)
    assert samples.dtype == np.float32
    np.testing.assert_array_equal(samples, np.cos(np.arange(200, 600) / 100).astype(np.float32))


def test_whole_flight_is_stored_with_its_channels(
    store: Store, aircraft: Aircraft, files: list[Path]
) -> None:
    imported = import_files(store, files, HEAD + CHANNELS)
    assert imported.maneuver is None
    assert imported.flight is not None
    assert imported.flight.id is not None
    channels = store.flight_channels.find(flight_id=imported.flight.id)
    assert [(c.name, c.start_s, c.n_samples) for c in channels] == [
        ("bfs", 100.0, 300),
        ("tas", 100.0, 120),
        ("q", 100.0, 1000),
    ]
    found = read_flight_channels(store.database, imported.flight.id, ["q", "bfs"])
    assert [channel for channel, _ in found.values()] == [channels[0], channels[2]]
    np.testing.assert_array_equal(found["q"][1], store.arrays.get(channels[2].array))
    with pytest.raises(Conflict, match=r"Flight 7 has a channel 'bfs' already, from a\.csv"):
        import_files(store, files, HEAD + CHANNELS)
    store.flights.delete(1)
    assert store.flight_channels.find() == []


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('clock = "fti"', 'clock = "egi"', "no clock 'egi'; defined: fti"),
        ("value = 100, unit", "value = 0, unit", "'maneuver.start' and 'maneuver.stop' leave"),
        ('sensor = "q"', 'sensor = "r"', "has no sensor 'r'; it has q"),
        ('column = "fti.mat:clock"', 'column = "fti.mat:watch"', "'fti.mat:watch'"),
        ("column = 2", "column = 3", r"'fdata' has 2 columns"),
        ('[time]\ncolumn = "t"', "", "'time' is missing; a.csv has no clock"),
    ],
)
def test_mismatches_are_listed(
    store: Store, aircraft: Aircraft, files: list[Path], old: str, new: str, words: str
) -> None:
    text = HEAD + MANEUVER + CHANNELS
    assert old in text
    with pytest.raises(BadInput, match=words):
        import_files(store, files, text.replace(old, new))
    assert store.flights.find() == []


def test_a_channel_longer_than_its_time_is_refused(
    store: Store, aircraft: Aircraft, files: list[Path]
) -> None:
    text = (HEAD + MANEUVER + CHANNELS).replace("fti.mat:clock", "b.csv:t")
    with pytest.raises(UnreadableFile, match=r"has 1000 samples but its time 'b\.csv:t' has 120"):
        import_files(store, files, text)


def test_angle_in_degrees_declared_as_radians_raises_a_query(
    store: Store, aircraft: Aircraft, files: list[Path]
) -> None:
    text = (HEAD + MANEUVER + CHANNELS).replace('unit = "deg"\n', 'unit = "rad"\n')
    with pytest.raises(BadInput, match=r"'bfs' varies by [\d.]+ rad.* Is it deg\?") as caught:
        import_files(store, files, text)
    assert caught.value.code == "unconfirmed-unit"
    (query,) = caught.value.context["queries"]  # type: ignore[misc]
    assert query["code"] == "too-large"
    assert store.maneuvers.find() == []
    confirmed = text.replace('unit = "rad"\n', 'unit = "rad"\nconfirmed = ["too-large"]\n')
    assert import_files(store, files, confirmed).maneuver is not None


@pytest.mark.parametrize(
    ("unit", "role", "size", "asked"),
    [
        ("rad", Role.INPUT, 0.03, None),
        ("deg", Role.INPUT, 0.03, ("rad",)),
        ("deg", Role.INPUT, 2.0, None),
        ("rad", Role.OUTPUT, 360.0, ("deg", "mrad")),
        ("rad/s", Role.OUTPUT, 40.0, ("deg/s", "mrad/s", "rpm")),
        ("g", Role.OUTPUT, 32.2, ("m/s2", "ft/s2", "in/s2")),
        ("g", Role.OUTPUT, 9.8, None),
        ("strain", Role.OUTPUT, 800.0, ("ustrain",)),
        ("V", Role.OUTPUT, 1e9, None),
    ],
)
def test_implausible_unit_raises_a_warning(
    unit: str, role: Role, size: float, asked: tuple[str, ...] | None
) -> None:
    warning = find_unit_warning("x", unit, role, np.array([0.0, size]))
    assert (None if warning is None else warning.instead) == asked
    assert find_unit_warning("x", unit, role, np.array([size, size])) is None


def test_campaign_is_imported_file_by_file(
    store: Store, aircraft: Aircraft, tmp_path: Path
) -> None:
    time_s = np.arange(100) / 50.0
    paths = [tmp_path / f"m{number}.npz" for number in range(4)]
    for number, path in enumerate(paths):
        np.savez(path, t=time_s, bf=np.sin(time_s + number), q=np.cos(time_s))
    paths[2].write_bytes(paths[2].read_bytes()[:-40])
    text = (
        HEAD
        + MANEUVER.replace('{ field = "tas", unit = "kt" }', '{ value = 40, unit = "kt" }')
        .replace('label = "two recorders"', "")
        .replace("101.0", "0.0")
        .replace("103.0", "1.0")
        + CHANNELS.split("[[clocks]]")[0]
        + '[[channels]]\ncolumn = "bf"\nname = "bfs"\nunit = "deg"\nrole = "input"\n'
    )
    results = dict(import_each(store, paths, text))
    assert [type(result) for result in results.values()] == [
        Imported,
        Imported,
        UnreadableFile,
        Imported,
    ]
    refused = results[paths[2]]
    assert isinstance(refused, FlexsidError)
    assert "m2.npz: the NumPy archive file is damaged" in refused.message
    assert [m.label for m in store.maneuvers.find()] == ["m0", "m1", "m3"]


KILLED = """
import os, signal, sys
from pathlib import Path
from flexsid.storage.repository import Repository
from flexsid.storage.store import Store
from flexsid.workflow.importing import flight_import

flight_import.BYTES_AT_ONCE = 1
add_many, written = Repository.add_many, []

def add_many_and_kill(repository, records):
    add_many(repository, records)
    written.append(records)
    if len(written) == 2:
        os.kill(os.getpid(), signal.SIGKILL)

Repository.add_many = add_many_and_kill
upload = flight_import.read_upload([Path(name) for name in sys.argv[3:]], sys.argv[2])
flight_import.store_upload(Store.open(sys.argv[1]), upload)
"""


def test_import_killed_while_writing_stores_nothing(
    store: Store, aircraft: Aircraft, database_url: str, files: list[Path]
) -> None:
    text = HEAD + MANEUVER + CHANNELS
    command = [sys.executable, "-c", KILLED, database_url, text, *map(str, files)]
    ended = subprocess.run(command, check=False, env={**os.environ})
    assert ended.returncode == -signal.SIGKILL
    assert store.flights.find() == store.maneuvers.find() == store.channels.find() == []
    assert import_files(store, files, text).maneuver is not None


def test_unused_column_may_contain_nan(store: Store, aircraft: Aircraft, files: list[Path]) -> None:
    rows = files[0].read_text().splitlines()
    broken = [
        f"{rows[0]},gps",
        *(f"{row},{'nan' if k else 'inf'}" for k, row in enumerate(rows[1:])),
    ]
    files[0].write_text("\n".join(broken))
    stored = import_files(store, files, HEAD + MANEUVER + CHANNELS).maneuver
    assert stored is not None
    used = CHANNELS + '[[channels]]\ncolumn = "gps"\nunit = "m"\nrole = "condition"\n'
    mapping = HEAD + MANEUVER.replace("two recorders", "another") + used
    with pytest.raises(UnreadableFile, match="row 2, column 'gps' holds inf"):
        import_files(store, files, mapping)


def test_old_uploads_are_deleted_while_the_server_runs(
    store: Store, files: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(uploads, "locate_uploads", lambda store: tmp_path / "uploads")
    old = uploads.add_upload(store, files[:1], ["a.csv"])
    uploader = uploads.find_folder(store, old.id) / "account"
    long_ago = uploader.stat().st_mtime - (uploads.RETENTION_DAYS + 1) * 86400
    os.utime(uploader, (long_ago, long_ago))
    new = uploads.add_upload(store, files[:1], ["a.csv"])
    assert {path.name for path in (tmp_path / "uploads").iterdir()} == {new.id}
