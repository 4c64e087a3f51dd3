"""Place: which process this is, in words that a process elsewhere can check."""

from __future__ import annotations

import os
import socket
from pathlib import Path


def this_process() -> str:
    """Name of this process: host, its numbering of processes, number, and start."""
    return " ".join((*_here(), str(os.getpid()), _started(os.getpid())))


def is_gone(place: str | None) -> bool:
    """Whether a process is known not to be there any more; False where that cannot be told."""
    if place is None:
        return True
    *where, number, started = place.split(" ")
    if tuple(where) != _here():
        return False
    return _started(int(number)) != started


def short(place: str) -> str:
    """Host and number of a process, for people."""
    host, _, number, _ = place.split(" ")
    return f"{host}/{number}"


def _here() -> tuple[str, str]:
    try:
        numbering = os.readlink("/proc/self/ns/pid")
    except OSError:
        numbering = "-"
    return socket.gethostname().replace(" ", "-"), numbering


def _started(process: int) -> str:
    """When a process started, for its number may be another's by now; empty if there is none."""
    try:
        # The name of the program, in parentheses, may hold anything.
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return _alive(process)
    return "" if fields[0] in "ZX" else fields[19]


def _alive(process: int) -> str:
    try:
        os.kill(process, 0)
    except (OSError, OverflowError):
        return ""
    return "-" if not Path("/proc/self/stat").exists() else ""
