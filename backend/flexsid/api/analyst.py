"""Name of the analyst of a request: of the account, or as set in a personal workbench."""

from __future__ import annotations

import unicodedata
from typing import Annotated
from urllib.parse import unquote

from fastapi import Depends, Header

from flexsid.errors import BadInput
from flexsid.storage.access import get_access
from flexsid.text import check_line

HEADER = "X-Flexsid-Analyst"
_LONGEST = 100


def read_name(sent: str) -> str:
    """Return a name as it is stored: NFKC normalised, no control characters, single blanks.

    Raises
    ------
    BadInput
        If the text is not a valid name.
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


_DESCRIPTION = "Name of the analyst, percent-encoded UTF-8; that of the account is used instead."


async def _get_analyst(
    name: Annotated[str, Header(alias=HEADER, description=_DESCRIPTION)] = "",
) -> str:
    return read_name(name)


async def _require_analyst(
    name: Annotated[str, Header(alias=HEADER, description=_DESCRIPTION)],
) -> str:
    known = read_name(name)
    if not known:
        raise BadInput(
            f"the name of the analyst is missing; set it in the workbench, or send it as {HEADER}",
            code="no-analyst",
        )
    return known


TheAnalyst = Annotated[str, Depends(_get_analyst)]
"""Name of the analyst of the request; empty if none is set."""

NamedAnalyst = Annotated[str, Depends(_require_analyst)]
"""Name of the analyst of the request; the request is refused if none is set."""


def choose_author(stated: str, analyst: str) -> str:
    """Return the author of a record: in a personal workbench as stated in the request.

    Raises
    ------
    BadInput
        If a request of an account states another author.
    """
    if get_access() is not None and stated not in ("", analyst):
        raise BadInput(
            f"the author is who is logged in, '{analyst}', not '{stated}'; omit the field",
            code="author-is-account",
        )
    return stated or analyst
