"""Report of a version of a global model: derivatives over the envelope, score, credibility."""

from __future__ import annotations

from flexsid.figures.global_model import draw_coverage, draw_slice
from flexsid.records.global_model import GlobalModelResult, GlobalModelSummary, GlobalModelVersion
from flexsid.reports.content import (
    Drawing,
    Facts,
    Report,
    ReportTable,
    Section,
    Words,
    estimate,
    listed,
    moment,
    number,
)
from flexsid.reports.credibility import report_version_credibility
from flexsid.storage.store import Store
from flexsid.workflow.global_model.slices import compute_coverage, slice_derivative
from flexsid.workflow.global_model.versions import find_decision, load_result

_MOST_SLICES = 12


def global_model_report(store: Store, global_model_id: int) -> Report:
    """Report a version of a global model.

    Raises
    ------
    UnknownRecord
        If there is none of this id.
    """
    version = store.global_model_versions.get(global_model_id)
    decision = find_decision(store, version)
    result = load_result(store, version)
    summary = result.summary
    aircraft = store.aircraft.get(version.aircraft_id)
    outlying = tuple(Words(one.sentence, warns=True) for one in summary.outliers)
    state = "not proposed" if decision is None else decision.state.value
    return Report(
        title=f"Global model version {version.version}: {version.label}",
        subtitle=f"{version.axis.capitalize()} derivatives of {aircraft.name}, {state}",
        name=f"flexsid-global-model-{global_model_id}",
        sections=(
            Section(
                "Summary",
                (
                    Words(version.sentence),
                    *((Words(version.note),) if version.note else ()),
                    *outlying,
                    Facts(_summarise(version, summary, state)),
                ),
            ),
            Section("Derivatives", (_tabulate_derivatives(summary),)),
            Section("Derivatives that vary most", _draw_slices(result)),
            Section(
                "Coverage",
                (
                    Drawing(
                        draw_coverage(compute_coverage(result)),
                        "Standard error over the envelope relative to its smallest, with the runs",
                    ),
                ),
            ),
            Section("Prediction of flights", (_tabulate_scores(summary),)),
            report_version_credibility(store, version, summary, decision),
        ),
        provenance=(
            ("Version", f"{version.version}, stored {moment(version.created_at)}"),
            ("By", version.author or "–"),
            ("SHA-256 of the model", version.result),
            *((f"Run {run.run_id}", run.hash) for run in version.runs),
        ),
    )


def _summarise(
    version: GlobalModelVersion, summary: GlobalModelSummary, state: str
) -> tuple[tuple[str, str], ...]:
    ranges = (
        (one.quantity.value, f"{number(one.lowest)} to {number(one.highest)}")
        for one in summary.variables
    )
    return (
        ("Review", state),
        ("Modes", listed(summary.modes, "none: rigid body")),
        *ranges,
        ("Runs", listed(run.run_id for run in version.runs)),
    )


def _tabulate_derivatives(summary: GlobalModelSummary) -> ReportTable:
    rows = []
    for one in summary.derivatives:
        value, error = estimate(one.value, one.std_error)
        drift = listed((s.quantity.value for s in one.slopes if s.is_drift), "–")
        rows.append(
            (one.label, one.name, drift, value, error, number(one.scatter, 2), str(one.n_runs))
        )
    return ReportTable(
        ("", "name", "varies with", "value", "σ", "scatter", "runs"),
        tuple(rows),
        "Values and standard errors σ at the mean condition of the runs, scatter between runs",
        numbers_from=3,
    )


def _draw_slices(result: GlobalModelResult) -> tuple[Drawing, ...]:
    """Draw the derivatives that vary with the first variable, those of the largest ratio first."""
    ordered = sorted(
        result.summary.derivatives,
        key=lambda one: -abs(one.slopes[0].slope) / max(one.slopes[0].std_error, 1e-300),
    )
    return tuple(
        Drawing(
            draw_slice(slice_derivative(result, one.name)),
            f"{one.label} ({one.name}) with ±2 standard errors, others at the mean condition",
        )
        for one in ordered[:_MOST_SLICES]
    )


def _tabulate_scores(summary: GlobalModelSummary) -> ReportTable:
    return ReportTable(
        ("mean of the model", "selected", "degree", "log density", "rms / σ", "within 2σ [%]"),
        tuple(
            (
                "prediction" if one.uses_prediction else "none",
                "yes" if one.is_selected else "no",
                str(one.degree),
                f"{one.log_density:.3f}",
                f"{one.rms:.2f}",
                f"{100.0 * one.share_inside:.0f}",
            )
            for one in summary.scores
        ),
        "Each flight predicted by all others, for each candidate of the model",
        numbers_from=2,
    )
