"""Files of samples: names of variables, and channels of several rates."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import loadmat, netcdf_file

from flexsid.errors import BadInput
from flexsid.records.maneuver import Role
from flexsid.records.views import ChannelTrace
from flexsid.workflow.views.sample_files import SampleForm, name_variables, write_samples


def trace(name: str, rate_hz: float, n: int) -> ChannelTrace:
    values = np.random.default_rng(n).normal(size=n)
    return ChannelTrace(
        name=name, unit="m/s^2", role=Role.OUTPUT, time_s=np.arange(n) / rate_hz, values=values
    )


TRACES = (trace("az.1", 100.0, 40), trace("az_1", 100.0, 40), trace("alpha", 50.0, 20))


def test_channels_of_each_rate_have_their_times(tmp_path: Path):
    content = write_samples(TRACES, SampleForm.NETCDF, "1-01 FTA 506")
    file: Any = netcdf_file(io.BytesIO(content), mmap=False)
    assert file.title == b"1-01 FTA 506"
    dimensions = {name: file.variables[name].dimensions for name in ("az_1", "az_1_2", "alpha")}
    assert dimensions == {"az_1": ("time_s",), "az_1_2": ("time_s",), "alpha": ("time_s_2",)}
    assert file.variables["az_1"].long_name == b"az.1"
    np.testing.assert_array_equal(file.variables["time_s_2"][:], TRACES[2].time_s)
    (tmp_path / "x.mat").write_bytes(write_samples(TRACES, SampleForm.MATLAB, "x"))
    found = loadmat(tmp_path / "x.mat", simplify_cells=True)
    for name, one in zip(("az_1", "az_1_2", "alpha"), TRACES, strict=True):
        np.testing.assert_array_equal(found[name]["time"], one.time_s)
        np.testing.assert_array_equal(found[name]["signals"]["values"], one.values)
        assert found[name]["signals"]["label"] == one.name
    with pytest.raises(BadInput, match=r"az\.1 and alpha were not sampled at the same times"):
        write_samples(TRACES, SampleForm.CSV, "x")


def test_names_of_variables_are_valid_and_differ():
    long = 70 * "a"
    names = ["1st", "A", "a", "title", "time_s_2", "q [deg]", "ä", long, f"{long}b"]
    found = name_variables(names)
    assert all(one.isidentifier() and one.isascii() and len(one) <= 63 for one in found.values())
    assert len({one.casefold() for one in found.values()}) == len(names)
    assert not any(one.startswith(("time_s", "title,")) for one in found.values())
