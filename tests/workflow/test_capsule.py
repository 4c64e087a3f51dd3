"""Capsules of runs: recomputed without the database, and refused if any byte was changed."""

from __future__ import annotations

import json
import os
import sqlite3
import subprocess
import sys
import zipfile
from contextlib import closing
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import sqlalchemy as sa

from flexsid.errors import BadInput, Conflict
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.maneuver import ConditioningStep, Correction, StepKind
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.arrays import describe_array
from flexsid.storage.signatures import read_public_key
from flexsid.storage.store import Store
from flexsid.storage.tables import arrays
from flexsid.verification.recomputation import compare_results, recompute_capsule
from flexsid.workflow.runs.capsule import read_capsule, write_capsule

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


def test_a_capsule_is_recomputed_without_the_database(flown: Store, tmp_path: Path):
    first = flown.runs.get(1)
    settings = RunSettings(out_of_band_modes=OutOfBandModes.RETAINED, max_iterations=20)
    request = EstimationRun(
        maneuver_id=first.maneuver_id,
        method=Method.FRE,
        structure=first.structure,
        settings=settings,
        author="Ann",
    )
    run = execute_run(flown, request, RUN, lambda progress: None)
    assert run.result is not None, run.error
    content = write_capsule(flown, run.id or 0)
    assert content == write_capsule(flown, run.id or 0), "equal content is an equal file"
    with zipfile.ZipFile(BytesIO(content)) as archive:
        crate = json.loads(archive.read("ro-crate-metadata.json"))
        listed = set(archive.namelist())
        exported = json.loads(archive.read("run.json"))
    graph = {one["@id"]: one for one in crate["@graph"]}
    about = graph["ro-crate-metadata.json"]
    assert about["conformsTo"]["@id"] == "https://w3id.org/ro/crate/1.1"
    parts = {one["@id"] for one in graph[about["about"]["@id"]]["hasPart"]}
    assert parts <= listed
    assert graph["#author"]["name"] == "Ann"
    assert exported["run"]["settings"]["out_of_band_modes"] == "retained"
    assert exported["run"]["rests_on"]

    clean = tmp_path / "clean"
    clean.mkdir()
    (clean / "run.zip").write_bytes(content)
    environment = {"PATH": os.environ["PATH"], "HOME": str(clean)}
    key = read_public_key(flown.database) or ""
    done = subprocess.run(
        [Path(sys.executable).with_name("flexsid"), "recompute", "run.zip", "--key", key, "--json"],
        cwd=clean,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert (found["agrees"], found["key"]) == (True, key)
    assert max(one["difference"] for one in found["compared"]) <= 1e-9
    assert [one["name"] for one in found["compared"]][:2] == ["parameters", "standard errors"]
    assert [file.name for file in clean.iterdir()] == ["run.zip"], "no database is made"


def test_every_changed_byte_of_a_capsule_is_noticed(flown: Store):
    content = write_capsule(flown, 1)
    rng = np.random.default_rng(3)
    head, tail = range(0, 200, 9), range(len(content) - 700, len(content), 9)
    for place in (*head, *tail, *rng.integers(len(content), size=100)):
        changed = bytearray(content)
        changed[place] ^= 1 << int(rng.integers(8))
        with pytest.raises(BadInput):
            read_capsule(bytes(changed))
    for other in (content[:-1], content + b"\n", content[1:], b""):
        with pytest.raises(BadInput):
            read_capsule(other)


def test_a_database_with_triggers_is_refused(flown: Store):
    capsule = read_capsule(write_capsule(flown, 1))
    with closing(sqlite3.connect(":memory:")) as content:
        content.deserialize(capsule.data)
        content.execute("CREATE VIEW hostile AS SELECT load_extension('x')")
        changed = content.serialize()
    with pytest.raises(BadInput, match="tables"):
        recompute_capsule(replace(capsule, data=changed))


def test_a_capsule_without_checksums_is_recomputed(flown: Store):
    capsule = read_capsule(write_capsule(flown, 1))
    with closing(sqlite3.connect(":memory:")) as opened:
        opened.deserialize(capsule.data)
        opened.execute("ALTER TABLE arrays DROP COLUMN checksum")
        earlier = opened.serialize()
    assert recompute_capsule(replace(capsule, data=earlier)).agrees


def test_samples_altered_with_their_checksum_are_not_recomputed(flown: Store):
    (channel,) = flown.channels.find(maneuver_id=1, name="q")
    altered = describe_array(2.0 * flown.arrays.get(channel.array), channel.unit)
    values = {"data": bytes(altered["data"]), "checksum": altered["checksum"]}
    with flown.database.transaction() as connection:
        connection.execute(sa.update(arrays).where(arrays.c.hash == channel.array).values(values))
    capsule = read_capsule(write_capsule(flown, 1))
    with pytest.raises(Conflict, match="channel 'q' of maneuver 1"):
        recompute_capsule(capsule)


def test_another_result_differs_and_changed_data_are_not_exported(flown: Store):
    capsule = read_capsule(write_capsule(flown, 1))
    assert recompute_capsule(capsule).agrees
    run = flown.runs.get(1)
    assert run.result is not None
    first = run.result.parameters[0]
    other = replace(first, value=first.value * (1.0 + 1e-8))
    compared = compare_results(
        flown, run.result, replace(run.result, parameters=(other, *run.result.parameters[1:]))
    )
    assert {one.name: one.difference for one in compared}["parameters"] == pytest.approx(1e-8)
    with pytest.raises(BadInput, match="numerical methods"):
        recompute_capsule(replace(capsule, versions={"methods": "0"}))
    maneuver = flown.runs.get(1).maneuver_id
    delayed = Correction(channel="q", kind=StepKind.DELAY, delay_s=0.01)
    flown.conditioning.add(ConditioningStep(maneuver_id=maneuver, channel="q", correction=delayed))
    with pytest.raises(Conflict) as refused:
        write_capsule(flown, 1)
    assert refused.value.code == "data-changed"
