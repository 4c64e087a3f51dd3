"""What a run fitted, what it left over, and how sure it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.comparison import Comparison
from flexsid.records.run import EstimationRun, FitBlock, Method, Pole, RunResult
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
from flexsid.workflow.comparison.derivative_comparison import compare, of_coefficient
from flexsid.workflow.model_structures.run_results import result_of
from flexsid.workflow.views.modes import modal_poles

_SHOWN_FIRST = 2  # outputs drawn when none was chosen; a page shows that many at once


def finished(store: Store, run_id: int) -> tuple[EstimationRun, RunResult]:
    """Read a run that has a result.

    Raises
    ------
    Conflict
        If it has none (yet), or it was altered.
    """
    run = store.runs.get(run_id)
    return run, result_of(run, "no result to show")


def fit(
    store: Store, run_id: int, outputs: Sequence[str] = (), block: str | None = None
) -> FitPlot:
    """Read measured and fitted lines; the first outputs of the first block by default."""
    run, result = finished(store, run_id)
    chosen = _block(run, result, block)
    names = outputs or chosen.outputs[:_SHOWN_FIRST]
    omega, measured, fitted = _lines(store, chosen)
    return FitPlot(
        run_id=run_id,
        method=run.method,
        block=chosen.name,
        frequency_hz=omega / (2.0 * np.pi),
        traces=tuple(
            _trace(run, result, chosen, name, measured, fitted) for name in dict.fromkeys(names)
        ),
    )


def _trace(
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
        # on the sheet of the measured phase, so that 179 and -179 degrees are neighbours
        fitted_phase_rad=phase + np.angle(y * z.conj()),
        r_squared=_r_squared_of(result, block.name, output),
    )


def _r_squared_of(result: RunResult, block: str, output: str) -> float | None:
    """Share of what is drawn that the model explains; older runs know only that of all blocks."""
    own = [one for one in result.fit.quality if (one.block, one.output) == (block, output)]
    return own[0].r_squared if own else result.fit.r_squared.get(output)


def residual(store: Store, run_id: int, block: str | None = None) -> Residuals:
    """Read residuals of all outputs of a block, each over its own rms."""
    run, result = finished(store, run_id)
    chosen = _block(run, result, block)
    omega, measured, fitted = _lines(store, chosen)
    size = np.abs(measured - fitted)
    rms = np.sqrt(np.mean(size**2, axis=0))
    return Residuals(
        run_id=run_id,
        method=run.method,
        block=chosen.name,
        frequency_hz=omega / (2.0 * np.pi),
        outputs=chosen.outputs,
        relative=np.divide(size, rms, out=np.zeros_like(size), where=rms > 0),
    )


def parameter_correlation(store: Store, run_id: int) -> ParameterCorrelation:
    """Read the correlation of the estimates from their covariance."""
    _, result = finished(store, run_id)
    covariance = store.arrays.get(result.covariance)
    sigma = np.sqrt(np.diag(covariance))
    scale = np.outer(sigma, sigma)
    undefined = np.full(covariance.shape, np.nan)
    return ParameterCorrelation(
        run_id=run_id,
        names=tuple(parameter.name for parameter in result.parameters),
        correlation=np.divide(covariance, scale, out=undefined, where=scale > 0),
    )


def poles(store: Store, run_ids: Sequence[int]) -> PoleMap:
    """Read the poles of models, and of the modes of the first one in vacuo."""
    found = [finished(store, run_id) for run_id in dict.fromkeys(run_ids)]
    if not found:
        raise BadInput("poles take at least one run; choose one", code="no-run")
    groups = [
        PoleGroup(
            label=f"{run.method.value} {run.id}",
            estimated=True,
            poles=_upper(result.poles),
            run_id=run.id,
            method=run.method,
        )
        for run, result in found
    ]
    in_vacuo = modal_poles(store, found[0][0])
    if in_vacuo:
        groups.append(PoleGroup(label="in vacuo", estimated=False, poles=in_vacuo))
    return PoleMap(groups=tuple(groups))


def _upper(poles: tuple[Pole, ...]) -> tuple[Pole, ...]:
    return tuple(pole for pole in poles if pole.imag >= 0)


def iterations(store: Store, run_id: int) -> Convergence:
    """Read how the cost fell."""
    _, result = finished(store, run_id)
    return Convergence(run_id=run_id, iterations=result.fit.iterations)


def _block(run: EstimationRun, result: RunResult, name: str | None) -> FitBlock:
    if name is None and result.blocks:
        return result.blocks[0]
    for block in result.blocks:
        if block.name == name:
            return block
    known = ", ".join(block.name for block in result.blocks) or "none"
    raise BadInput(
        f"run {run.id} has no block '{name}'; it has: {known}", code="unknown-block", block=name
    )


def _lines(store: Store, block: FitBlock) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    arrays = store.arrays.get_many(block.arrays.values())
    omega, measured, fitted = (
        arrays[block.arrays[name]] for name in ("omega", "measured", "fitted")
    )
    order = np.argsort(omega, kind="stable")
    return omega[order], measured[order], fitted[order]


def derivatives(
    store: Store,
    run_ids: Sequence[int],
    prediction_ids: Sequence[int] = (),
    coefficient: str | None = None,
) -> Comparison:
    """Read the derivatives of one coefficient, by method and prediction."""
    return of_coefficient(compare(store, run_ids, prediction_ids), coefficient)
