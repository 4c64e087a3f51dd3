"""The compose file is valid, and the services it starts answer their health checks.

No engine is needed: each service's own command is started here, in the order of
``depends_on``, with PostgreSQL from the distribution's package.
"""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import postgresql as postgresql_server
import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
COMPOSE = ROOT / "docker-compose.yml"
PATIENCE_S = 90.0
INPUT = re.compile(r"\$\{(\w+)(?::([-?])([^}]*))?\}")


def test_the_compose_file_is_one() -> None:
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


def test_it_has_no_secret_of_its_own() -> None:
    with pytest.raises(AssertionError, match="DB_PASSWORD"):
        services({})


def test_nothing_but_loopback_is_published() -> None:
    for service in services({"DB_PASSWORD": "x"}).values():
        for port in service.get("ports", ()):
            assert port.startswith("127.0.0.1:")


def test_every_service_answers_its_own_health_check(started: dict[str, str]) -> None:
    port = started["PORT"]
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/v1/health", timeout=10) as answer:
        assert json.load(answer)["status"] == "ok"
    deadline = time.monotonic() + PATIENCE_S
    while True:
        address = f"http://127.0.0.1:{port}/api/v1/jobs/status"
        with urllib.request.urlopen(address, timeout=10) as answer:
            crew = json.load(answer)["crew"]
        if crew is not None and crew["workers"] == 1:
            break
        assert time.monotonic() < deadline, crew
        time.sleep(0.2)
    assert crew["place"].startswith("Dask cluster")


@pytest.fixture
def started(tmp_path: Path, postgresql: postgresql_server.Cluster) -> Iterator[dict[str, str]]:
    """Every service, started as the file says, on ports that are free here."""
    inputs = {
        "DB_PASSWORD": "not-looked-at",
        "DB_PORT": str(postgresql.port),
        "DASK_PORT": str(_free_port()),
        "PORT": str(_free_port()),
    }
    found = services(inputs)
    assert set(found) == {"db", "scheduler", "worker", "web"}
    name = postgresql.copy()
    running: list[subprocess.Popen[bytes]] = []
    try:
        while found:
            ready = next(
                n for n, s in found.items() if not set(s.get("depends_on", {})) & set(found)
            )
            service = found.pop(ready)
            environment = _environment(service, inputs, name)
            if ready == "db":  # its image does what our cluster has done: make and start
                assert service["command"][0] == "postgres"
                environment |= {"PGPORT": inputs["DB_PORT"]}
            else:
                command = [inputs["DASK_PORT"] if p == "8786" else p for p in service["command"]]
                with (tmp_path / ready).open("w") as log:
                    running.append(
                        subprocess.Popen(
                            command, env=environment, cwd=tmp_path, stdout=log, stderr=log
                        )
                    )
            _wait_until_healthy(ready, service["healthcheck"]["test"], environment, tmp_path)
        yield inputs
    finally:
        for process in reversed(running):
            process.terminate()
        for process in reversed(running):
            process.wait(timeout=30)
        postgresql.drop(name)


def services(inputs: dict[str, str]) -> dict[str, Any]:
    """Services of the file with ``${...}`` filled in, as an engine does it."""

    def fill(found: re.Match[str]) -> str:
        name, kind, text = found.groups()
        assert name in inputs or kind != "?", f"{name}: {text}"
        return inputs.get(name, text or "")

    lines = [line for line in COMPOSE.read_text().splitlines() if not line.startswith("#")]
    return YAML(typ="safe").load(INPUT.sub(fill, "\n".join(lines)))["services"]


def _needs(service: dict[str, Any]) -> set[str]:
    return set(service.get("depends_on", {}))


def _environment(service: dict[str, Any], inputs: dict[str, str], database: str) -> dict[str, str]:
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
        **service.get("environment", {}),
    }
    if "DASK_SCHEDULER_ADDRESS" in environment:
        environment["DASK_SCHEDULER_ADDRESS"] = f"tcp://127.0.0.1:{inputs['DASK_PORT']}"
    if "FLEXSID_DATABASE" in environment:
        address = environment["FLEXSID_DATABASE"]
        environment["FLEXSID_DATABASE"] = f"{address.rpartition('/')[0]}/{database}"
    return environment


def _wait_until_healthy(
    name: str, test: list[str], environment: dict[str, str], logs: Path
) -> None:
    kind, *command = test
    assert kind == "CMD"
    if name == "db":  # our cluster has no such database
        command = [part for part in command if not part.startswith("--dbname")]
    deadline = time.monotonic() + PATIENCE_S
    while subprocess.run(command, env=environment, capture_output=True, check=False).returncode:
        log = logs / name
        assert time.monotonic() < deadline, log.read_text() if log.exists() else name
        time.sleep(0.2)


def _free_port() -> int:
    with closing(socket.socket()) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
