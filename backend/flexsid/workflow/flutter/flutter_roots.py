"""Roots of identified models over airspeed, dynamic pressure or fuel, and equivalent modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records.flutter import (
    Along,
    EquivalentLine,
    EquivalentPoint,
    FlutterRoots,
    RootBranch,
    TestedRoot,
)
from flexsid.storage.store import Store
from flexsid.sysid.stability.bands import RootBands, estimate_root_bands
from flexsid.sysid.stability.equivalent import (
    EquivalentMode,
    compute_equivalent_modes,
    fit_in_vacuo_mode,
)
from flexsid.sysid.stability.flutter import RootLocus, track_family_roots
from flexsid.sysid.stability.prediction import IdentifiedModes
from flexsid.sysid.stability.speeds import StateFamily, build_state_family
from flexsid.workflow.flutter.flutter_models import (
    NEXT,
    FlutterModels,
    FlutterQuery,
    build_loaded_model,
    fuse_runs,
    load_cached,
    name_motion,
)
from flexsid.workflow.flutter.run_flutter import RunModel, scale_to_fuel

_FUELS = 41
_HZ = 1.0 / (2.0 * np.pi)


def trace_flutter_roots(
    store: Store, query: FlutterQuery, along: Along = Along.AIRSPEED
) -> FlutterRoots:
    """Trace the roots of the preferred model with standard errors.

    Parameters
    ----------
    store, query
        As for ``flutter``.
    along
        Over fuel the airspeed is that of the next point.
    """
    if along is Along.FUEL:
        return load_cached(store, "fuel", query, lambda: _trace_over_fuel(store, query))
    found = load_cached(store, "roots", query, lambda: _trace_over_airspeed(store, query))
    return found if along is Along.AIRSPEED else _convert_to_pressure(store, query, found)


def _trace_over_airspeed(store: Store, query: FlutterQuery) -> FlutterRoots:
    models = fuse_runs(store, query)
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
        branches=_build_branches(models, locus, bands),
        tested=tested,
        flutter=None if best.crossing is None else best.crossing.airspeed,
        interval=best.interval,
        tested_to=models.at.tested,
        by_draws=bands.by_draws,
        note=_describe_bands(bands.by_draws, locus.airspeed, 1.0, "m/s"),
    )


def _convert_to_pressure(store: Store, query: FlutterQuery, roots: FlutterRoots) -> FlutterRoots:
    """Convert roots over airspeed to roots over dynamic pressure."""
    half = 0.5 * fuse_runs(store, query).at.density

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
        note=_describe_bands(roots.by_draws, half * roots.at**2, 1.0, "Pa"),
    )


def _trace_over_fuel(store: Store, query: FlutterQuery) -> FlutterRoots:
    models = fuse_runs(store, query)
    speed = query.next_m_s or NEXT * models.at.tested
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

    locus = track_family_roots(family, at, models.best.found.aircraft.motions)
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
        branches=_build_branches(models, locus, bands),
        tested=(),
        flutter=None if crossing is None else crossing.airspeed,
        interval=None,
        tested_to=None,
        by_draws=bands.by_draws,
        note=f"At {speed:.1f} m/s, at the queried air density. "
        + _describe_bands(bands.by_draws, at, 100.0, "% fuel"),
    )


def _concatenate(parts: list[RootBands]) -> RootBands:
    return RootBands(
        np.concatenate([part.real_std for part in parts]),
        np.concatenate([part.imag_std for part in parts]),
        np.concatenate([part.damping_std for part in parts]),
        np.concatenate([part.by_draws for part in parts]),
    )


def _describe_bands(by_draws: np.ndarray, at: np.ndarray, factor: float, unit: str) -> str:
    """Describe the method of the confidence bands."""
    if not by_draws.any():
        return "Bands of ±2σ by first-order propagation of the derivative covariance."
    where = factor * at[by_draws]
    return (
        f"Bands of ±2σ by first-order propagation of the derivative covariance; at"
        f" {int(by_draws.sum())} of {at.size} points between {where.min():.4g} and"
        f" {where.max():.4g}"
        f" {unit}, where first order is inaccurate, by 1000 Monte Carlo draws."
    )


def _build_branches(
    models: FlutterModels, locus: RootLocus, bands: RootBands
) -> tuple[RootBranch, ...]:
    found = models.best.found
    free = {int(row) - 2 for row in found.uncertain.rows}
    held = {str(n) for k, n in enumerate(found.aircraft.modes.numbers) if k not in free}
    damping = locus.damping()
    return tuple(
        RootBranch(
            name=name_motion(models.at.modes, name),
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
    found = models.best.found
    free = {int(row) - 2 for row in found.uncertain.rows}
    result = []
    for part in models.best.parts:
        own = scale_to_fuel(store, part, models.fuel)
        at = build_loaded_model(
            models.at.aircraft, models.at.modes, [part], models.fuel, models.at.density
        )
        there = replace(at, derivatives=own.aircraft.derivatives)
        modes = compute_equivalent_modes(there, own.uncertain)
        result.append(_EquivalentModes(part, tuple(m for k, m in enumerate(modes) if k in free)))
    return result


def list_equivalent_points(store: Store, models: FlutterModels) -> tuple[EquivalentPoint, ...]:
    """List frequency and damping of every estimated mode in every run (Eq. 25)."""
    return tuple(
        EquivalentPoint(
            run_id=one.part.run.id or 0,
            label=one.part.maneuver.label,
            airspeed_m_s=mode.airspeed,
            dynamic_pressure_pa=mode.dynamic_pressure,
            mode=mode.mode,
            name=name_motion(models.at.modes, str(mode.mode)),
            frequency_hz=_get_finite(mode.omega * _HZ),
            frequency_std_hz=_get_finite(mode.omega_std * _HZ),
            damping=_get_finite(mode.zeta),
            damping_std=_get_finite(mode.zeta_std),
        )
        for one in _compute_equivalent_modes(store, models)
        for mode in one.modes
    )


def fit_equivalent_lines(store: Store, models: FlutterModels) -> tuple[EquivalentLine, ...]:
    """Fit straight lines over dynamic pressure, where there are enough points."""
    points = _compute_equivalent_modes(store, models)
    size = models.at.aircraft.geometry
    lines = []
    for k, mode in enumerate(points[0].modes):
        structure = models.at.modes.table.at(models.fuel).select((mode.mode,))
        try:
            line = fit_in_vacuo_mode(
                [one.modes[k] for one in points],
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


def _get_finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
