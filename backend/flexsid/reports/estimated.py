"""Estimates of a campaign: trends over the flight envelope, and flutter prediction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flexsid.display_units import display_sentence
from flexsid.errors import FlexsidError
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER
from flexsid.records.comparison import Against
from flexsid.records.run import Method, RunState
from flexsid.reports.content import Part, ReportTable, Section, Words, converted, draw, heading
from flexsid.storage.maneuver_list import LatestRun, ManeuverItem
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_models import FlutterQuery

_RIGID = {"longitudinal": ("CZ_alpha", "Cm_alpha", "Cm_q"), "lateral": ("Cl_p", "Cn_beta", "Cn_r")}
_MOST_FOR_FLUTTER = 12  # fastest maneuvers, which determine the flutter speed


def list_latest_runs(item: ManeuverItem) -> list[LatestRun]:
    """List the latest successful run of each method."""
    return [run for run in item.runs.values() if run and run.state is RunState.SUCCEEDED]


def report_estimates(store: Store, flown: Sequence[ManeuverItem]) -> Iterator[Section]:
    """Report trends and flutter, if there are enough runs."""
    estimated = [item for item in flown if list_latest_runs(item)]
    if not estimated:
        return
    axes = [axis for axis in _RIGID if any(item.axis == axis for item in estimated)]
    for axis in axes:
        own = [item for item in estimated if item.axis == axis]
        of_axis = f", {axis}" if len(axes) > 1 else ""
        runs = [run.id for item in own for run in list_latest_runs(item)]
        if len(own) > 1:
            modes = store.runs.get(runs[-1]).structure.modes
            names = (*_RIGID[axis], *(f"CQ{mode}_etadot{mode}" for mode in modes))
            trends = tuple(_draw_trend(store, runs, name) for name in names)
            yield Section(f"Estimates{of_axis}", trends)
        yield Section(f"Flutter{of_axis}", tuple(_report_flutter(store, own)))


def _draw_trend(store: Store, runs: Sequence[int], name: str) -> Part:
    return draw(
        f"{name} over dynamic pressure with ±2 standard errors, by method",
        store,
        "trend",
        run_ids=runs,
        name=name,
        against=Against.DYNAMIC_PRESSURE,
    )


def _report_flutter(store: Store, estimated: Sequence[ManeuverItem]) -> Iterator[Part]:
    method = max(
        Method, key=lambda method: sum(_find_run(item, method) is not None for item in estimated)
    )
    speeds = [(item.airspeed_m_s, run) for item in estimated if (run := _find_run(item, method))]
    fastest = sorted(speeds, reverse=True)[:_MOST_FOR_FLUTTER]
    run_ids = tuple(run for _, run in fastest)
    try:
        prediction = get_result(store, FLUTTER, FlutterQuery(run_ids=run_ids)).flutter
    except FlexsidError as error:
        runs = ",".join(map(str, run_ids))
        yield Words(
            f"No flutter prediction from the {method.value} runs {runs} is stored"
            f" ({error.code}); predict flutter from them, then write this report again."
        )
        return
    yield Words(
        f"From {len(fastest)} runs of {method.value}: {display_sentence(prediction.sentence)}"
    )
    yield Words(display_sentence(prediction.test_point_margin))
    yield draw("Roots over airspeed", store, "v-omega-zeta", run_ids=run_ids)
    yield ReportTable(
        ("run", "maneuver", *(heading(name, "m/s") for name in ("airspeed", "flutter speed", "σ"))),
        tuple(
            (
                str(one.run_id),
                one.label,
                converted(one.tested_m_s, "m/s", 3),
                converted(one.airspeed_m_s, "m/s", 3),
                converted(one.airspeed_std_m_s, "m/s", 2),
            )
            for one in prediction.runs
        ),
        "Flutter prediction of each run",
        numbers_from=2,
    )


def _find_run(item: ManeuverItem, method: Method) -> int | None:
    run = item.runs.get(method)
    return run.id if run is not None and run.state is RunState.SUCCEEDED else None
