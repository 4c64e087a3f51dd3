"""Reports of flutter predictions and closed-loop analyses for the flight readiness review."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from math import log, log10, pi
from typing import Any

import numpy as np

from flexsid.display_units import display_sentence
from flexsid.jobs.kind import find_job, get_result
from flexsid.jobs.kinds import CLOSED_LOOP, FLUTTER
from flexsid.records import finite_or_none
from flexsid.records.flutter import ClosedLoop, Flutter, LoopMargin
from flexsid.records.run import AdequacyState, DerivedRun
from flexsid.reports.content import (
    Facts,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    converted,
    draw,
    heading,
    listed,
    moment,
    number,
    shown,
)
from flexsid.storage.content import find_changes
from flexsid.storage.store import Store
from flexsid.workflow.flutter.closed_loop import ClosedLoopQuery
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.model_structures.model_structures import describe_data_changes

_DB = 20.0 / log(10.0)  # of the natural logarithm of a factor
_LIMITS = (
    "This report supports a decision and does not make it: the prediction holds for the loading,"
    " the air density and the models named below. Clearance of a test point is with the flight"
    " readiness review."
)


def flutter_report(store: Store, query: FlutterQuery) -> Report:
    """Report a stored flutter prediction.

    Raises
    ------
    Conflict
        If the prediction has not been computed.
    """
    found = get_result(store, FLUTTER, query).flutter
    arguments = asdict(query)
    return Report(
        title="Flutter prediction",
        subtitle=_name_runs(store, query.run_ids),
        name=f"flexsid-flutter-{'-'.join(map(str, query.run_ids[:6]))}",
        sections=(
            Section("Summary", tuple(_summarise_flutter(store, query, found))),
            Section("Next test point", (_word_next_point(found), _tabulate_progress(found))),
            Section("Runs", tuple(_report_runs(store, query.run_ids, found.derived_runs, found))),
            Section("Frequency and damping", tuple(_draw_roots(store, arguments))),
            Section("Model structures", (_tabulate_structures(found),)),
            Section(
                "Flutter prediction methods",
                (
                    draw(
                        "Flutter speed of each run against the speed flown",
                        *(store, "flutter-forecast"),
                        **arguments,
                    ),
                    _tabulate_methods(found),
                ),
            ),
        ),
        provenance=_list_provenance(store, FLUTTER, query, query),
    )


def closed_loop_report(store: Store, query: ClosedLoopQuery) -> Report:
    """Report a stored closed-loop analysis.

    Raises
    ------
    Conflict
        If the analysis has not been computed.
    """
    found = get_result(store, CLOSED_LOOP, query)
    run_ids = query.flutter.run_ids
    arguments = {**asdict(query.flutter), "controller_id": query.controller_id}
    return Report(
        title=f"Closed-loop stability with {found.controller}",
        subtitle=_name_runs(store, run_ids),
        name=f"flexsid-closed-loop-{'-'.join(map(str, run_ids[:6]))}",
        sections=(
            Section("Summary", tuple(_summarise_closed_loop(store, query, found))),
            Section("Runs", tuple(_report_runs(store, run_ids, found.derived_runs))),
            Section(
                "Margins",
                (
                    draw(
                        "Stability margins of the loop of every surface, ±2 standard errors",
                        *(store, "closed-loop-margins"),
                        **arguments,
                    ),
                    *(_tabulate_margin(found, margin) for margin in found.margins),
                ),
            ),
            Section(
                "Roots",
                (
                    draw(
                        "Roots with and without the controller",
                        *(store, "closed-loop-roots"),
                        **arguments,
                    ),
                ),
            ),
        ),
        provenance=_list_provenance(store, CLOSED_LOOP, query, query.flutter),
    )


def _name_runs(store: Store, run_ids: Sequence[int]) -> str:
    maneuver = store.maneuvers.get(store.runs.get(run_ids[0]).maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id).name
    return f"{aircraft}, from run{'s' if len(run_ids) > 1 else ''} {listed(run_ids)}"


def _summarise_flutter(store: Store, query: FlutterQuery, found: Flutter) -> Iterator[Part]:
    if found.refusal:
        yield Words(f"No flutter speed is predicted: {found.refusal}", warns=True)
    elif found.airspeed_m_s is not None and found.low_m_s is None:
        yield Words("The interval of the flutter speed is unknown.", warns=True)
    yield from _warn_of_runs(store, query.run_ids)
    yield Words(display_sentence(found.sentence))
    frequency = found.frequency_rad_s
    yield Facts(
        (
            ("Flutter speed", shown(found.airspeed_m_s, "m/s")),
            ("95 % interval", _format_interval(found.low_m_s, found.high_m_s)),
            ("σ of the derivatives", shown(found.airspeed_std_m_s, "m/s", 2)),
            ("Spread of model structures", shown(found.spread_m_s, "m/s", 2)),
            ("σ of the modal frequencies", shown(found.modal_std_m_s, "m/s", 2)),
            ("Frequency", shown(frequency and frequency / (2.0 * pi), "Hz", 3)),
            ("Mechanism", found.mechanism or "–"),
            ("Fuel fraction", number(found.fuel_fraction, 3)),
            ("Air density", shown(found.density_kg_m3, "kg/m3")),
            ("Fastest point flown", shown(found.tested_m_s, "m/s")),
            ("Predicted before flight", shown(found.predicted_flutter_m_s, "m/s")),
        )
    )
    yield Words(_LIMITS)


def _word_next_point(found: Flutter) -> Part:
    margin = display_sentence(found.test_point_margin)
    if found.safe:
        return Words(
            f"{margin} The models predict no instability up to this point, with 95 % probability."
        )
    return Words(
        f"{margin} The models do not exclude an instability up to this point:"
        " review the evidence before flying it.",
        warns=True,
    )


def _summarise_closed_loop(
    store: Store, query: ClosedLoopQuery, found: ClosedLoop
) -> Iterator[Part]:
    yield from _warn_of_runs(store, query.flutter.run_ids)
    if found.lost_m_s is not None and found.low_m_s is None:
        yield Words("The interval of the stability limit is unknown.", warns=True)
    yield Words(display_sentence(found.sentence))
    yield Facts(
        (
            ("Controller", found.controller),
            ("Stability limit", shown(found.lost_m_s, "m/s")),
            ("95 % interval", _format_interval(found.low_m_s, found.high_m_s)),
            ("Spread of model structures", shown(found.spread_m_s, "m/s", 2)),
            ("Fuel fraction", number(found.fuel_fraction, 3)),
            ("Air density", shown(found.density_kg_m3, "kg/m3")),
            ("Fastest point flown", shown(found.tested_m_s, "m/s")),
        )
    )
    yield Words(_LIMITS)


def _format_interval(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return "–"
    return f"{converted(low, 'm/s')} to {shown(high, 'm/s')}"


def _warn_of_runs(store: Store, run_ids: Sequence[int]) -> Iterator[Part]:
    """Warn of runs on which the prediction rests although something speaks against them."""
    runs = [store.runs.get(run_id) for run_id in run_ids]
    changed = find_changes(store.database, [run.rests_on for run in runs])
    for run, since in zip(runs, changed, strict=True):
        late = describe_data_changes(run.id, since)
        if late is not None:
            yield Words(late, warns=True)
        if run.deleted_at is not None:
            yield Words(f"Run {run.id} was deleted after the prediction.", warns=True)
        if run.result is not None and run.result.adequacy.state is AdequacyState.SUSPECT:
            reason = run.result.adequacy.reason
            yield Words(f"Run {run.id} is suspect: {reason}", warns=True)


def _report_runs(
    store: Store,
    run_ids: Sequence[int],
    derived_runs: Sequence[DerivedRun],
    found: Flutter | None = None,
) -> Iterator[Part]:
    """Report the runs that a prediction rests on, their warnings, and its refits."""
    forecasts = {} if found is None else {one.run_id: one for one in found.runs}
    rows: list[tuple[str, ...]] = []
    warnings: list[tuple[str, str]] = []
    for run_id in run_ids:
        run = store.runs.get(run_id)
        maneuver = store.maneuvers.get(run.maneuver_id)
        result = run.result
        forecast = forecasts.get(run_id)
        rows.append(
            (
                str(run_id),
                maneuver.label,
                run.method.value,
                listed(run.structure.modes, "none"),
                run.state.value if result is None else result.fit.outcome,
                "–" if result is None else result.adequacy.state.value,
                converted(maneuver.condition.airspeed_m_s, "m/s", 3),
                number(maneuver.condition.fuel_fraction, 2),
                "–" if forecast is None else converted(forecast.airspeed_m_s, "m/s", 3),
                "–" if forecast is None else converted(forecast.airspeed_std_m_s, "m/s", 2),
            )
        )
        texts = () if result is None else result.fit.warnings
        warnings += [(str(run_id), text) for text in texts]
    head = (
        "run",
        "maneuver",
        "method",
        "modes",
        "outcome",
        "adequacy",
        heading("airspeed", "m/s"),
        "fuel",
    )
    of_run = (heading("flutter", "m/s"), heading("σ", "m/s"))
    width = len(head) + (len(of_run) if forecasts else 0)
    yield ReportTable(
        (*head, *of_run)[:width],
        tuple(row[:width] for row in rows),
        "Runs that the prediction rests on",
        numbers_from=6,
    )
    if warnings:
        yield ReportTable(("run", "warning"), tuple(warnings), "Warnings", numbers_from=2)
    if derived_runs:
        yield ReportTable(
            ("run", "refit", "purpose", "outcome"),
            tuple(
                (
                    str(one.run_id),
                    str(one.derived_run_id),
                    f"to {one.purpose}",
                    one.failure or "succeeded",
                )
                for one in derived_runs
            ),
            "Refits that bound the errors of the prediction",
            numbers_from=4,
        )


def _draw_roots(store: Store, arguments: dict[str, Any]) -> Iterator[Part]:
    for kind, caption in (
        ("v-omega-zeta", "Frequency and damping over airspeed, ±2 standard errors"),
        ("root-locus", "Root locus over airspeed"),
        ("flutter-map", "Flutter speed over fuel and altitude"),
    ):
        yield draw(caption, store, kind, **arguments)


def _tabulate_progress(found: Flutter) -> ReportTable:
    return ReportTable(
        (heading("flown up to", "m/s"), "runs", heading("flutter speed", "m/s"), "95 % interval"),
        tuple(
            (
                converted(one.tested_m_s, "m/s", 3),
                str(one.n_runs),
                converted(one.airspeed_m_s, "m/s", 3),
                _format_interval(one.low_m_s, one.high_m_s),
            )
            for one in found.progress
        ),
        "Prediction as the flights proceeded",
        numbers_from=0,
    )


def _tabulate_structures(found: Flutter) -> ReportTable:
    return ReportTable(
        ("modes", "runs", "preferred", heading("flutter speed", "m/s"), heading("σ", "m/s")),
        tuple(
            (
                listed(one.modes, "none"),
                listed(one.run_ids),
                "yes" if one.preferred else "second fit" if one.check else "no",
                converted(one.airspeed_m_s, "m/s", 3),
                converted(one.airspeed_std_m_s, "m/s", 2),
            )
            for one in found.structures
        ),
        "Flutter speed by model structure; the spread of the others widens the interval",
        numbers_from=3,
    )


def _tabulate_methods(found: Flutter) -> ReportTable:
    return ReportTable(
        ("method", heading("flutter speed", "m/s"), "remark"),
        tuple(
            (one.name, converted(one.airspeed_m_s, "m/s", 3), display_sentence(one.sentence))
            for one in found.trackers
        ),
        "Classical methods, without a structural model",
        numbers_from=3,
    )


def _tabulate_margin(found: ClosedLoop, margin: LoopMargin) -> ReportTable:
    def with_error(value: float, std: float) -> str:
        if not np.isfinite(value):
            return "–"
        return f"{number(float(value), 3)} ± {number(finite_or_none(2.0 * std), 2)}"

    rows = [
        (
            converted(float(speed), "m/s", 3),
            "yes" if found.growth[k] < 0.0 else "no",
            with_error(20.0 * log10(gain) if gain > 0.0 else np.nan, _DB * margin.gain_std[k]),
            with_error(np.degrees(margin.phase_rad[k]), np.degrees(margin.phase_std_rad[k])),
            with_error(margin.disk[k], margin.disk_std[k]),
        )
        for k, (speed, gain) in enumerate(zip(found.airspeed_m_s, margin.gain, strict=True))
    ]
    return ReportTable(
        (heading("airspeed", "m/s"), "stable", "gain [dB]", "phase [deg]", "disk"),
        tuple(rows),
        f"Margins of the loop of {margin.surface}, ±2 standard errors",
        numbers_from=2,
    )


def _list_provenance(
    store: Store, kind: Any, query: object, flutter: FlutterQuery
) -> tuple[tuple[str, str], ...]:
    job = find_job(store, kind, query)
    runs = [store.runs.get(run_id) for run_id in flutter.run_ids]
    given = {
        "fuel fraction": flutter.fuel,
        "altitude [m]": flutter.altitude_m,
        "next test point [m/s]": flutter.next_m_s,
        "modes not modelled": flutter.unmodelled_modes.value,
        "variation of derivatives": flutter.variation.value,
    }
    assert job is not None
    versions = job.versions or {}
    return (
        ("Job", f"{job.id}, requested by {job.author or '–'}, finished {moment(job.finished_at)}"),
        (
            "Request",
            listed(f"{name} {value}" for name, value in given.items() if value is not None),
        ),
        *((f"Run {run.id}", f"inputs {run.input_hash}, result {run.result_hash}") for run in runs),
        ("Software", listed(f"{name} {value}" for name, value in versions.items())),
    )
