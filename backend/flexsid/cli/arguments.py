"""Values of arguments that several commands read."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from flexsid.errors import BadInput
from flexsid.records.model_structure import Structure
from flexsid.storage.store import Store
from flexsid.workflow.aircraft.axes import find_body

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


def read_structure(arguments: argparse.Namespace, extra_parameters: str = "") -> Structure:
    """Read the options that describe a model structure."""
    free = arguments.free
    return Structure(
        modes=parse_list(arguments.modes or "", int, "--modes"),
        inputs=parse_list(arguments.inputs, str, "--inputs"),
        outputs=parse_list(arguments.outputs, str, "--outputs"),
        free=None if free is None else parse_list(free, str, "--free"),
        fixed={},
        free_delays=arguments.free_delays,
        extra_parameters=parse_list(extra_parameters, str, "--extra-parameters"),
    )


def set_axis(store: Store, structure: Structure, maneuver_id: int, axis: str | None) -> Structure:
    """Set the axis of a model structure, by default that of the maneuver it is fitted to."""
    own = store.maneuvers.get(maneuver_id).axis if axis is None else axis
    return replace(structure, axis=find_body(own).axis)
