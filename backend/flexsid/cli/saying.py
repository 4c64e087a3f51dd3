"""What a command answers: lines for people, or JSON for programs; progress beside it."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import orjson

from flexsid.errors import FlexsidError

_OPTIONS = orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z | orjson.OPT_SERIALIZE_NUMPY


def say(lines: Iterable[str], answer: Any, *, as_json: bool) -> None:
    """Print an answer to standard output."""
    if as_json:
        print(orjson.dumps(answer, option=_OPTIONS | orjson.OPT_INDENT_2).decode())
    else:
        for line in lines:
            print(line)


def say_next(line: str, answer: Any, *, as_json: bool) -> None:
    """Print one of many answers as soon as it is there; as JSON one object per line."""
    print(orjson.dumps(answer, option=_OPTIONS).decode() if as_json else line, flush=True)


def write_file(file: str | Path, content: bytes) -> None:
    """Write what a command made.

    Raises
    ------
    FlexsidError
        If the file cannot be written.
    """
    try:
        Path(file).write_bytes(content)
    except OSError as error:
        raise FlexsidError(
            f"{file} cannot be written: {error.strerror}", code="not-written"
        ) from error


def complain(message: str, code: str, *, as_json: bool) -> None:
    """Print what went wrong to standard error."""
    if as_json:
        print(orjson.dumps({"code": code, "detail": message}).decode(), file=sys.stderr)
    else:
        print(f"flexsid: {message}", file=sys.stderr)


def show_share(done: int, of: int, what: str) -> None:
    """Tell how many of many are done, to somebody who watches."""
    if sys.stderr.isatty():
        bar = "█" * round(30 * done / max(of, 1))
        end = "\n" if done == of else ""
        line = f"\r{bar:<30} {done} of {of} {what:<40.40}"
        print(line, end=end, file=sys.stderr, flush=True)
