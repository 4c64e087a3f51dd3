"""The compose file is valid, and what it starts answers its own health check."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
COMPOSE = ROOT / "docker-compose.yml"


def test_the_compose_file_is_one():
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


def test_the_service_answers_its_own_health_check(tmp_path):
    service = YAML(typ="safe").load(COMPOSE.read_text())["services"]["web"]
    environment = {
        **os.environ,
        # Commands of the container are those of this environment.
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
        **service["environment"],
        "FLEXSID_DATABASE": f"sqlite:///{tmp_path / 'flexsid.db'}",
        "FLEXSID_PORT": str(_free_port()),
    }
    with (tmp_path / "log").open("w") as log:
        server = subprocess.Popen(
            service["command"], env=environment, cwd=tmp_path, stdout=log, stderr=log
        )
        try:
            healthy = _becomes_healthy(service["healthcheck"]["test"], environment, server)
        finally:
            server.terminate()
            server.wait(timeout=20)
    assert healthy, (tmp_path / "log").read_text()


def _becomes_healthy(
    test: list[str], environment: dict[str, str], server: subprocess.Popen[bytes]
) -> bool:
    kind, *command = test
    assert kind == "CMD"
    for _ in range(120):
        if server.poll() is not None:
            return False
        done = subprocess.run(command, env=environment, capture_output=True, check=False)
        if done.returncode == 0:
            return True
        time.sleep(0.2)
    return False


def _free_port() -> int:
    with closing(socket.socket()) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
