"""Text: validation of names and notes, and escaping for other formats."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence

from flexsid.errors import BadInput

LONGEST_NAME = 200
"""Characters of a name, a label or a title."""

LONGEST_NOTE = 10_000
"""Characters of a note, a comment or a description."""

LONGEST_TEXT = 128 * 1024
"""Characters of a mapping or a deck.

Even with every character escaped in JSON, such a text stays below the limit of a body.
"""

LONGEST_FIELD = 500
"""Characters of the path of a field in a file."""

LARGEST_ID = 2**31 - 1
"""Largest id: that of an integer column of PostgreSQL."""

_INVISIBLE = (
    "\u2028-\u2029"  # separators of lines and paragraphs
    "\u202a-\u202e\u2066-\u2069"  # embeddings, overrides and isolates of direction
    "\u00ad\u180e\u200b\u2060-\u2065\u206a-\u206f\ufeff\ufff9-\ufffb"  # characters without width
    "\U000e0000-\U000e007f"  # tags
    "\ud800-\udfff\ufdd0-\ufdef\ufffe\uffff"  # surrogates and what is no character
)
# Joiners and marks of direction are needed to write Persian, Hebrew and Arabic.
_NOT_IN_A_LINE = re.compile(f"[\x00-\x1f\x7f-\x9f{_INVISIBLE}]")
_NOT_IN_LINES = re.compile(f"[\x00-\x08\x0b-\x1f\x7f-\x9f{_INVISIBLE}]")

_FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")


def check_line(text: str, longest: int = LONGEST_NAME) -> str:
    """Return a name or label in one spelling (NFC).

    Raises
    ------
    ValueError
        If it is too long, nothing but blanks, or holds a line break, a control character, an
        override of the writing direction or another invisible character.
    """
    return _check(text, _NOT_IN_A_LINE, longest)


def check_lines(text: str, longest: int = LONGEST_NOTE) -> str:
    """Return a note in one spelling (NFC); it may hold line breaks and tabs.

    Raises
    ------
    ValueError
        As ``check_line``.
    """
    return _check(text.replace("\r\n", "\n"), _NOT_IN_LINES, longest)


def _check(text: str, unwanted: re.Pattern[str], longest: int) -> str:
    if len(text) > longest:
        raise ValueError(f"has {len(text)} characters; at most {longest} are accepted")
    found = unwanted.search(text)
    if found is not None:
        code = ord(found.group())
        name = unicodedata.name(found.group(), "control character")
        raise ValueError(
            f"holds the character U+{code:04X} ({name.lower()}) at place {found.start() + 1}; "
            "write it with visible characters"
        )
    if text and not text.strip():
        raise ValueError("holds nothing but blanks; delete it or write a name")
    return unicodedata.normalize("NFC", text)


def escape_spreadsheet_cell(text: str) -> str:
    """Escape text that a spreadsheet would evaluate as a formula.

    Notes
    -----
    A quotation mark before ``= + - @`` and control characters, as OWASP's "CSV injection" advises.
    """
    return f"'{text}" if text.startswith(_FORMULA) or text.lstrip()[:1] in _FORMULA else text


def one_line(text: str) -> str:
    """Return text on one line, without control characters."""
    return " ".join(_NOT_IN_A_LINE.sub(" ", text).split())


def join_names(names: Sequence[str], most: int = 6) -> str:
    """Join names by commas; of many the first ones, and the number of the others."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def count_noun(count: int, noun: str) -> str:
    """Return a count with its noun in the singular or plural."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def make_c_identifiers(names: tuple[str, ...], longest: int = 48) -> tuple[str, ...]:
    """Make unique identifiers of C and MATLAB from names: letters of ASCII, digits, ``_``."""
    made: list[str] = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
        if not plain[:1].isalpha():
            plain = f"u_{plain}"
        plain = plain[:longest]
        number, own = 2, plain
        while own in made:
            own, number = f"{plain[: longest - 4]}_{number}", number + 1
        made.append(own)
    return tuple(made)


def split_names(text: str | None) -> tuple[str, ...] | None:
    """Parse names separated by commas; None if none are given."""
    if text is None:
        return None
    return tuple(name for name in (part.strip() for part in text.split(",")) if name) or None


def read_id(text: str) -> int | None:
    """Return the id that a text is; None if it is not in the one form of ids.

    Whoever checks an id and whoever reads it then mean the same record: `01`, `+1`, `1.0` and `1_0`
    are no ids.
    """
    found = int(text) if re.fullmatch("[1-9][0-9]{0,19}", text) else None
    return found if found is not None and found <= LARGEST_ID else None


def split_ids(text: str | None, field: str) -> tuple[int, ...]:
    """Parse ids separated by commas."""
    ids: list[int] = []
    for part in split_names(text) or ():
        found = read_id(part)
        if found is None:
            raise BadInput(f"{field}: {part!r} is not an id; give numbers separated by commas")
        ids.append(found)
    return tuple(ids)
