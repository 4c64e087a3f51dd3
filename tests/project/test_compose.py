"""The compose file is valid, and the services it starts pass their health checks.

No engine is needed: each service's own command is started here, in the order of
``depends_on``, with PostgreSQL from the distribution's package.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import postgresql as postgresql_server
import pytest
from ports import find_free_port
from ruamel.yaml import YAML
from waiting import PATIENCE_S, wait_until

ROOT = Path(__file__).parents[2]
COMPOSE = ROOT / "docker-compose.yml"
WRITABLE = {
    "db": {"database"},
    "certificate": {"certificates"},
    "web": {"data"},
    "backup": {"backups"},
}
INPUT = re.compile(r"\$\{(\w+)(?::([-?])([^}]*))?\}")


def test_the_compose_file_is_valid() -> None:
    check = subprocess.run(
        [
            *(sys.executable, "-m", "check_jsonschema"),
            *("--builtin-schema", "vendor.compose-spec", str(COMPOSE)),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert check.returncode == 0, check.stdout + check.stderr


def test_it_contains_no_secret() -> None:
    with pytest.raises(AssertionError, match="DB_PASSWORD"):
        services({})


def test_only_loopback_ports_are_published() -> None:
    for service in services({"DB_PASSWORD": "x"}).values():
        for port in service.get("ports", ()):
            assert port.startswith("127.0.0.1:")


def test_containers_are_hardened() -> None:
    found = services({"DB_PASSWORD": "x"})
    for name, service in found.items():
        assert service["read_only"] is True, name
        assert service["cap_drop"] == ["ALL"], name
        assert service["security_opt"] == ["no-new-privileges:true"], name
        assert re.fullmatch(r"\d+[mg]", service["mem_limit"]), name
        assert service["pids_limit"] > 0, name
        writable = {part.partition(":")[0] for part in service["volumes"] if part[-3:] != ":ro"}
        assert writable == WRITABLE.get(name, set()), name
    assert found["db"]["user"] == "postgres"


def test_recordings_and_brokers_are_settings_of_the_server() -> None:
    given = {"RECORDINGS": "file:///data/recordings", "BROKERS": "nats://127.0.0.1:4222"}
    web = services({"DB_PASSWORD": "x", **given})["web"]["environment"]
    assert (web["FLEXSID_RECORDINGS"], web["FLEXSID_BROKERS"]) == tuple(given.values())


def test_everything_in_the_image_has_the_hash_of_the_lock() -> None:
    text = (ROOT / "Dockerfile").read_text()
    assert "pip install --no-cache-dir --require-hashes -r deploy/uv.txt" in text
    assert "--build-constraint requirements.lock --require-hashes" in text
    assert "--constraint requirements.lock" in text


def test_images_of_others_have_a_digest() -> None:
    python = re.search(r"^ARG PYTHON_IMAGE=(.*)$", (ROOT / "Dockerfile").read_text(), re.MULTILINE)
    assert python is not None
    found = services({"DB_PASSWORD": "x"})
    assert found["certificate"]["build"]["args"]["PYTHON_IMAGE"] == python[1]
    chart = YAML(typ="safe").load(ROOT / "deploy/helm/flexsid/values.yaml")
    assert chart["database"]["image"] == found["db"]["image"]
    for image in (python[1], found["db"]["image"]):
        assert re.fullmatch(r"[a-z]+:[\w.-]+@sha256:[0-9a-f]{64}", image), image


def test_scheduler_and_workers_bind_loopback_only() -> None:
    found = services({"DB_PASSWORD": "x"})
    for name in ("scheduler", "worker"):
        command = found[name]["command"]
        assert command[command.index("--host") + 1] == "127.0.0.1", name
        assert command[command.index("--dashboard-address") + 1] == "127.0.0.1:0", name
        assert found[name]["network_mode"] == "host"
    written = (ROOT / "README.md").read_text() + COMPOSE.read_text()
    written += "".join(file.read_text() for file in ROOT.glob("docs/**/*.md"))
    for line in written.splitlines():
        if re.search(r"^\s*dask (scheduler|worker)\b", line):
            assert "--host 127.0.0.1 --dashboard-address 127.0.0.1:0" in line, line
            assert "tcp://" not in line, line


def _check_loopback_only(pids: set[int]) -> None:
    """Check every socket on which a service or one of its child processes listens."""
    for pid in pids | _children(pids):
        own: set[str] = set()
        with suppress(OSError):  # it may have ended
            own = {os.readlink(file) for file in Path(f"/proc/{pid}/fd").iterdir()}
        for kind in ("tcp", "tcp6"):
            for line in Path(f"/proc/net/{kind}").read_text().splitlines()[1:]:
                fields = line.split()
                if fields[3] == "0A" and f"socket:[{fields[9]}]" in own:
                    assert fields[1].startswith("0100007F:"), (pid, kind, fields[1])


def _children(pids: set[int]) -> set[int]:
    """Return all descendants of these processes."""
    found: set[int] = set()
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
            if parent in pids:
                found.add(int(folder.name))
    return found | _children(found) if found else found


def test_every_service_is_healthy_and_listens_on_loopback_only(
    started: dict[str, str],
) -> None:
    port = started["PORT"]

    def worker_pool() -> dict[str, Any] | None:
        address = f"http://127.0.0.1:{port}/api/v1/jobs/status"
        with urllib.request.urlopen(address, timeout=PATIENCE_S) as response:
            found = json.load(response)["worker_pool"]
        return found if found is not None and found["workers"] == 1 else None

    assert wait_until(worker_pool, "a worker")["location"].startswith("Dask cluster")
    with urllib.request.urlopen(
        f"http://127.0.0.1:{port}/api/v1/health", timeout=PATIENCE_S
    ) as response:
        health = json.load(response)
    assert {part["name"]: part["state"] for part in health["parts"]} == dict.fromkeys(
        ("database", "dispatcher", "workers", "clock", "readers", "certificate"), "ok"
    )
    assert health["status"] == "ok"
    if Path("/proc/net/tcp6").exists():
        _check_loopback_only({int(pid) for pid in started["PIDS"].split()})


@pytest.fixture
def started(tmp_path: Path, postgresql: postgresql_server.Cluster) -> Iterator[dict[str, str]]:
    """Every service, started as in the file, on free ports."""
    inputs = {
        "DB_PASSWORD": "not-checked",
        "DB_PORT": str(postgresql.port),
        "DASK_PORT": str(find_free_port()),
        "PORT": str(find_free_port()),
    }
    found = services(inputs)
    assert set(found) == {"db", "certificate", "scheduler", "worker", "web", "backup"}
    name = postgresql.copy()
    running: list[subprocess.Popen[bytes]] = []
    try:
        while found:
            ready = next(
                n for n, s in found.items() if not set(s.get("depends_on", {})) & set(found)
            )
            service = found.pop(ready)
            environment = _environment(service, inputs, name, tmp_path)
            if ready == "db":  # the image does what the test cluster has done: create and start
                assert service["command"][0] == "postgres"
                environment |= {"PGPORT": inputs["DB_PORT"]}
            else:
                command = [_on_this_computer(part, tmp_path) for part in service["command"]]
                with (tmp_path / ready).open("w") as log:
                    running.append(
                        subprocess.Popen(
                            command, env=environment, cwd=tmp_path, stdout=log, stderr=log
                        )
                    )
            if "healthcheck" in service:
                _wait_until_healthy(ready, service["healthcheck"]["test"], environment, tmp_path)
            else:
                assert running.pop().wait(PATIENCE_S) == 0, (tmp_path / ready).read_text()
        yield inputs | {"PIDS": " ".join(str(process.pid) for process in running)}
    finally:
        for process in reversed(running):
            process.terminate()
        for process in reversed(running):
            process.wait(timeout=PATIENCE_S)
        postgresql.drop(name)


def services(inputs: dict[str, str]) -> dict[str, Any]:
    """Services of the file with ``${...}`` filled in, as a container engine does."""

    def fill(found: re.Match[str]) -> str:
        name, kind, text = found.groups()
        assert name in inputs or kind != "?", f"{name}: {text}"
        return inputs.get(name, text or "")

    lines = [line for line in COMPOSE.read_text().splitlines() if not line.startswith("#")]
    return YAML(typ="safe").load(INPUT.sub(fill, "\n".join(lines)))["services"]


def _on_this_computer(text: str, folder: Path) -> str:
    return text.replace("/certificates", str(folder)).replace("/backups", str(folder))


def _environment(
    service: dict[str, Any], inputs: dict[str, str], database: str, folder: Path
) -> dict[str, str]:
    own: dict[str, str] = service.get("environment", {})
    environment = {
        **os.environ,
        # Commands of the container are those of this environment.
        "PATH": os.pathsep.join(
            [
                str(Path(sys.executable).parent),
                str(postgresql_server.find_programs()),
                os.environ["PATH"],
            ]
        ),
        "PYTHONPATH": str(ROOT / "backend"),
        **{key: _on_this_computer(value, folder) for key, value in own.items()},
    }
    if "FLEXSID_DATABASE" in environment:
        address = environment["FLEXSID_DATABASE"]
        environment["FLEXSID_DATABASE"] = f"{address.rpartition('/')[0]}/{database}"
    return environment


def _wait_until_healthy(
    name: str, test: list[str], environment: dict[str, str], logs: Path
) -> None:
    kind, *command = (_on_this_computer(part, logs) for part in test)
    assert kind == "CMD"
    if name == "db":  # the test cluster has no such database
        command = [part for part in command if not part.startswith("--dbname")]
    deadline = time.monotonic() + PATIENCE_S
    while subprocess.run(command, env=environment, capture_output=True, check=False).returncode:
        log = logs / name
        assert time.monotonic() < deadline, log.read_text() if log.exists() else name
        time.sleep(0.2)
