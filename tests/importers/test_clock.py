"""The sampling rate of a recording is found from rounded time stamps."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from flexsid.errors import FlexsidError
from flexsid.importers.clock import Clock, Timing, find_resolution
from flexsid.importers.mapping import TimeMapping, parse_mapping
from flexsid.importers.proposal import write_proposal
from flexsid.importers.sandbox import read_all
from flexsid.importers.source import SourceFile, Sources
from flexsid.workflow.importing.preview import describe_fields


def clock(stamps: np.ndarray, unit: str = "s", **more: np.ndarray) -> Clock:
    rng = np.random.default_rng(1)
    arrays = {"t": stamps, "q": rng.standard_normal(stamps.size), **more}
    source = SourceFile(name="f.csv", sha256="", arrays=arrays, first_row=2)
    timing = Timing(TimeMapping(column="t", unit=unit), (), Sources((source,)))
    return timing.clock(source, "q", "q", stamps.size, None)


def stamps(rate: float, seconds: float, resolution: float, start: float = 0.0) -> np.ndarray:
    exact = start + np.arange(round(rate * seconds)) / rate
    return np.round(exact / resolution) * resolution if resolution else exact


@pytest.mark.parametrize(
    ("rate", "resolution"),
    [(200, 0.01), (200, 0.05), (80, 0.01), (256, 0.001), (60, 0.01), (1000, 0.01), (128, 0.02)],
)
@pytest.mark.parametrize("start", [0.0, 12.3, 1.7e9])
def test_a_rounded_clock_gives_the_rate_of_the_recorder(
    rate: float, resolution: float, start: float
) -> None:
    found = clock(stamps(rate, 30.0, resolution, start))
    assert found.rate_hz == pytest.approx(rate, rel=1e-9)
    assert found.rounded_s == pytest.approx(resolution, rel=1e-3)


@pytest.mark.parametrize(("rate", "resolution"), [(200, 0.0), (200, 0.001), (100, 0.01)])
def test_a_fine_clock_is_not_taken_for_a_rounded_one(rate: float, resolution: float) -> None:
    found = clock(stamps(rate, 20.0, resolution))
    assert (found.rate_hz, found.rounded_s) == (rate, None)


@pytest.mark.parametrize("cut", [False, True])
def test_missing_sample_is_found_with_rounded_time(cut: bool) -> None:
    whole = stamps(200, 30.0, 0.01)
    if cut:
        whole = np.floor(np.arange(6000) / 2 + 1e-9) * 0.01
    place = "row 300" if cut else "no uniform rate near 19"  # stamps rounded to even are uneven
    with pytest.raises(FlexsidError, match=place) as error:
        clock(np.delete(whole, 3001))
    assert error.value.code == "time-not-uniform"


def test_ambiguous_rate_is_rejected() -> None:
    with pytest.raises(FlexsidError, match=r"sampling rate is between .* rate = \{") as error:
        clock(stamps(33.37, 3.0, 0.1))
    assert error.value.code == "clock-rounded"


def test_repeated_rows_are_rejected() -> None:
    twice = np.repeat(stamps(100, 10.0, 0.0), 2)
    with pytest.raises(FlexsidError, match="repeats the row before it") as error:
        clock(twice, q=np.repeat(np.random.default_rng(2).standard_normal(1000), 2))
    assert error.value.code == "rows-repeated"


def test_milliseconds_since_1970_are_not_seconds() -> None:
    with pytest.raises(FlexsidError, match=r"at most 1e\+11"):
        clock(1000.0 * stamps(200, 10.0, 0.0, 1.7e9))
    found = clock(np.round(1000.0 * stamps(200, 10.0, 0.0, 1.7e9)), unit="ms")
    assert found.rate_hz == 200.0
    assert found.start_s == pytest.approx(1.7e9)


def test_time_that_does_not_increase_is_rejected() -> None:
    back = stamps(200, 10.0, 0.01)
    back[500] = 0.0
    with pytest.raises(FlexsidError, match="does not increase"):
        clock(back)
    with pytest.raises(FlexsidError, match="does not increase"):
        clock(np.zeros(100))


def test_jitter_is_not_resolution() -> None:
    jitter = np.random.default_rng(3).uniform(-2e-4, 2e-4, 2000)
    assert find_resolution(np.arange(2000) / 200.0 + jitter) is None


def write_columns(file: Path, columns: dict[str, np.ndarray]) -> Sources:
    rows = zip(*(column.tolist() for column in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
    file.write_text("\n".join(lines))
    return read_all([file])


@pytest.mark.parametrize(
    ("unit", "seconds"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)]
)
@pytest.mark.parametrize("start", [0, 86_400, 1_700_000_000])
def test_the_unit_of_whole_stamps_is_proposed_from_their_size(
    tmp_path: Path, unit: str, seconds: float, start: int
) -> None:
    step = 0.01 if unit == "s" else round(0.01 / seconds)
    stamps = round(start / seconds) + step * np.arange(200)
    columns = {"timestamp": stamps, "q_deg_s": np.random.default_rng(1).normal(size=200)}
    sources = write_columns(tmp_path / "f.csv", columns)
    assert f'column = "timestamp"\nunit = "{unit}"' in write_proposal(sources, "X-1", 1, {})
    (q,) = [field for field in describe_fields(sources) if field.field == "q_deg_s"]
    assert q.rate_hz == pytest.approx(100.0, rel=1e-6)


def test_channels_behind_a_second_column_of_time_have_its_clock(tmp_path: Path) -> None:
    t, rng = np.arange(400) / 100.0, np.random.default_rng(1)
    columns = {
        "time": t,
        "q_deg_s": rng.normal(size=400),
        "time_ms": (1000.0 * t).round() + 40.0,  # the same instants
        "az_g": rng.normal(size=400),
        "time_adc": 0.003 + 1.25 * t,
        "elevator_deg": rng.normal(size=400),
    }
    sources = write_columns(tmp_path / "two.csv", columns)
    text = write_proposal(sources, "X-1", 1, {})
    mapping = parse_mapping(re.sub(r"guessed = .*", "", text))
    assert {one.name: one.clock for one in mapping.channels} == {
        "q": None,
        "az": None,
        "elevator": "time_adc",
    }
    rates = {field.field: field.rate_hz for field in describe_fields(sources)}
    assert (rates["az_g"], rates["elevator_deg"]) == pytest.approx((100.0, 80.0))
    (clock,) = mapping.clocks
    assert clock.column == "two.csv:time_adc"
    timing = Timing(mapping.time, mapping.clocks, sources)
    found = timing.clock(sources.items[0], "elevator_deg", "elevator", 400, "time_adc")
    assert (found.rate_hz, found.start_s) == pytest.approx((80.0, 0.003))
