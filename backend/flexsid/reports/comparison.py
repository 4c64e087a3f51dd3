"""Report of a comparison: derivatives of runs and predictions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flexsid.records.comparison import AgreementCount, Comparison, Row, SourceValue
from flexsid.records.run import AdequacyState
from flexsid.reports.content import (
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
from flexsid.reports.flown import source_facts
from flexsid.reports.validation import report_cross_predictions
from flexsid.storage.store import Store
from flexsid.workflow.comparison.derivative_comparison import (
    compare,
    list_coefficients,
    select_coefficient,
)
from flexsid.workflow.fits.estimators import get_title
from flexsid.workflow.model_structures.run_results import describe_data_changes

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
