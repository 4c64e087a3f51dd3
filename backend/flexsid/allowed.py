"""What a field of a request may be: ranges, lengths and text, said once beside its type.

A frozen dataclass carries them as ``Annotated[float, Allowed(ge=0.0, text="Fuel fraction.")]``.
Query parameters, request bodies and their OpenAPI texts are derived from it, and every request is
checked against it before it becomes a job (``flexsid.request_models``). Reading a stored record
checks nothing: what an earlier release stored stays readable.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

from flexsid.text import LARGEST_ID, LONGEST_NAME, LONGEST_NOTE, check_line, check_lines
from flexsid.units import LARGEST


@dataclass(frozen=True, slots=True, kw_only=True)
class Allowed:
    """Values that a field may have, and its description for users.

    ``choices`` are the texts that a text may be, ``strip`` removes blanks around a text before it
    is checked, ``check`` returns a text in its one spelling or raises ``ValueError``; lengths are
    those of a text or the numbers of items.
    """

    ge: float | None = None
    gt: float | None = None
    le: float | None = None
    lt: float | None = None
    min_length: int | None = None
    max_length: int | None = None
    pattern: str | None = None
    choices: tuple[str, ...] = ()
    strip: Literal[True] | None = None
    check: Callable[[str], str] | None = None
    text: str = ""


Id = Annotated[int, Allowed(ge=1, le=LARGEST_ID)]
RunIds = Annotated[tuple[Id, ...], Allowed(text="Ids of succeeded runs.")]
Number = Annotated[float, Allowed(ge=-LARGEST["number"], le=LARGEST["number"])]
Fuel = Annotated[float, Allowed(ge=0.0, le=1.0, text="Fuel fraction.")]
Share = Annotated[float, Allowed(ge=0.0, le=1.0)]
Altitude = Annotated[float, Allowed(ge=-1000.0, le=11_000.0, text="Standard altitude. [m]")]
Airspeed = Annotated[float, Allowed(ge=0.1, le=1000.0, text="True airspeed. [m/s]")]
Name = Annotated[str, Allowed(min_length=1, max_length=LONGEST_NAME, check=check_line)]
Names = Annotated[tuple[Name, ...], Allowed(max_length=500)]
Frequency = Annotated[float, Allowed(ge=0.0, le=1e4)]
Band = tuple[Frequency, Frequency]
Moment = Annotated[float, Allowed(ge=-LARGEST["time"], le=LARGEST["time"])]
Iterations = Annotated[int, Allowed(ge=1, le=1000)]
ModeNumber = Annotated[int, Allowed(ge=1, le=9999)]
Noise = Annotated[str, Allowed(choices=("diagonal", "full"))]
Positive = Annotated[float, Allowed(gt=0.0, le=1e5)]
Delay = Annotated[float, Allowed(ge=-1.0, le=1.0)]
Metre = Annotated[float, Allowed(ge=-1e6, le=1e6)]
MassUnit = Annotated[str, Allowed(choices=("kg", "t", "lb", "slug", "slinch"))]
LengthUnit = Annotated[str, Allowed(choices=("m", "mm", "in", "ft"))]
Axes = Annotated[str, Allowed(max_length=60, check=check_line)]
Author = Annotated[str, Allowed(max_length=LONGEST_NAME, check=check_line)]
Version = Annotated[int, Allowed(ge=1, le=2**31 - 1)]
Text = Annotated[str, Allowed(max_length=LONGEST_NOTE, check=check_lines)]
RequiredName = Annotated[Name, Allowed(strip=True)]
RequiredText = Annotated[Text, Allowed(strip=True, min_length=1)]
