"""Credentials of brokers, by name, from a file of the server.

Streams have their names only: neither the database nor a response, a message or a log has a
secret.
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Any

from pydantic import PlainValidator, ValidationInfo, WithJsonSchema

from flexsid.errors import BadInput


@dataclass(frozen=True, slots=True, kw_only=True)
class Credentials:
    """What a receiver logs in with at the broker ``server``; empty where none are needed."""

    server: str = ""
    user: str = ""
    password: str = field(default="", repr=False)
    token: str = field(default="", repr=False)


def read_credentials(file: Path | None) -> dict[str, Credentials]:
    """Read the credentials by name, from tables of TOML.

    A table has the ``server`` and either ``user`` and ``password``, or ``token``.

    Raises
    ------
    BadInput
        If the file cannot be read, or has something else; its contents are not cited.
    """
    if file is None:
        return {}
    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a TOML file"
        raise BadInput(
            f"FLEXSID_CREDENTIALS is {file}, which cannot be read: {reason}", code="bad-credentials"
        ) from None
    known = {one.name for one in fields(Credentials)}
    for name, table in tables.items():
        is_table = isinstance(table, dict) and all(isinstance(v, str) for v in table.values())
        if not is_table or not {"server"} <= table.keys() <= known:
            raise BadInput(
                f"credentials '{name}' in {file}: expected a table with the text server, the "
                "address of the broker, and user and password, or token",
                code="bad-credentials",
            )
    return {name: Credentials(**table) for name, table in tables.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class BrokerAccess:
    """Credentials by name, and addresses of the other brokers that are allowed (None: any)."""

    credentials: Mapping[str, Credentials] = field(default_factory=dict)
    brokers: Collection[str] | None = None


def get_access(info: ValidationInfo) -> BrokerAccess:
    """Return what the server allows where options are validated."""
    return info.context or BrokerAccess()


def _look_up(name: Any, info: ValidationInfo) -> Credentials:
    """Replace a name by the credentials that the server has under it."""
    known = get_access(info).credentials
    if name == "":
        return Credentials()
    if not isinstance(name, str) or name not in known:
        has = f"has {', '.join(sorted(known))}" if known else "has none (FLEXSID_CREDENTIALS)"
        raise ValueError(f"there are no credentials of this name; the server {has}")
    return known[name]


NamedCredentials = Annotated[
    Credentials, PlainValidator(_look_up), WithJsonSchema({"type": "string"})
]
"""Option of a receiver: the name of credentials; the validated option has the credentials."""
