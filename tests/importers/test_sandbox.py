"""The reader process is stopped after its time limit, ends with its parent, and is reused."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from waiting import wait_until

from flexsid.errors import UnreadableFile
from flexsid.importers import jail, sandbox
from flexsid.jobs import health

KILLED_PARENT = """
import os, sys
from pathlib import Path
from flexsid.importers import sandbox
sandbox.read_all([Path(sys.argv[1])])
print(sandbox._idle[0]._process.pid, flush=True)
os.kill(os.getpid(), 9)
"""


@pytest.fixture
def record(tmp_path: Path) -> Path:
    path = tmp_path / "flight.csv"
    path.write_text("t,q\n" + "".join(f"{k / 100},{k}\n" for k in range(200_000)))
    return path


def test_reading_that_takes_too_long_is_stopped(
    record: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as changed:
        changed.setattr(sandbox, "SECONDS", 1e-4)
        changed.setattr(sandbox, "_BYTES_PER_SECOND", 1e12)
        with pytest.raises(UnreadableFile, match=r"flight\.csv: reading takes more than") as caught:
            sandbox.read_all([record])
    assert caught.value.code == "too-slow"
    assert sandbox.read_all([record]).numbers("q").size == 200_000


def test_time_that_other_programs_use_does_not_count(
    record: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sandbox, "SECONDS", 1.0)
    monkeypatch.setattr(sandbox, "_BYTES_PER_SECOND", 1e12)
    wait_for_line = sandbox._ReaderProcess._line

    def wait_while_stopped(reader: sandbox._ReaderProcess, seconds: float) -> bytes | None:
        if seconds != sandbox._SECONDS_TO_START:  # it reads
            group = reader._process.pid
            os.killpg(group, signal.SIGSTOP)
            threading.Timer(1.5, os.killpg, (group, signal.SIGCONT)).start()
        return wait_for_line(reader, seconds)

    monkeypatch.setattr(sandbox._ReaderProcess, "_line", wait_while_stopped)
    assert sandbox.read_all([record]).numbers("q").size == 200_000


def test_samples_outlive_the_file_they_were_mapped_from(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", q=np.arange(5.0), empty=np.zeros((0, 3)), name=np.array("NOM"))
    sources = sandbox.read_all([tmp_path / "a.npz"])
    (tmp_path / "a.npz").unlink()
    np.testing.assert_array_equal(sources.numbers("q"), np.arange(5.0))
    assert sources.items[0].arrays["empty"].shape == (0, 3)
    assert sources.texts("name") == ("NOM",)
    with pytest.raises(ValueError, match="read-only"):
        sources.items[0].arrays["q"][0] = 1.0


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="only Linux lists its processes there")
def test_the_reader_ends_with_its_parent(record: Path) -> None:
    command = [sys.executable, "-c", KILLED_PARENT, str(record)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    pid = int(ended.stdout)
    command_line = Path(f"/proc/{pid}/cmdline")

    def is_over() -> bool:
        try:  # a zombie process has an empty command
            return not command_line.read_bytes()
        except OSError:
            return True

    wait_until(is_over, "the end of the reader")


def test_a_file_that_crashes_a_library_is_refused_and_the_next_is_read(
    record: Path, tmp_path: Path
) -> None:
    path = tmp_path / "flight.mat"
    savemat(path, {"t": np.arange(200) / 50.0, "q": np.ones(200)})
    raw = bytearray(path.read_bytes())
    raw[177] = 36  # a type that does not exist; scipy 1.17 looks it up without a check
    path.write_bytes(raw)
    with pytest.raises(UnreadableFile, match=r"flight\.mat: "):
        sandbox.read_all([path])
    assert sandbox.read_all([record]).numbers("q").size == 200_000


def test_what_a_platform_lacks_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jail, "find_landlock_version", lambda: 0)
    monkeypatch.setattr(jail, "has_namespaces", lambda: False)
    monkeypatch.setattr(jail, "_has_filter", lambda: False)
    files, programs = jail.list_missing()
    assert "open other files" in files
    assert "start programs" in programs
    assert health.check_readers(is_shared=True).state is health.PartState.DEGRADED
    assert health.check_readers(is_shared=False).state is health.PartState.OK
    assert files in health.check_readers(is_shared=False).text
