"""Output of the commands: text or JSON on standard output, progress on standard error."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import orjson

from flexsid.errors import FlexsidError

_OPTIONS = orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z | orjson.OPT_SERIALIZE_NUMPY


def print_result(lines: Iterable[str], result: Any, *, as_json: bool) -> None:
    """Print the result of a command to standard output."""
    if as_json:
        print(orjson.dumps(result, option=_OPTIONS | orjson.OPT_INDENT_2).decode())
    else:
        for line in lines:
            print(line)


def print_next_result(line: str, result: Any, *, as_json: bool) -> None:
    """Print one of several results at once; as JSON one object per line."""
    print(orjson.dumps(result, option=_OPTIONS).decode() if as_json else line, flush=True)


def write_file(file: str | Path, content: bytes) -> None:
    """Write the output file of a command.

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


def print_error(message: str, code: str, *, as_json: bool) -> None:
    """Print an error to standard error."""
    if as_json:
        print(orjson.dumps({"code": code, "detail": message}).decode(), file=sys.stderr)
    else:
        print(f"flexsid: {message}", file=sys.stderr)


def print_written_file(text: str, result: Any, *, as_json: bool) -> None:
    """Report a file as JSON on standard output, or as text on standard error."""
    if as_json:
        print_result((), result, as_json=True)
    else:
        print(text, file=sys.stderr)


def show_progress(text: str, end: str = "") -> None:
    """Replace the last line of a terminal; a file receives nothing."""
    if sys.stderr.isatty():
        print(f"\r{text}", end=end, file=sys.stderr, flush=True)


def show_count(done: int, of: int, what: str) -> None:
    """Show on a terminal how many items are done."""
    bar = "█" * round(30 * done / max(of, 1))
    show_progress(f"{bar:<30} {done} of {of} {what:<40.40}", end="\n" if done == of else "")
