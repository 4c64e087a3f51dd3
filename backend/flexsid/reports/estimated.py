"""Estimates of a campaign: trends over the flight envelope, and flutter prediction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flexsid import figures
from flexsid.errors import FlexsidError
from flexsid.records.comparison import Against
from flexsid.records.run import Method, RunState
from flexsid.reports.content import Drawing, Part, ReportTable, Section, Words, drawn
from flexsid.storage.maneuver_list import LatestRun, ManeuverItem
from flexsid.storage.store import Store
from flexsid.workflow.comparison.trends import fit_derivative_trend
from flexsid.workflow.flutter.flutter_analysis import (
    FlutterQuery,
    analyse_flutter,
    trace_flutter_roots,
)

_RIGID = ("CZ_alpha", "Cm_alpha", "Cm_q")
_MOST_FOR_FLUTTER = 12  # fastest maneuvers, which determine the flutter speed


def list_latest_runs(item: ManeuverItem) -> list[LatestRun]:
    """List the latest successful run of each method."""
    return [run for run in item.runs.values() if run and run.state is RunState.SUCCEEDED]


def report_estimates(store: Store, flown: Sequence[ManeuverItem]) -> Iterator[Section]:
    """Report trends and flutter, if there are enough runs."""
    estimated = [item for item in flown if list_latest_runs(item)]
    if not estimated:
        return
    runs = [run.id for item in estimated for run in list_latest_runs(item)]
    if len(estimated) > 1:
        modes = store.runs.get(runs[-1]).structure.modes
        names = (*_RIGID, *(f"CQ{mode}_etadot{mode}" for mode in modes))
        yield Section("Estimates", tuple(_draw_trend(store, runs, name) for name in names))
    yield Section("Flutter", tuple(_report_flutter(store, estimated)))


def _draw_trend(store: Store, runs: Sequence[int], name: str) -> Part:
    return drawn(
        f"{name} over dynamic pressure with ±2 standard errors, by method",
        lambda: figures.trend(fit_derivative_trend(store, runs, name, Against.DYNAMIC_PRESSURE)),
    )


def _report_flutter(store: Store, estimated: Sequence[ManeuverItem]) -> Iterator[Part]:
    method = max(
        Method, key=lambda method: sum(_find_run(item, method) is not None for item in estimated)
    )
    found = [(item.airspeed_m_s, run) for item in estimated if (run := _find_run(item, method))]
    fastest = sorted(found, reverse=True)[:_MOST_FOR_FLUTTER]
    query = FlutterQuery(run_ids=tuple(run for _, run in fastest))
    try:
        prediction = analyse_flutter(store, query)
    except FlexsidError as error:
        yield Words(f"No flutter prediction from the {method.value} runs: {error.message}.")
        return
    yield Words(f"From {len(fastest)} runs of {method.value}: {prediction.sentence}")
    yield Words(prediction.test_point_margin)
    yield Drawing(figures.v_omega_zeta(trace_flutter_roots(store, query)), "Roots over airspeed")
    yield ReportTable(
        ("run", "maneuver", "airspeed [m/s]", "flutter speed [m/s]", "σ [m/s]"),
        tuple(
            (
                str(one.run_id),
                one.label,
                f"{one.tested_m_s:.1f}",
                "–" if one.airspeed_m_s is None else f"{one.airspeed_m_s:.1f}",
                "–" if one.airspeed_std_m_s is None else f"{one.airspeed_std_m_s:.1f}",
            )
            for one in prediction.runs
        ),
        "Flutter prediction of each run",
        numbers_from=2,
    )


def _find_run(item: ManeuverItem, method: Method) -> int | None:
    run = item.runs.get(method)
    return run.id if run is not None and run.state is RunState.SUCCEEDED else None
