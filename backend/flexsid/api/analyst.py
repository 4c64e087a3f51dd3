"""Who asks: the name that the local analyst has set, which nobody has verified."""

from __future__ import annotations

import unicodedata
from typing import Annotated
from urllib.parse import unquote

from fastapi import Depends, Header

from flexsid.errors import BadInput
from flexsid.text import check_line

HEADER = "X-Flexsid-Analyst"
_LONGEST = 100


def read_name(sent: str) -> str:
    """Return a name as it is kept: one spelling, no control characters, single blanks.

    Raises
    ------
    BadInput
        If it is no name.
    """
    try:
        text = unquote(sent, errors="strict")
    except UnicodeDecodeError as error:
        raise BadInput(f"{HEADER} is not UTF-8, percent-encoded", code="bad-analyst") from error
    name = " ".join(unicodedata.normalize("NFKC", text).split())
    try:
        return check_line(name, _LONGEST)
    except ValueError as error:
        raise BadInput(f"{HEADER} {error}", code="bad-analyst") from error


_DESCRIPTION = "Name of the analyst, percent-encoded UTF-8; nobody verifies it."


async def _analyst(
    name: Annotated[str, Header(alias=HEADER, description=_DESCRIPTION)] = "",
) -> str:
    return read_name(name)


async def _named_analyst(
    name: Annotated[str, Header(alias=HEADER, description=_DESCRIPTION)],
) -> str:
    known = read_name(name)
    if not known:
        raise BadInput(
            f"this is kept with a name: set yours in the workbench, or send it as {HEADER}",
            code="no-analyst",
        )
    return known


TheAnalyst = Annotated[str, Depends(_analyst)]
"""Name of who asks; empty where none is set."""

NamedAnalyst = Annotated[str, Depends(_named_analyst)]
"""Name of who asks; refused where none is set."""
