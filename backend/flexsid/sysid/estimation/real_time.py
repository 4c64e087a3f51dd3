"""Equation error in real time: a recursive transform and a regression.

The transform of every channel at fixed frequencies is updated with each sample; the
derivatives follow at any time from a regression over these frequencies.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.equation_error import equation_error
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.estimation.reconstruction import reconstruct_motion
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.signals import FrequencyData

_RENORMALIZE = 10_000  # samples between exact evaluations of the rotation


class RecursiveTransform:
    """Finite Fourier transform that grows by one sample at a time.

    Parameters
    ----------
    omega
        Frequencies. [rad/s]
    rate_hz
        Samples per second. [Hz]
    n_channels
        Channels per sample.
    memory_s
        Time constant of exponential forgetting; None weights all samples equally. [s]
    start_s
        Time of the first sample. [s]

    Notes
    -----
    X_i = lambda X_{i-1} + x_i exp(-j omega t_i) with lambda = exp(-dt/memory). The rotation
    is one complex product per frequency; it is evaluated exactly every ``_RENORMALIZE``
    samples, so that rounding does not accumulate.
    """

    def __init__(
        self,
        omega: Float[np.ndarray, " n_omega"],
        rate_hz: float,
        n_channels: int,
        memory_s: float | None = None,
        start_s: float = 0.0,
    ) -> None:
        self.omega = np.asarray(omega, dtype=float)
        self.step_s = 1.0 / rate_hz
        self.start_s = start_s
        self.count = 0
        self._rotation = np.exp(-1j * self.omega * self.step_s)
        self._phase = np.exp(-1j * self.omega * start_s)
        self._decay = 1.0 if memory_s is None else float(np.exp(-self.step_s / memory_s))
        self._sum = np.zeros((self.omega.size, n_channels), dtype=complex)

    def update(self, sample: Float[np.ndarray, " n_channels"]) -> None:
        """Add one sample of every channel, trim value removed."""
        if self._decay != 1.0:
            self._sum *= self._decay
        self._sum += self._phase[:, None] * sample
        self.count += 1
        self._phase *= self._rotation
        if self.count % _RENORMALIZE == 0:
            time = self.start_s + self.count * self.step_s
            self._phase = np.exp(-1j * self.omega * time)

    @property
    def values(self) -> Complex[np.ndarray, "n_omega n_channels"]:
        """The transform so far. [channel unit * s]"""
        return self._sum * self.step_s


class RealTimeEquationError:
    """Derivatives from a stream of samples of inputs and outputs.

    Parameters
    ----------
    model, parameters
        As for equation error.
    omega
        Frequencies. [rad/s]
    rate_hz
        Of the stream. [Hz]
    input_response, output_response
        Recorded over true, (n_omega, n_u) and (n_omega, n_y): instruments.
    noise
        Spectral noise level of every output, fixed beforehand so that an update
        costs two small solves. [output unit * s]
    memory_s
        Time constant of exponential forgetting; None weights all samples equally. [s]
    """

    def __init__(
        self,
        model: AeroelasticModel,
        parameters: Parameters,
        omega: Float[np.ndarray, " n_omega"],
        rate_hz: float,
        input_response: Complex[np.ndarray, "n_omega n_u"],
        output_response: Complex[np.ndarray, "n_omega n_y"],
        noise: Float[np.ndarray, " n_y"],
        memory_s: float | None = None,
    ) -> None:
        self.model = model
        self.parameters = parameters
        self.input_response = input_response
        self.output_response = output_response
        self.noise = noise
        self._n_u = len(model.inputs)
        self.transform = RecursiveTransform(
            omega, rate_hz, self._n_u + len(model.outputs), memory_s
        )

    def update(self, inputs: Float[np.ndarray, " n_u"], outputs: Float[np.ndarray, " n_y"]) -> None:
        """Add one sample of all channels, trim value removed."""
        self.transform.update(np.concatenate([inputs, outputs]))

    def estimate(self) -> Estimate:
        """Estimate derivatives and their standard errors from all samples so far."""
        omega, values = self.transform.omega, self.transform.values
        u = FrequencyData(omega, values[:, : self._n_u] / self.input_response, self.model.inputs)
        z = FrequencyData(omega, values[:, self._n_u :], self.model.outputs)
        motion = reconstruct_motion(self.model, z, self.output_response, self.noise)
        return equation_error(self.model, motion, u, self.parameters, compensate=False)
