"""The report of a comparison: derivatives of runs and predictions side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flexsid import figures
from flexsid.records.comparison import AgreementCount, Comparison, Row, SourceValue
from flexsid.reports.content import (
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    drawn,
    estimate,
    listed,
    moment,
    number,
)
from flexsid.reports.flown import source_facts
from flexsid.reports.run import METHOD_NAMES
from flexsid.storage.store import Store
from flexsid.workflow.comparison.agreement import CONSISTENT_SIGMA
from flexsid.workflow.comparison.derivative_comparison import coefficients, compare, of_coefficient
from flexsid.workflow.model_structures.run_results import note_changes

_ABREAST = 6  # sources in one table, as many as fit on paper


def comparison_report(
    store: Store, run_ids: Sequence[int], prediction_ids: Sequence[int]
) -> Report:
    """Report how runs and predictions agree.

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
            Section("Summary", (*_verdicts(compared), *_late(compared), _sources(store, compared))),
            *(Section(name, _coefficient(compared, name)) for name in coefficients(compared)),
        ),
        provenance=(
            *(_run_facts(store, run_id) for run_id in dict.fromkeys(run_ids)),
            *(fact for maneuver in maneuvers for fact in source_facts(store, maneuver)),
        ),
    )


def _run_facts(store: Store, run_id: int) -> tuple[str, str]:
    run = store.runs.get(run_id)
    versions = listed(f"{name} {version}" for name, version in (run.versions or {}).items())
    return f"Run {run_id}", f"finished {moment(run.finished_at)} by {versions}"


def _late(compared: Comparison) -> tuple[Words, ...]:
    """Warn of runs whose data were corrected after they were computed."""
    texts = (note_changes(source.run_id, source.changed_since) for source in compared.sources)
    return tuple(Words(text, warns=True) for text in texts if text is not None)


_MOST_NAMED = 8  # derivatives that a verdict names


def _verdicts(compared: Comparison) -> tuple[Words, ...]:
    """How the runs agree among each other, then how each prediction agrees with them."""
    runs = [s for s in compared.sources if not s.is_prediction]
    apart = {row.name: row.max_difference_sigma for row in compared.rows if not row.consistent}
    words = [_verdict(compared.runs_verdict, apart, "between the runs", "No two runs")]
    labels = {s.key: s.label for s in compared.sources}
    for verdict in compared.prediction_verdicts:
        apart = {
            row.name: value.difference_sigma
            for row in compared.rows
            if (value := _value_of(row, verdict.source)) is not None and not value.consistent
        }
        label = labels[verdict.source or ""]
        against = "the run" if len(runs) == 1 else "every run"
        words.append(_verdict(verdict, apart, f"of {label} with {against}", f"No run and {label}"))
    return tuple(words)


def _value_of(row: Row, key: str | None) -> SourceValue | None:
    return next((value for value in row.values if value is not None and value.key == key), None)


def _verdict(
    verdict: AgreementCount, apart: Mapping[str, float | None], which: str, nobody: str
) -> Words:
    if not verdict.n_judged:
        return Words(f"{nobody} give standard errors for the same derivative.")
    text = (
        f"{verdict.n_consistent} of {verdict.n_judged} derivatives agree within "
        f"{CONSISTENT_SIGMA:g} combined standard errors {which}."
    )
    known = {name: size for name, size in apart.items() if size is not None}
    if known:
        worst = sorted(known, key=lambda name: known[name], reverse=True)
        text += " Furthest apart: "
        text += listed(f"{name} ({known[name]:.1f} σ)" for name in worst[:_MOST_NAMED])
        text += "."
    return Words(text, warns=bool(known))


def _sources(store: Store, compared: Comparison) -> ReportTable:
    rows = []
    for source in compared.sources:
        what, where, speed, fuel = "prediction", "–", "–", "–"
        if not source.is_prediction and source.run_id is not None:
            run = store.runs.get(source.run_id)
            maneuver = store.maneuvers.get(run.maneuver_id)
            what, where = METHOD_NAMES[run.method], maneuver.label
            speed = f"{maneuver.condition.airspeed_m_s:.2f}"
            fuel = f"{maneuver.condition.fuel_fraction:.2f}"
        rows.append((source.label, what, where, speed, fuel))
    return ReportTable(
        ("source", "kind", "maneuver", "airspeed [m/s]", "fuel fraction"),
        tuple(rows),
        "Sources",
        numbers_from=3,
    )


def _coefficient(compared: Comparison, name: str) -> tuple[Part, ...]:
    part = of_coefficient(compared, name)
    return (
        drawn(f"Derivatives of {name} with ±2 standard errors", lambda: figures.derivatives(part)),
        *(
            _numbers(part, range(start, min(start + _ABREAST, len(part.sources))))
            for start in range(0, len(part.sources), _ABREAST)
        ),
    )


def _numbers(part: Comparison, sources: range) -> ReportTable:
    return ReportTable(
        ("derivative", *(part.sources[place].label for place in sources), "runs apart [σ]"),
        tuple(
            (
                row.name,
                *(_written(row.values[place]) for place in sources),
                number(row.max_difference_sigma, 2),
            )
            for row in part.rows
        ),
        "Value ± standard error; runs apart: largest difference between two runs, and in brackets"
        " that of a prediction from a run, in combined standard errors",
    )


def _written(value: SourceValue | None) -> str:
    if value is None:
        return "–"
    written = " ± ".join(estimate(value.value, value.std_error)).removesuffix(" ± –")
    if value.difference_sigma is None:
        return written
    return f"{written} ({value.difference_sigma:.1f} σ)"
