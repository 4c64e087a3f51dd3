"""Roots of identified models over airspeed, dynamic pressure or fuel, and equivalent modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records import finite_or_none
from flexsid.records.flutter import (
    Along,
    EquivalentLine,
    EquivalentPoint,
    FlutterRoots,
    RootBranch,
    TestedRoot,
)
from flexsid.storage.store import Store
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.equivalent import (
    EquivalentMode,
    compute_equivalent_modes,
    fit_in_vacuo_mode,
)
from flexsid.sysid.stability.root_errors import RootBands, estimate_root_bands
from flexsid.sysid.stability.root_tracking import (
    RootLocus,
    track_family_roots,
    track_shaped_loadings,
)
from flexsid.sysid.stability.state_family import StateFamily, build_state_family
from flexsid.workflow.flutter.flutter_models import (
    NEXT,
    FlutterModels,
    build_loaded_model,
    name_motion,
)
from flexsid.workflow.flutter.run_models import RunModel, scale_to_fuel
from flexsid.workflow.modal_data.modal_tables import AircraftModes

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
