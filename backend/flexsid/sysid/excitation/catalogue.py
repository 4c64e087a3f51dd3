"""Flight test aids of Table 1: their target modes, and the harmonics of their inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from flexsid.errors import BadInput
from flexsid.sysid.excitation.multisine import assign_harmonics

# --- Target modes of a design: the band about each of them that its harmonics have to resolve -----

HARMONICS_PER_SURFACE = 3
"""Harmonics of every surface about a target: amplitude and phase of its response on both sides of
the peak and at it."""

PHUGOID = "PH"
"""Group of the phugoid in Table 1."""

_PHUGOID_AMPLITUDE = 0.1  # of its harmonics, relative to that of others: see weight_harmonics
_OCTAVE = 2.0  # of rigid-body modes: well damped, with a response that varies over an octave
_HALF_WIDTHS = 5.0  # half-power half-widths: further away a mode responds with a fifth of its peak
_LEAST_WIDTH = 0.1  # of the frequency: error of a predicted frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """A mode that a design excites, and the band about it. [Hz]

    ``number`` is that of the modal table, None for a rigid-body mode; ``group`` is that of Table 1;
    ``damping`` is the damping ratio, None where it is not predicted. [1]
    """

    name: str
    group: str
    number: int | None
    frequency_hz: float
    damping: float | None
    low_hz: float
    high_hz: float


def build_rigid_target(name: str, frequency_hz: float, damping: float | None) -> Target:
    """Build a rigid-body target: an octave to both sides of its frequency."""
    return Target(
        name=name,
        group=name,
        number=None,
        frequency_hz=frequency_hz,
        damping=damping,
        low_hz=frequency_hz / _OCTAVE,
        high_hz=frequency_hz * _OCTAVE,
    )


def build_structural_target(
    name: str, group: str, number: int, range_hz: tuple[float, float], damping: float
) -> Target:
    """Build a structural target from its range of frequencies. [Hz]

    Notes
    -----
    The band is wider than the half-power band by ``_HALF_WIDTHS``, with at least ``_LEAST_WIDTH``
    and at most an octave to both sides.
    """
    width = 1.0 + float(np.clip(_HALF_WIDTHS * damping, _LEAST_WIDTH, _OCTAVE - 1.0))
    low, high = range_hz
    return Target(
        name=name,
        group=group,
        number=number,
        frequency_hz=0.5 * (low + high),
        damping=damping,
        low_hz=low / width,
        high_hz=high * width,
    )


def interleave_harmonics(
    n_surfaces: int,
    count: int,
    first: int,
    last: int | None = None,
    width: float = np.inf,
) -> list[Int[np.ndarray, " n_tones"]]:
    """Interleave harmonics of equal spacing, one set per surface.

    Parameters
    ----------
    n_surfaces, count
        Number of sets and of harmonics in each; more where ``width`` requires it.
    first, last
        Lowest harmonic, and that which every set has to reach; by default sets are as dense as
        possible.
    width
        Number of harmonics in the narrowest target band, in which every set has
        ``HARMONICS_PER_SURFACE``. A band too narrow for the sets is disregarded.

    Notes
    -----
    Multisines of a low peak factor have a constant envelope, for which the products of any two
    harmonics of equal difference cancel: that requires equal spacing. With spacings that differ by
    one harmonic the relative peak factor is 1.2 to 1.3 instead of 1.03 to 1.1. Multiples of a
    common base, which are harmonics of remainder zero or half of the spacing, have about 1.0: with
    an even spacing two sets are such.
    """
    spacing = n_surfaces
    if last is not None:
        largest = int(width // HARMONICS_PER_SURFACE) if np.isfinite(width) else last
        spacing = max(n_surfaces, -(-(last - first + 1) // count))
        if largest >= n_surfaces:
            spacing = min(spacing, largest)
        if spacing % 2 and (spacing < largest or spacing > n_surfaces):
            spacing += 1 if spacing < largest else -1
        count = max(count, -(-(last - first + 1) // spacing))
    slots = n_surfaces + n_surfaces % 2
    remainders = np.arange(n_surfaces) * spacing // (slots if spacing >= slots else n_surfaces)
    starts = np.sort(first + (remainders - first) % spacing)
    return [start + spacing * np.arange(count) for start in starts]


def interleave_target_harmonics(
    n_surfaces: int,
    count: int,
    first: int,
    targets: Sequence[Target],
    duration_s: float,
    free: int = 1,
) -> list[Int[np.ndarray, " n_tones"]]:
    """Interleave harmonics over the bands of targets, one set per surface.

    Parameters
    ----------
    n_surfaces, count
        Number of sets and of harmonics in each, at least.
    first
        Lowest harmonic; lower where a target requires it.
    targets, duration_s
        At least one target, and the period. [s]
    free
        Lowest harmonic that no other input has.

    Notes
    -----
    Equal spacing from a phugoid to a structural mode needs a thousand harmonics. A phugoid below
    all other targets has ``HARMONICS_PER_SURFACE`` in all instead: those that throttles leave are
    of the first surface, in addition to ``count``. Its band of few harmonics holds no more.
    """
    phugoid = find_separate_phugoid(targets)
    low: list[Int[np.ndarray, " n_tones"]] = [np.zeros(0, dtype=int)] * n_surfaces
    others = [one for one in targets if one is not phugoid]
    least = int(np.floor(min(one.low_hz for one in others) * duration_s))
    begin = max(free, min(first, least))
    if phugoid is not None:
        lowest, highest = np.ceil(phugoid.low_hz * duration_s), phugoid.high_hz * duration_s
        own = HARMONICS_PER_SURFACE - max(0, int(min(free, highest + 1) - lowest))
        if own > 0:
            lowest = max(int(lowest), free)
            spacing = max(1, int((highest - lowest) // max(1, own - 1)))
            low[0] = lowest + spacing * np.arange(own)
            begin = int(low[0][-1]) + 1
    last = int(np.ceil(max(one.high_hz for one in others) * duration_s))
    width = min(one.high_hz - one.low_hz for one in others) * duration_s
    high = interleave_harmonics(n_surfaces, count, begin, last, width)
    return [np.concatenate(pair) for pair in zip(low, high, strict=True)]


def find_separate_phugoid(targets: Sequence[Target]) -> Target | None:
    """Find the phugoid among targets, where its band lies below those of all others."""
    others = [one.low_hz for one in targets if one.group != PHUGOID]
    return next(
        (one for one in targets if one.group == PHUGOID and others and one.high_hz < min(others)),
        None,
    )


def weight_harmonics(
    harmonics: Sequence[int], targets: Sequence[Target], duration_s: float
) -> tuple[float, ...] | None:
    """Return the relative power of the harmonics of a surface; None for a flat spectrum.

    Flat is the spectrum of a surface without harmonics of a phugoid.

    Notes
    -----
    A phugoid with the damping ratio of Lanchester, 1 / (sqrt(2) L/D) = 0.05 of L/D = 14, responds
    with 1 / (2 zeta) = 10 times its static response: its harmonics have a tenth of the amplitude
    of the others. With the same amplitude they would raise the relative peak factor by 0.2.
    """
    phugoid = find_separate_phugoid(targets)
    if phugoid is None:
        return None
    highest = phugoid.high_hz * duration_s
    if min(harmonics) > highest:
        return None
    return tuple(_PHUGOID_AMPLITUDE**2 if one <= highest else 1.0 for one in harmonics)


def count_harmonics(
    harmonics: Mapping[str, Sequence[int]], duration_s: float, target: Target
) -> int:
    """Return the least number of harmonics of a surface within the band of a target.

    Of all inputs together for a phugoid, which surfaces and throttles excite alike.
    """
    low, high = target.low_hz * duration_s, target.high_hz * duration_s
    counts = {n: len([k for k in own if low <= k <= high]) for n, own in harmonics.items()}
    if target.group == PHUGOID:
        return sum(counts.values())
    return min((count for name, count in counts.items() if not is_throttle(name)), default=0)


def find_least_duration(targets: Sequence[Target], n_surfaces: int) -> float:
    """Find the shortest period with three harmonics of every surface about each target. [s]

    About a phugoid three of all inputs together.
    """
    slots = {
        one: HARMONICS_PER_SURFACE * (1 if one.group == PHUGOID else n_surfaces) + 1
        for one in targets
    }
    return max((n / (one.high_hz - one.low_hz) for one, n in slots.items()), default=0.0)


# --- Harmonic assignment: harmonics of each input, interleaved over a band, and their checks ------

_GRID = 2001  # frequencies over which the density of harmonics is evaluated
_NEAR = 0.05  # standard deviation of the harmonics about a target, of its frequency


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """Band of one input: ``count`` harmonics from ``low_hz`` to ``high_hz``.

    With ``targets_hz``, half of the harmonics lie about them, within a tenth of each
    frequency.
    """

    low_hz: float
    high_hz: float
    count: int
    targets_hz: tuple[float, ...] = ()


def assign_harmonics_to_bands(
    bands: Mapping[str, Band], duration_s: float
) -> dict[str, Int[np.ndarray, " n_tones"]]:
    """Assign harmonics to every input in a band of its own, none of them shared.

    Bands may overlap; the duration is the period. [s]

    Raises
    ------
    BadInput
        If a band ends before it begins, or holds too few harmonics that are free.

    Notes
    -----
    Each input requests frequencies evenly over its band, or denser about its targets.
    From the lowest up, each requested frequency gets the nearest free harmonic, so that
    inputs with the same band interleave.
    """
    places = sorted(
        (place, index, name)
        for index, (name, band) in enumerate(bands.items())
        for place in (_places(name, band) * duration_s).tolist()
    )
    highest = max((band.high_hz for band in bands.values()), default=0.0)
    free = np.ones(int(np.floor(highest * duration_s + 1e-9)) + 1, dtype=bool)
    dealt: dict[str, list[int]] = {name: [] for name in bands}
    for place, _, name in places:
        band = bands[name]
        first = max(1, int(np.ceil(band.low_hz * duration_s - 1e-9)))
        last = int(np.floor(band.high_hz * duration_s + 1e-9))
        left = first + np.flatnonzero(free[first : last + 1])
        if not left.size:
            raise BadInput(
                f"{name} asks for {band.count} harmonics from {band.low_hz:g} to"
                f" {band.high_hz:g} Hz; the band holds {max(0, last - first + 1)} of"
                f" 1/{duration_s:g} s and the inputs together need more; ask for fewer, widen the"
                " band, or fly longer",
                code="too-many-harmonics",
            )
        nearest = int(left[np.argmin(np.abs(left - place))])
        free[nearest] = False
        dealt[name].append(nearest)
    return {name: np.sort(np.array(own, dtype=int)) for name, own in dealt.items()}


def _places(name: str, band: Band) -> Float[np.ndarray, " count"]:
    """Frequencies at equal shares of the requested density of harmonics. [Hz]"""
    if not (0.0 < band.low_hz <= band.high_hz and band.count >= 1):
        raise BadInput(
            f"{name} cannot have {band.count} harmonics from {band.low_hz:g} to"
            f" {band.high_hz:g} Hz; give at least one, from a positive frequency up",
            code="bad-band",
        )
    for target in band.targets_hz:
        if not band.low_hz <= target <= band.high_hz:
            raise BadInput(
                f"the target of {name} at {target:g} Hz lies outside its band of"
                f" {band.low_hz:g} to {band.high_hz:g} Hz",
                code="target-outside-band",
            )
    hz = np.linspace(band.low_hz, band.high_hz, _GRID)
    density = np.ones(_GRID)
    for target in band.targets_hz:
        width = _NEAR * target
        bump = np.exp(-0.5 * ((hz - target) / width) ** 2)
        density += bump / max(float(bump.mean()), 1e-12) / len(band.targets_hz)
    share = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
    return np.interp((np.arange(band.count) + 0.5) / band.count, share / share[-1], hz)


def check_harmonics(
    harmonics: Mapping[str, Sequence[int]], duration_s: float, rate_hz: float
) -> None:
    """Raise BadInput for harmonics that are not orthogonal at the sample rate.

    Raises
    ------
    BadInput
        If an input has no harmonics, two share one, a harmonic reaches the Nyquist
        frequency, or the period is no whole number of samples.
    """
    if not harmonics:
        raise BadInput("the design has no input; give at least one", code="no-inputs")
    assigned: dict[int, str] = {}
    for name, own in harmonics.items():
        if not own:
            raise BadInput(
                f"input {name} has no harmonics; give it at least one or remove the input",
                code="input-without-harmonics",
            )
        for harmonic in own:
            if harmonic < 1:
                raise BadInput(
                    f"harmonic {harmonic} of {name} is not an oscillation; the lowest is 1",
                    code="bad-harmonic",
                )
            if harmonic in assigned:
                raise BadInput(
                    f"harmonic {harmonic} belongs to {assigned[harmonic]} and {name}; the two would"
                    " not be orthogonal; give it to one",
                    code="shared-harmonic",
                )
            assigned[harmonic] = name
    n_samples = duration_s * rate_hz
    if abs(n_samples - round(n_samples)) > 1e-6:
        raise BadInput(
            f"{duration_s:g} s at {rate_hz:g} Hz are {n_samples:.3f} samples; take"
            f" {round(n_samples) / rate_hz:.9g} s so that the period is whole",
            code="period-not-whole",
        )
    highest = max(assigned)
    if 2 * highest >= round(n_samples):
        raise BadInput(
            f"harmonic {highest} is {highest / duration_s:.4g} Hz, not below the Nyquist"
            f" frequency {rate_hz / 2:g} Hz; sample faster or end the band lower",
            code="above-nyquist",
        )


# --- Flight test aids of Table 1: 24 designs, their inputs, targets and harmonics per input -------

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
