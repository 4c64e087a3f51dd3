"""Flight test aids of Table 1 that the workbench flies: how many harmonics per input."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flexsid.sysid.excitation.multisine import Multisine, allot_harmonics, design_multisine


@dataclass(frozen=True, slots=True)
class FlightTestAid:
    """One row of Table 1; the counts are harmonics per input."""

    number: int
    harmonics_per_input: int
    targets: str


CATALOGUE: dict[int, FlightTestAid] = {
    aid.number: aid
    for aid in (
        FlightTestAid(503, 25, "short period and first elastic mode"),
        FlightTestAid(506, 65, "short period and first elastic modes"),
    )
}


def design_flight_test_aid(
    number: int,
    *,
    order: tuple[str, ...],
    relative_peaks: Mapping[str, float],
    peak: float,
    period_s: float,
    first_harmonic: int,
) -> Multisine:
    """Design the multisine of a flight test aid.

    Parameters
    ----------
    number
        FTA number of Table 1.
    order
        Inputs in the order in which harmonics are dealt.
    relative_peaks
        Peak of each input relative to ``peak``; they set the order of columns. [1]
    peak
        Largest deflection of an input with relative peak 1. [rad]
    period_s
        Period T. [s]
    first_harmonic
        Lowest harmonic of 1/T.

    Raises
    ------
    KeyError
        If the catalogue has no such flight test aid.
    """
    dealt = allot_harmonics(order, CATALOGUE[number].harmonics_per_input, first_harmonic)
    return design_multisine(
        {name: dealt[name] for name in relative_peaks},
        period_s,
        {name: peak * relative for name, relative in relative_peaks.items()},
    )
