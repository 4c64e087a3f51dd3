"""Degrees of freedom of a test in the names of channels: ``12+z``, ``12:-Y``, ``12X``."""

from __future__ import annotations

import re
from typing import NamedTuple

DOF = r"\d{1,9}\s*:?\s*(?:[+-]\s*[xyz]|[xyz]\s*[+-]?)"
"""Pattern of a node with a direction, any case."""

_PARTS = re.compile(r"(\d+)\s*:?\s*([+-]?)\s*([xyz])\s*([+-]?)", re.IGNORECASE)
_IN_NAME = re.compile(r"^(?P<name>.*?)\s*\[(?P<unit>[^\]]*)\]$")
_RATIO = re.compile(r"\(?(?P<response>[^()]+?)\)?\s*/\s*\(?(?P<force>N|lbf)\)?")


class DegreeOfFreedom(NamedTuple):
    """A node, and its direction: 1, 2, 3 for x, y, z, negative if opposite."""

    node: int
    direction: int


def parse_degree_of_freedom(text: str) -> DegreeOfFreedom | None:
    """Return the degree of freedom that a text names; None if it names none."""
    found = _PARTS.fullmatch(text.strip())
    if found is None or (found[2] and found[4]):
        return None
    axis = "xyz".index(found[3].lower()) + 1
    return DegreeOfFreedom(int(found[1]), -axis if "-" in (found[2], found[4]) else axis)


def split_unit(name: str) -> tuple[str, str]:
    """Split ``force 61+z [N]`` into the name and the unit."""
    found = _IN_NAME.match(name.strip())
    return (name.strip(), "") if found is None else (found["name"], found["unit"].strip())


def split_ratio(unit: str) -> tuple[str, str] | None:
    """Split ``(m/s2)/N`` into the units of response and force; None if it is none of a force."""
    found = _RATIO.fullmatch(unit.strip())
    return None if found is None else (found["response"].strip(), found["force"])
