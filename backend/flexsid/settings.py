"""Settings from environment variables."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

from flexsid.errors import BadInput

DEFAULT_DATABASE = "sqlite:///var/flexsid.db"
DEFAULT_PORT = 8000


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Address of the database, port of the web server, number of worker processes.

    ``dask`` is the address of a scheduler; without it ``workers`` local
    processes compute (None: one less than the number of cores). Reports use the file
    ``report_template``.
    """

    database: str = DEFAULT_DATABASE
    port: int = DEFAULT_PORT
    dask: str | None = None
    workers: int | None = None
    report_template: str | None = None


def read_settings(environment: Mapping[str, str] = os.environ) -> Settings:
    """Read the variables ``FLEXSID_...``; unset ones have their defaults."""
    port = _number(environment, "FLEXSID_PORT", "a port number", 65535)
    return Settings(
        database=environment.get("FLEXSID_DATABASE") or DEFAULT_DATABASE,
        port=DEFAULT_PORT if port is None else port,
        dask=environment.get("FLEXSID_DASK") or None,
        workers=_number(environment, "FLEXSID_WORKERS", "a number of processes", 256),
        report_template=environment.get("FLEXSID_REPORT_TEMPLATE") or None,
    )


def _number(environment: Mapping[str, str], name: str, what: str, most: int) -> int | None:
    text = environment.get(name)
    if not text:
        return None
    if not (text.isascii() and text.isdigit() and 0 < int(text[:9]) <= most):
        raise BadInput(f"{name} is {text!r}; expected {what} from 1 to {most}")
    return int(text)
