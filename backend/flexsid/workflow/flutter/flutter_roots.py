"""Roots of identified models along airspeed, dynamic pressure or fuel, and equivalent modes."""

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
from flexsid.sysid.stability.bands import Bands, root_bands
from flexsid.sysid.stability.equivalent import EquivalentMode, equivalent_modes, fit_in_vacuo
from flexsid.sysid.stability.flutter import RootLocus, follow_family
from flexsid.sysid.stability.prediction import IdentifiedModes
from flexsid.sysid.stability.speeds import StateFamily, state_family
from flexsid.workflow.flutter.flutter_models import (
    NEXT,
    Answered,
    FlutterQuery,
    loaded,
    models_of,
    named,
    remembered_of,
)
from flexsid.workflow.flutter.run_flutter import FlownRun, at_fuel

_FUELS = 41
_HZ = 1.0 / (2.0 * np.pi)


def flutter_roots(
    store: Store, question: FlutterQuery, along: Along = Along.AIRSPEED
) -> FlutterRoots:
    """Follow the roots of the preferred model, with standard errors.

    Parameters
    ----------
    store, question
        As for ``flutter``.
    along
        Over fuel the airspeed is that of the next point.
    """
    if along is Along.FUEL:
        return remembered_of(store, "fuel", question, lambda: _over_fuel(store, question))
    found = remembered_of(store, "roots", question, lambda: _over_airspeed(store, question))
    return found if along is Along.AIRSPEED else _over_pressure(store, question, found)


def _over_airspeed(store: Store, question: FlutterQuery) -> FlutterRoots:
    answer = models_of(store, question)
    found, best = answer.best.found, answer.best.prediction
    locus = best.locus
    bands = root_bands(found.aircraft, locus, found.uncertain, answer.at.density)
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
        for part in answer.best.parts
        for name, root in part.roots.items()
    )
    return FlutterRoots(
        along=Along.AIRSPEED,
        at=locus.airspeed,
        airspeed_m_s=locus.airspeed,
        branches=_branches(answer, locus, bands),
        tested=tested,
        flutter=None if best.crossing is None else best.crossing.airspeed,
        interval=best.interval,
        tested_to=answer.at.tested,
        by_draws=bands.by_draws,
        note=_note(bands.by_draws, locus.airspeed, 1.0, "m/s"),
    )


def _over_pressure(store: Store, question: FlutterQuery, roots: FlutterRoots) -> FlutterRoots:
    """The same over dynamic pressure in the air of the question."""
    half = 0.5 * models_of(store, question).at.density

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
        note=_note(roots.by_draws, half * roots.at**2, 1.0, "Pa"),
    )


def _over_fuel(store: Store, question: FlutterQuery) -> FlutterRoots:
    answer = models_of(store, question)
    speed = question.next_m_s or NEXT * answer.at.tested
    at = np.linspace(0.0, 1.0, _FUELS)
    known: dict[float, IdentifiedModes] = {}

    def model(fuel: float) -> IdentifiedModes:
        if fuel not in known:
            known[fuel] = answer.fused_at(store, answer.best.parts, fuel)
        return known[fuel]

    def family(fuels: np.ndarray) -> StateFamily:
        each = [
            state_family(model(fuel).aircraft, np.array([speed]), answer.at.density)
            for fuel in fuels.tolist()
        ]
        A, scale = (np.concatenate([getattr(one, k) for one in each]) for k in ("A", "scale"))
        return replace(each[0], A=A, scale=scale)

    locus = follow_family(family, at, answer.best.found.aircraft.motions)
    bands = _joined(
        [
            root_bands(
                model(fuel).aircraft,
                replace(locus, airspeed=np.array([speed]), roots=locus.roots[[k]]),
                model(fuel).uncertain,
                answer.at.density,
            )
            for k, fuel in enumerate(at.tolist())
        ]
    )
    crossing = locus.flutter
    return FlutterRoots(
        along=Along.FUEL,
        at=at,
        airspeed_m_s=np.array([speed]),
        branches=_branches(answer, locus, bands),
        tested=(),
        flutter=None if crossing is None else crossing.airspeed,
        interval=None,
        tested_to=None,
        by_draws=bands.by_draws,
        note=f"At {speed:.1f} m/s, in the air of the question. "
        + _note(bands.by_draws, at, 100.0, "% fuel"),
    )


def _joined(parts: list[Bands]) -> Bands:
    return Bands(
        np.concatenate([part.real_std for part in parts]),
        np.concatenate([part.imag_std for part in parts]),
        np.concatenate([part.damping_std for part in parts]),
        np.concatenate([part.by_draws for part in parts]),
    )


def _note(by_draws: np.ndarray, at: np.ndarray, factor: float, unit: str) -> str:
    """Sentence on where the bands come from."""
    if not by_draws.any():
        return "Bands of ±2σ by the covariance of the derivatives, first order."
    where = factor * at[by_draws]
    return (
        f"Bands of ±2σ by the covariance of the derivatives, first order; at {int(by_draws.sum())}"
        f" of {at.size} places between {where.min():.4g} and {where.max():.4g} {unit}, where that"
        " misleads, by 1000 draws."
    )


def _branches(answer: Answered, locus: RootLocus, bands: Bands) -> tuple[RootBranch, ...]:
    found = answer.best.found
    free = {int(row) - 2 for row in found.uncertain.rows}
    held = {str(n) for k, n in enumerate(found.aircraft.modes.numbers) if k not in free}
    damping = locus.damping()
    return tuple(
        RootBranch(
            name=named(answer.at.modes, name),
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
class _InAir:
    """Equivalent modes of one run, those only that it estimated."""

    part: FlownRun
    modes: tuple[EquivalentMode, ...]


def _in_air(store: Store, answer: Answered) -> list[_InAir]:
    """All runs brought to one loading and air."""
    found = answer.best.found
    free = {int(row) - 2 for row in found.uncertain.rows}
    result = []
    for part in answer.best.parts:
        own = at_fuel(store, part, answer.fuel)
        at = loaded(answer.at.aircraft, answer.at.modes, [part], answer.fuel, answer.at.density)
        there = replace(at, derivatives=own.aircraft.derivatives)
        modes = equivalent_modes(there, own.uncertain)
        result.append(_InAir(part, tuple(m for k, m in enumerate(modes) if k in free)))
    return result


def equivalent_points(store: Store, answer: Answered) -> tuple[EquivalentPoint, ...]:
    """Frequency and damping of every estimated mode in every run (Eq. 25)."""
    return tuple(
        EquivalentPoint(
            run_id=one.part.run.id or 0,
            label=one.part.maneuver.label,
            airspeed_m_s=mode.airspeed,
            dynamic_pressure_pa=mode.dynamic_pressure,
            mode=mode.mode,
            name=named(answer.at.modes, str(mode.mode)),
            frequency_hz=_finite(mode.omega * _HZ),
            frequency_std_hz=_finite(mode.omega_std * _HZ),
            damping=_finite(mode.zeta),
            damping_std=_finite(mode.zeta_std),
        )
        for one in _in_air(store, answer)
        for mode in one.modes
    )


def equivalent_lines(store: Store, answer: Answered) -> tuple[EquivalentLine, ...]:
    """Straight lines over dynamic pressure, where there are points enough."""
    points = _in_air(store, answer)
    size = answer.at.aircraft.geometry
    lines = []
    for k, mode in enumerate(points[0].modes):
        structure = answer.at.modes.table.at(answer.fuel).select((mode.mode,))
        try:
            line = fit_in_vacuo(
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
                name=named(answer.at.modes, str(mode.mode)),
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


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
