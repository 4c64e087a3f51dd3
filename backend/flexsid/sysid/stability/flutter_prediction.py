"""Flutter speed from identified derivatives, with its uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.flutter_extrapolation import (
    FlownInstability,
    FlownPoint,
    Standing,
    compare_with_flight,
    name_leading,
)
from flexsid.sysid.stability.root_errors import (
    ModalErrors,
    UncertainDerivatives,
    compute_crossing_slopes,
    compute_modal_factors,
    compute_modal_slopes,
    estimate_crossing_error,
    estimate_growth_rates,
    estimate_root_bands,
    sample_crossings,
)
from flexsid.sysid.stability.root_tracking import FlutterCrossing, RootLocus, track_roots

_POINTS = 120  # airspeeds of a root locus
_SIGMAS = 1.96  # of a 95 % interval
_UNRESOLVED_SHARE = 0.3  # of a flutter speed: with a larger error it is not identifiable
_TAILS = (0.025, 0.975)  # of drawn flutter speeds: a 95 % interval
_DRAWN_TO = 1.5  # of the highest airspeed searched, up to which drawn models are
_CHECKED_REACH = 1.5  # of a first-order interval, by where its roots must have left the axis
_CHECKED_SPEEDS = 40
_LEAST_DRAWN = 0.3  # of drawn models, that are stable as far as was flown
_LARGEST_EXTRAPOLATION = 2.0  # of the largest dynamic pressure flown, of a straight line
_MOST_PREDICTIONS = 30  # of a fixed-point iteration


@dataclass(frozen=True, slots=True)
class FlutterPrediction:
    """Predicted flutter speed and its uncertainty.

    ``crossing`` is None for an aircraft that is stable up to the highest speed searched;
    ``sentence`` states the result. ``airspeed_std`` is statistical; ``spread`` is due to other
    model structures, ``modal_std`` to the uncertainty of the modal table's frequencies [m/s].
    Where flight contradicts the model or does not determine its unstable root, ``refusal`` states
    the reason and there is no crossing. ``drawn`` are the airspeeds between which 95 % of models
    drawn within statistics and modal errors become unstable, where first order does not hold.
    """

    locus: RootLocus
    crossing: FlutterCrossing | None
    airspeed_std: float
    spread: float
    sentence: str
    modal_std: float = 0.0
    refusal: str = ""
    drawn: tuple[float, float] | None = None

    @property
    def total_std(self) -> float:
        """Standard deviation of the airspeed: statistics, structure and modal table. [m/s]"""
        return float(np.sqrt(self.airspeed_std**2 + self.spread**2 + self.modal_std**2))

    @property
    def interval(self) -> tuple[float, float] | None:
        """95 % interval of the airspeed: statistics, structure and modal table together. [m/s]

        A model without flutter has one if some of the models drawn within its errors flutter.
        """
        if self.crossing is None:
            return self.drawn
        speed, spread = self.crossing.airspeed, _SIGMAS * self.spread
        reach = _SIGMAS * float(np.hypot(self.airspeed_std, self.modal_std))
        low, high = self.drawn or (speed - reach, speed + reach)
        below, above = (float(np.hypot(edge - speed, spread)) for edge in (low, high))
        if not (np.isfinite(below) and np.isfinite(above)):
            return None
        # The speed itself may lie outside of what was drawn: most models are then unstable before.
        return max(0.0, speed - below if low < speed else low - spread), (
            speed + above if high > speed else high + spread
        )


def predict_flutter(
    found: IdentifiedModes,
    band: tuple[float, float],
    density: float | None = None,
    spread: float = 0.0,
    called: Mapping[str, str] | None = None,
    flown: Sequence[FlownPoint] = (),
    *,
    draws: bool = False,
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
    draws
        Whether the interval is that of drawn models where first order does not hold; these take
        longer than all else.

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
    flown_to = max((one.airspeed for one in flown if one.comparable), default=low)
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
        prediction = FlutterPrediction(locus, None, np.nan, spread, sentence, refusal=refusal)
        if refusal or already or not draws:
            return prediction
        drawn = _draw_interval(found, (max(low, flown_to), high), density)
        if drawn is None or drawn[0] >= high:
            return prediction
        sentence += _describe_drawn(drawn, _DRAWN_TO * high)
        return replace(prediction, drawn=drawn, sentence=sentence)
    std = estimate_crossing_error(found.aircraft, crossing, found.uncertain, density)
    modal_std = _modal_std(found, crossing, density)
    prediction = FlutterPrediction(locus, crossing, std, spread, "", modal_std)
    start = max(low, flown_to) if flown_to < crossing.airspeed else low
    reach = _SIGMAS * float(np.hypot(std, modal_std))
    if draws and not _is_first_order(found, crossing, reach, start, density):
        prediction = replace(prediction, drawn=_draw_interval(found, (start, high), density))
    sentence = f"{already} " if already else ""
    sentence += f"{_describe_crossing(crossing, names)} at {crossing.airspeed:.2f}"
    sentence += _describe_error(prediction)
    sentence += f", {crossing.frequency:.2f} rad/s." if crossing.frequency else "."
    if crossing.recovers_at is not None:
        sentence += f" It is a hump: stable again from {crossing.recovers_at:.2f} m/s."
    if prediction.drawn is not None and prediction.drawn[1] >= _DRAWN_TO * high:
        sentence += f" Of models within the errors{_describe_stable(_DRAWN_TO * high)}"
    half = 0.5 * np.ptp(prediction.interval) if prediction.interval else 0.0
    if half > _UNRESOLVED_SHARE * crossing.airspeed:
        sentence += " With so large an error the flutter speed is not identifiable from these runs."
    return replace(prediction, sentence=f"{sentence}{remark}")


def _describe_error(prediction: FlutterPrediction) -> str:
    """Describe the error of a flutter speed: its interval where first order does not hold."""
    interval = prediction.interval
    if interval is None:
        return " m/s, with unknown error"
    if prediction.drawn is None:
        return f" ± {2.0 * prediction.total_std:.2f} m/s"
    low, high = interval
    return f" m/s, between {low:.1f} and {high:.1f} m/s with 95 % probability"


def _describe_drawn(drawn: tuple[float, float], end: float) -> str:
    """Describe the drawn models of a model without flutter, which were followed to an airspeed."""
    low, high = drawn
    if high < end:
        between = f"between {low:.1f} and {high:.1f} m/s"
        return f" Of models within the errors, 95 % become unstable {between}."
    stable = _describe_stable(end)
    return f" Models within the errors become unstable from {low:.1f} m/s on;{stable}"


def _describe_stable(end: float) -> str:
    return f" some are stable up to {end:.1f} m/s, as far as they were followed."


def _draw_interval(
    found: IdentifiedModes, band: tuple[float, float], density: float | None
) -> tuple[float, float] | None:
    """Airspeeds between which 95 % of models within the errors become unstable first. [m/s]

    None where errors are unknown, or all are stable. Models that are unstable where the band
    begins, the fastest airspeed flown, are rejected, since the aircraft was not. Those that are
    stable in the band are followed to 1.5 times its end, where the interval ends if more than
    2.5 % of them still are.
    """
    uncertain = found.uncertain
    is_known = uncertain.rows.size > 0 and bool(np.isfinite(uncertain.covariance).all())
    if not is_known or found.aircraft.shape is not None:
        return None
    end = _DRAWN_TO * band[1]
    drawn = sample_crossings(
        found.aircraft,
        (band[0], end),
        uncertain,
        _compute_modal_errors(found),
        density,
    )
    ahead = drawn[drawn > band[0]]
    if ahead.size < _LEAST_DRAWN * drawn.size:  # flight rejects the errors themselves
        ahead = drawn
    low, high = np.quantile(np.minimum(ahead, end), _TAILS)
    return (float(low), float(high)) if low < end else None


def _is_first_order(
    found: IdentifiedModes,
    crossing: FlutterCrossing,
    reach: float,
    start: float,
    density: float | None,
) -> bool:
    """Whether the first-order interval of a crossing agrees with the errors of all roots.

    Notes
    -----
    From ``start`` to 1.5 times its distance below the crossing all roots must be stable by 1.96 of
    their own standard deviations, at as much above it one must be unstable by as much. Otherwise a
    hump barely reaches the axis, another root may become unstable before, or roots coalesce.
    """
    if not np.isfinite(reach) or found.aircraft.shape is not None or not found.uncertain.rows.size:
        return True
    edges = crossing.airspeed + np.array([-1.0, 1.0]) * _CHECKED_REACH * reach
    if edges[0] <= start:
        return False
    speeds = np.append(np.linspace(start, edges[0], _CHECKED_SPEEDS), edges[1])
    growth, std = estimate_growth_rates(
        found.aircraft,
        speeds,
        found.uncertain,
        _compute_modal_errors(found),
        density,
    )
    is_stable = bool(np.all(growth[:-1] + _SIGMAS * std[:-1] < 0.0))
    return is_stable and bool(np.any(growth[-1] - _SIGMAS * std[-1] > 0.0))


def _compute_modal_errors(found: IdentifiedModes) -> ModalErrors:
    """Compute the errors of the modal table and the changes of derivatives that compensate them.

    Notes
    -----
    At the dynamic pressure q_e flown, data determine the sum omega^2 - q_e S c C_Q_eta / m of
    Eq. 25: an estimated C_Q_eta compensates an error of omega^2 there, and 1 - q / q_e of it
    remains at q. A C_Q_eta that was not estimated compensates nothing. The sum of structural
    and aerodynamic damping, 2 zeta omega - rho V S c^2 C_Q_etadot / 4 m, is known there as well: of
    an error of zeta 1 - rho V / (rho V)_e remains. What fused runs leave, their fit gives.
    """
    aircraft, uncertain, stiffness = found.aircraft, found.uncertain, found.stiffness
    n, first = aircraft.modes.omega.size, aircraft.derivatives.body.size
    gains, std = np.zeros((uncertain.rows.size, 2 * n)), np.zeros(2 * n)
    if stiffness is None:
        return ModalErrors(np.diag(std), gains)
    if stiffness.joint is not None:
        return stiffness.joint
    std[:n] = stiffness.relative_std
    if stiffness.damping_std is not None:
        std[n:] = stiffness.damping_std
    c = aircraft.condition
    forces = aircraft.derivatives.body.row_factors(c, aircraft.modes.mass)[first:]
    rates = forces * c.chord / (2.0 * c.airspeed)
    per_unit = np.concatenate(
        [
            forces * stiffness.pressure / c.dynamic_pressure,
            rates * stiffness.mass_flow / (c.density * c.airspeed),
        ]
    )
    compensated = compute_modal_factors(aircraft) / per_unit
    places = list(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
    for k, change in enumerate(compensated.tolist()):
        own = (first + k % n, first + k)
        if own in found.places:
            gains[places.index(own), k] = -change
    return ModalErrors(np.diag(std**2), gains)


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
        uncertain = _add_stiffness_errors(found, high, density)
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
    found: IdentifiedModes, airspeed: float, density: float | None
) -> UncertainDerivatives:
    """Add the errors of modal frequencies at an airspeed to those of C_Q_eta."""
    aircraft, uncertain, errors = found.aircraft, found.uncertain, _compute_modal_errors(found)
    air = aircraft.condition.density if density is None else density
    condition = replace(aircraft.condition, airspeed=airspeed, density=air)
    body, n = aircraft.derivatives.body, aircraft.modes.omega.size
    per_unit = body.row_factors(condition, aircraft.modes.mass)[body.size :]
    known = list(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
    own = [(body.size + k, body.size + k) for k in range(n)]
    places = list(dict.fromkeys([*known, *own]))
    at = [places.index(place) for place in own]
    change = np.zeros((len(places), 2 * n))
    change[: len(known)] = errors.gains
    change[at, np.arange(n)] += compute_modal_factors(aircraft)[:n] / per_unit
    covariance = np.zeros((len(places), len(places)))
    covariance[: len(known), : len(known)] = uncertain.covariance
    variance = np.einsum("ij,jk,ik->i", change[at], errors.covariance, change[at])
    covariance[at, at] += variance
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
    """Standard deviation of a crossing's airspeed from that of the modal table. [m/s]"""
    if found.stiffness is None:
        return 0.0
    aircraft, errors = found.aircraft, _compute_modal_errors(found)
    places = found.uncertain.rows, found.uncertain.columns
    of_table = np.concatenate(compute_modal_slopes(aircraft, crossing, density))
    slopes = compute_crossing_slopes(aircraft, crossing, *places, density) @ errors.gains
    slopes = slopes - of_table * compute_modal_factors(aircraft)
    return float(np.sqrt(max(slopes @ errors.covariance @ slopes, 0.0)))


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
