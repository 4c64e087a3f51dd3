"""Flutter prediction from fused identified models, at any loading and air density."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records.aircraft import Aircraft
from flexsid.records.flutter import (
    Flutter,
    FlutterMap,
    Participation,
    ProgressForecast,
    RunForecast,
    StructureForecast,
    TrackerForecast,
)
from flexsid.storage.store import Store
from flexsid.sysid.stability.equivalent import compute_separation
from flexsid.sysid.stability.flutter import FlutterCrossing, track_roots
from flexsid.sysid.stability.flutter_extrapolation import (
    TestPoint,
    extrapolate_damping,
    extrapolate_envelope,
    extrapolate_flutter_margin,
)
from flexsid.sysid.stability.prediction import (
    FlutterPrediction,
    IdentifiedModes,
)
from flexsid.workflow.aircraft.flight_condition import compute_standard_density
from flexsid.workflow.flutter.flutter_models import (
    NEXT,
    FlutterModels,
    FlutterQuery,
    Group,
    compute_spread,
    fuse_runs,
    load_cached,
    name_motion,
)
from flexsid.workflow.flutter.flutter_roots import (
    fit_equivalent_lines,
    list_equivalent_points,
    trace_flutter_roots,
)
from flexsid.workflow.flutter.run_flutter import RunModel, UnmodelledModes, load_run_models
from flexsid.workflow.flutter.test_point_margin import describe_margin, is_safe

__all__ = [
    "FlutterQuery",
    "FusedModel",
    "UnmodelledModes",
    "analyse_flutter",
    "compute_flutter",
    "fuse_model",
    "map_flutter_speed",
    "trace_flutter_roots",
]

_STEP = 1.02  # ratio of airspeeds: closer ones are one step of a campaign
_METHODS = {
    "Damping extrapolation": extrapolate_damping,
    "Flutter margin (Zimmerman-Weissenburger)": extrapolate_flutter_margin,
    "Envelope function": extrapolate_envelope,
}


def analyse_flutter(store: Store, query: FlutterQuery) -> Flutter:
    """Predict the flutter speed from identified runs, and the margin of the next test point.

    Raises
    ------
    BadInput
        If there is no run, runs are of several aircraft, or the loading is impossible.
    """
    return load_cached(store, "flutter", query, lambda: _analyse(store, query))


def _analyse(store: Store, query: FlutterQuery) -> Flutter:
    models = fuse_runs(store, query)
    best = models.best.prediction
    tested = models.at.tested
    next_speed = query.next_m_s or NEXT * tested
    interval, crossing = best.interval, best.crossing
    known = models.at.aircraft.flutter
    return Flutter(
        sentence=f"{best.sentence} {_describe_search(models)}",
        refusal=best.refusal,
        searched_from_m_s=models.at.band[0],
        searched_to_m_s=models.at.band[1],
        test_point_margin=describe_margin(models, next_speed),
        safe=is_safe(models, next_speed),
        fuel_fraction=models.fuel,
        density_kg_m3=models.at.density,
        tested_m_s=tested,
        margin=None if crossing is None else crossing.airspeed / tested - 1.0,
        next_m_s=next_speed,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_get_finite(best.airspeed_std),
        spread_m_s=best.spread,
        modal_std_m_s=best.modal_std,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
        frequency_rad_s=None if crossing is None else crossing.frequency,
        mechanism=None if crossing is None else crossing.mechanism.value,
        participation=()
        if crossing is None
        else tuple(
            Participation(name=name_motion(models.at.modes, motion), share=share)
            for motion, share in sorted(crossing.participation.items(), key=lambda x: -x[1])
        ),
        predicted_flutter_m_s=None
        if known is None
        else float(np.interp(models.fuel, known.fuel, known.speed_m_s)),
        structures=tuple(
            _summarise_structure(group, preferred=group is models.best) for group in models.groups
        ),
        runs=tuple(_summarise_run(store, models, part) for part in models.best.parts),
        progress=_list_progress(store, models),
        trackers=_extrapolate(models),
        equivalents=fit_equivalent_lines(store, models),
        equivalent_points=list_equivalent_points(store, models),
    )


def map_flutter_speed(store: Store, query: FlutterQuery) -> FlutterMap:
    """Map flutter speed over fuel and altitude with the preferred model structure."""
    return load_cached(store, "map", query, lambda: _compute_map(store, query))


def _compute_map(store: Store, query: FlutterQuery) -> FlutterMap:
    models = fuse_runs(store, query)
    fuel, altitude = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 6000.0, 7)
    speeds = np.full((altitude.size, fuel.size), np.nan)
    band = np.linspace(*models.at.band, 60)
    for column, share in enumerate(fuel.tolist()):
        aircraft = models.fuse(store, models.best.parts, share).aircraft
        for row, height in enumerate(altitude):
            locus = track_roots(aircraft, band, compute_standard_density(float(height)))
            crossing = next((c for c in locus.crossings if not _is_passed(c, models)), None)
            if crossing is not None and not models.best.prediction.refusal:
                speeds[row, column] = crossing.airspeed
    return FlutterMap(fuel=fuel, altitude_m=altitude, airspeed_m_s=speeds)


def _is_passed(crossing: FlutterCrossing, models: FlutterModels) -> bool:
    """Return whether an instability ends below the fastest speed flown."""
    return crossing.recovers_at is not None and crossing.recovers_at < models.at.tested


@dataclass(frozen=True, slots=True)
class FusedModel:
    """Preferred fused model of several runs at one loading.

    ``others`` are models of the same runs in other model structures.
    """

    aircraft: Aircraft
    found: IdentifiedModes
    others: tuple[IdentifiedModes, ...]
    fuel: float
    density: float
    tested_m_s: float


def compute_flutter(
    store: Store, query: FlutterQuery, report: Callable[[float, str], None]
) -> None:
    """Compute all flutter results run by run and cache them.

    Parameters
    ----------
    store, query
        As for ``flutter``.
    report
        Called with the completed fraction and the next step; may raise to stop.
    """
    numbers = list(dict.fromkeys(query.run_ids))
    for k, number in enumerate(numbers):
        report(0.6 * k / len(numbers), f"Loading run {number}")
        load_run_models(store, number, query.unmodelled_modes)
    for share, words, find in (
        (0.6, "Predicting flutter", analyse_flutter),
        (0.8, "Tracing roots", trace_flutter_roots),
        (0.9, "Mapping flutter speed", map_flutter_speed),
    ):
        report(share, words)
        find(store, query)


def fuse_model(store: Store, query: FlutterQuery) -> FusedModel:
    """Fuse runs as for their flutter prediction."""
    models = fuse_runs(store, query)
    others = tuple(group.found for group in models.groups if group is not models.best)
    return FusedModel(
        models.at.aircraft,
        models.best.found,
        others,
        models.fuel,
        models.at.density,
        models.at.tested,
    )


def _summarise_structure(group: Group, *, preferred: bool) -> StructureForecast:
    found, prediction, last = group.found, group.prediction, group.parts[-1]
    numbers = found.aircraft.modes.numbers
    free = {int(row) - 2 for row in found.uncertain.rows}
    crossing = prediction.crossing
    return StructureForecast(
        run_ids=tuple(part.run.id or 0 for part in group.parts),
        modes=tuple(n for k, n in enumerate(numbers) if k in free),
        held_modes=tuple(n for k, n in enumerate(numbers) if k not in free),
        unmodelled_modes=last.omitted_modes,
        source=last.source,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_get_finite(
            float(np.hypot(prediction.airspeed_std, prediction.modal_std))
        ),
        frequency_rad_s=None if crossing is None else crossing.frequency,
        sentence=prediction.sentence,
        preferred=preferred,
        check=last.check,
    )


def _summarise_run(store: Store, models: FlutterModels, part: RunModel) -> RunForecast:
    found = models.fuse(store, [part], models.fuel)
    prediction = models.at.predict(found, [part], models.fuel)
    crossing = prediction.crossing
    short = part.poles.get("SP", 0j)
    elastic = [abs(pole) for name, pole in part.poles.items() if name != "SP"]
    return RunForecast(
        run_id=part.run.id or 0,
        label=part.maneuver.label,
        tested_m_s=part.maneuver.condition.airspeed_m_s,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=_get_finite(
            float(np.hypot(prediction.airspeed_std, prediction.modal_std))
        ),
        sentence=prediction.sentence,
        separation=compute_separation(elastic, abs(short))
        if elastic and short.imag > 0.0
        else None,
    )


def _list_progress(store: Store, models: FlutterModels) -> tuple[ProgressForecast, ...]:
    """List the flutter prediction after every airspeed of the campaign, with structure spread."""
    steps: list[float] = []
    for speed in sorted(part.maneuver.condition.airspeed_m_s for part in models.best.parts):
        if steps and speed < _STEP * steps[-1]:
            steps[-1] = speed
        else:
            steps.append(speed)
    return tuple(_predict_until(store, models, speed) for speed in steps)


def _predict_until(store: Store, models: FlutterModels, speed: float) -> ProgressForecast:
    def predict(group: Group) -> FlutterPrediction | None:
        parts = [p for p in group.parts if p.maneuver.condition.airspeed_m_s <= speed]
        if not parts:
            return None
        return models.predict(store, parts)

    best = predict(models.best)
    assert best is not None  # its parts gave the speed
    others = [
        replace(group, prediction=prediction)
        for group in models.groups[1:]
        if (prediction := predict(group)) is not None
    ]
    interval, crossing = best.interval, best.crossing
    if crossing is not None:
        interval = replace(best, spread=compute_spread(crossing.airspeed, others)).interval
    return ProgressForecast(
        tested_m_s=speed,
        n_runs=sum(p.maneuver.condition.airspeed_m_s <= speed for p in models.best.parts),
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
    )


def _extrapolate(models: FlutterModels) -> tuple[TrackerForecast, ...]:
    """Extrapolate damping, flutter margin and envelope of the short period and critical mode."""
    found, best = models.best.found, models.best.prediction
    motions = found.aircraft.motions
    if best.crossing is not None:
        shares = best.crossing.participation
        motions = tuple(sorted(shares, key=lambda name: -shares[name]))
    elastic = [name for name in motions if name != "SP"]
    critical = name_motion(models.at.modes, elastic[0]) if elastic else ""
    points = [
        TestPoint(
            part.maneuver.condition.airspeed_m_s,
            0.5 * part.maneuver.condition.density_kg_m3 * part.maneuver.condition.airspeed_m_s**2,
            part.poles[critical],
            part.poles["SP"],
        )
        for part in models.best.parts
        if critical in part.poles and "SP" in part.poles
    ]
    result = []
    for name, extrapolate in _METHODS.items():
        try:
            speed = extrapolate(points)
            sentence = f"Extrapolated from {len(points)} test points of {critical} and SP."
        except FlexsidError as reason:
            speed, sentence = None, str(reason)
        result.append(TrackerForecast(name=name, airspeed_m_s=speed, sentence=sentence))
    return tuple(result)


def _describe_search(models: FlutterModels) -> str:
    """Describe the searched range of airspeed."""
    low, high = models.at.band
    return (
        f"Searched from {low:.1f} to {high:.1f} m/s, {low / models.at.tested:.2g} to"
        f" {high / models.at.tested:.2g} times the fastest speed flown."
    )


def _get_finite(std: float) -> float | None:
    return std if np.isfinite(std) else None
