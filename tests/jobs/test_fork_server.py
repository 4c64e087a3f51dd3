"""Programs are forked from what their parent has loaded, and end as others do."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="other systems load programs anew")

# A process with one thread; that of a test has others.
PARENT = """
import json, os, signal, sys, threading, time, types
from flexsid.jobs.child import Program
from flexsid.jobs.fork_server import get_fork_server, start_fork_server

def main(arguments):
    connection, lifeline = map(int, arguments)
    answer = {"ppid": os.getppid(), "path": sys.path, "files": len(os.listdir("/proc/self/fd"))}
    os.write(connection, json.dumps(answer).encode())
    os.read(lifeline, 1)
    sys.exit(3)

loaded = types.ModuleType("loaded")
loaded.main = main
sys.modules["loaded"] = loaded

def ask(program):
    return json.loads(os.read(program.connection.fileno(), 100_000))
"""


def run_parent(folder: Path, program: str, **variables: str) -> Any:
    """Run statements in a process and return the result that they print."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        [sys.executable, "-c", PARENT + program],
        cwd=folder,
        env={**environment, **variables},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    return json.loads(done.stdout)


def test_how_a_forked_program_ended_is_known(tmp_path: Path) -> None:
    codes = run_parent(
        tmp_path,
        """
start_fork_server()
released, stopped, killed = [Program("loaded") for _ in range(3)]
parents = {ask(one)["ppid"] for one in (released, stopped, killed)}
assert len(parents) == 1 and os.getpid() not in parents  # not loaded anew
assert released.find_exit_code() is None
released.release_lifeline()
stopped.signal(signal.SIGTERM)
killed.kill()
print(json.dumps([one.find_exit_code() for one in (released, stopped, killed)]))
""",
    )
    assert codes == [3, -15, -9]


def test_a_forked_program_has_nothing_of_its_parent_but_its_pipes(tmp_path: Path) -> None:
    (tmp_path / "given").mkdir()
    answers = run_parent(
        tmp_path,
        """
held = [os.pipe() for _ in range(20)]
start_fork_server()
programs = [Program("loaded") for _ in range(3)]
print(json.dumps([ask(one) for one in programs]))
""",
        PYTHONPATH=str(tmp_path / "given"),
    )
    assert {one["files"] for one in answers} == {6}  # with the one that lists them
    for one in answers:
        assert not {"", str(tmp_path), str(tmp_path / "given")} & set(one["path"])


def test_the_fork_server_ends_with_its_parent(tmp_path: Path) -> None:
    server = run_parent(
        tmp_path,
        """
start_fork_server()
print(ask(Program("loaded"))["ppid"], flush=True)
os._exit(0)
""",
    )
    for _ in range(200):
        if not Path(f"/proc/{server}").exists():
            return
        subprocess.run(["sleep", "0.05"], check=True)
    pytest.fail("the fork server outlives its parent")


def test_a_program_is_loaded_anew_without_a_fork_server(tmp_path: Path) -> None:
    worker = """
program = Program("flexsid.jobs.worker")
parent = open(f"/proc/{program.pid}/stat").read().rpartition(")")[2].split()[1]
program.connection.close()
program._process.wait(30)
print(json.dumps([int(parent) == os.getpid(), program.find_exit_code()]))
"""
    with_threads = "threading.Thread(target=time.sleep, args=(60,), daemon=True).start()\n"
    ended = """
start_fork_server()
os.kill(ask(Program("loaded"))["ppid"], signal.SIGKILL)
"""
    assert run_parent(tmp_path, with_threads + "start_fork_server()" + worker) == [True, 0]
    assert run_parent(tmp_path, ended + worker) == [True, 0]
