"""Numbers of the figures of a validation: spectra, residuals and their correlation."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.run import Method
from flexsid.records.validation import (
    CorrelationCurve,
    CrossValidation,
    HeldOutSpectra,
    ResidualCorrelations,
)
from flexsid.records.views import FitPlot, FitTrace, Residuals
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import FittedSpectra
from flexsid.sysid.estimation.validation import (
    ResidualCorrelation,
    autocorrelate_residual,
    cross_correlate_residual,
)
from flexsid.workflow.validation.predicted_maneuver import PredictedManeuver, predict_maneuver

_SHOWN_FIRST = 2  # outputs drawn by default


def read_prediction(
    store: Store, run_id: int, maneuver_id: int | None = None, outputs: Sequence[str] = ()
) -> FitPlot:
    """Predict outputs of a maneuver, by default that of the run; the first outputs by default."""
    spectra = _predict(store, run_id, maneuver_id).spectra
    return _plot(run_id, spectra, outputs)


def compute_prediction_residuals(
    store: Store, run_id: int, maneuver_id: int | None = None
) -> Residuals:
    """Compute the residuals of the predicted outputs of a maneuver, relative to their rms."""
    return _compute_residuals(run_id, _predict(store, run_id, maneuver_id).spectra)


def correlate_residuals(
    store: Store, run_id: int, maneuver_id: int | None = None, outputs: Sequence[str] = ()
) -> ResidualCorrelations:
    """Correlate the residuals of outputs with themselves, the inputs, and each other.

    Residuals are those of the outputs predicted from measured inputs, by default for the
    maneuver of the run and its first output.

    Raises
    ------
    BadInput
        If the model has no such output.
    """
    predicted = _predict(store, run_id, maneuver_id)
    spectra = predicted.spectra
    names = tuple(dict.fromkeys(outputs)) or spectra.outputs[:1]
    omega, correlation = spectra.omega, spectra.correlation
    residuals = {
        name: (spectra.measured - spectra.fitted)[:, _get_column(spectra, name)] for name in names
    }
    curves = []
    for name, residual in residuals.items():
        own = autocorrelate_residual(omega, residual, correlation)
        curves.append(_describe_curve(name, name, own))
        for k, channel in enumerate(predicted.input_names):
            found = cross_correlate_residual(omega, residual, predicted.inputs[:, k], correlation)
            curves.append(_describe_curve(name, channel, found))
    for first, second in combinations(names, 2):
        found = cross_correlate_residual(omega, residuals[first], residuals[second], correlation)
        curves.append(_describe_curve(first, second, found))
    outside = [np.abs(curve.values) > curve.bound for curve in curves]
    return ResidualCorrelations(
        run_id=run_id,
        maneuver_id=_get_maneuver_id(store, run_id, maneuver_id),
        curves=tuple(curves),
        share_outside=float(np.mean(np.concatenate(outside))),
    )


def read_held_out_fit(
    found: CrossValidation, maneuver_id: int | None = None, outputs: Sequence[str] = ()
) -> FitPlot:
    """Read measured and predicted outputs at the frequencies held out."""
    return _plot(found.summary.run_id, _get_spectra(found, maneuver_id), outputs)


def compute_held_out_residuals(found: CrossValidation, maneuver_id: int | None = None) -> Residuals:
    """Compute the residuals at the frequencies held out, relative to their rms."""
    return _compute_residuals(found.summary.run_id, _get_spectra(found, maneuver_id))


def _predict(store: Store, run_id: int, maneuver_id: int | None) -> PredictedManeuver:
    number = _get_maneuver_id(store, run_id, maneuver_id)
    return predict_maneuver(store, store.runs.get(run_id), number)


def _get_maneuver_id(store: Store, run_id: int, maneuver_id: int | None) -> int:
    return store.runs.get(run_id).maneuver_id if maneuver_id is None else maneuver_id


def _get_spectra(found: CrossValidation, maneuver_id: int | None) -> FittedSpectra:
    def convert(one: HeldOutSpectra) -> FittedSpectra:
        return FittedSpectra("held out", one.outputs, one.omega, one.measured, one.predicted)

    for one in found.spectra:
        if maneuver_id in (None, one.maneuver_id):
            return convert(one)
    raise BadInput(
        f"run {found.summary.run_id} was not fitted to maneuver {maneuver_id}",
        code="unknown-maneuver",
    )


def _get_column(spectra: FittedSpectra, output: str) -> int:
    if output not in spectra.outputs:
        raise BadInput(
            f"the model has no output '{output}'; it has {', '.join(spectra.outputs)}",
            code="unknown-output",
            output=output,
        )
    return spectra.outputs.index(output)


def _plot(run_id: int, spectra: FittedSpectra, outputs: Sequence[str]) -> FitPlot:
    r_squared = spectra.r_squared()
    traces = []
    for name in dict.fromkeys(outputs or spectra.outputs[:_SHOWN_FIRST]):
        column = _get_column(spectra, name)
        z, y = spectra.measured[:, column], spectra.fitted[:, column]
        phase = np.angle(z)
        traces.append(
            FitTrace(
                output=name,
                unit=describe(name).unit,
                input=None,
                measured_magnitude=np.abs(z),
                measured_phase_rad=phase,
                fitted_magnitude=np.abs(y),
                fitted_phase_rad=phase + np.angle(y * z.conj()),
                r_squared=float(r_squared[column]),
            )
        )
    return FitPlot(
        run_id=run_id,
        method=Method.OE,  # whatever the method of the run: outputs from measured inputs
        block=spectra.name,
        frequency_hz=spectra.omega / (2.0 * np.pi),
        traces=tuple(traces),
        curve="predicted",
    )


def _compute_residuals(run_id: int, spectra: FittedSpectra) -> Residuals:
    size = np.abs(spectra.measured - spectra.fitted)
    rms = np.sqrt(np.mean(size**2, axis=0))
    return Residuals(
        run_id=run_id,
        method=Method.OE,
        block=spectra.name,
        frequency_hz=spectra.omega / (2.0 * np.pi),
        outputs=spectra.outputs,
        relative=np.divide(size, rms, out=np.zeros_like(size), where=rms > 0),
    )


def _describe_curve(output: str, other: str, found: ResidualCorrelation) -> CorrelationCurve:
    return CorrelationCurve(
        output=output, other=other, lags_s=found.lags_s, values=found.values, bound=found.bound
    )
