"""Roots of identified models over airspeed, pressure or fuel, and where they become unstable."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records import finite_or_none
from flexsid.records.flutter import (
    Along,
    EquivalentLine,
    EquivalentPoint,
    FlutterPoint,
    FlutterRoots,
    Instability,
    RootBranch,
    TestedRoot,
)
from flexsid.storage.store import Store
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction
from flexsid.sysid.stability.order import (
    EquivalentMode,
    compute_equivalent_modes,
    fit_in_vacuo_mode,
)
from flexsid.sysid.stability.poles import StateFamily, build_state_family
from flexsid.sysid.stability.root_errors import RootBands, estimate_root_bands
from flexsid.sysid.stability.root_tracking import (
    RootLocus,
    track_family_roots,
    track_shaped_loadings,
)
from flexsid.workflow.flutter.flutter_models import (
    NEXT,
    FlutterModels,
    build_loaded_model,
    name_motion,
)
from flexsid.workflow.flutter.run_models import RunModel, scale_to_fuel
from flexsid.workflow.modal_data.modal_tables import AircraftModes

# --- Roots of identified models over airspeed, dynamic pressure or fuel, and equivalent modes -----

_FUELS = 41
_HZ = 1.0 / (2.0 * np.pi)


def trace_flutter_roots(
    store: Store, models: FlutterModels, along: Along = Along.AIRSPEED
) -> FlutterRoots:
    """Trace the roots of the preferred model with standard errors.

    Parameters
    ----------
    store, models
        Fused runs, and the records that they are from.
    along
        Over fuel the airspeed is that of the next point.
    """
    if along is Along.FUEL:
        return _trace_over_fuel(store, models)
    found = _trace_over_airspeed(models)
    return found if along is Along.AIRSPEED else _convert_to_pressure(models, found)


def _trace_over_airspeed(models: FlutterModels) -> FlutterRoots:
    found, best = models.best.found, models.best.prediction
    locus = best.locus
    bands = estimate_root_bands(found.aircraft, locus, found.uncertain, models.at.density)
    tested = tuple(
        TestedRoot(
            run_id=part.run.id or 0,
            label=part.maneuver.label,
            airspeed_m_s=part.maneuver.condition.airspeed_m_s,
            at=part.maneuver.condition.airspeed_m_s,
            name=name,
            frequency=abs(root.value),
            damping=-root.value.real / abs(root.value),
            damping_std=root.damping_std,
        )
        for part in models.best.parts
        for name, root in part.roots.items()
    )
    return FlutterRoots(
        along=Along.AIRSPEED,
        at=locus.airspeed,
        airspeed_m_s=locus.airspeed,
        branches=build_branches(locus, bands, models.at.modes, _list_held(models)),
        tested=tested,
        flutter=None if best.crossing is None else best.crossing.airspeed,
        interval=best.interval,
        tested_to=models.at.tested,
        by_monte_carlo=bands.by_monte_carlo,
        note=_describe_bands(bands.by_monte_carlo, locus.airspeed, 1.0, "m/s"),
    )


def _convert_to_pressure(models: FlutterModels, roots: FlutterRoots) -> FlutterRoots:
    """Convert roots over airspeed to roots over dynamic pressure."""
    half = 0.5 * models.at.density

    def pressure(speed: float | None) -> float | None:
        return None if speed is None else half * speed**2

    interval = roots.interval
    return replace(
        roots,
        along=Along.DYNAMIC_PRESSURE,
        at=half * roots.at**2,
        tested=tuple(replace(root, at=half * root.airspeed_m_s**2) for root in roots.tested),
        flutter=pressure(roots.flutter),
        interval=None if interval is None else (half * interval[0] ** 2, half * interval[1] ** 2),
        tested_to=pressure(roots.tested_to),
        note=_describe_bands(roots.by_monte_carlo, half * roots.at**2, 1.0, "Pa"),
    )


def _trace_over_fuel(store: Store, models: FlutterModels) -> FlutterRoots:
    speed = models.query.next_m_s or NEXT * models.at.tested
    at = np.linspace(0.0, 1.0, _FUELS)
    cached: dict[float, IdentifiedModes] = {}

    def model(fuel: float) -> IdentifiedModes:
        if fuel not in cached:
            cached[fuel] = models.fuse(store, models.best.parts, fuel)
        return cached[fuel]

    def family(fuels: np.ndarray) -> StateFamily:
        each = [
            build_state_family(model(fuel).aircraft, np.array([speed]), models.at.density)
            for fuel in fuels.tolist()
        ]
        A, scale = (np.concatenate([getattr(one, k) for one in each]) for k in ("A", "scale"))
        return replace(each[0], A=A, scale=scale)

    if models.best.found.aircraft.shape is None:
        locus = track_family_roots(family, at, models.best.found.aircraft.motions)
    else:
        locus = track_shaped_loadings(
            lambda fuel: model(fuel).aircraft, at, speed, models.at.density
        )
    bands = _concatenate(
        [
            estimate_root_bands(
                model(fuel).aircraft,
                replace(locus, airspeed=np.array([speed]), roots=locus.roots[[k]]),
                model(fuel).uncertain,
                models.at.density,
            )
            for k, fuel in enumerate(at.tolist())
        ]
    )
    crossing = locus.flutter
    return FlutterRoots(
        along=Along.FUEL,
        at=at,
        airspeed_m_s=np.array([speed]),
        branches=build_branches(locus, bands, models.at.modes, _list_held(models)),
        tested=(),
        flutter=None if crossing is None else crossing.airspeed,
        interval=None,
        tested_to=None,
        by_monte_carlo=bands.by_monte_carlo,
        note=f"At {speed:.1f} m/s, at the queried air density. "
        + _describe_bands(bands.by_monte_carlo, at, 100.0, "% fuel"),
    )


def _concatenate(parts: list[RootBands]) -> RootBands:
    return RootBands(
        np.concatenate([part.real_std for part in parts]),
        np.concatenate([part.imag_std for part in parts]),
        np.concatenate([part.damping_std for part in parts]),
        np.concatenate([part.by_monte_carlo for part in parts]),
    )


def _describe_bands(by_monte_carlo: np.ndarray, at: np.ndarray, factor: float, unit: str) -> str:
    """Describe the method of the confidence bands."""
    if not by_monte_carlo.any():
        return "Bands of ±2σ by first-order propagation of the derivative covariance."
    where = factor * at[by_monte_carlo]
    return (
        f"Bands of ±2σ by first-order propagation of the derivative covariance; at"
        f" {int(by_monte_carlo.sum())} of {at.size} points between {where.min():.4g} and"
        f" {where.max():.4g}"
        f" {unit}, where first order is inaccurate, by 1000 Monte Carlo draws."
    )


def _list_held(models: FlutterModels) -> frozenset[str]:
    """List the modes of the preferred model that were not estimated."""
    found = models.best.found
    return frozenset(str(n) for n in found.aircraft.modes.numbers if n not in found.estimated_modes)


def build_branches(
    locus: RootLocus, bands: RootBands, modes: AircraftModes, held: frozenset[str] = frozenset()
) -> tuple[RootBranch, ...]:
    """Build the branches of a locus with their standard errors and displayed names."""
    damping = locus.damping()
    return tuple(
        RootBranch(
            name=name_motion(modes, name),
            held=name in held,
            real=np.real(locus.roots[:, k]),
            imag=np.imag(locus.roots[:, k]),
            damping=damping[:, k],
            real_std=bands.real_std[:, k],
            imag_std=bands.imag_std[:, k],
            damping_std=bands.damping_std[:, k],
        )
        for k, name in enumerate(locus.names)
    )


@dataclass(frozen=True, slots=True)
class _EquivalentModes:
    """Equivalent modes of one run, estimated ones only."""

    part: RunModel
    modes: tuple[EquivalentMode, ...]


def _compute_equivalent_modes(store: Store, models: FlutterModels) -> list[_EquivalentModes]:
    """Compute equivalent modes of all runs at one loading and air density."""
    estimated = models.best.found.estimated_modes
    result = []
    for part in models.best.parts:
        own = scale_to_fuel(store, part, models.fuel)
        at = build_loaded_model(
            models.at.aircraft, models.at.modes, [part], models.fuel, models.at.density
        )
        there = replace(at, derivatives=own.aircraft.derivatives)
        modes = compute_equivalent_modes(there, own.uncertain)
        result.append(_EquivalentModes(part, tuple(m for m in modes if m.mode in estimated)))
    return result


def compute_equivalents(
    store: Store, models: FlutterModels
) -> tuple[tuple[EquivalentLine, ...], tuple[EquivalentPoint, ...]]:
    """Compute frequency and damping of every estimated mode in every run (Eq. 25), and lines."""
    found = _compute_equivalent_modes(store, models)
    return _fit_equivalent_lines(models, found), _list_equivalent_points(models, found)


def _list_equivalent_points(
    models: FlutterModels, found: list[_EquivalentModes]
) -> tuple[EquivalentPoint, ...]:
    return tuple(
        EquivalentPoint(
            run_id=one.part.run.id or 0,
            label=one.part.maneuver.label,
            airspeed_m_s=mode.airspeed,
            dynamic_pressure_pa=mode.dynamic_pressure,
            mode=mode.mode,
            name=name_motion(models.at.modes, str(mode.mode)),
            frequency_hz=finite_or_none(mode.omega * _HZ),
            frequency_std_hz=finite_or_none(mode.omega_std * _HZ),
            damping=finite_or_none(mode.zeta),
            damping_std=finite_or_none(mode.zeta_std),
        )
        for one in found
        for mode in one.modes
    )


def _fit_equivalent_lines(
    models: FlutterModels, found: list[_EquivalentModes]
) -> tuple[EquivalentLine, ...]:
    """Fit straight lines over dynamic pressure, where there are enough points."""
    size = models.at.aircraft.geometry
    lines = []
    for k, mode in enumerate(found[0].modes):
        structure = models.at.modes.table.at(models.fuel).select((mode.mode,))
        try:
            line = fit_in_vacuo_mode(
                [one.modes[k] for one in found],
                size.area_m2,
                size.chord_m,
                float(structure.mass[0]),
            )
        except FlexsidError:
            continue  # too few points for a line
        lines.append(
            EquivalentLine(
                mode=mode.mode,
                name=name_motion(models.at.modes, str(mode.mode)),
                table_hz=float(structure.omega[0]) * _HZ,
                frequency_hz=line.omega * _HZ,
                frequency_std_hz=line.omega_std * _HZ,
                damping=line.zeta,
                damping_std=line.zeta_std,
                stiffness_derivative=line.stiffness_derivative,
                stiffness_derivative_std=line.stiffness_derivative_std,
                damping_derivative=line.damping_derivative,
                damping_derivative_std=line.damping_derivative_std,
            )
        )
    return tuple(lines)


# --- Speeds at which the roots of a flutter analysis become unstable ------------------------------

NEUTRAL = 1e-4
"""Structural damping g: below it a root is neutral, as an undamped mode in vacuo."""

RIGID_BODY_OMEGA = 2.0 * np.pi * 0.05
"""rad/s: a root closer to the origin is a rigid-body motion or round-off."""

_RISING = 1e-3
"""1/s: a root that grows more slowly (doubling in 700 s) is neutral."""

_JUMP = 0.25
"""Largest relative change in frequency of one root between rows."""

_DENSITY_SWEEPS = ("PKNL", "PKNLS")
_WITHOUT_ONSET = ("K",)


@dataclass(frozen=True, slots=True, eq=False)
class SweptRoot:
    """One root of one analysis, in the order of its sweep; arrays (n,)."""

    number: int
    airspeed: np.ndarray
    damping: np.ndarray
    omega: np.ndarray
    growth: np.ndarray
    density: np.ndarray
    mach: np.ndarray

    @property
    def is_neutral(self) -> bool:
        """Whether the root stays undamped or within 0.05 Hz of the origin."""
        size = np.hypot(self.growth, self.omega)
        return bool((np.abs(self.damping) < NEUTRAL).all() or (size < RIGID_BODY_OMEGA).all())

    def compute_excess(self, g: float) -> np.ndarray:
        """Return the damping beyond a structural damping g, which does not hold static motions."""
        return self.damping - np.where(self.omega < RIGID_BODY_OMEGA, 0.0, g)


def select_roots(arrays: dict[str, np.ndarray], method: str) -> list[SweptRoot]:
    """Return the roots of one analysis, each in the order of its sweep.

    Rows are taken by rising airspeed; in sweeps of matched points (PKNL) in the order printed,
    reversed where dynamic pressure falls, as their airspeeds need not rise.
    """
    return [_select_root(arrays, int(number), method) for number in np.unique(arrays["root"])]


def find_instabilities(
    arrays: dict[str, np.ndarray], title: str, method: str, g: float = 0.0
) -> tuple[list[FlutterPoint], list[str]]:
    """Find the speeds at which roots of one analysis become unstable; return points and notes.

    Parameters
    ----------
    arrays
        As stored in a FlutterSummary, of one analysis.
    title, method
        Description of the analysis, and its solution method.
    g
        Structural damping that the structure is assumed to have. [1]

    Notes
    -----
    Damping is interpolated by a straight line between the rows on either side of ``g``, and of
    zero for static motions.
    """
    if method in _WITHOUT_ONSET:
        return [], [f"no speed is read, since method {method} does not follow its roots."]
    points: list[FlutterPoint] = []
    neutral: list[int] = []
    notes: list[str] = []
    for root in select_roots(arrays, method):
        if root.is_neutral:
            rising = float(root.growth.max())
            if rising < _RISING or (root.damping < NEUTRAL).all():
                neutral.append(root.number)
            else:
                notes.append(
                    f"root {root.number} grows slowly, doubling in {np.log(2.0) / rising:.3g} s "
                    "or longer (within 0.05 Hz of the origin, a motion of the free body): no "
                    "speed is read from it."
                )
            continue
        excess = root.compute_excess(g)
        slow = np.hypot(root.growth, root.omega) < RIGID_BODY_OMEGA
        state = np.where((np.abs(excess) < NEUTRAL) | slow, 0, np.sign(excess)).astype(int)
        before = 0
        for row in range(state.size):
            if state[row] > 0 and before <= 0:
                points.append(_interpolate_onset(root, excess, row, before, title, notes))
            before = int(state[row]) or before
    if neutral:
        listed = ", ".join(map(str, neutral))
        notes.append(f"roots {listed} stay neutral or slow: no speed is read from them.")
    return points, notes


def _interpolate_onset(
    root: SweptRoot, excess: np.ndarray, row: int, before: int, title: str, notes: list[str]
) -> FlutterPoint:
    """Interpolate the speed at which a root becomes unstable between rows."""
    first, share = row, 0.0
    if before < 0:  # seen stable: the last row without growth lies on the other side of zero
        first = int(np.flatnonzero(excess[:row] <= 0)[-1])
        share = float(excess[first] / (excess[first] - excess[first + 1]))
    after = first + 1 if before < 0 else row

    def at(values: np.ndarray) -> float:
        return float(values[first] + share * (values[after] - values[first]))

    kind = Instability.DIVERGENCE if root.omega[after] < RIGID_BODY_OMEGA else Instability.FLUTTER
    omega = at(root.omega)
    if kind is Instability.DIVERGENCE:
        omega = 0.0
    elif root.omega[first] < RIGID_BODY_OMEGA:
        omega = float(root.omega[after])
    larger = float(max(root.omega[first], root.omega[after]))
    if abs(float(root.omega[after] - root.omega[first])) > max(_JUMP * larger, RIGID_BODY_OMEGA):
        notes.append(
            f"root {root.number} changes from {root.omega[first] / (2.0 * np.pi):.3g} to "
            f"{root.omega[after] / (2.0 * np.pi):.3g} Hz between {root.airspeed[first]:.4g} and "
            f"{root.airspeed[after]:.4g} m/s, where it becomes unstable: roots may be exchanged "
            "there; check with a finer sweep."
        )
    density, mach = at(root.density), at(root.mach)
    return FlutterPoint(
        root=root.number,
        airspeed_m_s=at(root.airspeed),
        omega_rad_s=omega,
        kind=kind,
        is_bound=before >= 0,
        analysis=title,
        mach=mach if np.isfinite(mach) else None,
        density_ratio=density if np.isfinite(density) else None,
    )


def _select_root(arrays: dict[str, np.ndarray], number: int, method: str) -> SweptRoot:
    rows = np.flatnonzero(arrays["root"] == number)
    speed = arrays["airspeed"][rows]
    if method in _DENSITY_SWEEPS:
        pressure = arrays["density"][rows] * speed**2
        order = rows if pressure[-1] >= pressure[0] else rows[::-1]
    elif method == "KE":
        order = rows if speed[-1] >= speed[0] else rows[::-1]
    else:
        order = rows[np.argsort(speed, kind="stable")]
    return SweptRoot(
        number,
        *(arrays[name][order] for name in ("airspeed", "damping", "omega", "growth")),
        *(arrays[name][order] for name in ("density", "mach")),
    )


# --- Flutter margin of the next test point with its confidence interval ---------------------------


def describe_margin(models: FlutterModels, next_speed: float) -> str:
    """Describe the margin of the next test point and its interval, or why there is none."""
    best = models.best.prediction
    at, crossing = f"Next point at {next_speed:.1f} m/s", best.crossing
    if best.refusal:
        return f"{at}: no margin, since no flutter speed can be predicted from these runs."
    if crossing is None:
        first, last = best.locus.airspeed[[0, -1]].tolist()
        if _is_unstable_at(best, first):
            return f"{at}: no margin, since the model is unstable already at {first:.1f} m/s."
        others = [g.prediction.crossing.airspeed for g in models.groups if g.prediction.crossing]
        if others:
            return (
                f"{at}: no margin, since another structure of the same runs becomes unstable"
                f" at {min(others):.1f} m/s."
            )
        if next_speed > last:
            return f"{at}: no margin, since the model was evaluated up to {last:.1f} m/s only."
        if best.interval is not None:
            return (
                f"{at}: no instability is predicted up to {last:.1f} m/s, but models within the"
                f" errors become unstable from {best.interval[0]:.1f} m/s on."
            )
        return f"{at}: no instability is predicted up to {last:.1f} m/s."
    margin = f"margin {crossing.airspeed / next_speed - 1.0:+.1%}"
    if best.interval is None:
        return f"{at}: {margin}, uncertainty unknown."
    low, high = (edge / next_speed - 1.0 for edge in best.interval)
    bounded = f"{margin}, between {low:+.1%} and {high:+.1%} with 95 % probability"
    if low > 0.0 and _is_unstable_at(best, next_speed):
        return (
            f"{at}: {bounded}; but a root that becomes unstable at a lower speed is unstable there."
        )
    if low > 0.0:
        return f"{at}: {bounded}."
    if high < 0.0:
        return f"{at} lies beyond flutter: {bounded}."
    return f"{at} may be beyond flutter: {bounded}. Fly a slower point first."


def is_safe(models: FlutterModels, next_speed: float) -> bool:
    """Return whether the model predicts no instability up to the next point, with 95 %."""
    best = models.best.prediction
    if best.refusal:
        return False
    if best.crossing is None:
        is_stable = not _is_unstable_at(best, best.locus.airspeed[0])
        alike = all(group.prediction.crossing is None for group in models.groups)
        ahead = best.interval is None or best.interval[0] > next_speed
        return is_stable and alike and ahead and next_speed <= float(best.locus.airspeed[-1])
    bounded = best.interval is not None and best.interval[0] > next_speed
    return bounded and not _is_unstable_at(best, next_speed)


def _is_unstable_at(prediction: FlutterPrediction, speed: float) -> bool:
    locus = prediction.locus
    near = int(np.argmin(np.abs(locus.airspeed - speed)))
    return bool((np.real(locus.roots[near]) > 0.0).any())
