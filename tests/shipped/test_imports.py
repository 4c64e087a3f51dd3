"""No process runs code of the folder in which the server was started, nor of ``PYTHONPATH``."""

from __future__ import annotations

import shutil
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

from rigid_record import simulate_doublet, write_record
from shipped import Client, serving_installed
from waiting import wait_until

TRAP = "import os, sys\nwith open({file!r}, 'a') as f:\n    f.write(f'{{os.getpid()}} {name}\\n')\n"


def lay_traps(folder: Path, file: Path) -> None:
    """Write a module for each name of the standard library and of every installed package."""
    names = {*sys.stdlib_module_names, *packages_distributions(), "org", "sitecustomize"}
    for name in sorted(name for name in names if name.isidentifier()):
        (folder / f"{name}.py").write_text(TRAP.format(file=str(file), name=name))


def test_every_process_imports_from_the_installation_only(campaign: Path, tmp_path: Path) -> None:
    caught, caught_by_path = tmp_path / "caught", tmp_path / "caught-by-path"
    started_in, by_path = tmp_path / "folder", tmp_path / "path"
    for folder in (started_in, by_path):
        folder.mkdir()
    database = tmp_path / "flexsid.db"
    shutil.copy(campaign, database)
    lay_traps(started_in, caught)
    # What the server itself imports by PYTHONPATH is the choice of whoever starts it.
    (by_path / "sitecustomize.py").write_text(
        TRAP.format(file=str(caught_by_path), name="sitecustomize")
    )
    with serving_installed(started_in, f"sqlite:///{database}", PYTHONPATH=str(by_path)) as server:
        client = server.connect()
        import_record(client, tmp_path)  # the process that reads files, dispatcher and worker
        run = client.send("post", "runs", {"maneuver_id": 2, "method": "EE"})
        assert client.wait_for_end(f"runs/{run['id']}")["state"] == "succeeded"
        stream_maneuver(client, run["id"])  # the processes of streams and of their estimates
        pid = server.process.pid
    assert not caught.exists(), caught.read_text()
    assert {line.split()[0] for line in caught_by_path.read_text().splitlines()} == {str(pid)}


def import_record(client: Client, folder: Path) -> None:
    record, mapping = write_record(folder, simulate_doublet())
    upload = client.upload(record)["upload"]["id"]
    body = {"mapping": mapping.read_text(), "confirmed": True}
    job = client.send("post", f"uploads/{upload}/import", body)
    ended = client.wait_for_end(f"jobs/{job['id']}")
    assert ended["state"] == "succeeded", ended["error"]


def stream_maneuver(client: Client, run_id: int) -> None:
    receiver = {"name": "replay", "options": {"maneuver_id": 2, "speed": 20.0}}
    body = {"run_id": run_id, "title": "traps", "receiver": receiver}
    stream = client.send("post", "live/streams", body)["id"]

    def has_ended() -> bool:
        return client.get(f"live/streams/{stream}")["stream"]["status"] == "stopped"

    wait_until(has_ended, "the end of the stream")
    states = client.get(f"live/streams/{stream}/history")["states"]
    assert any(one["state"]["estimate"] for one in states)
