"""What the environment decides."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

from flexsid.errors import BadInput

DEFAULT_DATABASE = "sqlite:///var/flexsid.db"
DEFAULT_PORT = 8000


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """Where the database is, which port serves the page, and the file reports are put into."""

    database: str = DEFAULT_DATABASE
    port: int = DEFAULT_PORT
    report_template: str | None = None


def read_settings(environment: Mapping[str, str] = os.environ) -> Settings:
    """Read ``FLEXSID_DATABASE`` and the like; what is not set has its default."""
    text = environment.get("FLEXSID_PORT") or str(DEFAULT_PORT)
    if not (text.isascii() and text.isdigit() and 0 < int(text) < 65536):
        raise BadInput(f"FLEXSID_PORT is {text!r}; expected a port number from 1 to 65535")
    return Settings(
        database=environment.get("FLEXSID_DATABASE") or DEFAULT_DATABASE,
        port=int(text),
        report_template=environment.get("FLEXSID_REPORT_TEMPLATE") or None,
    )
