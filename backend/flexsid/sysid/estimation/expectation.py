"""Information before flight: the standard errors that an excitation promises."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.as_flown import AsFlown
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.line_model import LineModel
from flexsid.sysid.estimation.noise import smoothed_density
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import GRAVITY
from flexsid.sysid.signals import TimeHistory
from flexsid.sysid.spectra.fourier import finite_fourier_transform

LOAD_FACTOR = "load factor"
_REFITS = 4  # until weights and what is left of the model error agree
_POINTS = 16  # per shortest period, where peaks are looked for


@dataclass(frozen=True, slots=True)
class ExpectedLines:
    """One input's lines as they would be recorded.

    ``signal`` is each output over the root of what lies beside it there, noise and model
    error; ``sensitivity`` its change with each parameter over the mean level of that over
    all lines, by which the estimator weighs. Both are amplitude ratios. [1]
    """

    omega: Float[np.ndarray, " n_omega"]
    signal: Complex[np.ndarray, "n_omega n_y"]
    sensitivity: Complex[np.ndarray, "n_omega n_y n_theta"]


@dataclass(frozen=True, slots=True)
class Expectation:
    """Information that each input brings at the amplitude it has now.

    ``scatter`` is what the information would be worth if the estimator knew the noise as
    it is: the covariance is I^-1 (scatter) I^-1, which is I^-1 for white noise. ``prior``
    adds to both. ``waves`` are deflections [rad] and load factor [1] over time by input.
    """

    names: tuple[str, ...]
    inputs: tuple[str, ...]
    theta: Float[np.ndarray, " n_theta"]
    information: Float[np.ndarray, "n_u n_theta n_theta"]
    scatter: Float[np.ndarray, "n_u n_theta n_theta"]
    prior: Float[np.ndarray, " n_theta"]
    limited: tuple[str, ...]
    waves: Float[np.ndarray, "n_u n_time n_limited"]
    lines: tuple[ExpectedLines, ...] = ()

    def covariance(
        self, gains: Float[np.ndarray, " n_u"] | None = None
    ) -> Float[np.ndarray, "n_theta n_theta"]:
        """Predicted covariance when inputs are multiplied by gains."""
        inverse, middle = self.parts(self._powers(gains))
        return inverse @ middle @ inverse

    def std_errors(
        self, gains: Float[np.ndarray, " n_u"] | None = None
    ) -> Float[np.ndarray, " n_theta"]:
        """Predicted standard errors when inputs are multiplied by gains."""
        return np.sqrt(np.diag(self.covariance(gains)))

    def peaks(
        self, gains: Float[np.ndarray, " n_u"] | None = None
    ) -> Float[np.ndarray, " n_limited"]:
        """Largest of every limited quantity, all inputs moving together."""
        return np.abs(np.tensordot(np.sqrt(self._powers(gains)), self.waves, axes=1)).max(axis=0)

    def parts(
        self, powers: Float[np.ndarray, " n_u"]
    ) -> tuple[Float[np.ndarray, "n_theta n_theta"], Float[np.ndarray, "n_theta n_theta"]]:
        """Inverse information and scatter when the inputs' powers are multiplied."""
        prior = np.diag(self.prior)
        inverse = _invert(np.tensordot(powers, self.information, axes=1) + prior)
        return inverse, np.tensordot(powers, self.scatter, axes=1) + prior

    def worth(self) -> list[Float[np.ndarray, " n_omega"]]:
        """Of every line, how many parameters' worth of information it brings, by input.

        The trace of its information with the covariance of all: the slope of the
        D-optimal criterion with the line's power. Without priors all lines together
        are worth as many parameters as there are.
        """
        inverse, _ = self.parts(self._powers(None))
        half = np.linalg.cholesky(inverse)
        return [
            2.0 * np.sum(np.abs(one.sensitivity @ half) ** 2, axis=(1, 2)) for one in self.lines
        ]

    def _powers(self, gains: Float[np.ndarray, " n_u"] | None) -> Float[np.ndarray, " n_u"]:
        return np.ones(len(self.inputs)) if gains is None else np.asarray(gains, dtype=float) ** 2


def expect(
    model: AeroelasticModel,
    parameters: Parameters,
    multisine: Multisine,
    flown: AsFlown,
    priors: Mapping[str, float] | None = None,
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
    flown
        How surfaces follow and how outputs scatter.
    priors
        Standard deviations of prior knowledge by parameter.

    Notes
    -----
    One period, recorded whole. Noise of density S has transforms of variance S T_record; the
    estimator weights with its mean over the lines, and the covariance counts what it really
    is, 1/2 N^-1 [Re sum J^H W S W J] N^-1, as for a fit. Inputs own their lines, so that their
    information adds up.
    """
    foreign = set(multisine.inputs) - set(model.inputs)
    if foreign:
        raise BadInput(
            f"the model has no inputs {', '.join(sorted(foreign))}; it has"
            f" {', '.join(model.inputs)}"
        )
    period = multisine.period_s
    n_time = _POINTS * max(int(tones.harmonics.max()) for tones in multisine.tones.values())
    answers, waves = [], []
    for name, tones in multisine.tones.items():
        omega = 2.0 * np.pi * tones.harmonics / period
        command = -0.5j * period * tones.amplitudes * np.exp(1j * tones.phases)
        answer = _answer(model, parameters, flown, omega, {name: command})
        whole = np.zeros((n_time // 2 + 1, answer.limited.shape[1]), dtype=complex)
        whole[tones.harmonics] = answer.limited
        answers.append(answer)
        waves.append(np.fft.irfft(whole, n_time, axis=0) * (n_time / period))
    return _gather(
        parameters,
        multisine.inputs,
        (*model.inputs, LOAD_FACTOR),
        answers,
        np.stack(waves),
        flown,
        period + flown.margin_s,
        priors,
    )


def expect_from_history(
    model: AeroelasticModel,
    parameters: Parameters,
    history: TimeHistory,
    flown: AsFlown,
    band_hz: tuple[float, float],
    priors: Mapping[str, float] | None = None,
) -> Expectation:
    """The same for any input, all surfaces counted as one: doublet, 3-2-1-1, sweep.

    Parameters
    ----------
    history
        Commands named as the model's inputs; the record must hold the response, too. [rad]
    band_hz
        Lines of 1/record from here to there are used. [Hz]

    Raises
    ------
    BadInput
        If the band holds no line of the record.
    """
    n_samples = history.values.shape[0]
    duration = n_samples / history.rate_hz
    harmonics = np.arange(1, (n_samples + 1) // 2)
    omega = 2.0 * np.pi * harmonics / duration
    used = (omega >= 2.0 * np.pi * band_hz[0]) & (omega <= 2.0 * np.pi * band_hz[1])
    if not used.any():
        raise BadInput(
            f"no line of a record of {duration:g} s lies between {band_hz[0]:g} and"
            f" {band_hz[1]:g} Hz",
            code="empty-band",
        )
    omega = omega[used]
    spectra = finite_fourier_transform(history.values, history.rate_hz, omega)
    answer = _answer(
        model, parameters, flown, omega, dict(zip(history.names, spectra.T, strict=True))
    )
    waves = waves_of_history(model, parameters, history, flown)[None]
    limited = (*model.inputs, LOAD_FACTOR)
    return _gather(parameters, ("all",), limited, [answer], waves, flown, duration, priors)


def waves_of_history(
    model: AeroelasticModel, parameters: Parameters, history: TimeHistory, flown: AsFlown
) -> Float[np.ndarray, "n_time n_limited"]:
    """Deflections [rad] and load factor [1] that commands bring about."""
    n_samples = history.values.shape[0]
    harmonics = np.arange(1, (n_samples + 1) // 2)
    omega = 2.0 * np.pi * harmonics * history.rate_hz / n_samples
    spectra = np.fft.rfft(history.values, axis=0)[harmonics]
    inputs = _deflections(model, flown, omega, dict(zip(history.names, spectra.T, strict=True)))
    sensors = np.ones((omega.size, len(model.outputs)), dtype=complex)
    motion = _line_model(model, parameters, omega, inputs, sensors).respond(parameters.start).motion
    whole = np.zeros((n_samples // 2 + 1, len(model.inputs) + 1), dtype=complex)
    whole[harmonics] = _limited(model, omega, inputs, motion)
    return np.fft.irfft(whole, n_samples, axis=0)


@dataclass(frozen=True, slots=True)
class _Answer:
    """Recorded outputs, their sensitivities, and what the model misses, at lines."""

    omega: Float[np.ndarray, " n_omega"]
    outputs: Complex[np.ndarray, "n_omega n_y"]
    limited: Complex[np.ndarray, "n_omega n_limited"]
    jacobian: Complex[np.ndarray, "n_omega n_y n_theta"]
    missed: Complex[np.ndarray, "n_omega n_y"]


def _answer(
    model: AeroelasticModel,
    parameters: Parameters,
    flown: AsFlown,
    omega: Float[np.ndarray, " n_omega"],
    commands: Mapping[str, Complex[np.ndarray, " n_omega"]],
) -> _Answer:
    inputs = _deflections(model, flown, omega, commands)
    missed = np.zeros((omega.size, len(model.outputs)), dtype=complex)
    for name, command in commands.items():
        if name in flown.missed:
            missed += flown.missed[name](omega) * command[:, None]
    lines = _line_model(model, parameters, omega, inputs, flown.instruments(omega))
    response = lines.respond(parameters.start)
    sensitivity = lines.sensitivity(parameters.start, response)
    return _Answer(
        omega,
        response.outputs,
        _limited(model, omega, inputs, response.motion),
        lines.jacobian(sensitivity),
        missed,
    )


def _deflections(
    model: AeroelasticModel,
    flown: AsFlown,
    omega: Float[np.ndarray, " n_omega"],
    commands: Mapping[str, Complex[np.ndarray, " n_omega"]],
) -> Complex[np.ndarray, "n_omega n_u"]:
    inputs = np.zeros((omega.size, len(model.inputs)), dtype=complex)
    for name, command in commands.items():
        inputs += flown.follow[name](omega) * command[:, None]
    return inputs


def _line_model(
    model: AeroelasticModel,
    parameters: Parameters,
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    instruments: Complex[np.ndarray, "n_omega n_y"],
) -> LineModel:
    nothing = np.zeros(instruments.shape, dtype=complex)
    group = np.zeros(omega.size, dtype=int)
    experiment = Experiment("design", model, instruments, omega, inputs, nothing, group, ("",))
    return LineModel(experiment, parameters)


def _limited(
    model: AeroelasticModel,
    omega: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    motion: Complex[np.ndarray, "n_omega n_r"],
) -> Complex[np.ndarray, "n_omega n_limited"]:
    """Deflections, and the load factor at the centre of gravity: V (q - alpha-dot) / g."""
    load = model.condition.airspeed / GRAVITY * (motion[:, 1] - 1j * omega * motion[:, 0])
    return np.column_stack([inputs, load])


def _gather(
    parameters: Parameters,
    inputs: tuple[str, ...],
    limited: tuple[str, ...],
    answers: Sequence[_Answer],
    waves: Float[np.ndarray, "n_u n_time n_limited"],
    flown: AsFlown,
    record_s: float,
    priors: Mapping[str, float] | None,
) -> Expectation:
    known = dict(priors or {})
    prior = np.array([known[n] ** -2.0 if n in known else 0.0 for n in parameters.names])
    omega = np.concatenate([answer.omega for answer in answers])
    J = np.concatenate([answer.jacobian for answer in answers])
    noise = record_s * flown.noise(omega)
    left, level = _refitted(
        J,
        np.concatenate([answer.missed for answer in answers]),
        np.real(np.diagonal(noise, axis1=1, axis2=2)).mean(axis=0),
        prior,
    )
    size = np.sqrt(level)
    J = J / size[:, None]
    density = noise / np.outer(size, size) + _smoothed(omega, left / size)
    beside = size * np.sqrt(np.real(np.diagonal(density, axis1=1, axis2=2)))
    ends = np.cumsum([answer.omega.size for answer in answers])[:-1]
    parts = [np.split(each, ends) for each in (J, density, beside)]
    return Expectation(
        names=parameters.names,
        inputs=inputs,
        theta=parameters.start,
        information=np.stack([_products(own, own) for own in parts[0]]),
        scatter=np.stack(
            [_products(own, S @ own) for own, S in zip(parts[0], parts[1], strict=True)]
        ),
        prior=prior,
        limited=limited,
        waves=waves,
        lines=tuple(
            ExpectedLines(answer.omega, answer.outputs / level, own)
            for answer, own, level in zip(answers, parts[0], parts[2], strict=True)
        ),
    )


def _refitted(
    J: Complex[np.ndarray, "n_omega n_y n_theta"],
    missed: Complex[np.ndarray, "n_omega n_y"],
    noise: Float[np.ndarray, " n_y"],
    prior: Float[np.ndarray, " n_theta"],
) -> tuple[Complex[np.ndarray, "n_omega n_y"], Float[np.ndarray, " n_y"]]:
    """Model error that a fit to these lines would leave, and mean level of all that is left.

    The parameters give way until the error is least in the weights that follow from it.
    """
    left, level = missed, noise + np.mean(np.abs(missed) ** 2, axis=0)
    if not missed.any():
        return left, level
    for _ in range(_REFITS):
        weighted = J / level[:, None]
        normal = 0.5 * _products(weighted, J) + np.diag(0.5 * prior)
        pull = np.real(np.einsum("kyp,ky->p", weighted.conj(), missed))
        scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
        step = np.linalg.lstsq(normal / np.outer(scale, scale), pull / scale, rcond=1e-12)[0]
        left = missed - J @ (step / scale)
        level = noise + np.mean(np.abs(left) ** 2, axis=0)
    return left, level


def _smoothed(
    omega: Float[np.ndarray, " n_omega"], values: Complex[np.ndarray, "n_omega n_y"]
) -> Complex[np.ndarray, "n_omega n_y n_y"]:
    """Density of values over neighbouring lines, at every line in the order given."""
    order = np.argsort(omega, kind="stable")
    smooth = smoothed_density(values[order], np.zeros(omega.size, dtype=int), 1)
    density = np.empty((omega.size, *smooth.blocks.shape[1:]), dtype=complex)
    density[order] = smooth.of_lines()
    return density


def _products(
    a: Complex[np.ndarray, "n_omega n_y n_theta"], b: Complex[np.ndarray, "n_omega n_y n_theta"]
) -> Float[np.ndarray, "n_theta n_theta"]:
    """2 Re sum a^H b."""
    n = a.shape[-1]
    left, right = a.reshape(-1, n), b.reshape(-1, n)
    return 2.0 * (np.real(left).T @ np.real(right) + np.imag(left).T @ np.imag(right))


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
