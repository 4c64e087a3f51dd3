"""MDF3 and MDF4, the measurement files of recorders, through asammdf, an extra.

``pip install flexsid[mdf]``. Every group of channels has its own clock.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from flexsid.errors import UnreadableFile
from flexsid.importers.source import NOT_READ, Field

_FORMULA = {3: 10, 4: 3}
"""Number of the conversion by a formula; a text from a file is not evaluated."""


def recognises(head: bytes) -> bool:
    """Return whether the file has the magic number of MDF."""
    return head.startswith(b"MDF ")


def read(path: Path) -> Iterator[Field]:
    """Read every channel with its unit and the clock of its group.

    A name that several groups have is followed by ``@`` and the number of the
    group; clocks are called ``time``, ``time@2``, ...

    Raises
    ------
    UnreadableFile
        If a channel is computed by a formula.
    """
    from asammdf import MDF

    logging.getLogger("asammdf").setLevel(logging.CRITICAL)
    with MDF(path, raise_on_multiple_occurrences=False) as file:
        counts = Counter(channel.name for group in file.groups for channel in group.channels)
        version = int(str(file.version)[0])
        left: list[str] = []
        for number, group in enumerate(file.groups, start=1):
            yield from _group(file, group, number, version, counts, left)
        if left:
            yield Field(NOT_READ, np.array(left))


def _group(
    file: Any, group: Any, number: int, version: int, counts: Counter[str], left: list[str]
) -> Iterator[Field]:
    master = file.masters_db.get(number - 1)
    n_samples = int(group.channel_group.cycles_nr)
    clock = ""
    if master is not None:
        clock = "time" if number == 1 else f"time@{number}"
        yield Field(clock, np.asarray(file.get_master(number - 1), dtype=np.float64), "s")
    for index, channel in enumerate(group.channels):
        if index == master:
            continue
        name = channel.name if counts[channel.name] == 1 else f"{channel.name}@{number}"
        conversion = channel.conversion
        if conversion is not None and conversion.conversion_type == _FORMULA.get(version, -1):
            raise UnreadableFile(
                f"channel '{name}' is computed by a formula, which is not evaluated; export the "
                "values.",
                column=name,
            )
        signal = file.get(group=number - 1, index=index, ignore_invalidation_bits=False)
        samples = np.asarray(signal.samples)
        if samples.dtype.kind in "biuf" and samples.ndim == 1:
            if samples.size != n_samples:
                raise UnreadableFile(
                    f"channel '{name}' holds {samples.size} of {n_samples} samples.", column=name
                )
            yield Field(name, samples, (signal.unit or "").strip(), clock)
        else:
            left.append(f"{name}: {_describe(samples)}")


def _describe(samples: np.ndarray) -> str:
    """Return what the samples of a channel are that is not read."""
    if samples.dtype.kind in "SU":
        return "texts, or numbers that a table converts to texts"
    if samples.dtype.kind == "c":
        return "complex numbers"
    each = samples.dtype if samples.ndim < 2 else samples.shape[1:]
    return f"samples that are arrays or structures, {each}"
