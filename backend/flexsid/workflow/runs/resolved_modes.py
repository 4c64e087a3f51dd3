"""Modes in the band that the data of maneuvers do not determine, before any fit."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.records.run import EstimationRun
from flexsid.storage.store import Store
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.excitation.fisher_information import compute_determined_shares
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.spectra.measured_spectra import MeasuredSpectra
from flexsid.sysid.spectra.residual_spectrum import estimate_scatter
from flexsid.workflow.fits.estimation_task import EstimationTask
from flexsid.workflow.runs.estimation import prepare

LEAST_DETERMINED = 2.0 / 3.0
"""Mean share of the prior variances of its derivatives that data remove for a result: there the
expected variance from data alone is half that of the prior. In-plane modes in the band of 34 drawn
flights had 0.00 to 0.63; of the other modes one had 0.56 (seven outputs), all others at least
0.78."""

_QUIETEST = 1e-6  # noise over the rms of an output, at least: simulated data have none


def compute_mode_shares(store: Store, run: EstimationRun) -> dict[int, float]:
    """Compute how far the data of a run are expected to determine each mode of its structure.

    Parameters
    ----------
    store
        The campaign.
    run
        Maneuvers, settings, and a model structure with all modes in question.

    Returns
    -------
    dict
        By mode, the mean share of the prior variances of the derivatives of its equation that the
        data remove. They are those that the run reports: columns of modes below
        ``LEAST_DETERMINED`` do not count. Empty where there is no prediction, the noise is not
        known, or the run cannot be prepared.

    Notes
    -----
    The derivatives with respect to the mode's own motion are not counted: a sharp resonance shows
    frequency and damping in any sensor, but not what excites it. The noise is the scatter of the
    outputs about smooth responses to the inputs, gusts included, or that of the sensors.
    """
    try:
        task = prepare(store, run)
    except BadInput:  # raised again when the proposed run is prepared
        return {}
    shares = _compute_derivative_shares(task)
    found: dict[int, float] = {}
    modes = task.structure.modes if shares else ()
    while modes:
        own = list_derivative_names(modes, task.model.inputs, task.model.body)
        found |= {mode: _average(shares, own, mode) for mode in modes}
        least = min(modes, key=lambda mode: found[mode])
        if found[least] >= LEAST_DETERMINED:
            break
        modes = tuple(mode for mode in modes if mode != least)
    return found


def _average(shares: dict[str, float], names: tuple[str, ...], mode: int) -> float:
    own_motion = {f"CQ{mode}_eta{mode}", f"CQ{mode}_etadot{mode}"}
    row = [n for n in names if n.startswith(f"CQ{mode}_") and n not in own_motion]
    return float(np.mean([shares[name] for name in row]))


def _compute_derivative_shares(task: EstimationTask) -> dict[str, float]:
    """Compute the share of the prior variance of every derivative, retained modes included."""
    if task.nuisance is None:
        return {}
    noise = [_estimate_noise(data.measured) for data in task.maneuvers]
    if not any(np.isfinite(std).any() for std in noise):
        return {}
    names = task.model.derivative_names
    priors = task.nuisance.list_priors(names, task.spread)
    parameters = select_parameters(task.nuisance.mean, names, task.model.outputs)
    experiments = [
        output_error(one.model, one.measured.inputs, one.measured.outputs, one.measured.instruments)
        for one in task.maneuvers
    ]
    std = np.array([priors[name][1] for name in names])
    shares = compute_determined_shares(experiments, noise, parameters, std)
    return dict(zip(names, shares.tolist(), strict=True))


def _estimate_noise(measured: MeasuredSpectra) -> Float[np.ndarray, " n_y"]:
    """Estimate the noise of the outputs' spectra; infinite where it is not known."""
    noise = estimate_scatter(measured.inputs.values, measured.outputs.values)
    noise = measured.output_noise if noise is None else noise
    size = np.sqrt(np.mean(np.abs(measured.outputs.values) ** 2, axis=0))
    known = np.isfinite(noise) & (size > 0.0)
    noise = np.maximum(noise, _QUIETEST * size) * np.sqrt(measured.resolution_overlap)
    return np.where(known, noise, np.inf)
