"""Commands of analyses take the request of the interface, and print any record."""

from __future__ import annotations

from dataclasses import MISSING, dataclass

import pytest

from flexsid.api.request_examples import FIELDS
from flexsid.cli.analyses import format_record, list_commands
from flexsid.cli.main import build_parser
from flexsid.cli.options import read_requests
from flexsid.errors import BadInput
from flexsid.request_models import list_fields

_COMMANDS = {name: analysis for name, _summary, analysis in list_commands()}


@pytest.mark.parametrize("name", _COMMANDS)
def test_a_command_reads_the_requests_of_its_analysis(name: str) -> None:
    request = _COMMANDS[name].request
    first, *others = list_fields(request)
    flag = ["--maneuver"] if first.name.startswith("maneuver") else []
    needed = {one.name: FIELDS[one.name] for one in others if one.default is MISSING}
    options = [part for key, value in needed.items() for part in (f"--{key}", str(value))]
    arguments = build_parser(name).parse_args([name, *flag, "1,2", *options])
    ids = [(1, 2)] if first.name.endswith("s") else [1, 2]
    expected = [request(**{first.name: one}, **needed) for one in ids]
    assert list(read_requests(request, arguments)) == expected
    nothing = build_parser(name).parse_args([name, *flag, "", *options])
    with pytest.raises(BadInput, match="is given"):
        list(read_requests(request, nothing))


def test_a_band_and_what_is_left_out_are_options() -> None:
    given = "transfer-function --maneuver 1 --input bfs --output q --no-delay --band 0.5,3"
    arguments = build_parser("transfer-function").parse_args(given.split())
    (found,) = read_requests(arguments.analysis.request, arguments)
    assert (found.delay, found.band_hz) == (False, (0.5, 3.0))


@dataclass(frozen=True)
class Row:
    name: str
    frequency_hz: float
    frequency_std_hz: float
    mac: float | None = None


@dataclass(frozen=True)
class Record:
    run_id: int
    sentence: str
    gain: float
    gain_std: float
    n_modes: int
    outputs: tuple[str, ...]
    spectrum: tuple[float, ...]
    modes: tuple[Row, ...]
    warnings: tuple[str, ...]


def test_a_record_is_printed_with_errors_units_and_tables() -> None:
    modes = (Row("SW1B", 2.98, 0.04), Row("SW1T", 12.5, 0.3))
    record = Record(4, "It fits.", 1.5, 0.25, 2, ("q", "az"), (0.0,) * 100, modes, ("Short.",))
    assert list(format_record(record)) == [
        "run 4: It fits.",
        "  gain             1.5 ± 0.25",
        "  number of modes  2",
        "  outputs          q, az",
        "  spectrum         100 values; --json writes them",
        "  modes",
        "    name  frequency [Hz]",
        "    SW1B  2.98 ± 0.04",
        "    SW1T  12.5 ± 0.3",
        "  Warning: Short.",
        "  Values ± one standard error.",
    ]
