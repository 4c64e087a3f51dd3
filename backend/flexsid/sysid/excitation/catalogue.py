"""Flight test aids of Table 1: 24 designs, their inputs, targets and harmonics per input."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from flexsid.sysid.excitation.multisine import assign_harmonics
from flexsid.sysid.excitation.targets import (
    Target,
    interleave_harmonics,
    interleave_target_harmonics,
)

ELASTIC_GROUPS = {"LE": slice(0, 2), "HE": slice(2, 8)}
"""Structural modes of LE and HE by their place in order of frequency: modes 7-8 and 9-14 of the
X-56A's finite element model, whose first six are rigid (Sec. V.B)."""


_THROTTLE = "throttle"


def is_throttle(name: str) -> bool:
    """Whether an input is a throttle by its name; its unit is the full range."""
    return name.startswith(_THROTTLE)


@dataclass(frozen=True, slots=True)
class FlightTestAid:
    """One row of Table 1, numbered by its lowest amplitude; the counts are per input.

    ``periods`` is the duration in units of T; ``axis`` is the symmetry of the deflections.
    """

    number: int
    harmonics_per_input: int
    targets: str
    axis: str = "symmetric"
    periods: int = 1
    surfaces: int = 5
    throttles: int = 0
    throttle_harmonics: int = 0

    @property
    def numbers(self) -> tuple[int, int, int]:
        """Numbers of the low, medium and high amplitude."""
        return self.number, self.number + 1, self.number + 2

    def input_names(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Surfaces in the order in which harmonics are assigned, and throttles.

        Neighbours on the wing are not neighbours here (Sec. V.C).
        """
        order = ("bf", "wf3", "wf1", "wf4", "wf2")
        sides = {"symmetric": "s", "antisymmetric": "a", "independent": "lr"}[self.axis]
        surfaces = tuple(f"{name}{side}" for side in sides for name in order)
        throttles = {0: (), 1: ("throttle",), 2: ("throttle_l", "throttle_r")}[self.throttles]
        return surfaces, throttles

    @property
    def rigid_targets(self) -> tuple[str, ...]:
        """Rigid-body modes among the targets: PH, SP, DR, RS."""
        return tuple(group for group in self.targets.split() if group not in ELASTIC_GROUPS)

    @property
    def elastic_targets(self) -> tuple[str, ...]:
        """Groups of structural modes among the targets: LE, HE."""
        return tuple(group for group in self.targets.split() if group in ELASTIC_GROUPS)

    def highest_harmonic(self) -> int | None:
        """Highest harmonic of 1/(4T) that the row's targets need; None for a row of one T.

        Notes
        -----
        A row of one T has consecutive harmonics. The rows of 4T have hardly more of them on a
        grid four times as fine, so that consecutive ones would end at a quarter of the band:
        they span the band of the row of one T with the same axis and structural targets.
        """
        if self.periods == 1:
            return None
        brief = next(
            aid
            for aid in CATALOGUE.values()
            if aid.periods == 1
            and aid.axis == self.axis
            and aid.elastic_targets == self.elastic_targets
        )
        return self.periods * brief.harmonics_per_input * brief.surfaces

    def harmonics(
        self, first: int = 1, targets: Sequence[Target] = (), duration_s: float = 1.0
    ) -> dict[str, Int[np.ndarray, " n_tones"]]:
        """Assign harmonics of the design's own duration; throttles have the lowest.

        Parameters
        ----------
        first
            Lowest harmonic of the surfaces; throttles have 1 and what follows it.
        targets, duration_s
            Target modes on an aircraft and the period [s]: every surface has harmonics about each
            of them, more than Table 1 where that requires it. Without targets the surfaces reach
            the harmonic of ``highest_harmonic``.
        """
        surfaces, throttles = self.input_names()
        low = assign_harmonics(throttles, self.throttle_harmonics, 1)
        free = 1 + len(throttles) * self.throttle_harmonics
        n, count = len(surfaces), self.harmonics_per_input
        if targets:
            sets = interleave_target_harmonics(n, count, first, targets, duration_s, free)
        else:
            sets = interleave_harmonics(n, count, max(first, free), self.highest_harmonic())
        return dict(zip(surfaces, sets, strict=True)) | low


def _rows(
    axis: str, surfaces: int, rows: tuple[tuple[int, int, int, int, int, str], ...]
) -> tuple[FlightTestAid, ...]:
    return tuple(
        FlightTestAid(number, count, targets, axis, periods, surfaces, throttles, low)
        for number, periods, throttles, count, low, targets in rows
    )


CATALOGUE: dict[int, FlightTestAid] = {
    aid.number: aid
    for aid in (
        *_rows(
            "symmetric",
            5,
            (
                (500, 1, 0, 12, 0, "SP"),
                (503, 1, 0, 25, 0, "SP LE"),
                (506, 1, 0, 65, 0, "SP LE HE"),
                (509, 4, 0, 25, 0, "PH SP"),
                (512, 4, 0, 51, 0, "PH SP LE"),
                (515, 4, 0, 66, 0, "PH SP LE HE"),
                (518, 4, 1, 24, 4, "PH SP"),
                (521, 4, 1, 50, 4, "PH SP LE"),
                (524, 4, 1, 66, 2, "PH SP LE HE"),
            ),
        ),
        *_rows(
            "antisymmetric",
            5,
            (
                (530, 1, 0, 13, 0, "DR RS"),
                (533, 1, 0, 25, 0, "DR RS LE"),
                (536, 1, 0, 65, 0, "DR RS LE HE"),
                (539, 4, 1, 10, 2, "DR RS"),
                (542, 4, 1, 22, 2, "DR RS LE"),
                (545, 4, 1, 64, 2, "DR RS LE HE"),
            ),
        ),
        *_rows(
            "independent",
            10,
            (
                (550, 1, 0, 7, 0, "DR SP RS"),
                (553, 1, 0, 13, 0, "DR SP RS LE"),
                (556, 1, 0, 33, 0, "DR SP RS LE HE"),
                (559, 4, 0, 13, 0, "PH DR SP RS"),
                (562, 4, 0, 25, 0, "PH DR SP RS LE"),
                (565, 4, 0, 66, 0, "PH DR SP RS LE HE"),
                (568, 4, 2, 13, 2, "PH DR SP RS"),
                (571, 4, 2, 25, 2, "PH DR SP RS LE"),
                (574, 4, 2, 66, 2, "PH DR SP RS LE HE"),
            ),
        ),
    )
}
