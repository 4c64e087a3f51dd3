"""Validation: folds of frequencies, prediction of held-out data, correlation of residuals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Complex, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.estimate import FittedSpectra
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.leakage import remove_leakage
from flexsid.sysid.estimation.noise import SMOOTHED_FREQUENCIES

# --- Validation: folds of frequencies, prediction of measured outputs, correlation of residuals

BOUND = 1.96
"""Standard deviations of a bound: uncorrelated residuals exceed it at 5 % of the lags."""
_LAGS = 40
"""Lags on either side: more of them repeat, since an input has every n-th harmonic only."""
_NEIGHBOURS = 12
"""Frequencies on either side whose mean is the power of a residual."""


def assign_folds(assigned_input: np.ndarray, n_folds: int) -> np.ndarray:
    """Assign frequencies to folds in turn, separately for each input.

    Parameters
    ----------
    assigned_input
        Index of the input that each frequency is assigned to, in order of frequency; -1 for
        none. (n_omega,)
    n_folds
        Number of folds, at least two.

    Returns
    -------
    np.ndarray
        Fold of each frequency; every fold has frequencies of every input, over the whole band.

    Raises
    ------
    BadInput
        If an input has fewer frequencies than there are folds.
    """
    if n_folds < 2:
        raise BadInput(f"{n_folds} folds; expected at least two", code="bad-folds")
    folds = np.empty(assigned_input.size, dtype=int)
    for number, index in enumerate(np.unique(assigned_input).tolist()):
        own = np.flatnonzero(assigned_input == index)
        if own.size < n_folds:
            raise BadInput(
                f"an input has {own.size} frequencies, fewer than {n_folds} folds; choose at most "
                f"{own.size} folds or a wider band",
                code="bad-folds",
            )
        # Inputs begin with different folds, so that the folds have equal sizes.
        folds[own] = (np.arange(own.size) + number) % n_folds
    return folds


def predict_outputs(
    experiment: Experiment,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    held_out: Bool[np.ndarray, " n_omega"] | None = None,
) -> FittedSpectra:
    """Predict the measured outputs of a maneuver from its measured inputs.

    Notes
    -----
    The parameters are not fitted. The free response to the states at the ends of the record,
    which no model can predict, is estimated from the residuals, of ``held_out`` frequencies not,
    and removed: a wrong model with lightly damped poles would fit them by it.

    Raises
    ------
    NotIdentifiable
        If the response of the model is not finite.
    """
    predicted = FrequencyDomainModel(experiment, parameters).respond(theta).outputs
    if not np.isfinite(predicted).all():
        raise NotIdentifiable(
            f"the model has no finite response at the frequencies of {experiment.name}"
        )
    return FittedSpectra(
        name=experiment.name,
        outputs=experiment.model.outputs,
        omega=experiment.omega,
        measured=remove_leakage(experiment, parameters, theta, held_out).measured,
        fitted=predicted,
        correlation=experiment.noise_correlation(),
    )


@dataclass(frozen=True, slots=True)
class ResidualCorrelation:
    """Correlation function of residuals, and the bound of uncorrelated ones. [1]

    ``lags_s`` are positive where the residual is later than what it is correlated with.
    """

    lags_s: Float[np.ndarray, " n_lags"]
    values: Float[np.ndarray, " n_lags"]
    bound: Float[np.ndarray, " n_lags"]

    @property
    def share_outside(self) -> float:
        """Share of the lags outside the bound; 0.05 is expected of uncorrelated residuals."""
        return float(np.mean(np.abs(self.values) > self.bound))


def select_lags(omega: Float[np.ndarray, " n_omega"]) -> Float[np.ndarray, " n_lags"]:
    """Select the lags that the band resolves, from the shortest to its negative. [s]"""
    return np.arange(-_LAGS, _LAGS + 1) * np.pi / float(omega.max())


def autocorrelate_residual(
    omega: Float[np.ndarray, " n_omega"],
    residual: Complex[np.ndarray, " n_omega"],
    correlation: Complex[np.ndarray, "n_omega n_omega"] | None = None,
) -> ResidualCorrelation:
    """Correlate a residual with itself at another time, relative to white noise of its band.

    Parameters
    ----------
    omega
        Frequencies. [rad/s]
    residual
        Of one output.
    correlation
        Between the frequencies, for white noise of the record; None if they are independent.

    Notes
    -----
    r(tau) = sum_k |E_k|^2 d_k / sum_k |E_k|^2, with d_k = cos(w_k tau) less its mean over the
    frequencies: white noise of the band has the correlation function mean(cos(w_k tau)). Where
    E is white, |E_k|^2 is exponential with the covariance S^2 |C_kl|^2, and r has the variance
    sum_kl d_k |C_kl|^2 d_l / M^2.
    """
    lags = select_lags(omega)
    lags = lags[lags > 0.0]
    cosines = np.cos(lags[:, None] * omega)
    d = cosines - cosines.mean(axis=1, keepdims=True)
    power = np.abs(residual) ** 2
    spread = d if correlation is None else d @ np.abs(correlation) ** 2
    std = np.sqrt(np.maximum(np.sum(spread * d, axis=1), 0.0)) / omega.size
    total = float(power.sum())
    values = d @ power / total if total > 0.0 else np.zeros(lags.size)
    return ResidualCorrelation(lags, values, BOUND * std)


def cross_correlate_residual(
    omega: Float[np.ndarray, " n_omega"],
    residual: Complex[np.ndarray, " n_omega"],
    other: Complex[np.ndarray, " n_omega"],
    correlation: Complex[np.ndarray, "n_omega n_omega"] | None = None,
) -> ResidualCorrelation:
    """Correlate a residual with the spectrum of an input, or with another residual.

    Parameters
    ----------
    omega, residual, correlation
        As for ``autocorrelate_residual``.
    other
        Spectrum that it is correlated with.

    Notes
    -----
    r(tau) = Re sum_k conj(B_k) E_k exp(j w_k tau) / sqrt(sum |B_k|^2 sum |E_k|^2). Where E is
    circular with the covariance G_kl = s_k C_kl s_l and independent of B, r has the variance
    a^H G a / (2 sum |B|^2 sum |E|^2), a_k = B_k exp(-j w_k tau). E need not be white: s_k^2 is
    the mean of |E|^2 over neighbouring frequencies.
    """
    lags = select_lags(omega)
    power = float(np.sum(np.abs(residual) ** 2)) * float(np.sum(np.abs(other) ** 2))
    if power == 0.0:
        return ResidualCorrelation(lags, np.zeros(lags.size), np.zeros(lags.size))
    order = np.argsort(omega, kind="stable")
    s = np.empty(omega.size)
    s[order] = np.sqrt(_smooth(np.abs(residual[order]) ** 2))
    turned = np.exp(1j * lags[:, None] * omega)
    values = np.real(turned @ (other.conj() * residual)) / np.sqrt(power)
    a = turned.conj() * (other * s)
    spread = a if correlation is None else a @ correlation.T
    variance = np.real(np.sum(a.conj() * spread, axis=1)) / (2.0 * power)
    return ResidualCorrelation(lags, values, BOUND * np.sqrt(np.maximum(variance, 0.0)))


def _smooth(power: Float[np.ndarray, " n_omega"]) -> Float[np.ndarray, " n_omega"]:
    """Compute the mean over neighbouring frequencies."""
    window = np.ones(min(2 * _NEIGHBOURS + 1, power.size))
    counts = np.convolve(np.ones(power.size), window, mode="same")
    return np.convolve(power, window, mode="same") / counts


# --- Likelihood of frequencies that two models were not fitted to, and which of them it prefers

LEAST_DIFFERENCE = 10.0
"""Of log likelihoods: e^10 to one. Shapes of different meshes differ by less near flutter."""

LEAST_SIGMAS = 3.0
"""Of the difference, in its own standard errors: by chance once in 740 comparisons."""


@dataclass(frozen=True, slots=True)
class LikelihoodDifference:
    """Log likelihood of held-out frequencies by one model less that by another.

    ``std_error`` is from the scatter between frequencies, ``per_frequency`` the log likelihoods of
    both models divided by the number of frequencies, without constants.
    """

    value: float
    std_error: float
    n_frequencies: int
    per_frequency: tuple[float, float]

    @property
    def is_decided(self) -> bool:
        """Whether the difference is beyond chance and ``LEAST_DIFFERENCE``."""
        return abs(self.value) > max(LEAST_DIFFERENCE, LEAST_SIGMAS * self.std_error)


def compute_held_out_likelihoods(
    omega: Float[np.ndarray, " n_omega"],
    residuals: Complex[np.ndarray, "n_omega n_y"],
    held_out: Bool[np.ndarray, " n_omega"],
) -> Float[np.ndarray, " n_held_out"]:
    """Compute the log likelihood of each held-out frequency, without constants.

    Parameters
    ----------
    omega
        Frequencies. [rad/s]
    residuals
        Of a model that was fitted to the other frequencies, at all of them.
    held_out
        Frequencies that it was not fitted to.

    Notes
    -----
    -sum_o (|nu_o|^2 / S_o + ln S_o), where S_o is the mean of |nu_o|^2 over the
    ``SMOOTHED_FREQUENCIES`` fitted frequencies that are nearest: complex normal residuals,
    independent between outputs. In turbulence and near flutter their spectrum is far from white.
    """
    power = np.abs(residuals) ** 2
    fitted = np.flatnonzero(~held_out)
    distance = np.abs(omega[held_out, None] - omega[fitted])
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :SMOOTHED_FREQUENCIES]
    S = np.maximum(power[fitted[nearest]].mean(axis=1), np.finfo(float).tiny)
    return -np.sum(power[held_out] / S + np.log(S), axis=1)


def compare_likelihoods(
    first: Float[np.ndarray, " n"], second: Float[np.ndarray, " n"]
) -> LikelihoodDifference:
    """Compare the log likelihoods of the same held-out frequencies by two models.

    Notes
    -----
    Differences at the frequencies are independent: their sum has the standard error sqrt(n) s, with
    their sample standard deviation s.
    """
    difference = first - second
    n = difference.size
    std = float(np.sqrt(n) * difference.std(ddof=1)) if n > 1 else float("inf")
    per_frequency = (float(first.mean()), float(second.mean()))
    return LikelihoodDifference(float(difference.sum()), std, n, per_frequency)
