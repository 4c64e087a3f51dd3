"""Maximum-likelihood fit of a modal model to frequency responses, with its covariance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.special import chdtri

POWERS = {"displacement": 0, "velocity": 1, "acceleration": 2}
MOST_DAMPED = 0.3  # damping ratio: larger ones are not structural modes
_LARGEST_STEP = 0.5  # of the decay rate of a pole, in one step
_LEAST_NOISE = 1e-3  # of the rms of a response
_LEAST_PROFILE = 1e-3  # of the mean noise variance over frequency
_SMOOTHED = 15  # frequencies at least on each side of a smoothed noise variance
_LEAST_KNOWN = 0.5  # relative: largest standard deviation of a damping ratio
_FALSE_MODES = 1e-4  # probability that noise alone is found to be a mode
_SCANNED_DAMPING = (0.003, 0.01, 0.03)
_REFUSED_BAND = 0.02  # relative, about a frequency where no mode could be fitted
_MOST_SCANNED = 500  # frequencies
_MOST_ROUNDS = 25
_VAIN_ROUNDS = 2  # at most, in which no mode is added
_SCANNED_OUTSIDE = 1.5  # modes are sought up to this ratio beyond the band
_ADDED = 4  # modes at most in one round
_APART = 0.1  # least relative distance in frequency of modes added in one round
_CLOSE = 6.0  # decay rates: poles nearer to each other are a close pair
_RANK = 1e-10  # of the largest singular value: smaller ones of the information are rounding
_OUTSIDE = range(-4, 5)
"""Powers of s of the modes outside of the band.

With -4, -2, 0 and 2 only, two modes 20 and 30 % above the band shifted a frequency by four standard
deviations (2e-5). The odd ones are their damping."""

_BLOCK = 64  # outputs factored at once


@dataclass(frozen=True, slots=True)
class _Effort:
    """Fits, each with the noise variances of the one before, steps of each and its end."""

    fits: int
    steps: int
    same_cost: float  # relative change of the cost of a converged fit


_SEARCH = _Effort(2, 6, 1e-4)
_FINAL = _Effort(3, 12, 1e-6)


@dataclass(frozen=True, slots=True, eq=False)
class ModalModel:
    """Poles, participation factors and shapes fitted to frequency responses.

    ``poles`` (n,) [rad/s], ``participation`` (n, n_references) with a largest component of one,
    ``shapes`` (n, n_outputs), the sum of their products over s - pole and of the conjugates are
    displacements per force. ``covariance`` (2 n, 2 n) is that of the real parts, then of the
    imaginary parts of the poles [rad2/s2]. ``fitted`` has the shape and unit of the responses.
    """

    poles: Complex[np.ndarray, " n"]
    participation: Complex[np.ndarray, "n n_in"]
    shapes: Complex[np.ndarray, "n n_out"]
    covariance: Float[np.ndarray, "two_n two_n"]
    fitted: Complex[np.ndarray, "n_omega n_out n_in"]

    def compute_std(self) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
        """Standard deviations of natural frequencies [rad/s] and damping ratios [1]."""
        return propagate_covariance(self.poles, self.covariance)


def propagate_covariance(
    poles: Complex[np.ndarray, " n"], covariance: Float[np.ndarray, "two_n two_n"]
) -> tuple[Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """Standard deviations of natural frequencies [rad/s] and damping ratios [1] of poles.

    Notes
    -----
    First-order propagation through omega = |pole| and zeta = -Re(pole) / |pole|.
    """
    n = poles.size
    size, real, imaginary = np.abs(poles), np.real(poles), np.imag(poles)
    blocks = np.array(
        [
            [np.diagonal(covariance[i * n : (i + 1) * n, j * n : (j + 1) * n]) for j in (0, 1)]
            for i in (0, 1)
        ]
    )
    to_omega = np.stack([real, imaginary]) / size
    to_zeta = np.stack([-(imaginary**2), real * imaginary]) / size**3
    return (
        np.sqrt(np.einsum("in,ijn,jn->n", to_omega, blocks, to_omega)),
        np.sqrt(np.einsum("in,ijn,jn->n", to_zeta, blocks, to_zeta)),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _ModalProblem:
    s: np.ndarray
    lift: np.ndarray
    responses: np.ndarray
    line_correlation: float
    profile: np.ndarray  # (n_omega,) known noise variance over frequency, of mean one


@dataclass(frozen=True, slots=True, eq=False)
class _Weights:
    """Noise variance as product of one of each response and one of each frequency."""

    response: np.ndarray  # (n_out, n_in) standard deviation
    frequency: np.ndarray  # (n_omega,) factor


@dataclass(frozen=True, slots=True, eq=False)
class _Reduced:
    """Basis functions and data in the space that the basis spans; terms of residual modes out."""

    first: np.ndarray  # (rows, n, 2)
    second: np.ndarray  # (rows, n, 2)
    data: np.ndarray  # (rows, n_out, n_in), in standard deviations
    outside: float  # squared norm of the data outside of the space


def fit_modal_model(
    omega: Float[np.ndarray, " n_omega"],
    responses: Complex[np.ndarray, "n_omega n_out n_in"],
    quantity: str,
    poles: Complex[np.ndarray, " n"],
    participation: Complex[np.ndarray, "n n_in"],
    line_correlation: float = 1.0,
    std: Float[np.ndarray, "n_omega n_out n_in"] | None = None,
    *,
    is_fixed: bool = False,
) -> tuple[ModalModel, Float[np.ndarray, " n_left"]]:
    """Fit modes to frequency responses from start values; add and remove modes by significance.

    Parameters
    ----------
    omega
        Frequencies, all positive. [rad/s]
    responses
        Displacement, velocity or acceleration, as ``quantity`` states, per force.
    poles, participation
        Start values. [rad/s], any scale
    line_correlation
        Sum of the squared correlations of the noise of a frequency with that of the others, by the
        window of the spectra (``AveragedSpectra``); one of independent noise.
    std
        Standard deviations of the responses in any scale, whose mean over outputs and references
        gives the noise variance over frequency; None if they are not known.
    is_fixed
        Whether the modes are those of the start values; none is added or removed.

    Returns
    -------
    ModalModel
        Modes in order of frequency; some may lie outside the band.
    array
        Frequencies where the residuals still resemble a mode. [rad/s]

    Notes
    -----
    Model: H_or = s^p (sum_k psi_ok L_kr / (s - lambda_k) + its conjugate + terms in s^-4 to s^4
    of modes outside of the band). Noise is independent over frequencies and responses; its
    variance, one of each response times one of each frequency, comes from the residuals, where
    ``std`` is given as a slowly varying multiple of its shape over frequency. The
    weighted squares are minimised over poles and participation factors by Gauss-Newton with
    the shapes eliminated by orthogonal projection (Golub and Pereyra 1973, doi:10.1137/0710036);
    the covariance is the inverse of the projected information matrix. Source of the estimator:
    El-Kafafy, De Troyer, Peeters and Guillaume (2013), ML-MM. A mode is added where the residuals
    resemble it, and retained where it lowers the cost, by the chi-squared test with
    ``_FALSE_MODES``.
    """
    s = 1j * omega
    problem = _ModalProblem(
        *(s, s ** POWERS[quantity], responses, line_correlation),
        np.ones(omega.size) if std is None else _compute_profile(std),
    )
    poles, part = poles.astype(complex), _scale(participation.astype(complex))
    weights = _start_weights(responses)
    poles, part, weights = _refine(problem, poles, part, weights)
    if is_fixed:
        poles, part, weights = _refine(problem, poles, part, weights, _FINAL)
        order = np.argsort(np.abs(poles))
        left, _ = _scan_residuals(problem, poles, part, weights, [])
        model = _finish(problem, poles[order], part[order], weights)
        inside = (np.abs(left) >= omega[0]) & (np.abs(left) <= omega[-1])
        return model, np.sort(np.abs(left[inside]))
    refused: list[float] = []
    vain = 0
    for _ in range(_MOST_ROUNDS):
        poles, part, weights = _remove_insignificant(problem, poles, part, weights)
        candidates, directions = _scan_residuals(problem, poles, part, weights, refused)
        if not candidates.size or vain == _VAIN_ROUNDS:
            refused += list(np.abs(candidates))
            break
        grown = np.append(poles, candidates)
        more = np.concatenate([part, _scale(directions)])
        larger = _remove_insignificant(problem, *_refine(problem, grown, more, weights))
        if larger[0].size <= poles.size:
            refused += list(np.abs(candidates))
            vain += 1
            continue
        poles, part, weights = larger
    if poles.size:
        poles, part, weights = _refine(problem, poles, part, weights, _FINAL)
        poles, part, weights = _remove_insignificant(problem, poles, part, weights)
        poles, part, weights = _remove_redundant(problem, poles, part, weights)
    order = np.argsort(np.abs(poles))
    left = sorted(one for one in refused if omega[0] <= one <= omega[-1])
    return _finish(problem, poles[order], part[order], weights), np.array(left)


def _compute_profile(std: np.ndarray) -> np.ndarray:
    """Noise variance over frequency, of mean one: that of all responses relative to their mean."""
    variance = std**2
    mean = np.mean(variance, axis=0)
    if not (mean > 0).any():
        return np.ones(std.shape[0])
    profile = np.mean(variance[:, mean > 0] / mean[mean > 0], axis=1)
    return np.maximum(profile, _LEAST_PROFILE)


def _scale(part: np.ndarray) -> np.ndarray:
    largest = np.argmax(np.abs(part), axis=1)
    return part / part[np.arange(part.shape[0]), largest][:, None]


def _start_weights(responses: np.ndarray) -> _Weights:
    deviation = np.sqrt(np.mean(np.abs(responses) ** 2, axis=0))
    return _Weights(np.where(deviation > 0, deviation, 1.0), np.ones(responses.shape[0]))


def _columns(problem: _ModalProblem, poles: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the terms outside of the band, and first and second powers of each mode."""
    s, lift = problem.s, problem.lift
    size = np.sqrt(np.abs(s[0] * s[-1]))
    outside = np.stack([lift * (s / size) ** power for power in _OUTSIDE], axis=1)
    one = lift[:, None] / (s[:, None] - poles)
    other = lift[:, None] / (s[:, None] - poles.conj())
    first = np.stack([one + other, 1j * (one - other)], axis=2)
    one, other = one / (s[:, None] - poles), other / (s[:, None] - poles.conj())
    second = np.stack([one + other, 1j * (one - other)], axis=2)
    return outside, first, second


def _stack(values: np.ndarray) -> np.ndarray:
    return np.concatenate([np.real(values), np.imag(values)])


def _reduce(problem: _ModalProblem, poles: np.ndarray, weights: _Weights) -> _Reduced:
    """Factor the basis; project the data."""
    n_omega, n = problem.s.size, poles.size
    outside, first, second = _columns(problem, poles)
    flat = np.concatenate(
        [outside, first.reshape(n_omega, -1), second.reshape(n_omega, -1)], axis=1
    )
    basis = _stack(flat / weights.frequency[:, None])
    norm = np.linalg.norm(basis, axis=0)
    Q, R = np.linalg.qr(basis / norm)
    scaled = problem.responses / (weights.response * weights.frequency[:, None, None])
    # A complex variance of one is one half in each part.
    data = np.sqrt(2.0) * _stack(scaled).reshape(2 * n_omega, -1)
    inside = Q.T @ data
    n_outside = len(_OUTSIDE)
    R = (R * norm)[n_outside:, n_outside:]
    return _Reduced(
        first=R[:, : 2 * n].reshape(-1, n, 2),
        second=R[:, 2 * n :].reshape(-1, n, 2),
        data=inside[n_outside:].reshape(-1, *problem.responses.shape[1:]),
        outside=float(np.sum(data**2) - np.sum(inside**2)),
    )


def _times(pairs: np.ndarray, factor: np.ndarray) -> np.ndarray:
    """Columns (rows, n, 2) of a complex unknown times complex factors (..., n)."""
    one, other = pairs[..., 0], pairs[..., 1]
    z = factor[..., None, :]
    return np.stack(
        [np.real(z) * one + np.imag(z) * other, np.real(z) * other - np.imag(z) * one], axis=-1
    )


def _shape_design(
    reduced: _Reduced, part: np.ndarray, weights: _Weights, outputs: slice
) -> tuple[np.ndarray, np.ndarray]:
    """Design (n_out, n_in * rows, 2 n) of the shapes, and data (n_out, n_in * rows)."""
    blocks = _times(np.sqrt(2.0) * reduced.first, part.T)  # (n_in, rows, n, 2)
    n_in, rows, n, _ = blocks.shape
    inverse = 1.0 / weights.response[outputs]
    design = inverse[:, :, None, None] * blocks.reshape(n_in, rows, 2 * n)
    data = np.moveaxis(reduced.data[:, outputs], 0, 2)
    return design.reshape(-1, n_in * rows, 2 * n), data.reshape(-1, n_in * rows)


def _blocks(n_out: int) -> list[slice]:
    return [slice(start, start + _BLOCK) for start in range(0, n_out, _BLOCK)]


def _factor(design: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Factors Q and R of designs (n_out, rows, columns) with columns of length one, and lengths."""
    length = np.linalg.norm(design, axis=1)
    length[length == 0] = 1.0
    Q, R = np.linalg.qr(design / length[:, None])
    return Q, R, length


def _solve_shapes(
    reduced: _Reduced, part: np.ndarray, weights: _Weights
) -> tuple[np.ndarray, float]:
    """Shapes (n, n_out) of least squares, and the squared norm of the residuals."""
    shapes, cost = [], reduced.outside
    for outputs in _blocks(weights.response.shape[0]):
        design, data = _shape_design(reduced, part, weights, outputs)
        Q, R, scale = _factor(design)
        inside = np.einsum("orc,or->oc", Q, data)
        found = np.linalg.solve(R, inside[..., None])[..., 0] / scale
        shapes.append(found[:, 0::2] + 1j * found[:, 1::2])
        cost += float(np.sum(data**2) - np.sum(inside**2))
    return np.concatenate(shapes).T, cost


def _project(
    reduced: _Reduced, part: np.ndarray, shapes: np.ndarray, weights: _Weights
) -> np.ndarray:
    """Triangle of the Jacobian of poles and participation factors, shapes eliminated.

    The last column is that of the residuals.
    """
    n, n_in = part.shape
    largest = np.argmax(np.abs(part), axis=1)
    free = np.array([[r != largest[k] for k in range(n)] for r in range(n_in)])
    collected = []
    for outputs in _blocks(shapes.shape[1]):
        design, data = _shape_design(reduced, part, weights, outputs)
        inverse = np.sqrt(2.0) / weights.response[outputs]
        psi = shapes[:, outputs].T  # (n_out, n)
        n_out, rows = psi.shape[0], reduced.first.shape[0]
        residues = psi[:, None, :] * part.T  # (n_out, n_in, n)
        to_poles = _times(reduced.second, residues) * inverse[:, :, None, None, None]
        to_part = _times(reduced.first, psi)[:, None] * inverse[:, :, None, None, None]
        jacobian = np.zeros((n_out, n_in, rows, 1 + n_in, n, 2))
        jacobian[:, :, :, 0] = to_poles
        for reference in range(n_in):
            jacobian[:, reference, :, 1 + reference] = to_part[:, reference]
        mask = np.concatenate([np.ones((1, n), dtype=bool), free])
        flat = jacobian[:, :, :, mask].reshape(n_out, n_in * rows, -1)
        rest = np.concatenate([flat, data[..., None]], axis=2)
        Q = _factor(design)[0]
        rest -= Q @ (np.swapaxes(Q, 1, 2) @ rest)
        collected.append(np.linalg.qr(rest.reshape(-1, rest.shape[2]), mode="r"))
    return np.asarray(np.linalg.qr(np.concatenate(collected), mode="r"))


def _solve_step(triangle: np.ndarray) -> np.ndarray:
    R, right = triangle[:-1, :-1], triangle[:-1, -1]
    scale = np.linalg.norm(R, axis=0)
    scale[scale == 0] = 1.0
    return np.linalg.lstsq(R / scale, right, rcond=_RANK)[0] / scale


def _minimise(
    problem: _ModalProblem, poles: np.ndarray, part: np.ndarray, weights: _Weights, effort: _Effort
) -> tuple[np.ndarray, np.ndarray]:
    n, n_in = part.shape
    reduced = _reduce(problem, poles, weights)
    shapes, cost = _solve_shapes(reduced, part, weights)
    for _ in range(effort.steps):
        step = _solve_step(_project(reduced, part, shapes, weights)).reshape(-1, 2)
        change = step[:, 0] + 1j * step[:, 1]
        largest = np.argmax(np.abs(part), axis=1)
        free = np.arange(n_in)[:, None] != largest
        turn = np.zeros((n_in, n), dtype=complex)
        turn[free] = change[n:]
        # Of each mode alone, so that one far from its place does not hold the others.
        limit = np.maximum(np.abs(change[:n]) / (_LARGEST_STEP * np.abs(np.real(poles))), 1.0)
        change[:n] /= limit
        turn /= limit
        length = 1.0
        for _ in range(8):
            new = poles + length * change[:n]
            if np.all(np.real(new) < 0) and np.all(np.imag(new) > 0):
                new_part = _scale(part + length * turn.T)
                new_reduced = _reduce(problem, new, weights)
                new_shapes, new_cost = _solve_shapes(new_reduced, new_part, weights)
                if new_cost < cost:
                    break
            length *= 0.4
        else:
            break
        is_converged = cost - new_cost < effort.same_cost * cost
        poles, part, reduced, shapes, cost = new, new_part, new_reduced, new_shapes, new_cost
        if is_converged:
            break
    return poles, part


def _fit_responses(
    problem: _ModalProblem, poles: np.ndarray, part: np.ndarray, weights: _Weights
) -> tuple[np.ndarray, np.ndarray]:
    """Shapes, and responses fitted with the terms outside of the band."""
    n_omega, n_out, n_in = problem.responses.shape
    shapes = np.zeros((0, n_out), dtype=complex)
    if poles.size:
        shapes, _ = _solve_shapes(_reduce(problem, poles, weights), part, weights)
    outside, first, _ = _columns(problem, poles)
    modal = first[..., 0] @ np.real(
        residues := (shapes[:, :, None] * part[:, None, :]).reshape(-1, n_out * n_in)
    ) + first[..., 1] @ np.imag(residues)
    rest = problem.responses.reshape(n_omega, -1) - modal
    terms = _stack(outside / weights.frequency[:, None])
    norm = np.linalg.norm(terms, axis=0)
    found = np.linalg.lstsq(terms / norm, _stack(rest / weights.frequency[:, None]), rcond=None)[0]
    return shapes, (modal + outside @ (found / norm[:, None])).reshape(n_omega, n_out, n_in)


def _estimate_weights(problem: _ModalProblem, fitted: np.ndarray, n: int) -> _Weights:
    """Noise variances from residuals, corrected for the fitted parameters.

    Medians over frequencies do not count a mode that is not in the model as noise.
    """
    n_omega, n_out, n_in = fitted.shape
    squares = np.abs(problem.responses - fitted) ** 2 / problem.profile[:, None, None]
    n_real = len(_OUTSIDE) + 2 * n / n_in + 2 * n / n_out
    free = max(1.0 - 0.5 * n_real / n_omega, 1.0 / n_omega)
    least = _LEAST_NOISE**2 * np.mean(np.abs(problem.responses) ** 2, axis=0)
    least = np.where(least > 0, least, 1.0)
    middle = np.maximum(np.median(squares, axis=0), least)
    by_frequency = np.mean(squares / middle, axis=(1, 2))
    half = max(_SMOOTHED, n_omega // 16)
    places = np.unique(np.linspace(0, n_omega - 1, 2 * n_omega // half + 2).astype(int))
    smooth = [np.median(by_frequency[max(0, i - half) : i + half + 1]) for i in places]
    frequency = np.interp(np.arange(n_omega), places, smooth)
    frequency = np.maximum(frequency / np.mean(frequency), 1e-3)
    scaled = squares / frequency[:, None, None]
    variance = np.maximum(np.median(scaled, axis=0) / np.log(2.0) / free, least)
    # The mean is the more accurate where no mode is missing.
    mean = np.mean(scaled, axis=0) / free
    variance = np.where(mean < 1.2 * variance, np.maximum(mean, least), variance)
    # What varies slowly over frequency has the errors of that many fewer independent ones.
    return _Weights(
        np.sqrt(problem.line_correlation * variance), np.sqrt(problem.profile * frequency)
    )


def _refine(
    problem: _ModalProblem,
    poles: np.ndarray,
    part: np.ndarray,
    weights: _Weights,
    effort: _Effort = _SEARCH,
) -> tuple[np.ndarray, np.ndarray, _Weights]:
    for _ in range(effort.fits):
        _, fitted = _fit_responses(problem, poles, part, weights)
        weights = _estimate_weights(problem, fitted, poles.size)
        if not poles.size:
            break
        poles, part = _minimise(problem, poles, part, weights, effort)
    return poles, part, weights


def _remove_insignificant(
    problem: _ModalProblem, poles: np.ndarray, part: np.ndarray, weights: _Weights
) -> tuple[np.ndarray, np.ndarray, _Weights]:
    """Remove the least significant mode, and fit again, until all are significant."""
    n_out, n_in = problem.responses.shape[1:]
    least = float(chdtri(2 * (n_out + n_in), _FALSE_MODES / problem.s.size))
    while poles.size:
        reduced = _reduce(problem, poles, weights)
        gain = _compute_gains(reduced, part, weights)
        _, spread = propagate_covariance(poles, _compute_covariance(reduced, part, weights))
        gain[spread > _LEAST_KNOWN * -np.real(poles) / np.abs(poles)] *= 1e-12
        gain[-np.real(poles) > MOST_DAMPED * np.abs(poles)] = 0.0
        weakest = int(np.argmin(gain))
        if gain[weakest] >= least:
            break
        poles, part = np.delete(poles, weakest), np.delete(part, weakest, axis=0)
        if poles.size:
            poles, part, weights = _refine(problem, poles, part, weights)
    return poles, part, weights


def _remove_redundant(
    problem: _ModalProblem, poles: np.ndarray, part: np.ndarray, weights: _Weights
) -> tuple[np.ndarray, np.ndarray, _Weights]:
    """Remove modes of close pairs without which a new fit is not significantly worse.

    Two modes in place of one explain the same data, so that each is significant if the other
    retains its pole.
    """
    n_out, n_in = problem.responses.shape[1:]
    least = float(chdtri(2 * (n_out + n_in), _FALSE_MODES / problem.s.size))
    place = 0
    while place < poles.size:
        apart = np.abs(np.delete(poles, place) - poles[place])
        decay = np.maximum(-np.real(np.delete(poles, place)), -np.real(poles[place]))
        if not (apart < _CLOSE * decay).any():
            place += 1
            continue
        _, cost = _solve_shapes(_reduce(problem, poles, weights), part, weights)
        fewer = _minimise(
            problem, np.delete(poles, place), np.delete(part, place, axis=0), weights, _FINAL
        )
        _, other = _solve_shapes(_reduce(problem, fewer[0], weights), fewer[1], weights)
        if other - cost < least:
            poles, part, weights = _refine(problem, *fewer, weights, _FINAL)
            place = 0
        else:
            place += 1
    return poles, part, weights


def _compute_gains(
    reduced: _Reduced, part: np.ndarray, weights: _Weights
) -> Float[np.ndarray, " n"]:
    """Rise of the squared norm of the residuals without each mode, all others retained.

    x' S^-1 x with the estimate x of the shape of the mode and its covariance S.
    """
    gain = np.zeros(part.shape[0])
    for outputs in _blocks(weights.response.shape[0]):
        design, data = _shape_design(reduced, part, weights, outputs)
        Q, R, _ = _factor(design)
        half = np.linalg.inv(R).reshape(R.shape[0], -1, 2, R.shape[2])
        found = half @ np.einsum("orc,or->oc", Q, data)[:, None, :, None]
        covariance = half @ np.swapaxes(half, -1, -2)
        gain += np.sum(found * np.linalg.solve(covariance, found), axis=(0, 2, 3))
    return gain


def _scan_residuals(
    problem: _ModalProblem,
    poles: np.ndarray,
    part: np.ndarray,
    weights: _Weights,
    refused: list[float],
) -> tuple[np.ndarray, np.ndarray]:
    """Poles and participation factors that explain the residuals better than noise would."""
    n_omega, n_out, n_in = problem.responses.shape
    _, fitted = _fit_responses(problem, poles, part, weights)
    deviation = weights.response * weights.frequency[:, None, None]
    data = np.sqrt(2.0) * _stack((problem.responses - fitted) / deviation)
    data = data.reshape(2 * n_omega, -1)
    omega = np.imag(problem.s)[:: max(1, n_omega // _MOST_SCANNED)]
    outside = np.geomspace(1.02, _SCANNED_OUTSIDE, 12)
    omega = np.concatenate([omega[0] / outside[::-1], omega, omega[-1] * outside])
    for known in refused:
        omega = omega[np.abs(omega / known - 1.0) > _REFUSED_BAND]
    least = float(chdtri(2 * n_out * n_in, _FALSE_MODES / max(omega.size, 1)))
    found: list[tuple[float, complex, np.ndarray]] = []
    for damping in _SCANNED_DAMPING:
        trial = omega * (-damping + 1j * np.sqrt(1.0 - damping**2))
        one = problem.lift[:, None] / (problem.s[:, None] - trial)
        other = problem.lift[:, None] / (problem.s[:, None] - trial.conj())
        first = _stack((one + other) / weights.frequency[:, None])
        second = _stack(1j * (one - other) / weights.frequency[:, None])
        first /= np.linalg.norm(first, axis=0)
        second -= np.sum(first * second, axis=0) * first
        second /= np.linalg.norm(second, axis=0)
        u, v = first.T @ data, second.T @ data
        explained = np.sum(u**2 + v**2, axis=1)
        for place in np.flatnonzero(explained > least):
            found.append((explained[place], trial[place], u[place] + 1j * v[place]))
    selected: list[tuple[complex, np.ndarray]] = []
    for _, pole, parts in sorted(found, key=lambda one: -one[0]):
        if all(abs(abs(pole) / abs(other) - 1.0) > _APART for other, _ in selected):
            residues = parts.reshape(n_out, n_in) * weights.response
            selected.append((pole, np.linalg.svd(residues, full_matrices=False)[2][0]))
        if len(selected) == _ADDED:
            break
    directions = np.array([direction for _, direction in selected], dtype=complex)
    return np.array([pole for pole, _ in selected]), directions.reshape(-1, n_in)


def _compute_covariance(
    reduced: _Reduced, part: np.ndarray, weights: _Weights
) -> Float[np.ndarray, "two_n two_n"]:
    n = part.shape[0]
    shapes, _ = _solve_shapes(reduced, part, weights)
    triangle = _project(reduced, part, shapes, weights)[:-1, :-1]
    scale = np.linalg.norm(triangle, axis=0)
    scale[scale == 0] = 1.0
    half = np.linalg.pinv(triangle / scale, rcond=_RANK) / scale[:, None]
    index = np.concatenate([np.arange(0, 2 * n, 2), np.arange(1, 2 * n, 2)])
    return (half @ half.T)[np.ix_(index, index)]


def _finish(
    problem: _ModalProblem, poles: np.ndarray, part: np.ndarray, weights: _Weights
) -> ModalModel:
    n = poles.size
    shapes, fitted = _fit_responses(problem, poles, part, weights)
    covariance = np.zeros((2 * n, 2 * n))
    if n:
        covariance = _compute_covariance(_reduce(problem, poles, weights), part, weights)
    return ModalModel(poles, part, shapes, covariance, fitted)
