"""Samples of channels as files: CSV, MATLAB with structures for Simulink, NetCDF for xarray."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from typing import Any

import numpy as np
import orjson

from flexsid.errors import BadInput
from flexsid.records.views import ChannelTrace


class SampleForm(StrEnum):
    """Form of a file of samples."""

    JSON = "json"
    CSV = "csv"
    MATLAB = "mat"
    NETCDF = "nc"


MEDIA_TYPES = {
    SampleForm.JSON: "application/json",
    SampleForm.CSV: "text/csv; charset=utf-8",
    SampleForm.MATLAB: "application/x-matlab-data",
    SampleForm.NETCDF: "application/x-netcdf",
}

_LONGEST_NAME = 63  # characters of a name in MATLAB


def write_samples(traces: Sequence[ChannelTrace], form: SampleForm, title: str) -> bytes:
    """Write samples to a file; ``title`` names their maneuver.

    Raises
    ------
    BadInput
        If channels of a CSV were sampled at different times.

    Notes
    -----
    A channel in MATLAB is a structure with ``time`` and ``signals.values``, which blocks of the
    kind *From Workspace* of Simulink read, with its name and unit in ``signals.label`` and
    ``unit``. NetCDF is that of version 3, which xarray, MATLAB and Octave read: channels with the
    same times share a dimension, and units are attributes.
    """
    return _WRITERS[form](traces, title)


def _write_json(traces: Sequence[ChannelTrace], title: str) -> bytes:
    # Arrays that are not contiguous are no arrays to orjson.
    return orjson.dumps(traces, option=orjson.OPT_SERIALIZE_NUMPY, default=np.ndarray.tolist)


def _write_csv(traces: Sequence[ChannelTrace], title: str) -> bytes:
    first = traces[0]
    for one in traces:
        if not np.array_equal(one.time_s, first.time_s):
            raise BadInput(
                f"{first.name} and {one.name} were not sampled at the same times, and a table has "
                "one column of time; request them separately, or in another form than CSV",
                code="unequal-channels",
                channel=one.name,
            )
    head = ["time_s", *(f"{one.name} [{one.unit}]" if one.unit else one.name for one in traces)]
    out = io.StringIO()
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow(head)
    rows.writerows(np.column_stack([first.time_s, *(one.values for one in traces)]).tolist())
    return out.getvalue().encode()


def _write_matlab(traces: Sequence[ChannelTrace], title: str) -> bytes:
    from scipy import io as files  # imported for this format only

    names = name_variables([one.name for one in traces])
    content: dict[str, Any] = {"title": title}
    for one in traces:
        signals = {"values": one.values[:, None], "dimensions": 1.0, "label": one.name}
        content[names[one.name]] = {
            "time": one.time_s[:, None],
            "signals": signals,
            "unit": one.unit,
        }
    out: Any = io.BytesIO()  # the stubs of savemat accept no buffer
    files.savemat(out, content, long_field_names=True, oned_as="column")
    return out.getvalue()


def _write_netcdf(traces: Sequence[ChannelTrace], title: str) -> bytes:
    from scipy.io import netcdf_file  # imported for this format only

    out: Any = io.BytesIO()
    file: Any = netcdf_file(out, "w", version=2)  # offsets of 64 bits
    file.title, file.Conventions = title, "CF-1.11"
    times: list[tuple[str, np.ndarray]] = []
    names = name_variables([one.name for one in traces])
    for one in traces:
        clock = next((name for name, t in times if np.array_equal(t, one.time_s)), None)
        if clock is None:
            clock = "time_s" if not times else f"time_s_{len(times) + 1}"
            times.append((clock, one.time_s))
            file.createDimension(clock, one.time_s.size)
            _add_variable(file, clock, clock, one.time_s, {"units": "s", "long_name": "time"})
        attributes = {"units": one.unit or "1", "long_name": one.name, "role": one.role.value}
        _add_variable(file, names[one.name], clock, one.values, attributes)
    file.flush()
    return out.getvalue()


def _add_variable(
    file: Any, name: str, dimension: str, values: np.ndarray, attributes: Mapping[str, str]
) -> None:
    variable = file.createVariable(name, "f8", (dimension,))
    variable[:] = values
    for key, text in attributes.items():
        setattr(variable, key, text)


def name_variables(names: Sequence[str]) -> dict[str, str]:
    """Name variables of a file after channels: letters, digits and underscores, each once."""
    found: dict[str, str] = {}
    taken = {"title"}
    for name in names:
        stem = re.sub(r"\W", "_", name, flags=re.ASCII)
        if not stem[:1].isalpha() or stem.startswith("time_s"):  # those of times are time_s, ...
            stem = f"x{stem}"
        own, number = stem[:_LONGEST_NAME], 1
        while own.casefold() in taken:
            number += 1
            own = f"{stem[: _LONGEST_NAME - 6]}_{number}"
        taken.add(own.casefold())
        found[name] = own
    return found


_WRITERS: Mapping[SampleForm, Callable[[Sequence[ChannelTrace], str], bytes]] = {
    SampleForm.JSON: _write_json,
    SampleForm.CSV: _write_csv,
    SampleForm.MATLAB: _write_matlab,
    SampleForm.NETCDF: _write_netcdf,
}
