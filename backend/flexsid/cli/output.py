"""Arguments that several commands read, and output as text or JSON."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO, TypeVar

import orjson

from flexsid.errors import BadInput, FlexsidError

# --- Output of the commands: text or JSON on standard output, progress on standard error ----------

_OPTIONS = orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z | orjson.OPT_SERIALIZE_NUMPY


def print_result(lines: Iterable[str], result: Any, *, as_json: bool) -> None:
    """Print the result of a command to standard output."""
    if as_json:
        _print(orjson.dumps(result, option=_OPTIONS | orjson.OPT_INDENT_2).decode())
    else:
        for line in lines:
            _print(line)


def print_next_result(line: str, result: Any, *, as_json: bool) -> None:
    """Print one of several results at once; as JSON one object per line."""
    _print(orjson.dumps(result, option=_OPTIONS).decode() if as_json else line)
    flush_output()


def _print(line: str) -> None:
    with _writing_output():
        print(line)


def flush_output() -> int:
    """Write what is buffered, and return 0.

    The interpreter does so at its end, where a failure can no longer be handled.

    Raises
    ------
    BrokenPipeError
        If the reader has closed the output.
    FlexsidError
        If it cannot be written.
    """
    with _writing_output():
        print(end="", flush=True)
    return 0


def discard_output() -> None:
    """Discard what is buffered, and what is still written, of the output and of errors."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:  # closed by the shell
            _discard(stream)


def _discard(stream: TextIO) -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@contextmanager
def _writing_output() -> Iterator[None]:
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        _discard(sys.stdout)
        raise FlexsidError(
            f"the output cannot be written: {error.strerror}", code="not-written"
        ) from error


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


# --- Values of arguments that several commands read -----------------------------------------------

T = TypeVar("T")


def parse_list(text: str, kind: Callable[[str], T], option: str) -> tuple[T, ...]:
    """Parse a comma-separated list."""
    try:
        return tuple(kind(part.strip()) for part in text.split(",") if part.strip())
    except ValueError as error:
        raise BadInput(f"{option} is {text!r}; expected numbers separated by commas") from error


def parse_band(text: str | None) -> tuple[float, float] | None:
    """Parse two frequencies in Hz."""
    if text is None:
        return None
    limits = parse_list(text, float, "--band")
    if len(limits) != 2:
        raise BadInput(f"--band is {text!r}; expected two frequencies, e.g. 0.5,12")
    return limits[0], limits[1]
