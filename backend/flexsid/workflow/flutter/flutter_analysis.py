"""Flutter prediction from fused identified models, at any loading and air density."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import FlexsidError
from flexsid.records import finite_or_none
from flexsid.records.flutter import (
    Along,
    Flutter,
    FlutterMap,
    FlutterResult,
    Participation,
    ProgressForecast,
    RunForecast,
    StructureForecast,
    TrackerForecast,
)
from flexsid.records.job import Job
from flexsid.records.run import DerivedRun, Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.model.condition import compute_standard_density
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.stability.flutter_extrapolation import (
    TestPoint,
    extrapolate_damping,
    extrapolate_envelope,
    extrapolate_flutter_margin,
)
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction
from flexsid.sysid.stability.root_tracking import FlutterCrossing, track_roots
from flexsid.workflow.flutter.flutter_models import (
    NEXT,
    FlutterModels,
    FlutterQuery,
    Group,
    Variation,
    compute_spread,
    fuse_runs,
    list_nuisance_modes,
    name_motion,
)
from flexsid.workflow.flutter.flutter_roots import (
    compute_equivalents,
    describe_margin,
    is_safe,
    trace_flutter_roots,
)
from flexsid.workflow.flutter.run_models import RunModel, UnmodelledModes
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.derived_runs import DerivedResult, renumber, store_derived_fits

__all__ = [
    "FlutterQuery",
    "UnmodelledModes",
    "Variation",
    "analyse_flutter",
    "compute_flutter",
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
    return summarise_flutter(store, fuse_runs(store, query))


def summarise_flutter(store: Store, models: FlutterModels) -> Flutter:
    """Summarise the flutter prediction of fused runs."""
    best = models.best.prediction
    tested = models.at.tested
    next_speed = models.query.next_m_s or NEXT * tested
    interval, crossing = best.interval, best.crossing
    known = models.at.aircraft.flutter
    equivalents, equivalent_points = compute_equivalents(store, models)
    failed = describe_failed_fits(models.derived_runs)
    body = models.best.found.aircraft.derivatives.body
    return Flutter(
        sentence=f"{best.sentence} {_describe_search(models)}{failed}",
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
        airspeed_std_m_s=finite_or_none(best.airspeed_std),
        spread_m_s=finite_or_none(best.spread),
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
        equivalents=equivalents,
        equivalent_points=equivalent_points,
        derived_runs=models.derived_runs,
        axis="lateral" if body.symmetry == LATERAL.symmetry else "longitudinal",
    )


def map_flutter_speed(store: Store, models: FlutterModels) -> FlutterMap:
    """Map flutter speed over fuel and altitude with the preferred model structure."""
    fuel, altitude = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 6000.0, 7)
    speeds = np.full((altitude.size, fuel.size), np.nan)
    band = np.linspace(*models.at.band, 60)
    for column, share in enumerate(fuel.tolist()):
        aircraft = models.fuse(store, models.best.parts, share).aircraft
        for row, height in enumerate(altitude):
            locus = track_roots(aircraft, band, compute_standard_density(float(height)))
            crossing = next((c for c in locus.dangerous if not _is_passed(c, models)), None)
            if crossing is not None and not models.best.prediction.refusal:
                speeds[row, column] = crossing.airspeed
    return FlutterMap(fuel=fuel, altitude_m=altitude, airspeed_m_s=speeds)


def _is_passed(crossing: FlutterCrossing, models: FlutterModels) -> bool:
    """Return whether an instability ends below the fastest speed flown."""
    return crossing.recovers_at is not None and crossing.recovers_at < models.at.tested


def compute_flutter(
    store: Store, query: FlutterQuery, report: ReportProgress
) -> DerivedResult[FlutterResult]:
    """Fuse runs and predict their flutter, with roots over every variable and the map.

    Raises
    ------
    BadInput
        As ``fuse_runs``.
    """
    models = fuse_runs(store, query, report)
    report(Progress(fraction=0.6, message="Predicting flutter"))
    flutter = summarise_flutter(store, models)
    report(Progress(fraction=0.8, message="Tracing roots"))
    roots = {along: trace_flutter_roots(store, models, along) for along in Along}
    report(Progress(fraction=0.9, message="Mapping flutter speed"))
    result = FlutterResult(flutter=flutter, roots=roots, map=map_flutter_speed(store, models))
    return DerivedResult(result, models.new_fits)


def store_flutter(
    store: Store, job: Job, query: FlutterQuery, outcome: DerivedResult[FlutterResult]
) -> FlutterResult:
    """Store the refits of a flutter prediction, and return the prediction with their ids."""
    ids = store_derived_fits(store, outcome.fits, job)
    flutter = outcome.result.flutter
    flutter = replace(flutter, derived_runs=renumber(flutter.derived_runs, ids))
    return replace(outcome.result, flutter=flutter)


def _summarise_structure(group: Group, *, preferred: bool) -> StructureForecast:
    found, prediction, last = group.found, group.prediction, group.parts[-1]
    numbers, estimated = found.aircraft.modes.numbers, found.estimated_modes
    crossing, nuisance = prediction.crossing, list_nuisance_modes(group.parts, found)
    return StructureForecast(
        run_ids=tuple(part.run.id or 0 for part in group.parts),
        modes=tuple(n for n in numbers if n in estimated),
        held_modes=tuple(n for n in numbers if n not in estimated.union(nuisance)),
        nuisance_modes=nuisance,
        unmodelled_modes=last.omitted_modes,
        source=last.source,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=finite_or_none(
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
    body = found.aircraft.derivatives.body
    rigid = [abs(pole) for name, pole in part.poles.items() if name in body.poles]
    elastic = [abs(pole) for name, pole in part.poles.items() if name not in body.poles]
    oscillates = any(pole.imag > 0.0 for name, pole in part.poles.items() if name in body.poles)
    return RunForecast(
        run_id=part.run.id or 0,
        label=part.maneuver.label,
        tested_m_s=part.maneuver.condition.airspeed_m_s,
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=finite_or_none(
            float(np.hypot(prediction.airspeed_std, prediction.modal_std))
        ),
        sentence=prediction.sentence,
        separation=min(elastic) / max(rigid) if elastic and oscillates else None,
        adequacy=get_result(part.run).adequacy.state,
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
        spread = (
            np.inf
            if models.has_failed_fits
            else compute_spread(crossing.airspeed, models.best, others)
        )
        interval = replace(best, spread=spread).interval
    return ProgressForecast(
        tested_m_s=speed,
        n_runs=sum(p.maneuver.condition.airspeed_m_s <= speed for p in models.best.parts),
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        low_m_s=None if interval is None else interval[0],
        high_m_s=None if interval is None else interval[1],
    )


def _extrapolate(models: FlutterModels) -> tuple[TrackerForecast, ...]:
    """Extrapolate damping, flutter margin and envelope of the critical mode and its partner."""
    found, best = models.best.found, models.best.prediction
    motions = found.aircraft.motions
    if best.crossing is not None:
        shares = best.crossing.participation
        motions = tuple(sorted(shares, key=lambda name: -shares[name]))
    body = found.aircraft.derivatives.body
    elastic = [name_motion(models.at.modes, name) for name in motions if name not in body.poles]
    critical = elastic[0] if elastic else ""
    # The short period couples with wing bending; in the lateral axis two modes couple.
    partner = "SP" if "SP" in body.poles else "".join(elastic[1:2])
    points = [
        TestPoint(
            part.maneuver.condition.airspeed_m_s,
            0.5 * part.maneuver.condition.density_kg_m3 * part.maneuver.condition.airspeed_m_s**2,
            part.poles[critical],
            part.poles[partner],
        )
        for part in models.best.parts
        if critical in part.poles and partner in part.poles
    ]
    result = []
    for name, extrapolate in _METHODS.items():
        try:
            speed = extrapolate(points)
            sentence = f"Extrapolated from {len(points)} test points of {critical} and {partner}."
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


def describe_failed_fits(derived_runs: Sequence[DerivedRun]) -> str:
    """Describe refits that failed, without which the spread is unknown."""
    fits = "; ".join(
        f"run {one.run_id}, to {one.purpose}: {one.failure}"
        for one in derived_runs
        if one.failure is not None
    )
    return f" No interval is given, since refits failed ({fits})." if fits else ""
