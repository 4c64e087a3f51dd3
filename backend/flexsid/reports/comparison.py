"""The report of a comparison: derivatives of runs and predictions side by side."""

from __future__ import annotations

from collections.abc import Sequence

from flexsid import figures
from flexsid.records.comparison import Comparison, Row, SourceValue
from flexsid.reports.content import (
    Part,
    Report,
    Section,
    Table,
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
from flexsid.workflow.comparison import CONSISTENT_SIGMA, coefficients, compare, of_coefficient

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
            Section("Summary", (_verdict(compared), _sources(store, compared))),
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


def _verdict(compared: Comparison) -> Words:
    judged = [row for row in compared.rows if row.consistent is not None]
    apart = [row for row in judged if not row.consistent]
    if not judged:
        return Words("No two sources with a standard error share a derivative.")
    text = (
        f"{len(judged) - len(apart)} of {len(judged)} derivatives agree within "
        f"{CONSISTENT_SIGMA:g} combined standard errors."
    )
    if apart:
        worst = sorted(apart, key=_apart, reverse=True)
        text += " Furthest apart: " + listed(
            f"{row.name} ({row.max_difference_sigma:.1f} σ)" for row in worst[:8]
        )
        text += "."
    return Words(text, warns=bool(apart))


def _apart(row: Row) -> float:
    return row.max_difference_sigma or 0.0


def _sources(store: Store, compared: Comparison) -> Table:
    rows = []
    for source in compared.sources:
        what, where, speed, fuel = "prediction", "–", "–", "–"
        if source.kind != "prediction" and source.run_id is not None:
            run = store.runs.get(source.run_id)
            maneuver = store.maneuvers.get(run.maneuver_id)
            what, where = METHOD_NAMES[run.method], maneuver.label
            speed = f"{maneuver.condition.airspeed_m_s:.2f}"
            fuel = f"{maneuver.condition.fuel_fraction:.2f}"
        rows.append((source.label, what, where, speed, fuel))
    return Table(
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


def _numbers(part: Comparison, sources: range) -> Table:
    return Table(
        ("derivative", *(part.sources[place].label for place in sources), "apart [σ]"),
        tuple(
            (
                row.name,
                *(_written(row.values[place]) for place in sources),
                number(row.max_difference_sigma, 2),
            )
            for row in part.rows
        ),
        "Value ± standard error; apart: largest difference in combined standard errors",
    )


def _written(value: SourceValue | None) -> str:
    if value is None:
        return "–"
    return " ± ".join(estimate(value.value, value.std_error)).removesuffix(" ± –")
