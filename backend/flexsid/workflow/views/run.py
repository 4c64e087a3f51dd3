"""Fit, residuals, parameter correlation, poles and convergence of runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.comparison import Comparison
from flexsid.records.run import EstimationRun, FitBlock, Method, ModelAdequacy, Pole, RunResult
from flexsid.records.views import (
    Convergence,
    FitPlot,
    FitTrace,
    ParameterCorrelation,
    PoleGroup,
    PoleMap,
    Residuals,
)
from flexsid.storage.store import Store
from flexsid.sysid.estimation.agreement import compute_correlation
from flexsid.workflow.comparison.derivative_comparison import compare, select_coefficient
from flexsid.workflow.model_structures.run_results import get_result
from flexsid.workflow.views.modes import list_modal_poles

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
    return FitPlot(
        run_id=run_id,
        method=run.method,
        block=selected.name,
        frequency_hz=omega / (2.0 * np.pi),
        traces=tuple(
            _build_trace(run, result, selected, name, measured, fitted)
            for name in dict.fromkeys(names)
        ),
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
    phase = np.unwrap(np.angle(z)) if responses else np.angle(z)
    return FitTrace(
        output=output,
        unit=describe(output).unit,
        input=block.name if responses else None,
        measured_magnitude=np.abs(z),
        measured_phase_rad=phase,
        fitted_magnitude=np.abs(y),
        # unwrapped to the measured phase
        fitted_phase_rad=phase + np.angle(y * z.conj()),
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
