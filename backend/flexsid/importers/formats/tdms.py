"""TDMS, the files of LabVIEW and DIAdem, through npTDMS, an extra (``pip install flexsid[tdms]``).

Format: NI, TDMS File Format Internal Structure. A channel that is a waveform has its own clock.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import NOT_READ, Field

if TYPE_CHECKING:
    from nptdms import TdmsChannel

_START, _OFFSET, _STEP = "wf_start_time", "wf_start_offset", "wf_increment"
"""Properties of a waveform: moment, and seconds from it to the first sample and between samples."""


def recognises(head: bytes) -> bool:
    """Return whether the file begins with a segment of TDMS."""
    return head.startswith(b"TDSm")


def read(path: Path) -> Iterator[Field]:
    """Read all channels, such as ``run.q``, scaled, with the unit of ``unit_string``.

    Clocks of waveforms count from the first moment at which one of them starts; the waveforms of a
    group that have the same one share ``run.time``.

    Raises
    ------
    UnreadableFile
        If a channel has no name.
    """
    from nptdms import TdmsFile

    logging.getLogger("nptdms").setLevel(logging.CRITICAL)
    left: list[str] = []
    with TdmsFile.open(path) as file:
        channels = [channel for group in file.groups() for channel in group.channels()]
        names = {f"{one.group_name}.{one.name}" for one in channels}
        clocks: dict[tuple[str, int, float, float], str] = {}
        starts = [one.properties[_START] for one in channels if _START in one.properties]
        zero = min(starts, default=None)
        for channel in channels:
            if not channel.name:
                raise UnreadableFile(f"a channel of group '{channel.group_name}' has no name.")
            name = f"{channel.group_name}.{channel.name}"
            if not len(channel):
                left.append(f"{name}: empty")
                continue
            samples = np.asarray(channel[:])
            if samples.dtype.kind in "OSU":
                left.append(f"{name}: texts")
                continue
            own = _describe_clock(channel, zero)
            if own is not None and own not in clocks:
                shared = f"{channel.group_name}.time"
                is_taken = shared in names or shared in clocks.values()
                clocks[own] = f"{name}.time" if is_taken else shared
                *_, start, step = own
                yield Field(clocks[own], start + step * np.arange(samples.size), "s")
            unit = str(channel.properties.get("unit_string", "")).strip()
            yield Field(name, samples, unit, clocks[own] if own else "")
        if file.file_status.incomplete_final_segment:
            left.append("the file ends within a segment: what follows is missing")
    if left:
        yield Field(NOT_READ, np.array(left))


def _describe_clock(
    channel: TdmsChannel, zero: np.datetime64 | None
) -> tuple[str, int, float, float] | None:
    """Return group, number of samples, start and step [s] of a waveform; None for another one."""
    stated = channel.properties
    step = float(stated.get(_STEP, 0.0))
    if not step > 0.0:
        return None
    start = float(stated.get(_OFFSET, 0.0))
    if _START in stated:
        start += float((stated[_START] - zero) / np.timedelta64(1, "s"))
    return channel.group_name, len(channel), start, step
