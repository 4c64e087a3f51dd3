"""Whatever code runs where a file is read, it reaches that file and nothing else."""

from __future__ import annotations

import json
import platform
import socket
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import shipped
from shipped import Client, ask_command
from vendor_package import install_package, serving_by

ENTRY = '[project.entry-points."flexsid.importers"]\nattack = "vendor:ATTACK"'
MODULE = """
import ctypes, json, os, resource, socket, subprocess, sys, tempfile, threading
from pathlib import Path
import numpy as np
from flexsid.importers.formats.readers import FileFormat
from flexsid.importers.source import Field

def start_thread():
    thread = threading.Thread(target=int)
    thread.start()
    thread.join()

def write_temporary():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "one").write_text("a")
    with tempfile.TemporaryFile() as file:
        file.write(b"a")

def check(result):
    if result < 0:
        raise OSError

known = []

def read(path):
    order = json.loads(path.read_text())
    if "remember" in order:
        yield Field("later" if known else "first", np.zeros(3))
        known.append(path)
        return
    secret, others, port, parent = order["secret"], order["folder"], order["port"], os.getppid()
    outside = Path(others, "outside")
    C = ctypes.CDLL(None)
    attempts = {
        "open another file": lambda: Path(secret).read_text(),
        "open the database": lambda: Path(order["database"]).open("rb"),
        "open a system file": lambda: Path("/etc/passwd").read_text(),
        "open the environment of the server": lambda: Path(f"/proc/{parent}/environ").read_bytes(),
        "open the memory of its parent": lambda: Path(f"/proc/{parent}/mem").open("rb"),
        "see another file in a folder": lambda: os.listdir(others).index("flexsid.db"),
        "link another file": lambda: os.link(secret, "linked"),
        "rename another file": lambda: os.rename(secret, "renamed"),
        "connect": lambda: socket.create_connection(("127.0.0.1", port), 5.0),
        "connect to a server of the system": lambda: socket.socket(socket.AF_UNIX),
        "fork": lambda: os.fork() or os._exit(0),
        "fork by another call": lambda: os.posix_spawn("/bin/true", ["true"], {}),
        "exec": lambda: os.execv(sys.executable, ["python", "-c", "0"]),
        "start a program": lambda: subprocess.run(["/bin/true"]),
        "write outside": lambda: outside.write_text("a"),
        "write into its input": lambda: path.open("r+b"),
        "write into the installation": lambda: Path(__file__).open("a"),
        "truncate": lambda: os.truncate(secret, 0),
        "change permissions": lambda: os.chmod(secret, 0o777),
        "delete": lambda: Path(secret).unlink(),
        "signal": lambda: os.kill(parent, 0),
        "trace": lambda: check(C.ptrace(16, parent, None, None)),
        "open a ring of system calls": lambda: check(C.syscall(425, 1, bytes(120))),
        "write a large file": lambda: Path("large").open("wb").truncate(1 << 40),
        "raise a limit": lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (9999, 9999)),
        "see a variable of the server": lambda: os.environ["A_SECRET"],
        "start a thread": start_thread,
        "write temporary files": write_temporary,
        "open its input": path.read_bytes,
        "open many files": lambda: [os.pipe() for _ in range(1000)],
    }
    for name, attempt in attempts.items():
        try:
            attempt()
        except Exception:
            continue
        yield Field(name, np.zeros(3))
    yield Field("end", np.zeros(3))

ATTACK = FileFormat(
    name="attack", suffixes=(".attack",), recognises=lambda head: head[:1] == b"{", read=read
)
"""
NEEDED = ["start a thread", "write temporary files", "open its input", "end"]

pytestmark = pytest.mark.skipif(
    sys.platform != "linux" or platform.machine() not in ("x86_64", "aarch64"),
    reason="this platform has no jail, which `flexsid check` reports",
)


REFUSING = """
import ctypes, struct
C = ctypes.CDLL(None)
rows = [(0x20, 0, 0, 0)]
for number in {calls}:
    rows += [(0x15, 0, 1, number), (0x06, 0, 0, 0x00050000 | 38)]
rows.append((0x06, 0, 0, 0x7FFF0000))
code = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *row) for row in rows))
C.prctl(38, 1, 0, 0, 0)
assert C.prctl(22, 2, struct.pack("@HP", len(rows), ctypes.addressof(code)), 0, 0) == 0
"""
"""Refuses system calls from now on, as a kernel without them does."""

LANDLOCK, UNSHARE = 444, {"x86_64": 272, "aarch64": 97}.get(platform.machine(), 0)


def refuse_calls(program: Path, *calls: int) -> Path:
    """Return a program for which the platform lacks system calls."""
    first, _, rest = program.read_text().partition("\n")
    lacking = program.with_name(f"flexsid-without-{'-'.join(map(str, calls))}")
    lacking.write_text(f"{first}\n{REFUSING.format(calls=calls)}{rest}")
    lacking.chmod(0o755)
    return lacking


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("jail")
    return install_package(folder, ENTRY, MODULE), folder


@pytest.fixture(scope="module", params=["Landlock", "namespaces"])
def served(
    request: pytest.FixtureRequest, installed: tuple[Path, Path]
) -> Iterator[tuple[Client, Path]]:
    program, folder = installed
    if request.param == "namespaces":
        program = refuse_calls(program, LANDLOCK)
    with serving_by(program, folder, f"sqlite:///{folder / 'flexsid.db'}", A_SECRET="x") as client:
        yield client, folder


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    file = tmp_path / "secret"
    file.write_text("secret")
    return file


def test_a_reader_reaches_only_its_input(
    served: tuple[Client, Path], secret: Path, tmp_path: Path
) -> None:
    client, folder = served
    order = tmp_path / "flight.attack"
    with socket.create_server(("127.0.0.1", 0)) as listening:
        values = {
            "secret": str(secret),
            "folder": str(folder),
            "database": str(folder / "flexsid.db"),
            "port": listening.getsockname()[1],
        }
        order.write_text(json.dumps(values))
        found = client.upload(order)
    assert [field["field"] for field in found["fields"]] == NEEDED
    assert secret.read_text() == "secret"
    assert not (folder / "outside").exists()


def test_a_reader_leaves_nothing_to_the_next_import(
    served: tuple[Client, Path], tmp_path: Path
) -> None:
    """Code of one file cannot change how the next one is read."""
    client, _ = served
    order = tmp_path / "flight.attack"
    order.write_text('{"remember": 1}')
    seen = [[one["field"] for one in client.upload(order)["fields"]] for _ in range(2)]
    assert seen == [["first"], ["first"]]


def test_check_names_what_the_platform_lacks(
    installed: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    program, folder = installed
    monkeypatch.setattr(shipped, "PROGRAM", refuse_calls(program, LANDLOCK, UNSHARE))
    checked = ask_command(folder, f"sqlite:///{folder / 'flexsid.db'}", "check")
    (text,) = (one["text"] for one in checked["warnings"] if one["code"] == "reader-not-confined")
    assert "Landlock is missing" in text


def test_check_and_health_state_that_nothing_is_missing(served: tuple[Client, Path]) -> None:
    client, folder = served
    parts = {part["name"]: part for part in client.get("health")["parts"]}
    checked = ask_command(folder, f"sqlite:///{folder / 'flexsid.db'}", "check")
    notes = [one["code"] for one in checked["warnings"]]
    is_confined = parts["readers"]["text"] == "Open nothing but the uploaded files."
    assert is_confined == ("reader-not-confined" not in notes)
