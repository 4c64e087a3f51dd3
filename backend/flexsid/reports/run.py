"""The report of a run: what was asked, what came out, how far it can be trusted."""

from __future__ import annotations

from math import tau

from flexsid import figures
from flexsid.nomenclature import describe
from flexsid.records.run import EstimationRun, Method, RunResult
from flexsid.reports.content import (
    Facts,
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
from flexsid.reports.flown import condition_facts, source_facts
from flexsid.storage.content import changed_since
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import count_iterations
from flexsid.workflow import views
from flexsid.workflow.comparison.derivative_comparison import coefficients, compare, of_coefficient
from flexsid.workflow.model_structures.run_results import note_changes
from flexsid.workflow.views.run import finished

METHOD_NAMES = {
    Method.OE: "Output error",
    Method.FRE: "Frequency-response error",
    Method.EE: "Equation error",
}


def run_report(store: Store, run_id: int) -> Report:
    """Report a run that succeeded.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    run, result = finished(store, run_id)
    maneuver = store.maneuvers.get(run.maneuver_id)
    flight = store.flights.get(maneuver.flight_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    return Report(
        title=f"{METHOD_NAMES[run.method]}, run {run_id}",
        subtitle=f"{maneuver.label}, flight {flight.number} of {aircraft.name}",
        name=f"flexsid-run-{run_id}",
        sections=(
            Section("Summary", (*_warnings(store, run, result), Facts(_summary(run, result)))),
            Section("Flight condition", (Facts(condition_facts(maneuver)),)),
            Section("Derivatives", (*_derivatives(store, run, result), _parameters(result))),
            Section("Fit", _fit(store, run_id, result)),
            Section("Uncertainty", _uncertainty(store, run_id)),
            Section("Poles", _poles(store, run_id, result)),
        ),
        provenance=(*_provenance(store, run, result), *source_facts(store, maneuver)),
    )


def _warnings(store: Store, run: EstimationRun, result: RunResult) -> tuple[Part, ...]:
    (changed,) = changed_since(store.database, [run.rests_on])
    late = note_changes(run.id, changed)
    texts = (*(() if late is None else (late,)), *result.fit.warnings)
    return tuple(Words(text, warns=True) for text in texts)


def _summary(run: EstimationRun, result: RunResult) -> tuple[tuple[str, str], ...]:
    fit = result.fit
    structure = run.structure
    worst = min(fit.r_squared.items(), key=lambda pair: pair[1], default=None)
    return (
        ("Outcome", _outcome(result)),
        ("Modes", listed(structure.modes, "none: rigid body")),
        ("Inputs", listed(structure.inputs, "all that moved")),
        ("Outputs", listed(dict.fromkeys(o for b in result.blocks for o in b.outputs))),
        ("Parameters", f"{fit.n_parameters} estimated from {fit.n_lines} lines"),
        ("Band", "whole" if run.settings.band_hz is None else _band(run.settings.band_hz)),
        ("Worst R²", "–" if worst is None else f"{worst[1]:.3f} ({worst[0]})"),
    )


def _outcome(result: RunResult) -> str:
    fit = result.fit
    took = f"{fit.outcome} in {fit.seconds:.2f} s"
    if not fit.iterations:
        return took
    return f"{took}, {count_iterations(fit.iterations[-1].iteration)} from {fit.start}"


def _band(band: tuple[float, float]) -> str:
    return f"{band[0]:g} to {band[1]:g} Hz"


def _derivatives(store: Store, run: EstimationRun, result: RunResult) -> tuple[Part, ...]:
    assert run.id is not None
    compared = compare(
        store, [run.id], [] if result.prediction_id is None else [result.prediction_id]
    )
    return tuple(
        drawn(
            f"Derivatives of {name} with ±2 standard errors, beside the prediction",
            lambda name=name: figures.derivatives(of_coefficient(compared, name)),
        )
        for name in coefficients(compared)
    )


def _parameters(result: RunResult) -> ReportTable:
    rows = []
    for one in result.parameters:
        value, error = estimate(one.value, one.std_error)
        error = one.no_error or error
        share = (
            number(100 * one.std_error / abs(one.value), 2)
            if one.std_error is not None and one.value
            else "–"
        )
        label = describe(one.name).label
        rows.append((label, one.name, value, error, share, number(one.start)))
    return ReportTable(
        ("", "name", "value", "σ", "σ [%]", "start"),
        tuple(rows),
        "Estimates with their standard errors σ",
        numbers_from=2,
    )


def _fit(store: Store, run_id: int, result: RunResult) -> tuple[Part, ...]:
    return (
        *_qualities(result),
        *(
            drawn(
                f"Measured and fitted lines, {block.name}",
                lambda block=block, outputs=outputs: figures.fit(
                    views.fit(store, run_id, outputs, block.name)
                ),
            )
            for block in result.blocks
            for outputs in _in_fours(block.outputs)
        ),
        drawn(
            "Residuals over frequency",
            lambda: figures.residual(views.residual(store, run_id)),
        ),
        drawn(
            "Recorded outputs and the answer of the model to recorded inputs",
            lambda: figures.time_check(views.time_check(store, run_id)),
        ),
    )


def _qualities(result: RunResult) -> tuple[Part, ...]:
    if not result.fit.quality:
        return ()
    table = ReportTable(
        ("output", "block", "R²", "Theil", "whiteness"),
        tuple(
            (q.output, q.block, f"{q.r_squared:.3f}", f"{q.theil:.3f}", f"{q.whiteness:.3f}")
            for q in result.fit.quality
        ),
        "Fit of each output: share explained, Theil's inequality, probability that the"
        " residuals are white",
        numbers_from=2,
    )
    return (table,)


def _in_fours(names: tuple[str, ...]) -> list[tuple[str, ...]]:
    """As many as fit on a page."""
    return [names[start : start + 4] for start in range(0, len(names), 4)]


def _uncertainty(store: Store, run_id: int) -> tuple[Part, ...]:
    return (
        drawn(
            "Correlation of the estimates",
            lambda: figures.parameter_correlation(views.parameter_correlation(store, run_id)),
        ),
        drawn("Cost by iteration", lambda: figures.iterations(views.iterations(store, run_id))),
    )


def _poles(store: Store, run_id: int, result: RunResult) -> tuple[Part, ...]:
    if not result.poles:
        return (Words("The estimates make no whole model, which would have poles."),)
    rows = []
    for pole in result.poles:
        if pole.imag < 0:
            continue
        frequency, its_error = (
            (number(pole.real), "–")
            if pole.frequency is None
            else estimate(pole.frequency / tau, _cycles(pole.frequency_std))
        )
        damping, error = (
            ("–", "–") if pole.damping is None else estimate(pole.damping, pole.damping_std)
        )
        rows.append((pole.name or "–", frequency, its_error, damping, error))
    return (
        drawn(
            "Poles of the identified model beside those of its modes in vacuo",
            lambda: figures.poles(views.poles(store, [run_id])),
        ),
        ReportTable(
            ("mode", "frequency [Hz]", "σ", "damping ratio", "σ"),
            tuple(rows),
            "Poles; of a real root its place [1/s] stands for the frequency",
        ),
    )


def _cycles(omega: float | None) -> float | None:
    return None if omega is None else omega / tau


def _provenance(store: Store, run: EstimationRun, result: RunResult) -> tuple[tuple[str, str], ...]:
    def named(kept: int | None, name: str) -> str:
        return "none" if kept is None else f"{kept}, {name}"

    prediction = result.prediction_id
    tables = [
        (title, identity)
        for title, identity in (
            ("Modal table", run.modal_table_id),
            ("Damping table", run.damping_table_id),
        )
        if identity is not None
    ]
    return (
        ("Run", f"{run.id}, attempt {run.attempt}"),
        ("Author", run.author or "–"),
        ("Asked, finished", f"{moment(run.created_at)}, {moment(run.finished_at)}"),
        ("Model structure", _structure(run)),
        *((title, named(i, store.modal_tables.get(i).name)) for title, i in tables),
        (
            "Prediction",
            "none"
            if prediction is None
            else named(prediction, store.predictions.get(prediction).source),
        ),
        ("Start", run.settings.start.value),
        ("Noise", run.settings.noise),
        ("Covariance", result.covariance),
        ("Versions", listed(f"{k} {v}" for k, v in (run.versions or {}).items())),
    )


def _structure(run: EstimationRun) -> str:
    if run.structure_id is None:
        return "the run's own"
    version = "" if run.structure_version is None else f", version {run.structure_version}"
    return f"{run.structure_id}{version}"
