"""What the newest runs of a campaign say together: trends over the envelope, and flutter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flexsid import figures
from flexsid.errors import FlexsidError
from flexsid.records.comparison import Against
from flexsid.records.run import Method, RunState
from flexsid.reports.content import Drawing, Part, ReportTable, Section, Words, drawn
from flexsid.storage.maneuver_list import LatestRun, ManeuverItem
from flexsid.storage.store import Store
from flexsid.workflow.comparison.trends import trend
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, flutter, flutter_roots

_RIGID = ("CZ_alpha", "Cm_alpha", "Cm_q")
_MOST_FOR_FLUTTER = 12  # of the fastest maneuvers: they say most of where stability is lost


def newest(item: ManeuverItem) -> list[LatestRun]:
    """The newest run of each method that succeeded."""
    return [run for run in item.runs.values() if run and run.state is RunState.SUCCEEDED]


def estimated_sections(store: Store, flown: Sequence[ManeuverItem]) -> Iterator[Section]:
    """Say what was estimated, as far as there are runs enough to say it."""
    estimated = [item for item in flown if newest(item)]
    if not estimated:
        return
    runs = [run.id for item in estimated for run in newest(item)]
    if len(estimated) > 1:
        modes = store.runs.get(runs[-1]).structure.modes
        names = (*_RIGID, *(f"CQ{mode}_etadot{mode}" for mode in modes))
        yield Section("Estimates", tuple(_trend(store, runs, name) for name in names))
    yield Section("Flutter", tuple(_flutter(store, estimated)))


def _trend(store: Store, runs: Sequence[int], name: str) -> Part:
    return drawn(
        f"{name} over dynamic pressure with ±2 standard errors, by method",
        lambda: figures.trend(trend(store, runs, name, Against.DYNAMIC_PRESSURE)),
    )


def _flutter(store: Store, estimated: Sequence[ManeuverItem]) -> Iterator[Part]:
    method = max(
        Method, key=lambda method: sum(_of(item, method) is not None for item in estimated)
    )
    found = [(item.airspeed_m_s, run) for item in estimated if (run := _of(item, method))]
    fastest = sorted(found, reverse=True)[:_MOST_FOR_FLUTTER]
    question = FlutterQuery(run_ids=tuple(run for _, run in fastest))
    try:
        told = flutter(store, question)
    except FlexsidError as error:
        yield Words(f"Nothing can be foretold from the {method.value} runs: {error.message}.")
        return
    yield Words(f"From {len(fastest)} runs of {method.value}: {told.sentence}")
    yield Words(told.next_point)
    yield Drawing(figures.v_omega_zeta(flutter_roots(store, question)), "Roots over airspeed")
    yield ReportTable(
        ("run", "maneuver", "flown at [m/s]", "flutter [m/s]", "σ [m/s]"),
        tuple(
            (
                str(one.run_id),
                one.label,
                f"{one.tested_m_s:.1f}",
                "–" if one.airspeed_m_s is None else f"{one.airspeed_m_s:.1f}",
                "–" if one.airspeed_std_m_s is None else f"{one.airspeed_std_m_s:.1f}",
            )
            for one in told.runs
        ),
        "What each run foretells by itself",
        numbers_from=2,
    )


def _of(item: ManeuverItem, method: Method) -> int | None:
    run = item.runs.get(method)
    return run.id if run is not None and run.state is RunState.SUCCEEDED else None
