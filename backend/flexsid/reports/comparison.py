"""Report of a comparison, and estimates of a campaign: derivatives of runs and predictions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flexsid.display_units import display_sentence
from flexsid.errors import FlexsidError
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER
from flexsid.records.run import AdequacyState, Method, RunState
from flexsid.records.validation import Against, AgreementCount, Comparison, Row, SourceValue
from flexsid.reports.content import (
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    converted,
    draw,
    estimate,
    heading,
    listed,
    moment,
    number,
)
from flexsid.reports.run import report_cross_predictions, source_facts
from flexsid.storage.lists.maneuver_list import LatestRun, ManeuverItem
from flexsid.storage.store import Store
from flexsid.workflow.comparison.derivative_comparison import (
    compare,
    list_coefficients,
    select_coefficient,
)
from flexsid.workflow.fits.computation import get_title
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.model_structures.model_structures import describe_data_changes

# --- Report of a comparison: derivatives of runs and predictions ----------------------------------

_ABREAST = 6  # sources in one table, by page width


def comparison_report(
    store: Store, run_ids: Sequence[int], prediction_ids: Sequence[int]
) -> Report:
    """Report the agreement of runs and predictions.

    Raises
    ------
    BadInput
        If no run is given.
    Conflict
        If a run has no result.
    """
    compared = compare(store, run_ids, prediction_ids)
    maneuvers = [store.maneuvers.get(number) for number in compared.maneuver_ids]
    return Report(
        title=f"Comparison of {len(compared.sources)} sources",
        subtitle=listed(maneuver.label for maneuver in maneuvers),
        name="flexsid-comparison-" + "-".join(map(str, dict.fromkeys(run_ids))),
        sections=(
            Section(
                "Summary",
                (
                    *_summarise_agreement(compared),
                    *_warn_of_changes(compared),
                    _list_sources(store, compared),
                ),
            ),
            *(
                Section(
                    name,
                    (
                        draw(
                            f"Derivatives of {name} with ±2 standard errors",
                            store,
                            "derivatives",
                            run_ids=run_ids,
                            prediction_ids=prediction_ids,
                            coefficient=name,
                        ),
                        *_tabulate_coefficient(compared, name),
                    ),
                )
                for name in list_coefficients(compared)
            ),
            *report_cross_predictions(store, run_ids),
        ),
        provenance=(
            *(_describe_run(store, run_id) for run_id in dict.fromkeys(run_ids)),
            *(fact for maneuver in maneuvers for fact in source_facts(store, maneuver)),
        ),
    )


def _describe_run(store: Store, run_id: int) -> tuple[str, str]:
    run = store.runs.get(run_id)
    versions = listed(f"{name} {version}" for name, version in (run.versions or {}).items())
    return f"Run {run_id}", f"finished {moment(run.finished_at)} by {versions}"


def _warn_of_changes(compared: Comparison) -> tuple[Words, ...]:
    """Warn of runs whose data were corrected afterwards, and of those with model error."""
    texts = [
        describe_data_changes(source.run_id, source.changed_since) for source in compared.sources
    ]
    texts += [
        f"{source.label} is suspect: tests found remaining model error."
        for source in compared.sources
        if source.adequacy is AdequacyState.SUSPECT
    ]
    return tuple(Words(text, warns=True) for text in texts if text is not None)


_MOST_NAMED = 8  # derivatives that a verdict names


def _summarise_agreement(compared: Comparison) -> tuple[Words, ...]:
    """Summarise the agreement between runs, then of each prediction with them."""
    runs = [s for s in compared.sources if not s.is_prediction]
    differences = {
        row.name: row.max_difference_sigma for row in compared.rows if not row.consistent
    }
    words = [
        _summarise_count(compared.runs_verdict, differences, "between the runs", "No two runs")
    ]
    labels = {s.key: s.label for s in compared.sources}
    for verdict in compared.prediction_verdicts:
        differences = {
            row.name: value.difference_sigma
            for row in compared.rows
            if (value := _find_value(row, verdict.source)) is not None and not value.consistent
        }
        label = labels[verdict.source or ""]
        against = "the run" if len(runs) == 1 else "every run"
        words.append(
            _summarise_count(
                verdict, differences, f"of {label} with {against}", f"No run and {label}"
            )
        )
    return tuple(words)


def _find_value(row: Row, key: str | None) -> SourceValue | None:
    return next((value for value in row.values if value is not None and value.key == key), None)


def _summarise_count(
    verdict: AgreementCount, differences: Mapping[str, float | None], which: str, none: str
) -> Words:
    if not verdict.n_judged:
        return Words(f"{none} give standard errors for the same derivative.")
    text = (
        f"{verdict.n_consistent} of {verdict.n_judged} derivatives agree {which}; of correct "
        f"estimates {100.0 * verdict.false_alarm_rate:.2g} % do not."
    )
    known = {name: size for name, size in differences.items() if size is not None}
    if known:
        worst = sorted(known, key=lambda name: known[name], reverse=True)
        text += " Largest differences: "
        text += listed(f"{name} ({known[name]:.1f} σ)" for name in worst[:_MOST_NAMED])
        text += "."
    return Words(text, warns=bool(known))


def _list_sources(store: Store, compared: Comparison) -> ReportTable:
    rows = []
    for source in compared.sources:
        what, where, speed, fuel = "prediction", "–", "–", "–"
        if not source.is_prediction and source.run_id is not None:
            run = store.runs.get(source.run_id)
            maneuver = store.maneuvers.get(run.maneuver_id)
            what, where = get_title(run.method), maneuver.label
            speed = converted(maneuver.condition.airspeed_m_s, "m/s")
            fuel = f"{maneuver.condition.fuel_fraction:.2f}"
        rows.append((source.label, what, where, speed, fuel))
    return ReportTable(
        ("source", "kind", "maneuver", heading("airspeed", "m/s"), "fuel fraction"),
        tuple(rows),
        "Sources",
        numbers_from=3,
    )


def _tabulate_coefficient(compared: Comparison, name: str) -> Iterator[ReportTable]:
    part = select_coefficient(compared, name)
    for start in range(0, len(part.sources), _ABREAST):
        yield _tabulate(part, range(start, min(start + _ABREAST, len(part.sources))))


def _tabulate(part: Comparison, sources: range) -> ReportTable:
    return ReportTable(
        ("derivative", *(part.sources[place].label for place in sources), "difference of runs [σ]"),
        tuple(
            (
                row.name,
                *(_format_value(row.values[place]) for place in sources),
                number(row.max_difference_sigma, 2),
            )
            for row in part.rows
        ),
        "Value ± standard error; difference of runs: largest between two runs, and in brackets"
        " that of a prediction from a run, in standard errors of the difference",
    )


def _format_value(value: SourceValue | None) -> str:
    if value is None:
        return "–"
    written = " ± ".join(estimate(value.value, value.std_error)).removesuffix(" ± –")
    if value.difference_sigma is None:
        return written
    return f"{written} ({value.difference_sigma:.1f} σ)"


# --- Estimates of a campaign: trends over the flight envelope, and flutter prediction -------------

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
