"""Maximum-likelihood fit of modes to the spectral matrix of outputs in one band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float, Int
from scipy.linalg import cho_factor, cho_solve

from flexsid.sysid.modes.modal_model import MOST_DAMPED

_BIN = 0.25  # of the distance to the nearest pole: width of averaged frequencies
_STEPS = 40
_SAME_LIKELIHOOD = 1e-3  # change of the log likelihood at convergence
_HALVINGS = 12
_LARGEST_STEP = 0.5  # of the decay rate of a pole, in one step
_RIDGE = 1e-8  # of the scaled information
_FLOOR = 0.03  # of the background, added to all periodograms
_END_LINES = 3  # of each output, at least, in the bins at the ends
_QUIET = 0.3  # of the bins, of least power: start of the background


@dataclass(frozen=True, slots=True, eq=False)
class OutputBand:
    """Periodograms of a band, averaged over neighbouring frequencies.

    ``lines`` [rad per sample] are the frequencies, ``begins`` the first of each bin, ``count``
    their number, ``power`` the mean of Y Y^H, ``n_samples`` the length of the record.
    ``background`` is the mean of the quiet bins, of which ``power`` has a small part more: no
    spectral matrix is singular.
    """

    lines: Float[np.ndarray, " n_line"]
    begins: Int[np.ndarray, " n_bin"]
    count: Float[np.ndarray, " n_bin"]
    power: Complex[np.ndarray, "n_bin n_out n_out"]
    background: Complex[np.ndarray, "n_out n_out"]
    n_samples: int

    def average(self, values: np.ndarray) -> np.ndarray:
        """Mean of each bin of values at all frequencies."""
        count = self.count.reshape(-1, *(1 for _ in values.shape[1:]))
        return np.add.reduceat(values, self.begins) / count

    def compute_forms(
        self, poles: Complex[np.ndarray, " n"]
    ) -> tuple[Complex[np.ndarray, "n_bin n"], Complex[np.ndarray, "n_bin n"]]:
        """Expected periodograms of poles, averaged as the measured ones, and their slopes."""
        value, slope = compute_expected_shape(self.lines, poles, self.n_samples)
        return self.average(value), self.average(slope)


@dataclass(frozen=True, slots=True, eq=False)
class SpectrumModel:
    """Poles per sample, shapes, weights, and background.

    S(theta) = sum_k (shape_k weight_k^H d_k(theta) + its conjugate transpose) + B_0 + x B_1 where x
    runs from -1 to 1 over the band. A weight is the covariance of the outputs with its mode.
    """

    poles: Complex[np.ndarray, " n"]
    shapes: Complex[np.ndarray, "n n_out"]
    weights: Complex[np.ndarray, "n n_out"]
    background: Complex[np.ndarray, "two n_out n_out"]


@dataclass(frozen=True, slots=True, eq=False)
class SpectrumFit:
    """Fitted model, its negative log likelihood, and covariance of the poles.

    ``covariance`` (2 n, 2 n) is that of the real parts, then of the imaginary parts.
    """

    model: SpectrumModel
    cost: float
    covariance: Float[np.ndarray, "two_n two_n"]


def average_band(
    theta: Float[np.ndarray, " n_line"],
    transform: Complex[np.ndarray, "n_line n_out"],
    n_samples: int,
    poles: Complex[np.ndarray, " n"],
) -> OutputBand:
    """Average periodograms over frequencies that are close compared with the distance to poles."""
    step = 2.0 * np.pi / n_samples
    if poles.size:
        apart = np.min(np.abs(1j * theta[:, None] - poles), axis=1)
    else:
        apart = np.full(theta.size, (theta[-1] - theta[0]) / 8.0)
    # Position in units of bins; a frequency begins a bin where its integer part rises.
    place = np.cumsum(1.0 / np.maximum(_BIN * apart / step, 1.0))
    place = np.minimum.accumulate((place - place[0])[::-1])[::-1].astype(int)
    begins = np.flatnonzero(np.diff(place, prepend=-1))
    least = _END_LINES * transform.shape[1]
    begins = begins[(begins == 0) | ((begins >= least) & (begins <= theta.size - least))]
    count = np.diff(begins, append=theta.size).astype(float)
    power = transform[:, :, None] * transform[:, None].conj()
    mean = np.add.reduceat(power, begins) / count[:, None, None]
    quiet = _estimate_background(mean, count)
    return OutputBand(theta, begins, count, mean + _FLOOR * quiet, quiet, n_samples)


def _estimate_background(power: np.ndarray, count: np.ndarray) -> np.ndarray:
    """Mean of the bins of least power, made regular."""
    n_out = power.shape[1]
    trace = np.real(np.trace(power, axis1=1, axis2=2))
    quiet = trace <= np.quantile(trace, _QUIET)
    noise = np.average(power[quiet], axis=0, weights=count[quiet])
    return noise + 0.1 * np.eye(n_out) * np.real(np.trace(noise)) / n_out


def compute_expected_shape(
    theta: Float[np.ndarray, " n_bin"], poles: Complex[np.ndarray, " n"], n_samples: int
) -> tuple[Complex[np.ndarray, "n_bin n"], Complex[np.ndarray, "n_bin n"]]:
    """Expected periodogram of the covariance exp(pole lag), lag > 0, and its slope over the pole.

    Notes
    -----
    Sum over lags l of (1 - l / N) exp(l (pole - j theta)), the first one by half: leakage of the
    finite record included (Sykulski, Olhede, Guillaumin, Lilly and Early 2019, the debiased Whittle
    likelihood, doi:10.1093/biomet/asy071).
    """
    N = n_samples
    z = np.exp(poles - 1j * theta[:, None])
    last = np.exp(N * (poles - 1j * theta[:, None]))
    rest = 1.0 - z
    value = 1.0 / rest - 0.5 - z * (1.0 - last) / (N * rest**2)
    slope = z / rest**2 - z * ((1.0 - last) * (1.0 + z) / rest - N * last) / (N * rest**2)
    return value, slope


def start_model(
    band: OutputBand, poles: Complex[np.ndarray, " n"], shapes: Complex[np.ndarray, "n n_out"]
) -> SpectrumModel:
    """Start values: the quiet part of the band as background, and of each mode its peak."""
    noise = band.background
    inverse = np.linalg.inv(noise)
    weights = np.zeros_like(shapes)
    d, _ = band.compute_forms(poles)
    for k in range(poles.size):
        side = inverse @ shapes[k] / np.real(shapes[k].conj() @ inverse @ shapes[k])
        size = np.real(np.einsum("a,bac,c->b", side.conj(), band.power, side))
        form = 2.0 * np.real(d[:, k])
        inside = form > 0.5 * form.max()
        weights[k] = shapes[k] * np.sum(size[inside]) / np.sum(form[inside])
    return SpectrumModel(poles, shapes, weights, np.stack([noise, np.zeros_like(noise)]))


def fit_spectrum(band: OutputBand, start: SpectrumModel) -> SpectrumFit:
    """Fit modes to the periodograms of a band by maximum likelihood.

    Parameters
    ----------
    band
        Averaged periodograms.
    start
        Start values, of a positive definite spectral matrix.

    Returns
    -------
    SpectrumFit
        Model, cost and covariance of the poles.

    Notes
    -----
    Whittle likelihood: sum over frequencies of ln det S + tr(S^-1 I) with the periodogram I,
    maximised by Fisher scoring over poles, shapes, weights and the background, which is Hermitian
    and linear over frequency. Weights of their own leave free how the modal forces are correlated
    with each other and with what excites the modes outside of the band. Source of the likelihood
    of a modal model: Au (2012), doi:10.1016/j.ymssp.2011.06.017; the covariance is the inverse of
    the information: doi:10.1016/j.ymssp.2011.06.019.
    """
    model = start
    spectrum = compute_spectrum(band, model)
    cost = compute_cost(band, spectrum)
    information = np.zeros((0, 0))
    for _ in range(_STEPS):
        information, score = _compute_information(band, model, spectrum)
        step = _solve(information, score)
        change = step[: 2 * model.poles.size].reshape(-1, 2)
        size = np.hypot(*change.T) / (_LARGEST_STEP * -np.real(model.poles))
        length = 1.0 / max(1.0, float(size.max(initial=0.0)))
        for _ in range(_HALVINGS):
            trial = _move(model, length * step)
            found = compute_spectrum(band, trial)
            new = compute_cost(band, found) if np.all(np.real(trial.poles) < 0) else np.inf
            if new < cost:
                break
            length *= 0.4
        else:
            break
        gain, cost, model, spectrum = cost - new, new, trial, found
        if gain < _SAME_LIKELIHOOD:
            break
    information, _ = _compute_information(band, model, spectrum)
    n = model.poles.size
    inverse = _solve(information, np.eye(information.shape[0])[:, : 2 * n])[: 2 * n]
    order = np.concatenate([np.arange(0, 2 * n, 2), np.arange(1, 2 * n, 2)])
    return SpectrumFit(model, cost, inverse[np.ix_(order, order)])


def compute_spectrum(
    band: OutputBand, model: SpectrumModel
) -> Complex[np.ndarray, "n_bin n_out n_out"]:
    """Expected periodograms of a model at the frequencies of a band."""
    d, _ = band.compute_forms(model.poles)
    modal = np.einsum("bk,ka,kc->bac", d, model.shapes, model.weights.conj())
    x = _scale_frequency(band)[:, None, None]
    return modal + np.swapaxes(modal, 1, 2).conj() + model.background[0] + x * model.background[1]


def compute_strengths(model: SpectrumModel) -> Float[np.ndarray, " n"]:
    """Power of each mode at its peak relative to the background."""
    inverse = np.linalg.inv(model.background[0])
    power = np.abs(np.einsum("ka,ac,kc->k", model.weights.conj(), inverse, model.shapes))
    return power / -np.real(model.poles)


def propose_mode(
    band: OutputBand, model: SpectrumModel, dampings: tuple[float, ...]
) -> SpectrumModel:
    """Model with one more mode, where the periodograms exceed the model most significantly."""
    inverse = np.linalg.inv(compute_spectrum(band, model))
    score = inverse @ band.power @ inverse - inverse
    half = np.linalg.cholesky(np.linalg.inv(inverse))  # of S at the frequency of the trial
    theta = band.average(band.lines)
    best: tuple[float, complex, np.ndarray] = (-np.inf, 0j, np.zeros(0))
    for damping in dampings:
        trial = theta * (-damping + 1j)
        d, _ = band.compute_forms(trial)
        form = 2.0 * np.real(d) * band.count[:, None]
        gradient = np.einsum("bk,bac->kac", form, score)
        value, vector = np.linalg.eigh(np.swapaxes(half, 1, 2).conj() @ gradient @ half)
        size = value[:, -1] / np.sqrt(np.sum(form**2 / band.count[:, None], axis=0))
        place = int(np.argmax(size))
        if size[place] > best[0]:
            best = (float(size[place]), complex(trial[place]), half[place] @ vector[place, :, -1])
    _, pole, shape = best
    at = int(np.argmin(np.abs(theta - pole.imag)))
    d, _ = band.compute_forms(np.array([pole]))
    side = inverse[at] @ shape
    excess = np.real(side.conj() @ band.power[at] @ side - side.conj() @ shape)
    power = max(excess, 0.1) / np.real(side.conj() @ shape) ** 2 / (2.0 * float(np.real(d[at, 0])))
    return SpectrumModel(
        np.append(model.poles, pole),
        np.concatenate([model.shapes, shape[None]]),
        np.concatenate([model.weights, power * shape[None]]),
        model.background,
    )


def remove_mode(band: OutputBand, model: SpectrumModel, k: int) -> SpectrumModel:
    """Start values without one mode."""
    rest = np.arange(model.poles.size) != k
    return start_model(band, model.poles[rest], model.shapes[rest])


def is_structural(poles: Complex[np.ndarray, " n"]) -> np.ndarray:
    """Whether poles are damped no more than structural modes."""
    return -np.real(poles) <= MOST_DAMPED * np.abs(poles)


def _scale_frequency(band: OutputBand) -> np.ndarray:
    low, high = band.lines[0], band.lines[-1]
    return band.average((2.0 * band.lines - low - high) / (high - low))


def compute_cost(band: OutputBand, spectrum: np.ndarray) -> float:
    """Negative log likelihood, infinite where a spectral matrix is not positive definite."""
    try:
        half = np.linalg.cholesky(spectrum)
    except np.linalg.LinAlgError:
        return np.inf
    determinant = 2.0 * np.sum(np.log(np.real(np.diagonal(half, axis1=1, axis2=2))), axis=1)
    trace = np.real(np.trace(np.linalg.solve(spectrum, band.power), axis1=1, axis2=2))
    return float(np.sum(band.count * (determinant + trace)))


def _compute_information(
    band: OutputBand, model: SpectrumModel, spectrum: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Fisher information and score of poles, shapes, weights (pairs of real numbers), background.

    Slopes of S, whitened by its factor on both sides, are Hermitian; each is one row of real
    numbers whose inner product is the trace of the product.
    """
    n, n_out = model.shapes.shape
    white = np.linalg.inv(np.linalg.cholesky(spectrum))  # (n_bin, n_out, n_out)
    d, slope = band.compute_forms(model.poles)
    shapes = np.einsum("bac,kc->bka", white, model.shapes)
    weights = np.einsum("bac,kc->bka", white, model.weights).conj()
    columns = np.swapaxes(white, 1, 2)  # (n_bin, unknown component, n_out)
    # Complex slopes R of R + R^H; those of the imaginary parts are +-j R.
    to_poles = np.einsum("bk,bka,bkc->bkac", slope, shapes, weights)
    to_shapes = np.einsum("bk,bua,bkc->bkuac", d, columns, weights)
    to_weights = np.einsum("bk,bka,buc->bkuac", d, shapes, columns.conj())
    size = (band.count.size, -1, n_out, n_out)
    parts = np.concatenate([one.reshape(size) for one in (to_poles, to_shapes, to_weights)], axis=1)
    sign = np.ones(parts.shape[1])
    sign[n + n * n_out :] = -1.0  # weights enter conjugated
    modal = np.stack([parts, 1j * sign[:, None, None] * parts], axis=2).reshape(size)
    modal = modal + np.swapaxes(modal, 2, 3).conj()
    flat = white[:, None] @ _build_hermitian_basis(n_out) @ np.swapaxes(white, 1, 2).conj()[:, None]
    background = np.concatenate([flat, _scale_frequency(band)[:, None, None, None] * flat], axis=1)
    rows = _flatten(np.concatenate([modal, background], axis=1))  # (n_bin, p, n_out^2)
    rest = white @ band.power @ np.swapaxes(white, 1, 2).conj() - np.eye(n_out)
    p = rows.shape[1]
    design = np.moveaxis(rows, 1, 2).reshape(-1, p)
    weighted = np.moveaxis(rows * band.count[:, None, None], 1, 2).reshape(-1, p)
    return weighted.T @ design, weighted.T @ _flatten(rest[:, None])[:, 0].reshape(-1)


def _build_hermitian_basis(n: int) -> np.ndarray:
    found = []
    for a in range(n):
        for c in range(a, n):
            one = np.zeros((n, n), dtype=complex)
            one[a, c] = one[c, a] = 1.0
            found.append(one)
            if c > a:
                other = np.zeros((n, n), dtype=complex)
                other[a, c], other[c, a] = 1j, -1j
                found.append(other)
    return np.array(found).reshape(-1, n, n)


def _flatten(hermitian: np.ndarray) -> np.ndarray:
    """Real rows of Hermitian matrices, whose inner product is the trace of the product."""
    n = hermitian.shape[-1]
    above = np.triu_indices(n, 1)
    off = np.sqrt(2.0) * hermitian[..., above[0], above[1]]
    diagonal = np.real(np.diagonal(hermitian, axis1=-2, axis2=-1))
    return np.concatenate([diagonal, np.real(off), np.imag(off)], axis=-1)


def _solve(information: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solution; a ridge fixes the free complex scale factor of shape and weight of each mode."""
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(information), 1e-300))
    scaled = scale[:, None] * information * scale
    scaled[np.diag_indices_from(scaled)] += _RIDGE
    return (cho_solve(cho_factor(scaled), (right.T * scale).T).T * scale).T


def _move(model: SpectrumModel, step: np.ndarray) -> SpectrumModel:
    n, n_out = model.shapes.shape
    n_modal = n * (1 + 2 * n_out)
    change = step[: 2 * n_modal : 2] + 1j * step[1 : 2 * n_modal : 2]
    shapes, weights = change[n:].reshape(2, n, n_out)
    rest = step[2 * n_modal :].reshape(2, -1)
    return SpectrumModel(
        model.poles + change[:n],
        model.shapes + shapes,
        model.weights + weights,
        model.background + np.einsum("ip,pac->iac", rest, _build_hermitian_basis(n_out)),
    )
