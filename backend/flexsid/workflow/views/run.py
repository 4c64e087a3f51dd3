"""Numbers of runs: fit, residuals, correlation, poles, convergence, plot matrix of regressors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import (
    EstimationRun,
    FitBlock,
    Method,
    ModelAdequacy,
    Pole,
    RunResult,
    RunSettings,
)
from flexsid.records.validation import Comparison
from flexsid.records.views import (
    Convergence,
    FitPlot,
    FitTrace,
    ParameterCorrelation,
    PlotMatrix,
    PoleGroup,
    PoleMap,
    Residuals,
)
from flexsid.storage.store import Store
from flexsid.sysid.estimation.agreement import compute_correlation
from flexsid.sysid.regression.equation_error import build_regressors
from flexsid.sysid.spectra.collinearity import assess_collinearity
from flexsid.workflow.aircraft.axes import find_body, list_moved_surfaces
from flexsid.workflow.comparison.derivative_comparison import compare, select_coefficient
from flexsid.workflow.fits.equation_error_fit import fit_consistent_equation_error
from flexsid.workflow.measurements.maneuver_spectra import read_spectra
from flexsid.workflow.measurements.recording import find_assigned_inputs, select_frequencies
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.run_proposal import complete_request
from flexsid.workflow.views.maneuver import (
    CLEAR_OF_NYQUIST,
    find_sampling,
    list_input_names,
    read_traces,
    resample_to_slowest,
)
from flexsid.workflow.views.modes import list_modal_poles

# --- Fit, residuals, parameter correlation, poles and convergence of runs -------------------------

_SHOWN_FIRST = 2  # outputs drawn by default


def read_finished_run(store: Store, run_id: int) -> tuple[EstimationRun, RunResult]:
    """Read a run that has a result.

    Raises
    ------
    Conflict
        If it has none (yet), or it was altered.
    """
    run = store.runs.get(run_id)
    return run, get_result(run, "no result to show")


def read_fit(
    store: Store, run_id: int, outputs: Sequence[str] = (), block: str | None = None
) -> FitPlot:
    """Read measured and fitted data; the first outputs of the first block by default."""
    run, result = read_finished_run(store, run_id)
    selected = _get_block(run, result, block)
    names = outputs or selected.outputs[:_SHOWN_FIRST]
    omega, measured, fitted = _read_spectra(store, selected)
    frequency_hz = omega / (2.0 * np.pi)
    maneuver = store.maneuvers.get(run.maneuver_id)
    return FitPlot(
        run_id=run_id,
        method=run.method,
        block=selected.name,
        frequency_hz=frequency_hz,
        traces=tuple(
            _build_trace(run, result, selected, name, measured, fitted)
            for name in dict.fromkeys(names)
        ),
        inputs=() if maneuver.excitation is None else tuple(maneuver.excitation.harmonics),
        assigned_inputs=find_assigned_inputs(maneuver, frequency_hz),
    )


def _build_trace(
    run: EstimationRun,
    result: RunResult,
    block: FitBlock,
    output: str,
    measured: np.ndarray,
    fitted: np.ndarray,
) -> FitTrace:
    if output not in block.outputs:
        raise BadInput(
            f"run {run.id} did not fit '{output}'; block {block.name} "
            f"has {', '.join(block.outputs)}",
            code="unknown-output",
            output=output,
        )
    column = block.outputs.index(output)
    z, y = measured[:, column], fitted[:, column]
    responses = run.method is Method.FRE
    # Responses are unwrapped along the model, which has no noise; the data are next to it.
    model = np.unwrap(np.angle(y))
    phase = model + np.angle(z * y.conj()) if responses else np.angle(z)
    return FitTrace(
        output=output,
        unit=describe(output).unit,
        input=block.name if responses else None,
        measured_magnitude=np.abs(z),
        measured_phase_rad=phase,
        fitted_magnitude=np.abs(y),
        fitted_phase_rad=model if responses else phase + np.angle(y * z.conj()),
        r_squared=_get_r_squared(result, block.name, output),
    )


def _get_r_squared(result: RunResult, block: str, output: str) -> float | None:
    """Return R squared of a block; older runs have that of all blocks only."""
    own = [one for one in result.fit.quality if (one.block, one.output) == (block, output)]
    return own[0].r_squared if own else result.fit.r_squared.get(output)


def compute_residuals(store: Store, run_id: int, block: str | None = None) -> Residuals:
    """Read residuals of all outputs of a block, normalised by their rms."""
    run, result = read_finished_run(store, run_id)
    selected = _get_block(run, result, block)
    omega, measured, fitted = _read_spectra(store, selected)
    size = np.abs(measured - fitted)
    rms = np.sqrt(np.mean(size**2, axis=0))
    return Residuals(
        run_id=run_id,
        method=run.method,
        block=selected.name,
        frequency_hz=omega / (2.0 * np.pi),
        outputs=selected.outputs,
        relative=np.divide(size, rms, out=np.zeros_like(size), where=rms > 0),
    )


def compute_parameter_correlation(store: Store, run_id: int) -> ParameterCorrelation:
    """Read the correlation of the estimates from their covariance."""
    _, result = read_finished_run(store, run_id)
    return ParameterCorrelation(
        run_id=run_id,
        names=tuple(parameter.name for parameter in result.parameters),
        correlation=compute_correlation(store.arrays.get(result.covariance)),
    )


def read_adequacy(store: Store, run_id: int) -> ModelAdequacy:
    """Read the tests for remaining model error of a run."""
    return read_finished_run(store, run_id)[1].adequacy


def read_poles(store: Store, run_ids: Sequence[int]) -> PoleMap:
    """Read the poles of models, and of the modes of the first one in vacuo."""
    found = [read_finished_run(store, run_id) for run_id in dict.fromkeys(run_ids)]
    if not found:
        raise BadInput("poles need at least one run; select one", code="no-run")
    groups = [
        PoleGroup(
            label=f"{run.method.value} {run.id}",
            estimated=True,
            poles=_select_upper(result.poles),
            run_id=run.id,
            method=run.method,
        )
        for run, result in found
    ]
    in_vacuo = list_modal_poles(store, found[0][0])
    if in_vacuo:
        groups.append(PoleGroup(label="in vacuo", estimated=False, poles=in_vacuo))
    return PoleMap(groups=tuple(groups))


def _select_upper(poles: tuple[Pole, ...]) -> tuple[Pole, ...]:
    return tuple(pole for pole in poles if pole.imag >= 0)


def read_iterations(store: Store, run_id: int) -> Convergence:
    """Read the cost by iteration."""
    _, result = read_finished_run(store, run_id)
    return Convergence(run_id=run_id, iterations=result.fit.iterations)


def _get_block(run: EstimationRun, result: RunResult, name: str | None) -> FitBlock:
    if name is None and result.blocks:
        return result.blocks[0]
    for block in result.blocks:
        if block.name == name:
            return block
    known = ", ".join(block.name for block in result.blocks) or "none"
    raise BadInput(
        f"run {run.id} has no block '{name}'; it has: {known}", code="unknown-block", block=name
    )


def _read_spectra(store: Store, block: FitBlock) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    arrays = store.arrays.get_many(block.arrays.values())
    omega, measured, fitted = (
        arrays[block.arrays[name]] for name in ("omega", "measured", "fitted")
    )
    order = np.argsort(omega, kind="stable")
    return omega[order], measured[order], fitted[order]


def compare_derivatives(
    store: Store,
    run_ids: Sequence[int],
    prediction_ids: Sequence[int] = (),
    coefficient: str | None = None,
) -> Comparison:
    """Read the derivatives of one coefficient, by method and prediction."""
    return select_coefficient(compare(store, run_ids, prediction_ids), coefficient)


# --- Plot matrix of channels or equation-error regressors, with collinearity ----------------------

Domain = Literal["time", "frequency"]


def compute_plot_matrix(
    store: Store,
    maneuver_id: int,
    channels: Sequence[str] = (),
    domain: Domain = "time",
    modes: Sequence[int] = (),
) -> PlotMatrix:
    """Read channels during the excitation and compute collinearity; inputs by default.

    Left and right surfaces that only move together, or against each other, are one input.
    Trim before and after would add points at rest, which hide correlation. With ``modes`` the
    columns are the equation-error regressors of the default run with these modes, at harmonics
    only.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    if modes:
        return _read_regressors(store, maneuver, tuple(dict.fromkeys(modes)))
    selected = tuple(dict.fromkeys(channels)) or list_moved_surfaces(
        store.aircraft.get(maneuver.aircraft_id),
        maneuver.axis,
        maneuver.excitation,
        list_input_names(store, maneuver),
    )
    if domain == "frequency":
        return _read_regressor_spectra(store, maneuver, selected)
    excitation = maneuver.excitation
    interval = None if excitation is None else excitation.interval_s
    traces = read_traces(store, maneuver, selected, interval)
    together = resample_to_slowest(traces) if traces else ()
    samples = (
        np.stack([trace.values for trace in together], axis=1) if together else np.zeros((0, 0))
    )
    names = tuple(trace.name for trace in together)
    return _build_matrix(maneuver, names, tuple(trace.unit for trace in together), samples)


def _read_regressor_spectra(store: Store, maneuver: Maneuver, names: tuple[str, ...]) -> PlotMatrix:
    if maneuver.excitation is None:
        raise BadInput(
            "the excitation of this maneuver is unknown, and with it its harmonics; compare "
            "channels in the time domain",
            code="no-excitation",
        )
    rates = find_sampling(store, maneuver, names)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    below_hz = CLEAR_OF_NYQUIST * min(rate_hz for rate_hz, _ in rates.values())
    frequencies = select_frequencies(maneuver, (0.0, below_hz))
    spectra = read_spectra(store, maneuver, aircraft, names, frequencies).values
    return _build_matrix(maneuver, names, tuple(f"{rates[name][1]} s" for name in names), spectra)


def _read_regressors(store: Store, maneuver: Maneuver, modes: tuple[int, ...]) -> PlotMatrix:
    """Compute the regressors of the default run of equation error with these modes.

    Its out-of-band modes are retained with the prior that the data support, and so are its inputs,
    noise and corrections of the ends of the record.
    """
    assert maneuver.id is not None
    request = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.EE,
        structure=Structure(modes=modes, fixed={}, axis=find_body(maneuver.axis).axis),
        settings=RunSettings(),
    )
    task, _, fit = fit_consistent_equation_error(prepare(store, complete_request(store, request)))
    model, motion = task.model.with_modes(len(modes)), fit.motions[0]
    columns = build_regressors(
        model, motion.select_motions(len(model.motions)), task.maneuvers[0].measured.inputs
    )
    names = model.variables
    return _build_matrix(maneuver, names, tuple("s" for _ in names), columns)


def _build_matrix(
    maneuver: Maneuver, names: tuple[str, ...], units: tuple[str, ...], columns: np.ndarray
) -> PlotMatrix:
    assert maneuver.id is not None
    found = assess_collinearity(columns, remove_mean=not np.iscomplexobj(columns))
    return PlotMatrix(
        maneuver_id=maneuver.id,
        names=names,
        units=units,
        samples=columns,
        correlation=found.correlation,
        inflation=found.inflation,
        condition=found.condition,
    )
