"""Information before flight: the standard errors that a design promises."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy import optimize

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.line_model import LineModel
from flexsid.sysid.estimation.noise import LineMatrix
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import TimeHistory
from flexsid.sysid.spectra.fourier import finite_fourier_transform

_SHARPNESS = (10.0, 60.0, 300.0)  # of the smooth maximum over relative variances, in turn


@dataclass(frozen=True, slots=True)
class Expectation:
    """Information that each input brings at the amplitude it has now.

    ``powers`` is the mean square of every output by input. [output unit squared]
    """

    names: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    theta: Float[np.ndarray, " n_theta"]
    information: Float[np.ndarray, "n_u n_theta n_theta"]
    powers: Float[np.ndarray, "n_u n_y"]

    def std_errors(
        self, gains: Float[np.ndarray, " n_u"] | None = None
    ) -> Float[np.ndarray, " n_theta"]:
        """Predicted standard errors when inputs are multiplied by gains."""
        x = np.ones(len(self.inputs)) if gains is None else np.asarray(gains) ** 2
        return np.sqrt(np.diag(_invert(np.tensordot(x, self.information, axes=1))))


def expect(
    model: AeroelasticModel,
    parameters: Parameters,
    multisine: Multisine,
    noise_std: Float[np.ndarray, " n_y"],
    rate_hz: float,
) -> Expectation:
    """Fisher information of output error at the lines of a design.

    Parameters
    ----------
    model
        At the flight condition that is meant.
    parameters
        Free quantities; their start is taken as true.
    multisine
        Its inputs must be inputs of the model.
    noise_std
        White noise of every output at ``rate_hz``. [output unit]
    rate_hz
        Rate of the record. [Hz]

    Notes
    -----
    One period in steady state, surfaces measured without noise. A white sequence
    of standard deviation sigma has transforms of variance sigma^2 T / f_s; the
    covariance is 1/2 [Re sum J^H S^-1 J]^-1, as everywhere here. Inputs own
    their lines, so that their information adds up.
    """
    foreign = set(multisine.inputs) - set(model.inputs)
    if foreign:
        raise BadInput(
            f"the model has no inputs {', '.join(sorted(foreign))}; it has"
            f" {', '.join(model.inputs)}"
        )
    weight = rate_hz / (multisine.period_s * np.asarray(noise_std) ** 2)
    parts, powers = [], []
    for name, tones in multisine.tones.items():
        omega = 2.0 * np.pi * tones.harmonics / multisine.period_s
        inputs = np.zeros((omega.size, len(model.inputs)), dtype=complex)
        inputs[:, model.inputs.index(name)] = (
            -0.5j * multisine.period_s * tones.amplitudes * np.exp(1j * tones.phases)
        )
        part, outputs = _information(model, parameters, omega, inputs, weight)
        parts.append(part)
        powers.append(2.0 * np.sum(np.abs(outputs) ** 2, axis=0) / multisine.period_s**2)
    return Expectation(
        names=parameters.names,
        inputs=multisine.inputs,
        outputs=model.outputs,
        theta=parameters.start,
        information=np.stack(parts),
        powers=np.stack(powers),
    )


def expect_from_history(
    model: AeroelasticModel,
    parameters: Parameters,
    history: TimeHistory,
    noise_std: Float[np.ndarray, " n_y"],
    band_hz: tuple[float, float],
) -> Float[np.ndarray, " n_theta"]:
    """Predicted standard errors of any input: doublet, 3-2-1-1, sweep.

    Parameters
    ----------
    history
        Deflections named as the model's inputs; its record must hold the response, too.
    band_hz
        Lines of 1/record from here to there are used. [Hz]
    """
    duration = history.values.shape[0] / history.rate_hz
    lines = np.arange(np.ceil(band_hz[0] * duration), np.floor(band_hz[1] * duration) + 1.0)
    omega = 2.0 * np.pi * lines / duration
    spectra = finite_fourier_transform(history.values, history.rate_hz, omega)
    inputs = np.zeros((omega.size, len(model.inputs)), dtype=complex)
    for column, name in enumerate(history.names):
        inputs[:, model.inputs.index(name)] = spectra[:, column]
    weight = history.rate_hz / (duration * np.asarray(noise_std) ** 2)
    information, _ = _information(model, parameters, omega, inputs, weight)
    return np.sqrt(np.diag(_invert(information)))


def allocate_minimax(
    expectation: Expectation,
    largest_gain: Float[np.ndarray, " n_u"],
    power_limit: Float[np.ndarray, " n_y"],
) -> Float[np.ndarray, " n_u"]:
    """Gains of the inputs that make the worst relative standard error smallest.

    Parameters
    ----------
    expectation
        At the flat amplitudes.
    largest_gain
        What the deflection limit leaves to every input. [1]
    power_limit
        Largest mean square of every output, infinite where there is none.

    Notes
    -----
    In squared gains the information is linear, so variances are convex and limits
    are linear: there is one optimum.
    """
    reference = expectation.theta**2
    if np.any(reference == 0.0):
        raise BadInput("a derivative that is zero has no relative standard error; leave it out")
    limited = np.isfinite(power_limit)
    top = np.asarray(largest_gain, dtype=float) ** 2

    def worst(
        x: Float[np.ndarray, " n_u"], sharpness: float
    ) -> tuple[float, Float[np.ndarray, " n_u"]]:
        C = _invert(np.tensordot(x, expectation.information, axes=1))
        logs = np.log(np.diag(C) / reference)
        weights = np.exp(sharpness * (logs - logs.max()))
        value = logs.max() + np.log(weights.sum()) / sharpness
        shares = weights / weights.sum() / np.diag(C)
        slopes = [-shares @ np.sum((C @ part) * C, axis=1) for part in expectation.information]
        return float(value), np.array(slopes)

    used = expectation.powers[:, limited]
    start = np.minimum(1.0, top)
    if limited.any():
        start = start * min(1.0, float(np.min(power_limit[limited] / (start @ used))))
    limits = optimize.LinearConstraint(used.T / power_limit[limited][:, None], -np.inf, 1.0)
    for sharpness in _SHARPNESS:
        start = optimize.minimize(
            worst,
            start,
            args=(sharpness,),
            jac=True,
            method="SLSQP",
            bounds=[(1e-4 * value, value) for value in top],
            constraints=[limits] if limited.any() else [],
        ).x
    return np.sqrt(start)


def _information(
    model: AeroelasticModel,
    parameters: Parameters,
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    weight: Float[np.ndarray, " n_y"],
) -> tuple[Float[np.ndarray, "n_theta n_theta"], Complex[np.ndarray, "n_omega n_y"]]:
    blank = np.zeros((omega.size, len(model.outputs)), dtype=complex)
    lines = LineModel(
        Experiment(
            "design", model, blank + 1.0, omega, inputs, blank, np.zeros(omega.size, int), ("",)
        ),
        parameters,
    )
    response = lines.respond(parameters.start)
    sensitivity = lines.sensitivity(parameters.start, response)
    weights = LineMatrix(np.asarray(weight, dtype=float)[None], lines.experiment.group)
    normal, _ = NormalForm(lines).equations(sensitivity, blank, weights)
    return 2.0 * normal, response.outputs


def _invert(information: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled = information / np.outer(scale, scale)
    condition = float(np.linalg.cond(scaled))
    if not condition < 1e13:
        raise NotIdentifiable(
            f"the design's information has condition number {condition:.1e}: some derivatives are"
            " not told apart; excite more inputs or free fewer derivatives"
        )
    return np.linalg.inv(scaled) / np.outer(scale, scale)
