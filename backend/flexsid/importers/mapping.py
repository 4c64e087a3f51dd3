"""Mapping: the TOML file that defines names, units and roles of recorded columns.

The format is described in ``examples/README.md`` of the project.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from flexsid.errors import BadInput
from flexsid.importers.aircraft import AircraftPart, read_aircraft
from flexsid.importers.channels import read_channel
from flexsid.importers.clock import read_clocks, read_time
from flexsid.importers.maneuver import (
    FlightPart,
    ManeuverPart,
    RecordingPart,
    read_flight,
    read_maneuver,
)
from flexsid.importers.modal_table import ModalPart, read_modal_table
from flexsid.importers.predictions import PredictionPart, read_prediction
from flexsid.importers.quantity import refuse
from flexsid.importers.source import Sources
from flexsid.importers.table import Guessed, MappingTable

_KNOWN = Path(__file__).parent / "known"
_LARGEST_MAPPING = 1024 * 1024


@dataclass(frozen=True, slots=True, kw_only=True)
class Mapping:
    """One mapping file, checked; omitted parts are None or empty."""

    aircraft: AircraftPart | None = None
    flight: FlightPart | None = None
    recording: RecordingPart | None = None
    maneuver: ManeuverPart | None = None
    modal_tables: tuple[ModalPart, ...] = ()
    predictions: tuple[PredictionPart, ...] = ()
    guessed: tuple[Guessed, ...] = ()
    """Keys that a program proposed and that are not confirmed; such a mapping is not imported."""


def parse_mapping(text: str) -> Mapping:
    """Parse and check a mapping.

    Raises
    ------
    BadInput
        Naming the key that is missing, misspelt or of the wrong kind.
    """
    if len(text) > _LARGEST_MAPPING:
        raise BadInput(
            "The mapping is larger than 1 MB; expected a smaller TOML file.", code="bad-mapping"
        )
    try:
        content = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise BadInput(f"The mapping is not valid TOML: {error}.", code="bad-mapping") from error
    table = MappingTable(content)
    mapping = Mapping(
        aircraft=read_aircraft(table.table("aircraft")) if "aircraft" in table else None,
        flight=read_flight(table.table("flight")) if "flight" in table else None,
        recording=_recording(table),
        maneuver=_maneuver(table),
        modal_tables=tuple(read_modal_table(row) for row in table.tables("modal_tables")),
        predictions=tuple(read_prediction(row) for row in table.tables("predictions")),
    )
    table.close()
    mapping = replace(mapping, guessed=tuple(table.guesses))
    if mapping.recording is None and not mapping.modal_tables and not mapping.predictions:
        raise refuse(
            "channels",
            "or modal_tables or predictions must be given; the mapping has nothing to import.",
        )
    if mapping.maneuver is not None and mapping.recording is None:
        raise refuse("channels", "is missing; name at least the inputs and one output.")
    if mapping.recording is not None and mapping.flight is None:
        raise refuse("flight", "is missing; a recording belongs to a flight with a number.")
    return mapping


def _recording(table: MappingTable) -> RecordingPart | None:
    channels = tuple(read_channel(row) for row in table.tables("channels"))
    if not channels:
        for key in ("time", "clocks"):
            if key in table:
                raise refuse("channels", f"is missing, but '{key}' is given.")
        return None
    return RecordingPart(
        time=read_time(table.table("time")) if "time" in table else None,
        clocks=read_clocks(table.tables("clocks")),
        channels=channels,
    )


def _maneuver(table: MappingTable) -> ManeuverPart | None:
    if "maneuver" not in table:
        if "excitation" in table:
            raise refuse("maneuver", "is missing, but 'excitation' is given.")
        return None
    return read_maneuver(
        table.table("maneuver"), table.table("excitation") if "excitation" in table else None
    )


def find_known_mapping(sources: Sources) -> str | None:
    """Return the built-in mapping for files of a known layout.

    Returns
    -------
    str or None
        Text of the mapping; None for files of unknown layout.
    """
    simulated = ("t_s", "outputs", "inputs", "multisine_command", "output_names", "input_names")
    if all(sources.has(field) for field in simulated):
        return (_KNOWN / "flex28-record.toml").read_text(encoding="utf-8")
    return None
