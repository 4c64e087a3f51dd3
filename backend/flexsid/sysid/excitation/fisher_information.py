"""Fisher information and Cramer-Rao bounds of a planned excitation, and the share of the priors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float
from scipy import linalg

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.flight_noise import FlightNoiseModel
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.noise import SpectralMatrix, smooth_density
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import GRAVITY
from flexsid.sysid.signals import FrequencyData, TimeHistory
from flexsid.sysid.spectra.fourier import finite_fourier_transform

# --- Fisher information and Cramer-Rao bounds of a planned excitation -----------------------------

LOAD_FACTOR = "load factor"
_REFITS = 4  # iterations of the weights and the remaining model error
_POINTS = 16  # samples per shortest period, for the peaks: at most 2 % below the true ones
_LARGEST_CONDITION = 1e13  # of the scaled information: relative error of its inverse about 1e-3


@dataclass(frozen=True, slots=True)
class PredictedSpectra:
    """Predicted spectra at the harmonics of one input.

    ``signal`` is each output over the standard deviation of noise and model error there;
    ``sensitivity`` is the Jacobian of the outputs in units of that noise: L^-1 J for its spectral
    matrix L L^H. Both are amplitude ratios. [1]
    """

    omega: Float[np.ndarray, " n_omega"]
    signal: Complex[np.ndarray, "n_omega n_y"]
    sensitivity: Complex[np.ndarray, "n_omega n_y n_theta"]


@dataclass(frozen=True, slots=True)
class FisherInformation:
    """Fisher information of each input at its present amplitude.

    ``prior`` adds to it. ``nuisance`` parameters are estimated along, but not asked for.
    ``waves`` are deflections [rad] and load factor [1] over time; in the lateral axis that of
    the side force.
    """

    names: tuple[str, ...]
    inputs: tuple[str, ...]
    theta: Float[np.ndarray, " n_theta"]
    information: Float[np.ndarray, "n_u n_theta n_theta"]
    prior: Float[np.ndarray, " n_theta"]
    limited: tuple[str, ...]
    waves: Float[np.ndarray, "n_u n_time n_limited"]
    lines: tuple[PredictedSpectra, ...] = ()
    nuisance: frozenset[str] = frozenset()

    @property
    def reported(self) -> Bool[np.ndarray, " n_theta"]:
        """Parameters that are not nuisance parameters."""
        return np.array([name not in self.nuisance for name in self.names])

    def covariance(
        self, gains: Float[np.ndarray, " n_u"] | None = None
    ) -> Float[np.ndarray, "n_theta n_theta"]:
        """Predicted covariance of the parameters for inputs multiplied by gains."""
        return self.invert(self._powers(gains))

    def std_errors(
        self, gains: Float[np.ndarray, " n_u"] | None = None
    ) -> Float[np.ndarray, " n_theta"]:
        """Predicted standard errors for inputs multiplied by gains."""
        return np.sqrt(np.diag(self.covariance(gains)))

    def peaks(
        self, gains: Float[np.ndarray, " n_u"] | None = None
    ) -> Float[np.ndarray, " n_limited"]:
        """Peak of every limited quantity with all inputs active."""
        return np.abs(np.tensordot(np.sqrt(self._powers(gains)), self.waves, axes=1)).max(axis=0)

    def invert(self, powers: Float[np.ndarray, " n_u"]) -> Float[np.ndarray, "n_theta n_theta"]:
        """Invert the information for input powers multiplied by ``powers``."""
        return _invert(np.tensordot(powers, self.information, axes=1) + np.diag(self.prior))

    def information_by_frequency(self) -> list[Float[np.ndarray, " n_omega"]]:
        """Information of every harmonic, as a number of parameters, by input.

        Notes
        -----
        The derivative of log det C_rr, of the reported parameters, with respect to the log power
        of harmonic k: tr(C_rr^-1 [C I_k C]_rr) for C = I^-1. Without priors and nuisance
        parameters the sum over all harmonics is the number of parameters.
        """
        inverse = self.invert(self._powers(None))
        reported = self.reported
        half = np.linalg.cholesky(inverse[np.ix_(reported, reported)])
        through = linalg.solve_triangular(half, inverse[reported], lower=True).T
        return [
            2.0 * np.sum(np.abs(one.sensitivity @ through) ** 2, axis=(1, 2)) for one in self.lines
        ]

    def _powers(self, gains: Float[np.ndarray, " n_u"] | None) -> Float[np.ndarray, " n_u"]:
        return np.ones(len(self.inputs)) if gains is None else np.asarray(gains, dtype=float) ** 2


def predict_cramer_rao_bounds(
    model: AeroelasticModel,
    parameters: Parameters,
    multisine: Multisine,
    flight_noise: FlightNoiseModel,
    priors: Mapping[str, float] | None = None,
    nuisance: frozenset[str] = frozenset(),
) -> FisherInformation:
    """Compute the Fisher information of output error for a multisine.

    Parameters
    ----------
    model
        At the planned flight condition.
    parameters
        Free parameters; their starting values are taken as true.
    multisine
        Its inputs must be inputs of the model.
    flight_noise
        Command-to-surface responses and spectra of the output noise.
    priors
        Standard deviations of prior knowledge by parameter.
    nuisance
        Free parameters that are not asked for.

    Notes
    -----
    One period is recorded. The transform of noise of density S has the covariance S T_record, with
    whose inverse at every harmonic the estimator weights: the information is 2 Re sum J^H (S
    T_record)^-1 J. Model error that remains after the fit counts as noise. Every harmonic is
    assigned to one input, so that the information of the inputs adds up.
    Source: Pintelon and Schoukens, System Identification, 2nd ed., 2012, ch. 9.
    """
    foreign = set(multisine.inputs) - set(model.inputs)
    if foreign:
        raise BadInput(
            f"the model has no inputs {', '.join(sorted(foreign))}; it has"
            f" {', '.join(model.inputs)}"
        )
    period = multisine.period_s
    n_time = _POINTS * max(int(tones.harmonics.max()) for tones in multisine.tones.values())
    spectra, waves = [], []
    for name, tones in multisine.tones.items():
        omega = 2.0 * np.pi * tones.harmonics / period
        command = -0.5j * period * tones.amplitudes * np.exp(1j * tones.phases)
        spectrum = _predict_spectra(model, parameters, flight_noise, omega, {name: command})
        whole = np.zeros((n_time // 2 + 1, spectrum.limited.shape[1]), dtype=complex)
        whole[tones.harmonics] = spectrum.limited
        spectra.append(spectrum)
        waves.append(np.fft.irfft(whole, n_time, axis=0) * (n_time / period))
    return _gather(
        parameters,
        multisine.inputs,
        (*model.inputs, LOAD_FACTOR),
        spectra,
        np.stack(waves),
        flight_noise,
        period + flight_noise.margin_s,
        priors,
        nuisance,
    )


def predict_cramer_rao_bounds_from_history(
    model: AeroelasticModel,
    parameters: Parameters,
    history: TimeHistory,
    flight_noise: FlightNoiseModel,
    band_hz: tuple[float, float],
    priors: Mapping[str, float] | None = None,
    nuisance: frozenset[str] = frozenset(),
) -> FisherInformation:
    """Compute the Fisher information of any input history, all surfaces as one input.

    Parameters
    ----------
    history
        Commands named as the model's inputs, such as doublets, 3-2-1-1s or sweeps; the record
        must include the response. [rad]
    band_hz
        Lowest and highest frequency; the spacing is one over the record length. [Hz]

    Raises
    ------
    BadInput
        If no frequency of the record lies in the band.
    """
    n_samples = history.values.shape[0]
    duration = n_samples / history.rate_hz
    harmonics = np.arange(1, (n_samples + 1) // 2)
    omega = 2.0 * np.pi * harmonics / duration
    used = (omega >= 2.0 * np.pi * band_hz[0]) & (omega <= 2.0 * np.pi * band_hz[1])
    if not used.any():
        raise BadInput(
            f"a record of {duration:g} s has no frequency between {band_hz[0]:g} and"
            f" {band_hz[1]:g} Hz; widen the band or lengthen the record",
            code="empty-band",
        )
    omega = omega[used]
    spectra = finite_fourier_transform(history.values, history.rate_hz, omega)
    spectrum = _predict_spectra(
        model, parameters, flight_noise, omega, dict(zip(history.names, spectra.T, strict=True))
    )
    waves = compute_waves(model, parameters, history, flight_noise)[None]
    limited = (*model.inputs, LOAD_FACTOR)
    return _gather(
        *(parameters, ("all",), limited, [spectrum], waves),
        *(flight_noise, duration, priors, nuisance),
    )


def compute_flown_bounds(
    model: AeroelasticModel,
    parameters: Parameters,
    inputs: FrequencyData,
    flight_noise: FlightNoiseModel,
    record_s: float,
    priors: Mapping[str, float] | None = None,
) -> Float[np.ndarray, " n_theta"]:
    """Compute the Cramer-Rao bounds of a record from its measured surfaces.

    Parameters
    ----------
    model, parameters, flight_noise, priors
        As in :func:`predict_cramer_rao_bounds`.
    inputs
        Spectra of the deflections. [rad s]
    record_s
        Length of the record.

    Returns
    -------
    ndarray, (n_theta,)
        Standard errors, before ``flight_noise.variance_ratio``.

    Raises
    ------
    NotIdentifiable
        If the record has no information on some parameters, or an output has no noise.
    """
    omega = inputs.omega
    line_model = _build_line_model(
        model, parameters, omega, inputs.values, flight_noise.instruments(omega)
    )
    response = line_model.respond(parameters.start)
    J = line_model.jacobian(line_model.sensitivity(parameters.start, response))
    J = _whiten(J, record_s * flight_noise.noise(omega))
    information = _products(J) + np.diag(_precision(parameters, priors))
    return np.sqrt(np.diag(_invert(information)))


def compute_waves(
    model: AeroelasticModel,
    parameters: Parameters,
    history: TimeHistory,
    flight_noise: FlightNoiseModel,
) -> Float[np.ndarray, "n_time n_limited"]:
    """Compute deflections [rad] and load factor [1] over time for a command history."""
    n_samples = history.values.shape[0]
    harmonics = np.arange(1, (n_samples + 1) // 2)
    omega = 2.0 * np.pi * harmonics * history.rate_hz / n_samples
    spectra = np.fft.rfft(history.values, axis=0)[harmonics]
    inputs = _compute_deflections(
        model, flight_noise, omega, dict(zip(history.names, spectra.T, strict=True))
    )
    sensors = np.ones((omega.size, len(model.outputs)), dtype=complex)
    motion = (
        _build_line_model(model, parameters, omega, inputs, sensors)
        .respond(parameters.start)
        .motion
    )
    whole = np.zeros((n_samples // 2 + 1, len(model.inputs) + 1), dtype=complex)
    whole[harmonics] = _stack_limited(model, omega, inputs, motion)
    return np.fft.irfft(whole, n_samples, axis=0)


@dataclass(frozen=True, slots=True)
class _PredictedSpectrum:
    """Recorded outputs, limited quantities, Jacobian and unmodelled response by harmonic."""

    omega: Float[np.ndarray, " n_omega"]
    outputs: Complex[np.ndarray, "n_omega n_y"]
    limited: Complex[np.ndarray, "n_omega n_limited"]
    jacobian: Complex[np.ndarray, "n_omega n_y n_theta"]
    unmodelled: Complex[np.ndarray, "n_omega n_y"]


def _predict_spectra(
    model: AeroelasticModel,
    parameters: Parameters,
    flight_noise: FlightNoiseModel,
    omega: Float[np.ndarray, " n_omega"],
    commands: Mapping[str, Complex[np.ndarray, " n_omega"]],
) -> _PredictedSpectrum:
    inputs = _compute_deflections(model, flight_noise, omega, commands)
    unmodelled = np.zeros((omega.size, len(model.outputs)), dtype=complex)
    for name, command in commands.items():
        if name in flight_noise.unmodelled_responses:
            unmodelled += flight_noise.unmodelled_responses[name](omega) * command[:, None]
    line_model = _build_line_model(
        model, parameters, omega, inputs, flight_noise.instruments(omega)
    )
    response = line_model.respond(parameters.start)
    sensitivity = line_model.sensitivity(parameters.start, response)
    return _PredictedSpectrum(
        omega,
        response.outputs,
        _stack_limited(model, omega, inputs, response.motion),
        line_model.jacobian(sensitivity),
        unmodelled,
    )


def _compute_deflections(
    model: AeroelasticModel,
    flight_noise: FlightNoiseModel,
    omega: Float[np.ndarray, " n_omega"],
    commands: Mapping[str, Complex[np.ndarray, " n_omega"]],
) -> Complex[np.ndarray, "n_omega n_u"]:
    inputs = np.zeros((omega.size, len(model.inputs)), dtype=complex)
    for name, command in commands.items():
        inputs += flight_noise.command_responses[name](omega) * command[:, None]
    return inputs


def _build_line_model(
    model: AeroelasticModel,
    parameters: Parameters,
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    instruments: Complex[np.ndarray, "n_omega n_y"],
) -> FrequencyDomainModel:
    nothing = np.zeros(instruments.shape, dtype=complex)
    group = np.zeros(omega.size, dtype=int)
    experiment = Experiment("design", model, instruments, omega, inputs, nothing, group, ("",))
    return FrequencyDomainModel(experiment, parameters)


def _stack_limited(
    model: AeroelasticModel,
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    motion: Complex[np.ndarray, "n_omega n_r"],
) -> Complex[np.ndarray, "n_omega n_limited"]:
    """Stack deflections and the load factor at the centre of gravity.

    Notes
    -----
    V (q - alpha-dot) / g; of lateral-directional motion the side force over the weight,
    V (beta-dot + r cos alpha0 - p sin alpha0) / g - phi cos theta0.
    """
    load = motion[:, 1] - 1j * omega * motion[:, 0]
    if model.body.acts_by_gravity:
        load = np.einsum("kr,kr->k", model.known_dynamics(omega)[:, 0], motion)
    load = model.condition.airspeed / GRAVITY * load
    return np.column_stack([inputs, load])


def _gather(
    parameters: Parameters,
    inputs: tuple[str, ...],
    limited: tuple[str, ...],
    spectra: Sequence[_PredictedSpectrum],
    waves: Float[np.ndarray, "n_u n_time n_limited"],
    flight_noise: FlightNoiseModel,
    record_s: float,
    priors: Mapping[str, float] | None,
    nuisance: frozenset[str],
) -> FisherInformation:
    prior = _precision(parameters, priors)
    omega = np.concatenate([spectrum.omega for spectrum in spectra])
    J = np.concatenate([spectrum.jacobian for spectrum in spectra])
    noise = record_s * flight_noise.variance_ratio * flight_noise.noise(omega)
    remaining, level = _refit(
        J,
        np.concatenate([spectrum.unmodelled for spectrum in spectra]),
        np.real(np.diagonal(noise, axis1=1, axis2=2)).mean(axis=0),
        prior,
    )
    size = np.sqrt(level)
    density = noise / np.outer(size, size) + _smooth_by_frequency(omega, remaining / size)
    J = _whiten(J / size[:, None], density)
    deviation = size * np.sqrt(np.real(np.diagonal(density, axis1=1, axis2=2)))
    ends = np.cumsum([spectrum.omega.size for spectrum in spectra])[:-1]
    parts = [np.split(each, ends) for each in (J, deviation)]
    return FisherInformation(
        names=parameters.names,
        inputs=inputs,
        theta=parameters.start,
        information=np.stack([_products(own) for own in parts[0]]),
        prior=prior,
        limited=limited,
        waves=waves,
        lines=tuple(
            PredictedSpectra(spectrum.omega, spectrum.outputs / level, own)
            for spectrum, own, level in zip(spectra, *parts, strict=True)
        ),
        nuisance=nuisance,
    )


def _whiten(
    J: Complex[np.ndarray, "n_omega n_y n_theta"], noise: Complex[np.ndarray, "n_omega n_y n_y"]
) -> Complex[np.ndarray, "n_omega n_y n_theta"]:
    """Return L^-1 J for noise L L^H."""
    try:
        return np.linalg.solve(np.linalg.cholesky(noise), J)
    except np.linalg.LinAlgError:
        raise NotIdentifiable(
            "the residuals of an output of the run are zero: without noise there is no standard"
            " error to predict; select a run of a recorded flight"
        ) from None


def _precision(parameters: Parameters, priors: Mapping[str, float] | None) -> np.ndarray:
    known = dict(priors or {})
    return np.array([known[n] ** -2.0 if n in known else 0.0 for n in parameters.names])


def _refit(
    J: Complex[np.ndarray, "n_omega n_y n_theta"],
    unmodelled: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"],
    prior: Float[np.ndarray, " n_theta"],
) -> tuple[Complex[np.ndarray, "n_omega n_y"], Float[np.ndarray, " n_y"]]:
    """Compute the model error that remains after a fit, and the mean residual power.

    The parameters minimise the weighted error; the weights follow from the remaining error.
    """
    remaining, level = unmodelled, noise + np.mean(np.abs(unmodelled) ** 2, axis=0)
    if not unmodelled.any():
        return remaining, level
    for _ in range(_REFITS):
        weighted = J / level[:, None]
        normal = 0.5 * _products(J / np.sqrt(level)[:, None]) + np.diag(0.5 * prior)
        gradient = np.real(np.einsum("kyp,ky->p", weighted.conj(), unmodelled))
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        step = np.linalg.lstsq(normal / np.outer(scale, scale), gradient / scale, rcond=1e-12)[0]
        remaining = unmodelled - J @ (step / scale)
        level = noise + np.mean(np.abs(remaining) ** 2, axis=0)
    return remaining, level


def _smooth_by_frequency(
    omega: Float[np.ndarray, " n_omega"], values: Complex[np.ndarray, "n_omega n_y"]
) -> Complex[np.ndarray, "n_omega n_y n_y"]:
    """Smooth the spectral density of values over neighbouring frequencies; order as given."""
    order = np.argsort(omega, kind="stable")
    smooth = smooth_density(values[order], np.zeros(omega.size, dtype=int), 1)
    density = np.empty((omega.size, *smooth.blocks.shape[1:]), dtype=complex)
    density[order] = smooth.expand_blocks()
    return density


def _products(J: Complex[np.ndarray, "n_omega n_y n_theta"]) -> Float[np.ndarray, "n_p n_p"]:
    """2 Re sum J^H J."""
    rows = J.reshape(-1, J.shape[-1])
    return 2.0 * (np.real(rows).T @ np.real(rows) + np.imag(rows).T @ np.imag(rows))


def _invert(information: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    scaled = information / np.outer(scale, scale)
    condition = float(np.linalg.cond(scaled))
    if not condition < _LARGEST_CONDITION:
        raise NotIdentifiable(
            f"the Fisher information of the design has condition number {condition:.1e}, above"
            f" {_LARGEST_CONDITION:.0e}: some derivatives are not identifiable; excite more inputs"
            " or free fewer derivatives"
        )
    return np.linalg.inv(scaled) / np.outer(scale, scale)


# --- Share of their prior variances that data would remove from parameters, before any fit --------


def compute_determined_shares(
    experiments: Sequence[Experiment],
    noise_std: Sequence[Float[np.ndarray, " n_y"]],
    parameters: Parameters,
    prior_std: Float[np.ndarray, " n_theta"],
) -> Float[np.ndarray, " n_theta"]:
    """Compute the share of the prior variance of every parameter that data are expected to remove.

    Parameters
    ----------
    experiments
        Output error of each maneuver, with the inputs as they were flown.
    noise_std
        Standard deviations of the outputs' spectra at each maneuver; infinite for outputs that
        are not used. [output unit * s]
    parameters
        Their starting values are those of the prediction.
    prior_std
        Standard deviations of the prior of all parameters.

    Returns
    -------
    ndarray, (n_theta,)
        One where the data determine a parameter, zero where only its prior does.

    Notes
    -----
    With the information 2 N of the data at the prediction and the prior variances D^2 the share is
    1 - diag[(I + D 2 N D)^-1]: a half where the expected standard error from data alone equals that
    of the prior. Their sum is the number of parameters that the data determine.
    Source: MacKay, Bayesian interpolation, Neural Computation 4 (1992), eq. 4.9.
    """
    information = np.zeros((prior_std.size,) * 2)
    for experiment, std in zip(experiments, noise_std, strict=True):
        model = FrequencyDomainModel(experiment, parameters)
        sensitivity = model.sensitivity(parameters.start, model.respond(parameters.start))
        weights = SpectralMatrix(1.0 / std[None] ** 2, np.zeros(experiment.omega.size, dtype=int))
        information += 2.0 * NormalForm(model).matrix(sensitivity, weights)
    whole = np.eye(prior_std.size) + information * np.outer(prior_std, prior_std)
    factor = linalg.cho_factor(whole)
    return 1.0 - np.diag(linalg.cho_solve(factor, np.eye(prior_std.size)))
