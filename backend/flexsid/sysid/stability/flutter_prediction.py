"""Flutter speed from identified derivatives, with its uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes, StiffnessError
from flexsid.sysid.stability.flutter_extrapolation import (
    FlownInstability,
    FlownPoint,
    Standing,
    compare_with_flight,
    name_leading,
)
from flexsid.sysid.stability.root_errors import (
    UncertainDerivatives,
    compute_modal_slopes,
    estimate_crossing_error,
    estimate_root_bands,
)
from flexsid.sysid.stability.root_tracking import FlutterCrossing, RootLocus, track_roots

_POINTS = 120  # airspeeds of a root locus
_SIGMAS = 1.96  # of a 95 % interval
_UNRESOLVED_SHARE = 0.3  # of a flutter speed: with a larger error it is not identifiable
_LARGEST_EXTRAPOLATION = 2.0  # of the largest dynamic pressure flown, of a straight line
_MOST_PREDICTIONS = 30  # of a fixed-point iteration


@dataclass(frozen=True, slots=True)
class FlutterPrediction:
    """Predicted flutter speed and its uncertainty.

    ``crossing`` is None for an aircraft that is stable up to the highest speed searched;
    ``sentence`` states the result. ``airspeed_std`` is statistical; ``spread`` is due to other
    model structures, ``modal_std`` to the uncertainty of the modal table's frequencies [m/s].
    Where flight contradicts the model or does not determine its unstable root, ``refusal`` states
    the reason and there is no crossing.
    """

    locus: RootLocus
    crossing: FlutterCrossing | None
    airspeed_std: float
    spread: float
    sentence: str
    modal_std: float = 0.0
    refusal: str = ""

    @property
    def total_std(self) -> float:
        """Standard deviation of the airspeed: statistics, structure and modal table. [m/s]"""
        return float(np.sqrt(self.airspeed_std**2 + self.spread**2 + self.modal_std**2))

    @property
    def interval(self) -> tuple[float, float] | None:
        """95 % interval of the airspeed: statistics, structure and modal table together. [m/s]"""
        reach = _SIGMAS * self.total_std
        if self.crossing is None or not np.isfinite(reach):
            return None
        return max(0.0, self.crossing.airspeed - reach), self.crossing.airspeed + reach


def predict_flutter(
    found: IdentifiedModes,
    band: tuple[float, float],
    density: float | None = None,
    spread: float = 0.0,
    called: Mapping[str, str] | None = None,
    flown: Sequence[FlownPoint] = (),
) -> FlutterPrediction:
    """Predict the flutter speed from roots tracked over a band of airspeeds.

    Parameters
    ----------
    band
        Lowest and highest airspeed. [m/s]
    density
        Of the air; that of the known condition by default. [kg/m3]
    spread
        Standard deviation between model structures. [m/s]
    called
        Labels of motions, by name.
    flown
        Runs that the derivatives come from: a crossing that they contradict, or do not
        determine, is no prediction.

    Raises
    ------
    BadInput
        If the band is empty.
    NotIdentifiable
        If a derivative is no number.
    """
    low, high = band
    names = {name: _name_motion(name) for name in found.aircraft.motions} | dict(called or {})
    if not 0.0 < low < high < np.inf:
        raise BadInput(
            f"airspeeds from {low:g} to {high:g} m/s are not a band; the lowest must be positive "
            "and come first",
            code="bad-airspeed",
        )
    locus = track_roots(found.aircraft, np.linspace(low, high, _POINTS), density)
    growing = locus.unstable
    crossing, remark, refusal = _compare_crossings(found, locus, flown, names)
    if not locus.names:
        refusal = (
            f"No root oscillates over half of the airspeeds from {low:.1f} to {high:.1f} m/s: the"
            " model does not describe the aircraft."
        )
    already = ""
    if growing:
        name = names[locus.names[growing[0]]]
        already = f"Already unstable at {low:.1f} m/s in {name}; look at lower speeds."
    if crossing is None:
        sentence = f"{already}{remark}"
        if refusal:
            sentence = f"No flutter speed is predicted. {refusal}"
        elif not already:
            least = locus.damping().min(axis=0)
            weakest = int(np.argmin(least))
            sentence = (
                f"{_describe_stability(found, locus, flown, density)}; the least damping is "
                f"{100.0 * max(0.0, float(least[weakest])):.1f} % in "
                f"{names[locus.names[weakest]]}.{remark}"
            )
        return FlutterPrediction(locus, None, np.nan, spread, sentence, refusal=refusal)
    std = estimate_crossing_error(found.aircraft, crossing, found.uncertain, density)
    modal_std = _modal_std(found, crossing, density)
    prediction = FlutterPrediction(locus, crossing, std, spread, "", modal_std)
    reach = 2.0 * prediction.total_std
    sentence = f"{already} " if already else ""
    sentence += f"{_describe_crossing(crossing, names)} at {crossing.airspeed:.2f}"
    sentence += f" ± {reach:.2f} m/s" if np.isfinite(reach) else " m/s, with unknown error"
    sentence += f", {crossing.frequency:.2f} rad/s." if crossing.frequency else "."
    if crossing.recovers_at is not None:
        sentence += f" It is a hump: stable again from {crossing.recovers_at:.2f} m/s."
    if np.isfinite(reach) and reach > _UNRESOLVED_SHARE * crossing.airspeed:
        sentence += " With so large an error the flutter speed is not identifiable from these runs."
    return replace(prediction, sentence=f"{sentence}{remark}")


def _describe_stability(
    found: IdentifiedModes, locus: RootLocus, flown: Sequence[FlownPoint], density: float | None
) -> str:
    """State up to which airspeed a model without flutter is stable with its errors.

    Notes
    -----
    Errors of modal frequencies are those of C_Q_eta at the highest airspeed, where those that
    data compensate are largest.
    """
    high, uncertain = float(locus.airspeed[-1]), found.uncertain
    if uncertain.rows.size == 0:
        return f"The model is stable up to {high:.1f} m/s, with unknown error"
    if found.stiffness is not None:
        uncertain = _add_stiffness_errors(found, found.stiffness, high, density)
    bands = estimate_root_bands(found.aircraft, locus, uncertain, density)
    fast = list(locus.fast)
    is_stable = (np.real(locus.roots) + _SIGMAS * bands.real_std < 0.0)[:, fast].all(axis=1)
    condition = found.aircraft.condition
    air = condition.density if density is None else density
    own = condition.airspeed * np.sqrt(condition.density / air)
    tested = max((one.airspeed for one in flown), default=float(own))
    unsure = np.flatnonzero(~is_stable & (locus.airspeed > tested))
    if not unsure.size:
        return f"Stable up to {high:.1f} m/s within two standard errors"
    limit = max(tested, float(locus.airspeed[max(unsure[0] - 1, 0)]))
    return (
        f"Stable within two standard errors up to {limit:.1f} m/s only, without a predicted "
        f"instability up to {high:.1f} m/s"
    )


def _add_stiffness_errors(
    found: IdentifiedModes, stiffness: StiffnessError, airspeed: float, density: float | None
) -> UncertainDerivatives:
    """Add the errors of modal frequencies at an airspeed to those of C_Q_eta."""
    aircraft, uncertain = found.aircraft, found.uncertain
    change = _compute_stiffness_change(found, stiffness, airspeed, density)
    air = aircraft.condition.density if density is None else density
    condition = replace(aircraft.condition, airspeed=airspeed, density=air)
    body = aircraft.derivatives.body
    per_unit = body.row_factors(condition, aircraft.modes.mass)[body.size :]
    known = list(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
    own = [(body.size + k, body.size + k) for k in range(change.size)]
    places = list(dict.fromkeys([*known, *own]))
    at = [places.index(place) for place in own]
    covariance = np.zeros((len(places), len(places)))
    covariance[: len(known), : len(known)] = uncertain.covariance
    covariance[at, at] += (change / per_unit) ** 2
    rows, columns = np.array(places).T
    return UncertainDerivatives(rows, columns, covariance)


def _compare_crossings(
    found: IdentifiedModes, locus: RootLocus, flown: Sequence[FlownPoint], names: Mapping[str, str]
) -> tuple[FlutterCrossing | None, str, str]:
    """The crossing that agrees with the flights, a remark on it, or the reason for none."""
    if not flown:
        return locus.flutter, "", ""
    estimated = frozenset(map(str, found.estimated_modes))

    def compare(instability: FlownInstability) -> tuple[Standing, str]:
        return compare_with_flight(instability, locus, found.aircraft, estimated, flown, names)

    remarks = ""
    for branch in locus.unstable:
        standing, words = compare(_build_initial_instability(locus, branch, names))
        if standing in (Standing.CONTRADICTED, Standing.UNDETERMINED):
            return None, "", words
        remarks += f" {words}" if standing is Standing.PASSED else ""
    for crossing in locus.dangerous:
        words = f"{_describe_crossing(crossing, names)} at {crossing.airspeed:.1f} m/s"
        high = np.inf if crossing.recovers_at is None else crossing.recovers_at
        standing, words = compare(
            FlownInstability(
                words, crossing.airspeed, high, crossing.branch, crossing.participation
            )
        )
        if standing in (Standing.CONTRADICTED, Standing.UNDETERMINED):
            return None, "", words
        remarks += f" {words}" if words else ""
        if standing is not Standing.PASSED:
            return crossing, remarks, ""
    return None, remarks, ""


def _build_initial_instability(
    locus: RootLocus, branch: int, names: Mapping[str, str]
) -> FlownInstability:
    """A root that is unstable at the lowest speed; its motion is that of its name."""
    stable = np.flatnonzero(np.real(locus.roots[:, branch]) <= 0.0)
    high = float(locus.airspeed[stable[0]]) if stable.size else np.inf
    low, name = float(locus.airspeed[0]), locus.names[branch]
    words = f"An instability of {names[name]} from {low:.1f} m/s on"
    return FlownInstability(words, low, high, branch, {name: 1.0})


def _describe_crossing(crossing: FlutterCrossing, names: Mapping[str, str]) -> str:
    moving = name_leading(crossing.participation, names, "with")
    return f"{crossing.mechanism.value.capitalize()} of {moving}"


def _modal_std(found: IdentifiedModes, crossing: FlutterCrossing, density: float | None) -> float:
    """Standard deviation of a crossing's airspeed from that of the modal table. [m/s]

    Notes
    -----
    At the dynamic pressure q_e flown, data determine the sum omega^2 - q_e S c C_Q_eta / m of
    Eq. 25: an estimated C_Q_eta compensates an error of omega^2 there, and 1 - q / q_e of it
    remains at q. A C_Q_eta that was not estimated compensates nothing. The sum of structural
    and aerodynamic damping, 2 zeta omega - rho V S c^2 C_Q_etadot / 4 m, is known there as well: of
    an error of zeta 1 - rho V / (rho V)_e remains.
    """
    if found.stiffness is None:
        return 0.0
    aircraft, stiffness = found.aircraft, found.stiffness
    change = _compute_stiffness_change(found, stiffness, crossing.airspeed, density)
    slopes, of_damping = compute_modal_slopes(aircraft, crossing, density)
    variance = np.sum((slopes * change) ** 2)
    if stiffness.damping_std is not None:
        modes = aircraft.modes
        air = aircraft.condition.density if density is None else density
        n, first = modes.omega.size, aircraft.derivatives.body.size
        own = np.array([(first + k, first + n + k) in found.places for k in range(n)])
        left = 1.0 - np.where(own, air * crossing.airspeed / stiffness.mass_flow, 0.0)
        change = 2.0 * modes.zeta * modes.omega * stiffness.damping_std * left
        variance += np.sum((of_damping * change) ** 2)
    return float(np.sqrt(variance))


def _compute_stiffness_change(
    found: IdentifiedModes, stiffness: StiffnessError, airspeed: float, density: float | None
) -> Float[np.ndarray, " n_modes"]:
    """Standard deviations of the squared frequencies that derivatives leave. [rad2/s2]"""
    air = found.aircraft.condition.density if density is None else density
    left = 1.0 - 0.5 * air * airspeed**2 / _find_independent_pressures(found, stiffness)
    return 2.0 * found.aircraft.modes.omega**2 * stiffness.relative_std * left


def fuse_at_crossing(
    fuse: Callable[[float], IdentifiedModes],
    band: tuple[float, float],
    density: float,
    tested: float,
) -> IdentifiedModes:
    """Fuse derivatives at the dynamic pressure of their own flutter crossing.

    ``fuse`` gives the derivatives that stand for a dynamic pressure [Pa]; ``band`` are the
    airspeeds to search, ``tested`` is the fastest one flown [m/s], in air of a density. [kg/m3]

    Notes
    -----
    Fixed-point iteration with half steps. Without a crossing the derivatives are those of
    the fastest point flown.
    """
    speed = tested
    for _ in range(_MOST_PREDICTIONS):
        found = fuse(0.5 * density * speed**2)
        crossing = predict_flutter(found, band, density).crossing
        if crossing is None:
            return fuse(0.5 * density * tested**2)
        # A straight line is not extrapolated beyond twice the fastest dynamic pressure.
        aim = min(crossing.airspeed, np.sqrt(_LARGEST_EXTRAPOLATION) * tested)
        if abs(aim - speed) < 1e-4 * speed:
            return found
        speed = float(0.5 * (speed + aim))
    return fuse(0.5 * density * speed**2)


def _find_independent_pressures(
    found: IdentifiedModes, stiffness: StiffnessError
) -> Float[np.ndarray, " n_modes"]:
    """Dynamic pressures at which errors of frequencies and of derivatives are independent. [Pa]"""
    if isinstance(stiffness.pressure, np.ndarray):
        return stiffness.pressure
    first = found.aircraft.derivatives.body.size
    n_modes = len(found.aircraft.modes.numbers)
    own = [(first + k, first + k) in found.places for k in range(n_modes)]
    return np.where(own, stiffness.pressure, np.inf)


def compute_structure_spread(speeds: Sequence[float], preferred: float) -> float:
    """Compute the standard deviation of other structures' speeds about the preferred one."""
    if not speeds:
        return 0.0
    return float(np.sqrt(np.mean((np.asarray(speeds, dtype=float) - preferred) ** 2)))


_RIGID_MOTIONS = {
    "SP": "the short period",
    "PH": "the phugoid",
    "DR": "the dutch roll",
    "roll": "the roll mode",
    "spiral": "the spiral",
}


def _name_motion(motion: str) -> str:
    return _RIGID_MOTIONS.get(motion) or f"mode {motion}"
