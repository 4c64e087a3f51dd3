"""DataFlash, the log of ArduPilot, through pymavlink, an extra (``pip install flexsid[mavlink]``).

Source: ArduPilot, libraries/AP_Logger/README.md. Every message has its own time stamps.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import NOT_READ, Field
from flexsid.units import AUTOPILOT_UNITS

_MAGIC = b"\xa3\x95\x80"  # of the first message, which defines the others
_TEXT = b"FMT,"
_CLOCK = "TimeUS"
_DEFINITIONS = {"FMT", "FMTU", "MULT", "UNIT"}
_SETTINGS = {"PARM": "parameters of the autopilot"}
_INSTANCE = "I"
"""Column of the number of a sensor in all messages that have one."""
_OTHER_INSTANCES = ("C", "Instance", "Inst")
"""Columns that are such a number in some messages: where stamps repeat without it."""
_MOST_INSTANCES = 16
_HEADER = 3  # bytes before the fields of a message
_NUMBERS = {
    **{"b": "i1", "B": "u1", "M": "u1", "g": "<f2", "h": "<i2", "H": "<u2", "i": "<i4"},
    **{"I": "<u4", "f": "<f4", "d": "<f8", "q": "<i8", "Q": "<u8"},
    **{"c": "<i2", "C": "<u2", "e": "<i4", "E": "<u4", "L": "<i4"},
}
_TEXTS = {"n": 4, "N": 16, "Z": 64, "a": 64}  # and arrays, with their sizes in bytes


def recognises(head: bytes) -> bool:
    """Return whether the file begins with the definition of a message."""
    return head.startswith((_MAGIC, _TEXT))


def read(path: Path) -> Iterator[Field]:
    """Read the fields of all messages, such as ``IMU.GyrY``; instances are ``IMU.1.GyrY``.

    Clocks are the time stamps of the messages, since the start of the autopilot.

    Raises
    ------
    UnreadableFile
        If the log is a text.
    """
    from pymavlink.DFReader import DFReader_binary

    with path.open("rb") as file:
        if file.read(len(_TEXT)) == _TEXT:
            raise UnreadableFile("the log is a text; download the binary log (.bin).")
    with open(os.devnull, "w") as discarded, contextlib.redirect_stderr(discarded):
        log: Any = DFReader_binary(str(path))
    try:
        content = np.frombuffer(log.data_map, dtype=np.uint8).copy()
        left: list[str] = []
        for number, message in sorted(log.formats.items()):
            starts = np.array(log.offsets[number], dtype=np.int64)
            starts = starts[starts + message.len <= content.size]
            if not starts.size or message.name in _DEFINITIONS:
                continue
            if message.name in _SETTINGS or _CLOCK not in message.columns:
                what = _SETTINGS.get(message.name, "messages without time stamps")
                left.append(f"{message.name}: {starts.size} {what}")
                continue
            rows = content[starts[:, None] + np.arange(_HEADER, message.len)]
            yield from _message(message, np.ascontiguousarray(rows), left)
        outside = content.size - sum(
            message.len * int((np.array(log.offsets[number]) <= content.size - message.len).sum())
            for number, message in log.formats.items()
        )
        if outside > 0:
            left.append(f"{outside} bytes outside messages: damage, or the end was cut off")
        if left:
            yield Field(NOT_READ, np.array(left))
    finally:
        log.close()


def _message(message: Any, rows: np.ndarray, left: list[str]) -> Iterator[Field]:
    """Yield the fields of a message; ``rows`` (n_messages, n_bytes) are without their headers."""
    fields: dict[str, np.ndarray] = {}
    start = 0
    for column, kind in zip(message.columns, message.msg_fmts, strict=True):
        size = _TEXTS.get(kind) or np.dtype(_NUMBERS[kind]).itemsize
        if kind in _NUMBERS:
            own = np.ascontiguousarray(rows[:, start : start + size])
            fields[column] = own.view(_NUMBERS[kind])[:, 0]
        else:
            left.append(f"{message.name}.{column}: {'arrays' if kind == 'a' else 'texts'}")
        start += size
    instance = message.instance_field or _find_instance(fields)
    instances = fields.pop(instance, None) if instance else None
    numbers = [None] if instances is None else sorted(set(instances.tolist()))
    for number in numbers:
        shown = message.name if number in (None, 0) else f"{message.name}.{number}"
        selected = slice(None) if instances is None else instances == number
        clock = f"{shown}.{_CLOCK}"
        yield Field(clock, fields[_CLOCK][selected].astype(np.float64) * 1e-6, "s")
        for index, column in enumerate(message.columns):
            if column in fields and column != _CLOCK:
                unit, factor = _find_unit(message, index)
                samples = fields[column][selected]
                scaled = samples if factor == 1.0 else samples * factor
                yield Field(f"{shown}.{column}", scaled, unit, clock)


def _find_instance(fields: dict[str, np.ndarray]) -> str | None:
    """Return the column that separates sensors of one message, if the log does not name it."""
    stamps = fields[_CLOCK].astype(np.int64)
    is_repeated = np.unique(stamps).size < stamps.size
    for name in (_INSTANCE, *_OTHER_INSTANCES):
        own = fields.get(name)
        if own is None or own.dtype.kind not in "iu":
            continue
        if not 2 <= np.unique(own).size <= _MOST_INSTANCES:
            continue
        pairs = np.unique(np.stack([stamps, own.astype(np.int64)]), axis=1).shape[1]
        if pairs == stamps.size and (is_repeated or name == _INSTANCE):
            return name
    return None


def _find_unit(message: Any, index: int) -> tuple[str, float]:
    """Return the unit of a column, and the factor of its numbers in this unit."""
    stated = "" if message.units is None else message.units[index]
    unit, factor = AUTOPILOT_UNITS.get(stated, (stated, 1.0))
    return unit, factor * (message.msg_mults[index] or 1.0)
