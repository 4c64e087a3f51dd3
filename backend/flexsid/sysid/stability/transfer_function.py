"""Transfer functions of one input and output from frequency responses, with equivalent delay.

A low-order equivalent system is the transfer function of few poles that is closest to the
response of a higher-order one; its delay stands for the dynamics that it omits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.estimation.noise import smooth_density
from flexsid.sysid.stability.poles import compute_polar_slopes

MOST_ORDER = 6
"""Highest order of numerator and denominator: roots of higher ones are ill-conditioned."""

_DELAYS = np.linspace(-1.0, 3.0, 17)  # starting values, in radians at the highest frequency
_IMPROVED_STARTS = 3
_LINEAR_ROUNDS = 8  # of Sanathanan-Koerner weights
_ITERATIONS = 200
_CONVERGED = 1e-9  # relative change of the cost
_DAMPING = 1e-4  # first of the iteration, in the scaled normal matrix
_LEAST_DAMPING, _LARGEST_DAMPING = 1e-12, 1e12  # below, rounding makes it indefinite
_ROUNDS = 12  # of weights and mismatch
_SAME_VARIANCE = 1e-3  # relative change at convergence
_LARGEST_CONDITION = 1e12  # of the scaled normal matrix
_NEAR = 25  # frequencies whose residuals give the density of a standard error
_KNOWN = 8  # further frequencies that the measured noise counts as
_LEAST_SHARE = 0.2  # of the noise of a response: least part that is noise of the output
_LEAST_STD = 1e-9  # of a response, relative: weights of noise-free data stay finite
_DB, _DEGREES = 20.0 / np.log(10.0), 180.0 / np.pi
_PHASE_WEIGHT, _COST_FACTOR = 0.02, 20.0  # of the mismatch cost, MIL-STD-1797


@dataclass(frozen=True, slots=True)
class TransferFunctionForm:
    """Orders of K (s^m + ...) e^(-tau s) / (s^i (s^n + ...)): zeros m, poles n, integrators i."""

    zeros: int
    poles: int
    integrators: int = 0
    has_delay: bool = True

    def __post_init__(self) -> None:
        """Refuse orders that are no transfer function.

        Raises
        ------
        BadInput
            If an order is negative or too high, or there are more zeros than poles.
        """
        orders = (self.zeros, self.poles, self.integrators)
        if min(orders) < 0 or max(orders) > MOST_ORDER or self.poles + self.integrators == 0:
            raise BadInput(
                f"a transfer function with {self.zeros} zeros, {self.poles} poles and "
                f"{self.integrators} integrators cannot be fitted; expected 0 to {MOST_ORDER} of "
                "each, and at least one pole or integrator",
                code="bad-order",
            )
        if self.zeros > self.poles + self.integrators:
            raise BadInput(
                f"{self.zeros} zeros exceed {self.poles} poles and {self.integrators} integrators; "
                "raise the poles, or lower the zeros",
                code="bad-order",
            )

    @property
    def n_parameters(self) -> int:
        """Number of coefficients, and the delay."""
        return self.zeros + 1 + self.poles + self.has_delay

    @property
    def n_states(self) -> int:
        """Number of states that an end of a record leaves in motion."""
        return self.poles + self.integrators


@dataclass(frozen=True, slots=True)
class TransferFunctionRoot:
    """A zero or pole; of a pair, that above the real axis. [rad/s]

    ``frequency_rad_s`` is its modulus, of a real root the inverse of its time constant, and
    ``damping`` its damping ratio, of a real root 1 or -1; standard errors are to first order.
    """

    real_rad_s: float
    imag_rad_s: float
    frequency_rad_s: float
    frequency_std_rad_s: float
    damping: float
    damping_std: float


@dataclass(frozen=True, slots=True)
class TransferFunctionFit:
    """A transfer function fitted to a frequency response.

    Attributes
    ----------
    form
        Its orders.
    numerator, denominator
        Coefficients of rising powers of s, the denominator without its integrators.
    delay, delay_std
        Equivalent delay, zero where it has none. [s]
    covariance
        Of the coefficients but the leading one of the denominator, and the delay.
    gain, gain_std
        Leading coefficient of the numerator: the gain at high frequency.
    zeros, poles
        Roots of numerator and denominator, slow ones first.
    mismatch
        Standard deviation of the relative error of the transfer function beyond noise. [1]
    cost
        Mismatch cost, below 10 for a match that pilots do not distinguish.
    cost_beyond_noise
        Mismatch cost of a mismatch that, with the noise, explains the residuals; where the noise
        is not known the mismatch cost.
    residuals
        Measured less modelled response.
    leakage
        Part of the measured response by other inputs and the motion at the ends of its record.
    """

    form: TransferFunctionForm
    numerator: Float[np.ndarray, " m_1"]
    denominator: Float[np.ndarray, " n_1"]
    delay: float
    delay_std: float
    covariance: Float[np.ndarray, "p p"]
    gain: float
    gain_std: float
    zeros: tuple[TransferFunctionRoot, ...]
    poles: tuple[TransferFunctionRoot, ...]
    mismatch: float
    cost: float
    cost_beyond_noise: float
    residuals: Complex[np.ndarray, " n_omega"]
    leakage: Complex[np.ndarray, " n_omega"]

    def response(self, omega: Float[np.ndarray, " n"]) -> Complex[np.ndarray, " n"]:
        """Compute its frequency response."""
        s = 1j * omega
        numerator, denominator = self.numerator[::-1], self.denominator[::-1]
        integrated = np.polyval(denominator, s) * s**self.form.integrators
        return np.polyval(numerator, s) * np.exp(-self.delay * s) / integrated


def fit_transfer_function(
    form: TransferFunctionForm,
    omega: Float[np.ndarray, " n_omega"],
    response: Complex[np.ndarray, " n_omega"],
    std: Float[np.ndarray, " n_omega"] | None = None,
    overlap: float = 1.0,
    ends: Complex[np.ndarray, "n_omega n_ends"] | None = None,
    others: Complex[np.ndarray, "n_omega n_others"] | None = None,
    input_std: Float[np.ndarray, " n_omega"] | None = None,
) -> TransferFunctionFit:
    """Fit a transfer function to a measured frequency response.

    Parameters
    ----------
    form
        Orders.
    omega
        Frequencies, rising. [rad/s]
    response
        Output over input.
    std
        Standard deviation of its complex error, up to a common factor where ``mismatch`` is
        zero; None: equal relative errors.
    overlap
        Frequencies per resolution 1/T of the record, at least one.
    ends
        Spectra of unit impulses at the ends where the record may be in motion, over that of the
        input; by default it begins and ends at rest.
    others
        Spectra of other inputs that move, over that of the input.
    input_std
        Standard deviation of the noise of the measured input's spectrum, over its magnitude; part
        of ``std``. By default the input is exact.

    Raises
    ------
    BadInput
        If a value is not finite, or the response is zero.
    NotIdentifiable
        If there are too few frequencies, or the parameters are not identifiable.

    Notes
    -----
    The coefficients minimise sum |H_k - H(j omega_k)|^2 / v_k with
    v_k = sigma_k^2 + rho_k^2 |H(j omega_k)|^2 + mu^2 |H(j omega_k)|^2: noise of output and input
    (with rho_k the latter's relative one), and a mismatch mu of a transfer function of
    too low an order, which is relative as the errors of decibels and degrees are. mu makes the sum
    equal its degrees of freedom (Mandel and Paule, 1970), zero where noise alone does. Weights
    and mu alternate with Levenberg-Marquardt steps from linear fits (Sanathanan and Koerner, 1963,
    doi:10.1109/TAC.1963.1105517) over a grid of delays. With J the derivatives of H and w = 1/v,
    N = 2 Re sum J^H w J and Cov = N^-1 (2 Re sum J^H w S w J) N^-1, S from the residuals at
    neighbouring frequencies. The mismatch cost is 20 mean(dB^2 + 0.02 deg^2), with equal weights
    of equal ratios of frequency. A relative mismatch mu of the complex response has mu^2 / 2 in
    each of ln|H| and phase: the cost beyond noise is that of a mu with these weights.
    A record that ends in motion has the spectrum Z = H U + e^{-s t} c(s) / (s^i A(s)) for every end
    t, with A the denominator and c a polynomial of one order less than s^i A, whose coefficients
    are parameters, too (Pintelon and Schoukens, System Identification, 2nd ed., 2012, sec. 6.3).
    Another input has such a polynomial, too, and the delay.
    Over the spectrum of the input, and weighted with it, this is the output-error form, and with
    rho_k, which varies with the coefficients, that of errors in variables (ibid., sec. 9.3).
    Sources: Hodgkinson, LaManna and Heyde, AIAA 76-1922 (cost); Morelli, NASA/TM-2000-210117.
    """
    H, n = np.asarray(response, dtype=complex), omega.size
    if not (np.isfinite(H).all() and np.abs(H).all() and (std is None or np.isfinite(std).all())):
        raise BadInput("a frequency response to fit must be finite and not zero", code="not-finite")
    none = np.zeros((n, 0), dtype=complex)
    others, ends = (none if one is None else one for one in (others, ends))
    rho = np.zeros(n) if input_std is None else np.asarray(input_std, dtype=float)
    problem = _ResponseProblem(form, omega, H, others, ends, rho)
    if 2 * n <= problem.n_parameters + 2:
        raise NotIdentifiable(
            f"{n} frequencies do not determine {problem.n_parameters} parameters; use a wider band "
            "or lower orders"
        )
    size = np.abs(H)
    sigma = np.zeros(n) if std is None else np.asarray(std, dtype=float)
    sigma = np.maximum(sigma, _LEAST_STD * size)
    free = n - 0.5 * problem.n_parameters
    theta = problem.find_start(size**2 if std is None else sigma**2)
    mismatch, variance = 0.0, sigma**2
    for _ in range(_ROUNDS):
        modelled = np.abs(problem.compute_response(theta))
        of_input = rho * modelled
        of_output = np.sqrt(np.maximum(sigma**2 - of_input**2, (_LEAST_SHARE * sigma) ** 2))
        noise = np.hypot(of_output, of_input)
        found = _find_mismatch(problem.compute_residuals(theta), noise, modelled, free / n)
        before, variance = variance, of_output**2 + (found * modelled) ** 2
        theta = problem.minimise(theta, variance)
        mismatch = found
        if np.all(np.abs(variance - before) <= _SAME_VARIANCE * variance):
            break
    known = 0 if std is None else _KNOWN
    covariance = problem.compute_covariance(theta, variance, free, known) * overlap
    return problem.build_fit(theta, covariance, mismatch, sigma)


def compute_mismatch_cost(
    omega: Float[np.ndarray, " n_omega"],
    measured: Complex[np.ndarray, " n_omega"],
    modelled: Complex[np.ndarray, " n_omega"],
) -> float:
    """Compute 20 mean(dB^2 + 0.02 deg^2) of the differences, over the logarithm of frequency."""
    ratio = measured / modelled
    error = (_DB * np.log(np.abs(ratio))) ** 2
    error += _PHASE_WEIGHT * (_DEGREES * np.angle(ratio)) ** 2
    return _COST_FACTOR * float(np.average(error, weights=np.gradient(np.log(omega))))


def _find_mismatch(
    residuals: Complex[np.ndarray, " n_omega"],
    sigma: Float[np.ndarray, " n_omega"],
    size: Float[np.ndarray, " n_omega"],
    free: float,
    shares: Float[np.ndarray, " n_omega"] | None = None,
) -> float:
    """Find the relative mismatch that makes the mean normalised residual ``free``."""
    power = np.abs(residuals) ** 2

    def excess(mismatch: float) -> float:
        normalised = power / (sigma**2 + (mismatch * size) ** 2)
        return float(np.average(normalised, weights=shares)) - free

    if excess(0.0) <= 0.0:
        return 0.0
    upper = float(np.sqrt(np.average(power / size**2, weights=shares) / free)) * 1.01
    return float(scipy.optimize.brentq(excess, 0.0, upper, xtol=1e-14))


class _ResponseProblem:
    """Least squares of one response; s and the coefficients are scaled by a frequency."""

    def __init__(
        self,
        form: TransferFunctionForm,
        omega: Float[np.ndarray, " n_omega"],
        H: Complex[np.ndarray, " n_omega"],
        others: Complex[np.ndarray, "n_omega n_others"],
        ends: Complex[np.ndarray, "n_omega n_ends"],
        input_std: Float[np.ndarray, " n_omega"],
    ) -> None:
        self.form, self.omega, self.H, self.input_std = form, omega, H, input_std
        self.scale = float(np.exp(np.mean(np.log(omega))))
        s = 1j * omega / self.scale
        highest = max(form.zeros, form.n_states)
        self.powers = s[:, None] ** np.arange(highest + 1)
        self.integrated = s**form.integrators
        self.n_numerator = form.zeros + 1
        self.s = s
        beside = np.concatenate([others, ends], axis=1)[:, :, None]
        self.beside = (beside * self.powers[:, None, : form.n_states]).reshape(s.size, -1)
        self.is_delayed = np.arange(self.beside.shape[1]) < others.shape[1] * form.n_states
        self.n_parameters = form.n_parameters + self.beside.shape[1]

    def _split(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        m, n = self.n_numerator, self.form.poles
        delay = float(theta[m + n]) if self.form.has_delay else 0.0
        return theta[:m], np.append(theta[m : m + n], 1.0), delay

    def compute_response(self, theta: np.ndarray) -> Complex[np.ndarray, " n_omega"]:
        """Compute the response of the transfer function."""
        b, a, delay = self._split(theta)
        return (
            (self.powers[:, : b.size] @ b)
            * np.exp(-delay * self.s)
            / (self.integrated * (self.powers[:, : a.size] @ a))
        )

    def compute_leakage(self, theta: np.ndarray) -> Complex[np.ndarray, " n_omega"]:
        """Compute what other inputs and the motion at the ends add to the response."""
        return self._build_beside(theta) @ theta[self.form.n_parameters :]

    def _build_beside(self, theta: np.ndarray) -> Complex[np.ndarray, "n_omega n_beside"]:
        _, a, delay = self._split(theta)
        free = 1.0 / (self.integrated * (self.powers[:, : a.size] @ a))
        phase = np.where(self.is_delayed, np.exp(-delay * self.s)[:, None], 1.0)
        return self.beside * phase * free[:, None]

    def compute_residuals(self, theta: np.ndarray) -> Complex[np.ndarray, " n_omega"]:
        """Compute measured less modelled response."""
        return self.H - self.compute_response(theta) - self.compute_leakage(theta)

    def compute_jacobian(self, theta: np.ndarray) -> Complex[np.ndarray, "n_omega p"]:
        """Compute the derivatives of the response, and of what is added to it."""
        b, a, delay = self._split(theta)
        denominator = self.powers[:, : a.size] @ a
        through = np.exp(-delay * self.s) / (self.integrated * denominator)
        H = (self.powers[:, : b.size] @ b) * through
        beside, c = self._build_beside(theta), theta[self.form.n_parameters :]
        both = H + beside @ c
        columns = [
            self.powers[:, : b.size] * through[:, None],
            -self.powers[:, : a.size - 1] * (both / denominator)[:, None],
        ]
        if self.form.has_delay:
            delayed = H + beside @ np.where(self.is_delayed, c, 0.0)
            columns.append(-(self.s * delayed)[:, None])
        columns.append(beside)
        return np.concatenate(columns, axis=1)

    def find_start(self, variance: Float[np.ndarray, " n_omega"]) -> np.ndarray:
        """Find the best of linear fits with delays held; the first ones are improved."""
        top = float(np.abs(self.s[-1]))
        delays = _DELAYS / top if self.form.has_delay else np.zeros(1)
        linear = [self._fit_linear(delay, 1.0 / np.sqrt(variance)) for delay in delays.tolist()]
        starts = sorted(
            (one for one in linear if one is not None),
            key=lambda theta: self._compute_cost(theta, variance),
        )
        if not starts:
            raise NotIdentifiable(
                "the transfer function is not identifiable from this response; lower its orders"
            )
        ends = [self.minimise(theta, variance) for theta in starts[:_IMPROVED_STARTS]]
        return min(ends, key=lambda theta: self._compute_cost(theta, variance))

    def _fit_linear(
        self, delay: float, weights: Float[np.ndarray, " n_omega"]
    ) -> np.ndarray | None:
        """Fit a linear equation error, whose denominator then weights the next one."""
        m, n = self.n_numerator, self.form.poles
        advance = np.exp(delay * self.s)
        undelayed = self.H * advance * self.integrated
        known = [self.powers[:, :m], -undelayed[:, None] * self.powers[:, :n]]
        beside = self.beside * np.where(self.is_delayed, 1.0, advance[:, None])
        X = np.concatenate([*known, beside], axis=1)
        z = undelayed * self.powers[:, n]
        denominator = np.ones(self.omega.size, dtype=complex)
        theta = None
        for _ in range(_LINEAR_ROUNDS):
            w = weights / np.abs(denominator * self.integrated)
            A, y = X * w[:, None], z * w
            size = np.maximum(np.linalg.norm(A, axis=0), np.finfo(float).tiny)
            A = A / size
            stacked = np.concatenate([A.real, A.imag]), np.concatenate([y.real, y.imag])
            found = np.linalg.lstsq(*stacked, rcond=None)[0] / size
            if not np.isfinite(found).all():
                return theta
            theta = np.insert(found, m + n, delay) if self.form.has_delay else found
            denominator = self.powers[:, : n + 1] @ np.append(found[m : m + n], 1.0)
            if not np.abs(denominator).all():
                return None
        return theta

    def _weigh(self, theta: np.ndarray, variance: np.ndarray) -> Float[np.ndarray, " n_omega"]:
        """Compute weights of a variance, to which the noise of the input adds."""
        of_input = self.input_std * np.abs(self.compute_response(theta))
        return 1.0 / np.sqrt(variance + of_input**2)

    def _compute_cost(self, theta: np.ndarray, variance: np.ndarray) -> float:
        weighted = self.compute_residuals(theta) * self._weigh(theta, variance)
        return float(np.sum(np.abs(weighted) ** 2))

    def _build_normal(
        self, theta: np.ndarray, variance: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return scaled normal matrix, gradient and scale."""
        weights = self._weigh(theta, variance)
        J = self.compute_jacobian(theta) * weights[:, None]
        r = self.compute_residuals(theta) * weights
        N, g = np.real(J.conj().T @ J), np.real(J.conj().T @ r)
        if self.input_std.any():
            # The weights depend on the response, not on what other inputs and ends add to it.
            alone = theta.copy()
            alone[self.form.n_parameters :] = 0.0
            own = self.compute_jacobian(alone)
            own[:, self.form.n_parameters :] = 0.0
            change = np.real(self.compute_response(theta).conj()[:, None] * own)
            g += change.T @ (np.abs(r) * weights * self.input_std) ** 2
        size = np.sqrt(np.maximum(np.diag(N), np.finfo(float).tiny))
        return N / np.outer(size, size), g / size, size

    def minimise(self, theta: np.ndarray, variance: np.ndarray) -> np.ndarray:
        """Minimise the weighted squares from a start by Levenberg-Marquardt steps."""
        cost, damping = self._compute_cost(theta, variance), _DAMPING
        for _ in range(_ITERATIONS):
            N, g, size = self._build_normal(theta, variance)
            before = cost
            while damping < _LARGEST_DAMPING:
                step = scipy.linalg.solve(N + damping * np.eye(len(N)), g, assume_a="pos") / size
                trial = theta + step
                found = self._compute_cost(trial, variance)
                if found < cost:
                    theta, cost, damping = trial, found, max(0.1 * damping, _LEAST_DAMPING)
                    break
                damping *= 10.0
            if before - cost <= _CONVERGED * before:
                break
        return theta

    def compute_covariance(
        self,
        theta: np.ndarray,
        variance: Float[np.ndarray, " n_omega"],
        free: float,
        known: int,
    ) -> Float[np.ndarray, "p p"]:
        """Compute the covariance for the observed residuals, of scaled parameters.

        The known noise counts as so many further frequencies.
        """
        N, _, size = self._build_normal(theta, variance)
        if np.linalg.cond(N) > _LARGEST_CONDITION:
            raise NotIdentifiable(
                "the transfer function is not identifiable from this response: a pole and a zero "
                "cancel, or the band is too narrow; lower its orders"
            )
        inverse = scipy.linalg.inv(N) / np.outer(size, size) / 2.0
        weights = self._weigh(theta, variance)
        J = self.compute_jacobian(theta) * weights[:, None]
        r = (self.compute_residuals(theta) * weights)[:, None]
        smooth = smooth_density(r, np.zeros(len(r), dtype=int), 1)
        density = np.real(smooth.blocks[smooth.block, 0, 0]) * (len(r) / free)
        near = min(_NEAR, len(r)) * (free / len(r))
        density = (near * density + known) / (near + known)
        scaled = J * np.sqrt(density)[:, None]
        return inverse @ (2.0 * np.real(scaled.conj().T @ scaled)) @ inverse

    def build_fit(
        self,
        theta: np.ndarray,
        covariance: np.ndarray,
        mismatch: float,
        sigma: Float[np.ndarray, " n_omega"],
    ) -> TransferFunctionFit:
        """Convert to coefficients of s in rad/s, with the mismatch cost."""
        form, w0 = self.form, self.scale
        b, a, delay = self._split(theta)
        rest = w0 ** float(form.poles + form.integrators)
        factors = np.concatenate(
            [
                rest / w0 ** np.arange(b.size, dtype=float),
                w0 ** (form.poles - np.arange(form.poles, dtype=float)),
                np.full(int(form.has_delay), 1.0 / w0),
            ]
        )
        covariance = covariance[: factors.size, : factors.size] * np.outer(factors, factors)
        std = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        numerator = b * factors[: b.size]
        denominator = np.append(a[:-1] * factors[b.size : b.size + form.poles], 1.0)
        modelled, leakage = self.compute_response(theta), self.compute_leakage(theta)
        n_b, n_a = b.size, form.poles
        residuals = self.H - leakage - modelled
        cost = compute_mismatch_cost(self.omega, self.H - leakage, modelled)
        octaves, free = np.gradient(np.log(self.omega)), 1.0 - 0.5 * theta.size / self.omega.size
        beyond = _find_mismatch(residuals, sigma, np.abs(modelled), free, octaves)
        per_square = 0.5 * _COST_FACTOR * (_DB**2 + _PHASE_WEIGHT * _DEGREES**2)
        return TransferFunctionFit(
            form=form,
            numerator=numerator,
            denominator=denominator,
            delay=delay / w0,
            delay_std=float(std[-1]) if form.has_delay else 0.0,
            covariance=covariance,
            gain=float(numerator[-1]),
            gain_std=float(std[n_b - 1]),
            zeros=_compute_roots(numerator, covariance[:n_b, :n_b]),
            poles=_compute_roots(denominator, covariance[n_b : n_b + n_a, n_b : n_b + n_a]),
            mismatch=mismatch,
            cost=cost,
            cost_beyond_noise=min(cost, per_square * beyond**2),
            residuals=residuals,
            leakage=leakage,
        )


def _compute_roots(
    coefficients: Float[np.ndarray, " n_1"], covariance: Float[np.ndarray, "n_c n_c"]
) -> tuple[TransferFunctionRoot, ...]:
    """Compute the roots of a polynomial of rising powers with standard errors to first order.

    The covariance is that of its first coefficients; the others are exact.
    """
    if coefficients.size < 2:
        return ()
    roots = np.roots(coefficients[::-1]).astype(complex)
    roots = roots[np.imag(roots) >= 0.0]
    roots = roots[np.argsort(np.abs(roots))]
    slope = np.polyval(np.polyder(coefficients[::-1]), roots)
    own = -(roots[:, None] ** np.arange(covariance.shape[0])) / slope[:, None]
    by_modulus, by_damping = compute_polar_slopes(roots, own)
    stds = [
        np.sqrt(np.maximum(np.einsum("ri,ij,rj->r", rows, covariance, rows), 0.0)).tolist()
        for rows in (by_modulus, by_damping)
    ]
    return tuple(
        TransferFunctionRoot(
            root.real, root.imag, abs(root), f, -root.real / max(abs(root), 1e-300), z
        )
        for root, f, z in zip(roots.tolist(), *stds, strict=True)
    )
