"""Process identifiers that are unique across hosts, containers and restarts."""

from __future__ import annotations

import os
import socket
from pathlib import Path


def get_process_id() -> str:
    """Return host, PID namespace, PID and start time of this process."""
    return " ".join((*_get_namespace(), str(os.getpid()), _read_start_time(os.getpid())))


def is_gone(process_id: str | None) -> bool:
    """Return whether a process is known to have ended; False if that is unknown."""
    if process_id is None:
        return True
    *namespace, number, started = process_id.split(" ")
    if tuple(namespace) != _get_namespace():
        return False
    return _read_start_time(int(number)) != started


def shorten_process_id(process_id: str) -> str:
    """Return host and PID of a process, for display."""
    host, _, number, _ = process_id.split(" ")
    return f"{host}/{number}"


def _get_namespace() -> tuple[str, str]:
    try:
        pid_namespace = os.readlink("/proc/self/ns/pid")
    except OSError:
        pid_namespace = "-"
    return socket.gethostname().replace(" ", "-"), pid_namespace


def _read_start_time(process: int) -> str:
    """Return the start time of a process, since PIDs are reused; empty if it has ended."""
    try:
        # The name of the program, in parentheses, may contain any character.
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return _check_process(process)
    return "" if fields[0] in "ZX" else fields[19]


def _check_process(process: int) -> str:
    try:
        os.kill(process, 0)
    except (OSError, OverflowError):
        return ""
    return "-" if not Path("/proc/self/stat").exists() else ""
