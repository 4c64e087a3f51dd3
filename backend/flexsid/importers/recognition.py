"""Recognition of recorded columns by their words and by their motion; both are hints.

A name that no list contains still has words (``AOA_BOOM``, ``POS_WF1_LH``), and samples obey
physics whatever their name: excited surfaces share no lines with each other but each response
has those of all; commands lead; the derivative of theta is q; one g is the mean of ``az``; the
normal acceleration is V times the rate of the flight path.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from flexsid import units
from flexsid.importers.column_names import Meaning, is_measured
from flexsid.importers.source import COUNTS
from flexsid.records.maneuver import Role

_G = 9.80665  # m/s2
_DISJOINT = 0.3
"""Largest overlap of the spectra of two surfaces with interleaved lines: feedback moves each at
the lines of the others. A surface and a response overlap by 0.4 and more. [1]"""

_SAME = 0.9
"""Least overlap and correlation of a surface with its command, or of its two sides. [1]"""

_RATE_CORRELATION = 0.9
"""Least correlation of a rate gyro with the derivative of its attitude. [1]"""

_SLOW = 0.2
"""Largest share of the variance above 10 periods per record of what describes the condition,
which drifts; responses to an excitation have most of it there. [1]"""

_SAME_GAIN = 0.1
"""Largest error of the gain between a gyro and the derivative of its attitude, as logarithm."""

_LEAST_SPEED = 5.0
"""Least airspeed of a column of which nothing else is known, in any unit."""

_LEAST_LEAD_S = 2e-3
"""Least delay of a surface behind its command: servos of flight tests have 10 ms and more. [s]"""

_TOP, _ENDS, _MOST_LINES = 0.99, (0.002, 0.998), 200
"""Share of the power below the highest harmonic, and of the energy before the excitation begins
and ends; most harmonics that are tried. [1]"""

_USUAL = {"deflection": 5.0, "angle": 4.0, "rate": 10.0}
"""Usual peak-to-peak motion in an excitation: 5 deg, 4 deg, 10 deg/s. In rad it is 57 times less;
a column is taken in the unit in which it is nearer to the usual, on a logarithmic scale."""

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[µμ%]\w*")

_WORDS: tuple[tuple[str, str, str], ...] = (
    # words, quantity, kind
    ("aoa alpha alfa angleofattack", "alpha", "angle"),
    ("aos beta sideslip", "beta", "angle"),
    ("theta pitchangle pitchattitude", "theta", "angle"),
    ("phi rollangle bankangle bank", "phi", "angle"),
    ("psi heading hdg yawangle", "psi", "angle"),
    ("q pitchrate", "q", "rate"),
    ("p rollrate", "p", "rate"),
    ("r yawrate", "r", "rate"),
    ("az nz normalacc vertacc", "az", "acceleration"),
    ("ay ny lateralacc latacc", "ay", "acceleration"),
    ("ax nx longacc axialacc", "ax", "acceleration"),
    ("tas ktas vtas vt vtrue trueairspeed airspeed", "airspeed", "speed"),
    ("ias kias cas kcas", "indicated_airspeed", "speed"),
    ("alt altitude hp height pressalt", "altitude", "length"),
    ("fuel fuelqty fuelqt fuelremaining", "fuel_fraction", "fuel"),
    ("oat sat tat temp temperature tstatic", "temperature", "temperature"),
    ("mach", "mach", "number"),
    ("qbar qc pdyn", "dynamic_pressure", "pressure"),
    ("sg strain gage gauge eps", "strain", "strain"),
)
_SURFACES = (
    "elevator elev ele el de aileron ail da rudder rud dr flap flaps tef lef bf wf df dwf stab"
    " stabilator canard elevon flaperon spoiler wingflap bodyflap surface surf"
)
_SURFACE_WORDS = frozenset(_SURFACES.split())
_COMMAND_WORDS = frozenset(("cmd", "command", "commanded", "com", "dem", "demand"))
_RECORDERS = frozenset(("imu", "ins", "egi", "ahrs", "gyro", "adc", "rate", "body", "deg", "rad"))
_OTHER_WORDS = frozenset(("dot", "deriv", "flow", "std", "sigma", "err", "error", "bias", "lag"))
"""Words that make another quantity of the one beside them, as in alpha_dot and fuel_flow."""
_QUANTITIES = {word: (name, kind) for words, name, kind in _WORDS for word in words.split()}
_ALL_WORDS = frozenset(_QUANTITIES) | _SURFACE_WORDS
_LONG_WORDS = sorted((word for word in _ALL_WORDS if len(word) > 3), key=len, reverse=True)
_MODIFIERS = {
    ("pitch", "rate"): "pitchrate", ("roll", "rate"): "rollrate", ("yaw", "rate"): "yawrate",
    ("pitch", "rt"): "pitchrate", ("roll", "rt"): "rollrate", ("yaw", "rt"): "yawrate",
    ("pitch", "angle"): "pitchangle", ("pitch", "att"): "pitchangle",
    ("pitch", "attitude"): "pitchangle", ("roll", "angle"): "rollangle",
    ("roll", "att"): "rollangle", ("roll", "attitude"): "rollangle", ("yaw", "angle"): "yawangle",
    ("angle", "of"): "angleofattack", ("true", "airspeed"): "trueairspeed", ("v", "true"): "vtrue",
    ("wing", "flap"): "wingflap", ("body", "flap"): "bodyflap", ("press", "alt"): "pressalt",
    ("norm", "acc"): "normalacc", ("vert", "acc"): "vertacc", ("lat", "acc"): "latacc",
    ("long", "acc"): "longacc", ("normal", "acc"): "normalacc", ("t", "static"): "tstatic",
}  # fmt: skip
_STATED = {"degree": "deg", "degrees": "deg", "dps": "deg/s", "ue": "ustrain", "µe": "ustrain"}
_DIMENSIONS = {
    "angle": "angle", "angular rate": "rate", "acceleration": "acceleration", "strain": "strain",
    "speed": "speed", "length": "length", "temperature": "temperature", "pressure": "pressure",
    "mass": "fuel",
}  # fmt: skip
_KINDS = {
    "rate": ("rad/s", "deg/s"),
    "angle": ("rad", "deg"),
    "acceleration": ("g", "m/s2", "ft/s2"),
    "strain": ("ustrain", "strain"),
    "speed": ("m/s", "kt", "ft/s"),
    "length": ("ft", "m"),
    "fuel": ("%", "1", "lb"),
    "temperature": ("degC", "K"),
}
_CONDITION_KINDS = frozenset(("speed", "length", "fuel", "temperature", "number", "pressure"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Recorded:
    """One recorded column on the clock of its file."""

    field: str
    unit: str
    samples: np.ndarray
    rate_hz: float
    named: Meaning
    """What the list of usual names says; ``known`` if the name is in it."""


@dataclass(frozen=True, slots=True)
class _Hint:
    """What the words of a name say; empty where they say nothing."""

    name: str = ""
    kind: str = ""
    role: Role | None = None


_DEG = 180 / np.pi
_LEAST, _LARGEST = 1e-100, 1e100  # whose squares are numbers
_MOST_SCANNED = 16  # columns by which the period is found
_MOST_COMPARED = 3  # accelerometers with which a vane is compared
_MAY_BE_THETA = frozenset({("", ""), ("", "angle"), ("theta", "angle")})
_MAY_BE_Q = frozenset({("", ""), ("", "rate"), ("q", "rate")})


class _MovingColumns:
    """Spectra and derivatives of all columns of one clock, each computed once."""

    def __init__(self, columns: Sequence[Recorded]) -> None:
        self.columns = columns
        self.rate_hz = columns[0].rate_hz
        table = np.array([c.samples for c in columns], dtype=np.float64)
        self.mean = table.mean(axis=1)
        self.moved = table - self.mean[:, None]
        self.span = np.ptp(table, axis=1)
        time = np.linspace(-1.0, 1.0, table.shape[1])
        slope = self.moved @ time / (time @ time)
        self.detrended = self.moved - slope[:, None] * time
        self.lines = np.fft.rfft(self.detrended * np.hanning(table.shape[1]), axis=1)

    @cached_property
    def power(self) -> np.ndarray:
        """Power at the harmonics of the excitation, of unit area: there lines do not overlap."""
        power = _find_harmonics(self.detrended, np.abs(self.lines) ** 2, self.fast, self.rate_hz)
        return power / np.maximum(power.sum(axis=1, keepdims=True), _LEAST)

    @cached_property
    def fast(self) -> np.ndarray:
        """Share of the variance above 10 periods per record."""
        power = np.abs(self.lines) ** 2
        return power[:, 10:].sum(axis=1) / np.maximum(power.sum(axis=1), _LEAST)

    @cached_property
    def overlap(self) -> np.ndarray:
        """Overlap of the spectra, and of the times of motion, of each pair; the smaller one."""
        spectra = np.sqrt(self.power)
        energy = self.detrended**2
        width = max(1, energy.shape[1] // 64)
        usable = energy.shape[1] // width * width
        energy = energy[:, :usable].reshape(len(energy), -1, width).sum(axis=2)
        times = np.sqrt(energy / np.maximum(energy.sum(axis=1, keepdims=True), _LEAST))
        return np.minimum(spectra @ spectra.T, times @ times.T)

    def correlate(self, first: int, second: int) -> float:
        """Return the correlation of two columns at the delay where it is largest."""
        one, other = self.lines[first], self.lines[second]
        shifted = np.fft.irfft(one.conj() * other)
        size = max(float(np.linalg.norm(one) * np.linalg.norm(other)), _LEAST)
        return float(shifted[np.argmax(np.abs(shifted))]) * len(shifted) / 2 / size

    def is_same(self, first: int, second: int) -> bool:
        """Return whether two columns are one surface: its command, or its other side."""
        overlaps = self.overlap[first, second] > _SAME
        return bool(overlaps) and abs(self.correlate(first, second)) > _SAME

    def lead(self, first: int, second: int) -> float:
        """Return by how much the first column leads the second [s], by the phase of its lines."""
        cross = self.lines[first].conj() * self.lines[second]
        if self.correlate(first, second) < 0.0:
            cross = -cross
        omega = 2 * np.pi * np.fft.rfftfreq(self.moved.shape[1], 1 / self.rate_hz)
        weight = np.abs(cross) * (np.abs(cross) > 1e-2 * np.abs(cross).max())
        total = float((weight * omega**2).sum())
        return float(-(weight * omega * np.angle(cross)).sum() / max(total, _LEAST))

    @cached_property
    def used(self) -> slice:
        """Lines that are fitted: without drift, and below the end of the excitation.

        Above it, and above a third of the bandwidth, the derivative of an angle is noise.
        """
        size = self.lines.shape[1]
        power = np.abs(self.lines[self.fast > _SLOW, 4:]) ** 2
        end = size // 3
        if power.size:
            share = np.cumsum(power / np.maximum(power.sum(axis=1, keepdims=True), _LEAST), axis=1)
            end = min(end, 4 + int(np.median((share < _TOP).sum(axis=1))))
        return slice(4, max(8, end))

    def derivative(self, number: int) -> np.ndarray:
        """Lines of the derivative of a column."""
        omega = 2 * np.pi * np.fft.rfftfreq(self.moved.shape[1], 1 / self.rate_hz)
        return 1j * omega * self.lines[number]

    def fit(self, target: np.ndarray, *parts: np.ndarray) -> tuple[np.ndarray, float]:
        """Fit lines by a real combination of others where there is motion; return R too."""
        used = self.used
        matrix = np.array([_split(part[used]) for part in parts]).T
        wanted = _split(target[used])
        size = np.linalg.norm(matrix, axis=0)
        if not size.all() or not wanted.any():
            return np.zeros(len(parts)), 0.0
        gains, *_ = np.linalg.lstsq(matrix / size, wanted, rcond=None)
        error = wanted - matrix / size @ gains
        return gains / size, float(np.sqrt(max(0.0, 1 - error @ error / (wanted @ wanted))))


def _split(lines: np.ndarray) -> np.ndarray:
    """Return real and imaginary parts as one real vector."""
    return np.concatenate([np.real(lines), np.imag(lines)])


def _find_harmonics(
    signals: np.ndarray, power: np.ndarray, fast: np.ndarray, rate_hz: float
) -> np.ndarray:
    """Return the power at harmonics of 1/period, with the period of least overlap.

    A multisine at rest outside its period has no power at the harmonics of the others only if the
    harmonics are exact: an error of half a line in the highest hides it.
    """
    moving = fast > _SLOW
    if not moving.any():
        return power[:, 4:]
    signals_moving, n = signals[moving], signals.shape[1]
    share = np.cumsum(power[moving] / power[moving].sum(axis=1, keepdims=True), axis=1)
    top = float(np.median((share < _TOP).sum(axis=1))) * rate_hz / n
    energy = np.cumsum(signals_moving**2, axis=1)
    energy /= energy[:, -1:]
    length = float(np.median((energy < _ENDS[1]).sum(axis=1) - (energy < _ENDS[0]).sum(axis=1)))
    length = max(length, 8.0) / rate_hz
    every = max(1, int(rate_hz / (3.0 * max(top, 1 / length))))
    usable = n // every * every
    thinned = signals[:, :usable].reshape(len(signals), -1, every).mean(axis=2)
    time = np.arange(thinned.shape[1]) * every / rate_hz
    n_lines = int(np.clip(top * length, 8, _MOST_LINES))
    harmonics = np.arange(1, n_lines + 1)
    least, best = np.inf, length
    compared = thinned[moving][:: max(1, int(moving.sum()) // _MOST_SCANNED)]

    def transform(samples: np.ndarray, period: float) -> np.ndarray:
        return np.abs(samples @ np.exp(-2j * np.pi / period * np.outer(time, harmonics))) ** 2

    for period in length * np.arange(0.85, 1.1, 0.25 / n_lines):
        lines = transform(compared, period)
        own = lines / np.maximum(lines.sum(axis=1, keepdims=True), _LEAST)
        overlap = float((np.sqrt(own).sum(axis=0) ** 2).sum())
        if overlap < least:
            least, best = overlap, period
    return transform(thinned, best)


def recognise_columns(columns: Sequence[Recorded]) -> list[Meaning]:
    """Return the meaning of each column of one clock, by its words and its motion.

    Parameters
    ----------
    columns
        Equally many samples of one clock each.

    Returns
    -------
    list of Meaning
        Names of the list of usual ones stay. Everything else is marked: ``sure`` only where the
        unit is stated, ``known`` nowhere.
    """
    if not columns:
        return []
    steady = [_without_gaps(c) for c in columns]
    motion = _MovingColumns(steady)
    hints = [_read_words(c) for c in columns]
    found = _find_kinds(motion, hints)
    return [_to_meaning(c, own) for c, own in zip(columns, _find_units(motion, found), strict=True)]


@dataclass(frozen=True, slots=True)
class _Found:
    name: str = ""
    kind: str = ""
    role: Role | None = None
    unit: str = ""
    sure: bool = False
    surface: str = ""


def _without_gaps(column: Recorded) -> Recorded:
    good = np.isfinite(column.samples)
    if good.all() and np.abs(column.samples).max() <= _LARGEST:
        return column
    at = np.arange(good.size)
    if not good.any() or np.abs(column.samples[good]).max() > _LARGEST:
        return replace(column, samples=np.zeros(good.size))
    return replace(column, samples=np.interp(at, at[good], column.samples[good]))


def _read_words(column: Recorded) -> _Hint:
    """Return what the words of a name say; the stated unit excludes what it contradicts."""
    bare = re.sub(r"[\[(][^\])]*[\])]\s*$", "", column.field.strip()).rpartition(".")[2]
    words = [word.lower() for word in _WORD.findall(bare)]
    words += [_MODIFIERS[pair] for pair in pairwise(words) if pair in _MODIFIERS]
    if not _ALL_WORDS & set(words):  # run together, as in outsideairtemp
        joined = "".join(words)
        words += [word for word in _LONG_WORDS if word in joined][:1]
    dimension = _dimension(column)
    if _OTHER_WORDS & set(words):
        return _Hint(kind="" if dimension in ("", "number") else dimension)
    surface = bool(_SURFACE_WORDS & set(words))
    if surface and dimension in ("", "angle"):
        role = Role.COMMAND if _COMMAND_WORDS & set(words) else Role.INPUT
        return _Hint(kind="deflection", role=role)
    # A letter is a quantity beside the name of its recorder alone: the r of az_4r is a side.
    alone = all(len(w) == 1 or w.isdigit() or w in _RECORDERS for w in words)
    matches = [
        _QUANTITIES[word]
        for word in sorted(words, key=len)[::-1]
        if word in _QUANTITIES and (alone or len(word) > 1)
    ]
    if words[:1] == ["pitch"] and not matches and dimension in ("angle", "rate"):
        matches = [("theta", "angle") if dimension == "angle" else ("q", "rate")]
    for name, kind in matches:
        if dimension and dimension != kind and not (kind == "fuel" and dimension == "number"):
            continue
        role = Role.CONDITION if kind in _CONDITION_KINDS else Role.OUTPUT
        return _Hint(name=name, kind=kind, role=role)
    return _Hint(kind="" if dimension in ("", "number") else dimension)


def _dimension(column: Recorded) -> str:
    unit = _stated_unit(column)
    return _DIMENSIONS.get(units.dimension(unit), "number") if unit else ""


def _stated_unit(column: Recorded) -> str:
    if column.named.sure and column.named.unit:
        return column.named.unit
    within = re.search(r"[\[(]([^\])]*)[\])]\s*$", column.field)
    for text in (column.unit, within[1] if within else ""):
        text = _STATED.get(text.strip().lower(), text.strip())
        if text and units.is_known(text):
            return text
    return ""


def _read_unknown_unit(column: Recorded) -> str:
    """Return a stated unit that is not known, which is retained and asked; empty if there is none.

    What is in brackets without a fraction may be a place.
    """
    within = re.search(r"[\[(]([^\])]*)[\])]\s*$", column.field)
    texts = (column.unit, within[1] if within and re.search(r"[/^]", within[1]) else "")
    written = (text.strip() for text in texts if text != COUNTS)
    named = (text for text in written if text and text.lower() not in _STATED)
    return next((text for text in named if not units.is_known(text)), "")


def _find_kinds(motion: _MovingColumns, hints: Sequence[_Hint]) -> list[_Found]:
    """Return name, kind and role of each column."""
    found = [_Found(h.name, h.kind, h.role) for h in hints]
    pair = _find_rate(motion, found)
    slow = {
        k
        for k in range(len(found))
        if k not in pair
        and (hints[k].role is Role.CONDITION or (hints[k].role is None and _drifts(motion, k)))
    }
    for k in slow:
        found[k] = replace(found[k], role=Role.CONDITION)
    surfaces = _find_surfaces(motion, hints, slow | pair)
    for k, (role, first) in surfaces.items():
        found[k] = _Found("", "deflection", role, surface=motion.columns[first].field)
    rest = [k for k in range(len(found)) if k not in slow and k not in surfaces]
    for k in rest:
        kind = found[k].kind or ("acceleration" if _find_g(abs(motion.mean[k])) else "")
        found[k] = _Found(found[k].name, kind, Role.OUTPUT)
    _find_alpha(motion, found, rest)
    _name_conditions(motion, found, slow)
    return found


def _drifts(motion: _MovingColumns, k: int) -> bool:
    """Return whether a column describes the condition: it drifts, or only falls, as fuel does."""
    steps = np.diff(motion.columns[k].samples)
    return bool(motion.fast[k] < _SLOW or (steps <= 0).all() or (steps >= 0).all())


def _find_surfaces(
    motion: _MovingColumns, hints: Sequence[_Hint], slow: Iterable[int]
) -> dict[int, tuple[Role, int]]:
    """Return measured surfaces and commands, each with the first column of its surface.

    Surfaces share no lines, and commands lead.
    """
    still = set(slow)
    possible = [
        k
        for k, hint in enumerate(hints)
        if k not in still and hint.kind in ("", "angle", "deflection") and not hint.name
        and (hint.kind == "deflection" or _size(motion.span[k], "deflection") < 1.0)
    ]  # fmt: skip
    # A surface that is trimmed to 1 deg looks as an acceleration in g, which shares their lines.
    seems = {k: "" if hints[k].kind else _find_g(abs(motion.mean[k])) for k in possible}
    groups = _group_same(motion, [k for k in possible if not seems[k]])
    named = [any(hints[k].kind == "deflection" for k in group) for group in groups]
    chosen = _find_disjoint(motion.overlap, [group[0] for group in groups], named)
    apart = [groups[number][0] for number in sorted(chosen)]
    for group in _group_same(motion, [k for k in possible if seems[k] == "g"]):
        others = (n for n in range(len(groups)) if named[n] or n in chosen)
        same = next((n for n in others if motion.is_same(group[0], groups[n][0])), None)
        if same is not None:  # the other side of a surface
            groups[same] += group
        elif apart and (motion.overlap[group[0], apart] < _DISJOINT).all():
            chosen.add(len(groups))
            groups.append(group)
            named.append(False)
            apart.append(group[0])
    roles: dict[int, tuple[Role, int]] = {}
    for number, group in enumerate(groups):
        if named[number] or number in chosen:
            own = _find_commands(motion, hints, group)
            roles |= {k: (role, group[0]) for k, role in own.items()}
    return roles


def _group_same(motion: _MovingColumns, columns: Iterable[int]) -> list[list[int]]:
    """Return columns of one surface together: its command, its other side."""
    groups: list[list[int]] = []
    for k in columns:
        for group in groups:
            if motion.is_same(k, group[0]):
                group.append(k)
                break
        else:
            groups.append([k])
    return groups


def _find_disjoint(overlap: np.ndarray, first: Sequence[int], named: Sequence[bool]) -> set[int]:
    """Return the largest set of groups whose spectra are disjoint in pairs, with the named ones."""
    chosen = {k for k, own in enumerate(named) if own}

    def fits(k: int, others: Iterable[int]) -> bool:
        return all(overlap[first[k], first[other]] < _DISJOINT for other in others)

    free = [k for k in range(len(first)) if k not in chosen and fits(k, chosen)]
    best: set[int] = set()

    def extend(taken: set[int], left: list[int]) -> None:
        nonlocal best
        if len(taken) > len(best):
            best = set(taken)
        for number, k in enumerate(left):
            if len(taken) + len(left) - number <= len(best):
                return
            rest = [other for other in left[number + 1 :] if fits(other, (k,))]
            extend(taken | {k}, rest)

    extend(set(), free[:24])  # more are responses
    return chosen | best if len(chosen | best) > 1 else chosen


def _find_commands(
    motion: _MovingColumns, hints: Sequence[_Hint], group: Sequence[int]
) -> dict[int, Role]:
    """Return which columns of one surface are commands: those ahead of the others."""
    ahead = {k: motion.lead(k, group[0]) for k in group}
    first = max(ahead.values())
    lag = first - min(ahead.values())
    roles: dict[int, Role] = {}
    for k in group:
        leads = lag > _LEAST_LEAD_S and first - ahead[k] < lag / 2
        said = hints[k].role if hints[k].kind == "deflection" else None
        is_command = said is Role.COMMAND if said is Role.COMMAND else leads
        roles[k] = Role.COMMAND if is_command else Role.INPUT
    return roles


def _find_g(mean: float) -> str:
    """Return the unit in which a mean is one g within a fifth; empty if in none."""
    for unit in ("g", "m/s2", "ft/s2"):
        if 0.8 * _G < mean * units.lookup(unit).factor < 1.2 * _G:
            return unit
    return ""


def _find_rate(motion: _MovingColumns, found: list[_Found]) -> set[int]:
    """Find the attitude and the gyro of which one is the derivative of the other."""
    moving = [(k, own) for k, own in enumerate(found) if motion.span[k] > 0.0]
    angles = [k for k, own in moving if (own.name, own.kind) in _MAY_BE_THETA]
    rates = [k for k, own in moving if (own.name, own.kind) in _MAY_BE_Q]
    if not angles or not rates:
        return set()
    slopes = np.array([motion.derivative(k) for k in angles])[:, motion.used]
    lines = motion.lines[rates][:, motion.used]
    products = (slopes @ lines.conj().T).real
    sizes = [np.maximum(np.linalg.norm(each, axis=1), _LEAST) for each in (slopes, lines)]
    fits = products / np.outer(*sizes)
    gains = np.log(np.maximum(products / sizes[0][:, None] ** 2, _LEAST))
    near = np.abs(gains[..., None] + np.log([1.0, _DEG, 1 / _DEG])).min(axis=2) < _SAME_GAIN
    fits[~near | (np.array(angles)[:, None] == np.array(rates))] = 0.0
    if fits.max() < _RATE_CORRELATION:
        return set()
    first, second = np.unravel_index(np.argmax(fits), fits.shape)
    pair = angles[first], rates[second]
    found[pair[0]] = _Found("theta", "angle", Role.OUTPUT)
    found[pair[1]] = _Found("q", "rate", Role.OUTPUT)
    return set(pair)


def _find_alpha(motion: _MovingColumns, found: list[_Found], rest: Sequence[int]) -> None:
    """Find the vane: the normal acceleration is V times the rate of alpha less q."""
    names = {own.name: k for k, own in enumerate(found) if own.name}
    az = [k for k in rest if found[k].kind == "acceleration"]
    if "alpha" in names or "q" not in names or not az:
        return
    best, chosen = 0.0, None
    for k in rest:
        if found[k].name or found[k].kind not in ("", "angle"):
            continue
        for one in az[:_MOST_COMPARED]:
            parts = (motion.derivative(k), motion.lines[names["q"]])
            gains, fit = motion.fit(motion.lines[one], *parts)
            if gains[0] * gains[1] < 0.0 and fit > max(best, 0.7):
                best, chosen = fit, k
    if chosen is not None and _size(motion.span[chosen], "angle") < 2.5:
        found[chosen] = _Found("alpha", "angle", Role.OUTPUT)


def _size(span: float, kind: str) -> float:
    """Return the distance of a motion from the usual in its nearer unit, in powers of ten."""
    ratio = np.log10(max(span, 1e-12) / _USUAL[kind])
    return float(min(abs(ratio), abs(ratio + np.log10(180 / np.pi))))


def _name_conditions(motion: _MovingColumns, found: list[_Found], slow: Iterable[int]) -> None:
    """Name what drifts: fuel falls, altitude is large, the rest is airspeed or temperature."""
    names = {own.name for own in found}
    kinds = {
        "temperature": "temperature",
        "airspeed": "speed",
        "altitude": "length",
        "fuel_fraction": "fuel",
    }
    for k in sorted(slow):
        own = found[k]
        if own.name:
            continue
        values = motion.columns[k].samples
        falls = bool((np.diff(values) <= 0).all()) and motion.span[k] > 0.0
        mean = float(motion.mean[k])
        if own.kind in ("", "fuel") and falls and values.min() >= 0.0 and values.max() <= 100.0:
            name = "fuel_fraction"
        elif own.kind == "length" or (not own.kind and abs(mean) > 300.0):
            name = "altitude"
        elif own.kind == "speed":
            name = "airspeed"
        elif own.kind == "temperature" or (
            # what moves about zero is no temperature; near 0 degC the name must say it
            not own.kind
            and -70.0 < mean < 60.0
            and motion.span[k] < 0.5 * abs(mean)
            and not np.isin(values, (0.0, 1.0)).all()
        ):
            name = "temperature"
        else:
            name = ""
        if name and name not in names:
            found[k] = replace(own, name=name, kind=kinds.get(name, own.kind))
            names.add(name)
    left = [
        k
        for k in slow
        if not found[k].name and found[k].kind in ("", "speed")
        and motion.mean[k] > _LEAST_SPEED and motion.span[k] < 0.5 * motion.mean[k]
    ]  # fmt: skip
    if "airspeed" not in names and len(left) == 1:
        found[left[0]] = replace(found[left[0]], name="airspeed", kind="speed")


def _find_units(motion: _MovingColumns, found: Sequence[_Found]) -> list[_Found]:
    """Return units: as stated, else those in which related columns agree, else the usual size."""
    result: list[_Found] = []
    names = {own.name: k for k, own in enumerate(found) if own.name}
    stated = [_stated_unit(c) for c in motion.columns]
    attitude = _find_attitude_units(motion, stated, names)
    for k, own in enumerate(found):
        unit = stated[k]
        if not unit and own.kind == "deflection":
            unit = _of_twin(motion, found, stated, k) or _by_size(motion.span[k], "deflection")
        elif not unit and own.kind == "acceleration":
            unit = _find_g(abs(motion.mean[k])) or "g"
        elif not unit and own.kind in ("angle", "rate"):
            unit = _of_attitude(motion, own, attitude, k) or _by_size(motion.span[k], own.kind)
        elif not unit:
            unit = _of_condition(motion, own, k)
        result.append(replace(own, unit=unit, sure=bool(stated[k])))
    return _check_airspeed(motion, result, names)


def _by_size(span: float, kind: str) -> str:
    usual = _USUAL[kind]
    per_s = "/s" if kind == "rate" else ""
    return ("deg" if span > usual / np.sqrt(180 / np.pi) else "rad") + per_s


def _of_twin(motion: _MovingColumns, found: Sequence[_Found], stated: Sequence[str], k: int) -> str:
    """Return the unit of a deflection from its command or other side, whose unit is stated."""
    for other, own in enumerate(found):
        if other == k or own.kind != "deflection" or not stated[other]:
            continue
        if motion.is_same(k, other):
            factor = units.lookup(stated[other]).factor * motion.span[other] / motion.span[k]
            return min(_KINDS["angle"], key=lambda u: abs(np.log(factor / units.lookup(u).factor)))
    return ""


@dataclass(frozen=True, slots=True)
class _Attitude:
    theta: int
    angle: str
    rate: str


def _find_attitude_units(
    motion: _MovingColumns, stated: Sequence[str], names: Mapping[str, int]
) -> _Attitude | None:
    """Return the units of theta and q: as stated, else of usual size, each by the other."""
    theta, q = names.get("theta"), names.get("q")
    if theta is None or q is None:
        return None
    gains, fit = motion.fit(motion.lines[q], motion.derivative(theta))
    if fit < _RATE_CORRELATION or gains[0] <= 0.0:
        return None

    def distance(angle: str, rate: str) -> float:
        factors = units.lookup(rate).factor / units.lookup(angle).factor
        return 100.0 * abs(np.log10(gains[0] * factors)) + sum(
            abs(np.log10(motion.span[k] * units.lookup(unit).factor * _DEG / _USUAL[kind]))
            for k, unit, kind in ((theta, angle, "angle"), (q, rate, "rate"))
        )

    options = [
        (distance(angle, rate), angle, rate)
        for angle in ([stated[theta]] if stated[theta] else _KINDS["angle"])
        for rate in ([stated[q]] if stated[q] else _KINDS["rate"])
    ]
    _, angle, rate = min(options)
    return _Attitude(theta, angle, rate)


def _of_attitude(motion: _MovingColumns, own: _Found, attitude: _Attitude | None, k: int) -> str:
    """Return the unit of theta or q, or that in which another one moves about as far."""
    if attitude is None or not motion.span[k]:
        return ""
    if own.name in ("theta", "q"):
        return attitude.angle if own.name == "theta" else attitude.rate
    if own.kind == "rate":
        return ""
    factor = units.lookup(attitude.angle).factor * motion.span[attitude.theta] / motion.span[k]
    return min(_KINDS["angle"], key=lambda u: abs(np.log(factor / units.lookup(u).factor)))


def _of_condition(motion: _MovingColumns, own: _Found, k: int) -> str:
    mean = abs(float(motion.mean[k]))
    if own.kind == "fuel":
        return "%" if mean > 1.0 else "1"
    if own.kind == "temperature":
        return "K" if mean > 180.0 else "degC"
    if own.kind == "strain" or (not own.kind and own.role is Role.OUTPUT and motion.span[k] > 20):
        return "ustrain" if motion.span[k] > 1.0 else "strain"
    return _KINDS[own.kind][0] if own.kind in _KINDS else ""


def _check_airspeed(
    motion: _MovingColumns, found: list[_Found], names: Mapping[str, int]
) -> list[_Found]:
    """Find airspeed and its unit: normal acceleration is V times the rate of the flight path."""
    speed = _find_speed(motion, found, names)
    if speed is None:
        return found
    candidates = [
        k
        for k, own in enumerate(found)
        if own.role is Role.CONDITION and own.name in ("", "airspeed") and motion.mean[k] > 0.0
        and own.kind in ("", "speed")
    ]  # fmt: skip

    def best(k: int, unit: str) -> float:
        return abs(float(np.log(motion.mean[k] * units.lookup(unit).factor / speed)))

    pairs = [
        (best(k, unit), k, unit)
        for k in candidates
        for unit in ([found[k].unit] if found[k].sure else _KINDS["speed"])
        if units.is_known(unit) and units.dimension(unit) == "speed"
    ]
    if pairs and ("airspeed" in names or min(pairs)[0] < 0.25):
        _, k, unit = min(pairs)
        if "airspeed" not in names or names["airspeed"] == k:
            found[k] = replace(found[k], name="airspeed", kind="speed", unit=unit)
    return found


def _find_speed(
    motion: _MovingColumns, found: Sequence[_Found], names: Mapping[str, int]
) -> float | None:
    """Return the airspeed [m/s] by which an accelerometer, the vane and the gyro agree."""
    if not {"alpha", "q"} <= names.keys():
        return None
    alpha, q = names["alpha"], names["q"]
    factors = [units.lookup(found[k].unit).factor for k in (alpha, q)]
    path = factors[0] * motion.derivative(alpha) - factors[1] * motion.lines[q]
    estimates: list[tuple[float, float]] = []
    for k, own in enumerate(found):
        if own.kind == "acceleration" and own.unit:
            gains, fit = motion.fit(motion.lines[k] * units.lookup(own.unit).factor, path)
            estimates.append((fit, abs(float(gains[0]))))
    best = max(estimates, default=(0.0, 0.0))
    return best[1] if best[0] > 0.7 else None


def _with_unit(column: Recorded, own: _Found) -> Meaning:
    """Return a usual name with the unit of its motion, where the file states none."""
    named = column.named
    if named.sure or not own.unit:
        return named
    same = units.is_known(named.unit) and units.dimension(named.unit) == units.dimension(own.unit)
    return replace(named, unit=own.unit) if same else named


def _to_meaning(column: Recorded, own: _Found) -> Meaning:
    named = column.named
    if not is_measured(column.field):
        return named
    if named.known:
        return replace(_with_unit(column, own), surface=own.surface)
    sure = own.sure or named.sure
    unit = (not sure and _read_unknown_unit(column)) or own.unit or named.unit
    name = own.name if own.name in ("alpha", "beta", "theta", "phi", "psi", "p", "q", "r") else ""
    if own.role is Role.CONDITION:
        name = own.name
    return Meaning(
        name=name or named.name,
        unit=unit,
        role=own.role or named.role,
        sure=sure,
        known=False,
        surface=own.surface,
    )
