"""Equation error of several maneuvers: reconstructed motion, and one regression for each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex

from flexsid.errors import NotIdentifiable
from flexsid.sysid.estimation.agreement import fuse_estimates
from flexsid.sysid.estimation.end_states import number_ends
from flexsid.sysid.estimation.estimate import Estimate, Outcome
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.estimation.leakage import add_errors, fit_free_motion
from flexsid.sysid.estimation.likelihood import FitSettings
from flexsid.sysid.estimation.maneuver_data import ManeuverData, build_output_error
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.marginal_equation_error import marginal_equation_error
from flexsid.sysid.regression.reconstruction import ReconstructedMotion, reconstruct_motion


@dataclass(frozen=True, slots=True)
class EquationErrorFit:
    """Estimate by equation error, with the motion of every maneuver.

    ``out_of_band`` are the modes that were reconstructed in addition in any maneuver.
    """

    estimate: Estimate
    motions: tuple[ReconstructedMotion, ...]
    out_of_band: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class RetainedPrior:
    """Normal prior of the derivatives of retained modes, by name: mean and standard deviation.

    ``n_modes`` is the number of modes of the model structure, before the retained ones.
    """

    by_name: Mapping[str, tuple[float, float]]
    n_modes: int


def fit_whole_maneuvers(
    maneuvers: Sequence[ManeuverData], parameters: Parameters, prior: RetainedPrior | None
) -> EquationErrorFit:
    """Estimate all maneuvers by equation error as if they began and ended at rest.

    Parameters
    ----------
    maneuvers
        Maneuvers that share the derivatives.
    parameters
        The derivatives, fixed ones with their values.
    prior
        Of the retained modes, if there are any: they are marginalised.

    Notes
    -----
    Every maneuver has its share of the prior, so that the fused estimate has all of it.
    """
    labels = [data.label for data in maneuvers]
    if prior is None:
        pairs = [reconstruct_with_out_of_band_modes(data) for data in maneuvers]
        motions = tuple(motion for motion, _ in pairs)
        estimates = [
            equation_error(
                data.model,
                motion,
                data.measured.inputs,
                parameters,
                input_noise=data.measured.input_noise,
                commands=data.assign_commands(),
            )
            for data, motion in zip(maneuvers, motions, strict=True)
        ]
        added = dict.fromkeys(mode for _, modes in pairs for mode in modes)
        return EquationErrorFit(fuse_estimates(estimates, labels), motions, tuple(added))
    widened = np.sqrt(len(maneuvers))
    shares = {name: (mean, std * widened) for name, (mean, std) in prior.by_name.items()}
    found = [
        marginal_equation_error(
            data.model,
            data.measured.outputs,
            data.measured.instruments,
            data.measured.inputs,
            parameters,
            shares,
            prior.n_modes,
            data.measured.output_noise,
            data.measured.input_noise,
        )
        for data in maneuvers
    ]
    fused = fuse_estimates([estimate for estimate, _ in found], labels)
    fused = replace(fused, nuisance=frozenset(prior.by_name))
    return EquationErrorFit(fused, tuple(motion for _, motion in found), ())


def fit_free_maneuvers(
    maneuvers: Sequence[ManeuverData],
    started: Parameters,
    prior: RetainedPrior | None,
    settings: FitSettings,
) -> EquationErrorFit:
    """Estimate maneuvers by equation error without their free motion from the ends of records.

    Parameters
    ----------
    maneuvers
        Maneuvers of which nothing is assumed at the ends of some.
    started
        The derivatives, with starting values by equation error.
    prior
        Of the retained modes.
    settings
        Of the output error that estimates the states at the ends.

    Notes
    -----
    The free motion is subtracted before the regression; its errors are included.
    """
    free = [data.measured.free_ends for data in maneuvers]
    experiments = number_ends([build_output_error(data, data.label) for data in maneuvers])
    motion = fit_free_motion([one for one in experiments if one.free_ends], started, settings)

    def fit_without(
        outputs: Iterable[Complex[np.ndarray, "n_omega n_y"]], parameters: Parameters = started
    ) -> EquationErrorFit:
        each = iter(outputs)
        rest = [
            data.subtract_outputs(next(each)) if is_free else data
            for data, is_free in zip(maneuvers, free, strict=True)
        ]
        return fit_whole_maneuvers(rest, parameters, prior)

    found = fit_without(motion.outputs)
    estimate = found.estimate
    if not motion.converged:
        message = "The states at the ends of the record have not converged."
        estimate = replace(estimate, outcome=Outcome.ITERATION_LIMIT, message=message)
    near = replace(started, start=estimate.values)
    changes = [
        fit_without(map(np.add, motion.outputs, error), near).estimate.values - estimate.values
        for error in zip(*motion.errors, strict=True)
    ]
    changes = np.array(changes).reshape(-1, estimate.values.size)
    records = np.flatnonzero(free).tolist()
    return replace(found, estimate=add_errors(estimate, changes, motion.noise, records))


def reconstruct_with_out_of_band_modes(
    data: ManeuverData,
) -> tuple[ReconstructedMotion, tuple[int, ...]]:
    """Reconstruct the model's modes with as many out-of-band modes as the sensors resolve.

    Returns
    -------
    motion, modes
        Motion of rigid body and the model's modes; numbers of the modes reconstructed in addition.

    Notes
    -----
    An out-of-band mode reduces redundancy: where the noise of a sensor is then not
    identifiable from the others, its noise would be attributed to motion.
    """
    own = len(data.model.modes.numbers)
    for count in range(len(data.extended_model.modes.numbers), own, -1):
        model = data.extended_model.with_modes(count)
        try:
            motion = _reconstruct(model, data)
        except NotIdentifiable:
            continue
        if not motion.assumed:
            return motion.select_motions(model.n_rigid + own), model.modes.numbers[own:]
    return _reconstruct(data.model, data), ()


def _reconstruct(model: AeroelasticModel, data: ManeuverData) -> ReconstructedMotion:
    spectra = data.measured
    return reconstruct_motion(
        model,
        spectra.outputs,
        spectra.instruments,
        guess=spectra.output_noise,
        inputs=spectra.inputs,
    )
