"""Report of a run: flight condition, settings, estimates, fit, uncertainty, poles, validation."""

from __future__ import annotations

from collections.abc import Sequence
from math import tau
from typing import Any, TypeVar

from flexsid.display_units import display_unit
from flexsid.errors import BadInput, Conflict
from flexsid.jobs.kind import Kind, get_result
from flexsid.jobs.kinds import CROSS_PREDICTION, CROSS_VALIDATION
from flexsid.nomenclature import describe
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import AdequacyState, EstimationRun, ModelAdequacy, RunResult
from flexsid.records.validation import CrossValidationSummary
from flexsid.reports.content import (
    Facts,
    Markdown,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    draw,
    estimate,
    listed,
    moment,
    number,
    shown,
)
from flexsid.reports.credibility import report_run_credibility
from flexsid.storage.content import find_changes
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import count_iterations
from flexsid.workflow.comparison.derivative_comparison import compare, list_coefficients
from flexsid.workflow.fits.computation import get_title
from flexsid.workflow.model_structures.model_structures import describe_data_changes
from flexsid.workflow.review.notes import list_notes
from flexsid.workflow.runs.run_templates import get_run_template, list_changed_settings
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
from flexsid.workflow.validation.cross_validation import CrossValidationQuery
from flexsid.workflow.views.run import read_finished_run

# --- Sections of reports on validation: stored results, since reports compute nothing -------------

Result = TypeVar("Result")


def report_cross_validation(store: Store, run_id: int) -> tuple[Section, ...]:
    """Report the stored five-fold cross-validation of a run; no section without one."""
    found = _find_result(store, CROSS_VALIDATION, CrossValidationQuery(run_id=run_id))
    if found is None:
        return ()
    residual = draw("Residuals at the data held out", store, "held-out-residual", run_id=run_id)
    section = Section(
        "Cross-validation", (Words(found.summary.sentence), _tabulate(found.summary), residual)
    )
    return (section,)


def report_cross_predictions(store: Store, run_ids: Sequence[int]) -> tuple[Section, ...]:
    """Report the stored matrix of runs and their maneuvers; no section without one."""
    runs = tuple(dict.fromkeys(run_ids))
    if _find_result(store, CROSS_PREDICTION, CrossPredictionQuery(run_ids=runs)) is None:
        return ()
    caption = "Mean R² of the outputs of each maneuver, predicted by each model"
    drawing = draw(caption, store, "cross-prediction", run_ids=runs)
    return (Section("Cross-prediction", (drawing,)),)


def _find_result(store: Store, kind: Kind[Any, Result], query: object) -> Result | None:
    try:
        return get_result(store, kind, query)
    except (BadInput, Conflict):  # runs that may be compared, but not predict each other
        return None


def _tabulate(found: CrossValidationSummary) -> ReportTable:
    return ReportTable(
        ("output", "maneuver", "R²", "of the run", "Theil", "of the run"),
        tuple(
            (
                one.output,
                str(one.maneuver_id),
                f"{one.r_squared:.3f}",
                f"{one.fitted_r_squared:.3f}",
                f"{one.theil:.3f}",
                f"{one.fitted_theil:.3f}",
            )
            for one in found.outputs
        ),
        "R² and Theil's inequality coefficient of the data held out, by refits and by the run",
        numbers_from=2,
    )


# --- Flight condition and source files of a maneuver ----------------------------------------------


def condition_facts(maneuver: Maneuver) -> tuple[tuple[str, str], ...]:
    """List the flight condition of a maneuver with units."""
    c = maneuver.condition
    ratio = maneuver.airspeed_ratio
    return (
        (
            "Airspeed",
            f"{shown(c.airspeed_m_s, 'm/s')}{'' if ratio is None else f', {ratio:.3f} V/V_f'}",
        ),
        ("Dynamic pressure", shown(c.dynamic_pressure_pa, "Pa")),
        ("Density", shown(c.density_kg_m3, "kg/m3")),
        ("Fuel fraction", f"{c.fuel_fraction:.2f}"),
        ("Mass", shown(c.mass_kg, "kg")),
        ("Pitch inertia", shown(c.pitch_inertia_kg_m2, "kg*m2")),
        ("Angle of attack", shown(c.alpha_rad, "rad")),
        ("Duration", f"{maneuver.duration_s:g} s"),
        ("Flight test aid", "–" if maneuver.fta is None else f"FTA {maneuver.fta}"),
    )


def source_facts(store: Store, maneuver: Maneuver) -> tuple[tuple[str, str], ...]:
    """List the source files of a maneuver with their hashes."""
    found = {maneuver.source_file: maneuver.source_hash}
    for channel in store.channels.find(maneuver_id=maneuver.id):
        found.setdefault(channel.source_file, channel.source_hash)
    files = tuple(
        (f"File of maneuver {maneuver.id}", file if digest is None else f"{file}, SHA-256 {digest}")
        for file, digest in found.items()
        if file is not None
    )
    return files or ((f"Maneuver {maneuver.id}", "simulated, no source file"),)


# --- Report of a run: settings, estimates, fit, uncertainty, poles --------------------------------

_MOST_TESTS = 20  # of a table in a report
_OUTPUTS_OF_FIGURE = 4  # by page height
_MOST_FITS = 20  # that are drawn: a report has about ten pages


def run_report(store: Store, run_id: int) -> Report:
    """Report a run that succeeded.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    run, result = read_finished_run(store, run_id)
    maneuver = store.maneuvers.get(run.maneuver_id)
    flight = store.flights.get(maneuver.flight_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    return Report(
        title=f"{get_title(run.method)}, run {run_id}",
        subtitle=f"{maneuver.label}, flight {flight.number} of {aircraft.name}",
        name=f"flexsid-run-{run_id}",
        sections=(
            Section(
                "Summary", (*_list_warnings(store, run, result), Facts(_summarise(run, result)))
            ),
            Section("Flight condition", (Facts(condition_facts(maneuver)),)),
            Section(
                "Derivatives",
                (*_draw_derivatives(store, run, result), _tabulate_parameters(result)),
            ),
            Section("Fit", _report_fit(store, run_id, result)),
            *report_cross_validation(store, run_id),
            Section("Model adequacy", _report_adequacy(result.adequacy)),
            *(
                ()
                if result.symmetry is None
                else (Section("Symmetry", _report_adequacy(result.symmetry)),)
            ),
            Section("Uncertainty", _report_uncertainty(store, run_id)),
            Section("Poles", _report_poles(store, run_id, result)),
            *_report_notes(store, run_id),
            report_run_credibility(store, run, result),
        ),
        provenance=(*_list_provenance(store, run, result), *source_facts(store, maneuver)),
    )


def _report_notes(store: Store, run_id: int) -> tuple[Section, ...]:
    """Report the notes on a run, its maneuver, its modes and its derivatives."""
    notes = list_notes(store, run_id=run_id)
    parts = tuple(
        Markdown(
            note.text,
            f"{note.subject.value.capitalize()} {note.key}, {note.author}"
            f"{'' if note.author_verified else ' (unverified)'}, {moment(note.changed_at)}"
            + (f", revision {note.revision}" if note.revision > 1 else ""),
        )
        for note in notes
    )
    return (Section("Notes", parts),) if parts else ()


def _list_warnings(store: Store, run: EstimationRun, result: RunResult) -> tuple[Part, ...]:
    (changed,) = find_changes(store.database, [run.rests_on])
    late = describe_data_changes(run.id, changed)
    texts = (*(() if late is None else (late,)), *result.fit.warnings)
    return tuple(Words(text, warns=True) for text in texts)


def _summarise(run: EstimationRun, result: RunResult) -> tuple[tuple[str, str], ...]:
    fit = result.fit
    structure = run.structure
    worst = min(fit.r_squared.items(), key=lambda pair: pair[1], default=None)
    return (
        ("Outcome", _describe_outcome(result)),
        ("Model adequacy", f"{result.adequacy.state.value}. {result.adequacy.reason}"),
        ("Modes", listed(structure.modes, "none: rigid body")),
        ("Inputs", listed(structure.inputs, "all excited")),
        ("Outputs", listed(dict.fromkeys(o for b in result.blocks for o in b.outputs))),
        ("Parameters", f"{fit.n_parameters} estimated from {fit.n_lines} frequencies"),
        ("Band", "whole" if run.settings.band_hz is None else _format_band(run.settings.band_hz)),
        ("Worst R²", "–" if worst is None else f"{worst[1]:.3f} ({worst[0]})"),
    )


def _describe_outcome(result: RunResult) -> str:
    fit = result.fit
    took = f"{fit.outcome} in {fit.seconds:.2f} s"
    if not fit.iterations:
        return took
    return f"{took}, {count_iterations(fit.iterations[-1].iteration)} from {fit.start}"


def _format_band(band: tuple[float, float]) -> str:
    unit, factor = display_unit("Hz")
    return f"{factor * band[0]:.4g} to {factor * band[1]:.4g} {unit}"


def _draw_derivatives(store: Store, run: EstimationRun, result: RunResult) -> tuple[Part, ...]:
    assert run.id is not None
    predictions = [] if result.prediction_id is None else [result.prediction_id]
    return tuple(
        draw(
            f"Derivatives of {name} with ±2 standard errors, with the prediction",
            store,
            "derivatives",
            run_ids=[run.id],
            prediction_ids=predictions,
            coefficient=name,
        )
        for name in list_coefficients(compare(store, [run.id], predictions))
    )


def _tabulate_parameters(result: RunResult) -> ReportTable:
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
        repeatability, rest = number(one.repeatability, 2), one.rests_on or ""
        rows.append((label, one.name, value, error, share, repeatability, number(one.start), rest))
    return ReportTable(
        ("", "name", "value", "σ", "σ [%]", "repeatability", "start", ""),
        tuple(rows),
        "Estimates and standard errors σ, with what more than half of a variance rests on",
        numbers_from=2,
    )


def _report_fit(store: Store, run_id: int, result: RunResult) -> tuple[Part, ...]:
    drawn = select_outputs(result)
    n_drawn, n_all = (sum(len(names) for _, names in one) for one in (drawn, _list_blocks(result)))
    omitted = f"The figures have the lowest R² of each block, {n_drawn} of {n_all} fits."
    return (
        *tabulate_fit(result),
        *((Words(f"{omitted} All are on the page of the run."),) if n_drawn < n_all else ()),
        *(
            draw(
                f"Measured and fitted data, {block}",
                store,
                "fit",
                run_id=run_id,
                outputs=outputs,
                block=block,
            )
            for block, names in drawn
            for outputs in _divide(names)
        ),
        draw("Residuals over frequency", store, "residual", run_id=run_id),
        draw(
            "Measured and simulated outputs in time, with recorded inputs",
            store,
            "time-check",
            run_id=run_id,
        ),
    )


def _list_blocks(result: RunResult) -> list[tuple[str, tuple[str, ...]]]:
    return [(block.name, block.outputs) for block in result.blocks]


def select_outputs(result: RunResult) -> list[tuple[str, tuple[str, ...]]]:
    """Select the outputs of each block that are drawn: those with the lowest R²."""
    quality = {(one.block, one.output): one.r_squared for one in result.fit.quality}
    n_outputs = max(1, _MOST_FITS // max(1, len(result.blocks)))
    selected = []
    for name, outputs in _list_blocks(result):
        by_quality = sorted(outputs, key=lambda output: quality.get((name, output), 1.0))
        lowest = set(by_quality[:n_outputs])
        selected.append((name, tuple(output for output in outputs if output in lowest)))
    return selected


def tabulate_fit(result: RunResult) -> tuple[ReportTable, ...]:
    """Tabulate the fit of each output; by output and block where outputs have several."""
    quality = result.fit.quality
    if not quality:
        return ()
    if len({one.output for one in quality}) < len(quality):
        return (_tabulate_blocks(result),)
    table = ReportTable(
        ("output", "block", "R²", "Theil", "whiteness"),
        tuple(
            (q.output, q.block, f"{q.r_squared:.3f}", f"{q.theil:.3f}", f"{q.whiteness:.3f}")
            for q in quality
        ),
        "Fit of each output: R², Theil's inequality coefficient, probability of white residuals",
        numbers_from=2,
    )
    return (table,)


def _tabulate_blocks(result: RunResult) -> ReportTable:
    """Tabulate R² by output and block, with the worst of the other criteria."""
    names = [name for name, _ in _list_blocks(result)]
    rows = []
    for output in dict.fromkeys(q.output for q in result.fit.quality):
        own = {q.block: q for q in result.fit.quality if q.output == output}
        rows.append(
            (
                output,
                *(f"{own[name].r_squared:.3f}" if name in own else "–" for name in names),
                f"{max(q.theil for q in own.values()):.3f}",
                f"{min(q.whiteness for q in own.values()):.3f}",
            )
        )
    return ReportTable(
        ("output", *names, "Theil", "whiteness"),
        tuple(rows),
        "Fit of each output: R² by block; the largest of Theil's inequality coefficients and the "
        "smallest probability of white residuals",
        numbers_from=1,
    )


def _report_adequacy(adequacy: ModelAdequacy) -> tuple[Part, ...]:
    reason = Words(adequacy.reason, warns=adequacy.state is AdequacyState.SUSPECT)
    if not adequacy.tests:
        return (reason,)
    table = ReportTable(
        ("model error", "of", "meaning", "statistic", "degrees of freedom", "p", "p of all tests"),
        tuple(
            (
                test.hypothesis,
                test.subject,
                test.meaning,
                f"{test.statistic:.1f}",
                str(test.degrees_of_freedom or "–"),
                f"{test.p:.2g}",
                f"{test.adjusted_p:.2g}",
            )
            for test in adequacy.tests[:_MOST_TESTS]
        ),
        f"Tests, the {min(len(adequacy.tests), _MOST_TESTS)} of "
        f"{len(adequacy.tests)} with the smallest p",
        numbers_from=3,
    )
    return (reason, table)


def _divide(names: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Divide names into groups by page height."""
    step = _OUTPUTS_OF_FIGURE
    return [names[start : start + step] for start in range(0, len(names), step)]


def _report_uncertainty(store: Store, run_id: int) -> tuple[Part, ...]:
    return (
        draw("Correlation matrix of the estimates", store, "parameter-correlation", run_id=run_id),
        draw("Cost by iteration", store, "iterations", run_id=run_id),
    )


def _report_poles(store: Store, run_id: int, result: RunResult) -> tuple[Part, ...]:
    if not result.poles:
        return (Words("The estimates are not a complete model, so it has no poles."),)
    unit, per_hz = display_unit("Hz")
    factor = per_hz / tau
    rows = []
    for pole in result.poles:
        if pole.imag < 0:
            continue
        frequency, its_error = (
            (number(pole.real), "–")
            if pole.frequency is None
            else estimate(
                factor * pole.frequency,
                None if pole.frequency_std is None else factor * pole.frequency_std,
            )
        )
        damping, error = (
            ("–", "–") if pole.damping is None else estimate(pole.damping, pole.damping_std)
        )
        rows.append((pole.name or "–", frequency, its_error, damping, error))
    return (
        draw(
            "Poles of the identified model, with in-vacuo poles of its modes",
            store,
            "poles",
            run_ids=[run_id],
        ),
        ReportTable(
            ("mode", f"frequency [{unit}]", "σ", "damping ratio", "σ"),
            tuple(rows),
            "Poles; for real roots the value [1/s] instead of the frequency",
        ),
    )


def _list_provenance(
    store: Store, run: EstimationRun, result: RunResult
) -> tuple[tuple[str, str], ...]:
    def format_record(number: int | None, name: str) -> str:
        return "none" if number is None else f"{number}, {name}"

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
        ("Requested, finished", f"{moment(run.created_at)}, {moment(run.finished_at)}"),
        ("Model structure", _describe_structure(run)),
        *((title, format_record(i, store.modal_tables.get(i).name)) for title, i in tables),
        (
            "Prediction",
            "none"
            if prediction is None
            else format_record(prediction, store.predictions.get(prediction).source),
        ),
        ("Template", _describe_template(store, run)),
        ("Start", run.settings.start.value),
        ("Noise", run.settings.noise),
        ("Covariance", result.covariance),
        ("Versions", listed(f"{k} {v}" for k, v in (run.versions or {}).items())),
    )


def _describe_template(store: Store, run: EstimationRun) -> str:
    if run.run_template_id is None:
        return "none"
    template = get_run_template(store, run.run_template_id, run.run_template_revision)
    changed = list_changed_settings(run, template)
    text = f"{template.name}, revision {template.revision}"
    return f"{text}, changed: {listed(changed)}" if changed else text


def _describe_structure(run: EstimationRun) -> str:
    if run.structure_id is None:
        return "of this run"
    version = "" if run.structure_version is None else f", version {run.structure_version}"
    return f"{run.structure_id}{version}"
