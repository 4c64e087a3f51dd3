"""Modes of a structure from measured frequency responses, with stabilisation diagram and errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.modes.modal_model import MOST_DAMPED, POWERS, fit_modal_model

# --- Stabilisation diagram of measured frequency responses: poly-reference least squares ----------

_FREQUENCY_TOLERANCE = 0.01  # relative change from one order to the next of a stable frequency
_DAMPING_TOLERANCE = 0.05  # relative change from one order to the next of a stable damping ratio
_SAME_PARTICIPATION = 0.95  # least MAC of participation vectors of a stable pole
_LEAST_ORDERS = 0.3  # of the orders, at least three, in which a mode must be stable
_MOST_ADVANCE = 0.02  # sine of the mean phase from one frequency to the next: noise has less
_SAME_COLUMN = 0.9  # least MAC of participation vectors of one mode in several orders


@dataclass(frozen=True, slots=True, eq=False)
class StabilizationPole:
    """One pole of one model order; ``stable`` if the order before has the same."""

    order: int
    value: complex
    participation: Complex[np.ndarray, " n_references"]
    stable: bool
    stable_frequency: bool

    @property
    def omega(self) -> float:
        """Undamped natural frequency. [rad/s]"""
        return abs(self.value)

    @property
    def damping(self) -> float:
        """Damping ratio. [1]"""
        return -self.value.real / abs(self.value)


def compute_stabilisation(
    omega: Float[np.ndarray, " n_omega"],
    responses: Complex[np.ndarray, "n_omega n_outputs n_references"],
    highest_order: int,
) -> tuple[StabilizationPole, ...]:
    """Poles of models of rising order, each compared with the order before.

    Parameters
    ----------
    omega
        Evenly spaced frequencies of the fitted band. [rad/s]
    responses
        Of any quantity per force.
    highest_order
        Of the polynomials; each order gives as many poles as there are references.

    Raises
    ------
    BadInput
        If there are fewer frequencies than a model of this order needs, or the responses
        contradict causality.

    Notes
    -----
    Source: Guillaume, Verboven, Vanlanduit, Van der Auweraer and Peeters (2003), the
    poly-reference least-squares complex frequency-domain estimator (pLSCF): a right matrix
    fraction in z = exp(-j omega dt), reduced normal equations, the constant coefficient of the
    denominator constrained to one, which turns the poles of noise unstable.
    """
    n_omega, _, n_in = responses.shape
    if n_omega < 2 * (highest_order + 1):
        raise BadInput(
            f"{n_omega} frequencies are too few for models of order {highest_order}; take a "
            "wider band or a lower order",
            code="too-few-frequencies",
        )
    if _compute_advance(responses) > _MOST_ADVANCE:
        raise BadInput(
            "the phase of the responses rises through their resonances, which contradicts "
            "causality: they are conjugated, or forces and responses are exchanged; conjugate "
            "their values",
            code="acausal-responses",
        )
    span = float(omega[-1] - omega[0])
    step = np.pi / (1.02 * span)  # the band ends just below half a turn of z
    powers = np.exp(-1j * np.outer((omega - omega[0]) * step, np.arange(highest_order + 1)))
    M = _compute_reduced_normal(powers, responses)
    poles: list[StabilizationPole] = []
    before: list[StabilizationPole] = []
    for order in range(2, highest_order + 1):
        size = n_in * (order + 1)
        found = _compute_poles(M[:size, :size], n_in, order, step, float(omega[0]))
        now = [_compare_orders(order, value, part, before) for value, part in found]
        poles += now
        before = now
    return tuple(pole for pole in poles if omega[0] <= pole.omega <= omega[-1])


def _compute_advance(responses: Complex[np.ndarray, "n_omega n_outputs n_references"]) -> float:
    """Sine of the mean advance of phase from one frequency to the next, weighted by power.

    A resonance turns the response of a stable structure back by half a turn where it is largest,
    a delay turns it back everywhere; phase rises only between resonances, where it is small.
    """
    power = responses[1:] * responses[:-1].conj()
    total = float(np.sum(np.abs(power)))
    return float(np.sum(np.imag(power))) / total if total > 0.0 else 0.0


def _compute_reduced_normal(
    powers: Complex[np.ndarray, "n_omega n_powers"],
    responses: Complex[np.ndarray, "n_omega n_outputs n_references"],
) -> Float[np.ndarray, "n_all n_all"]:
    """Sum over outputs of T - S' R^-1 S, from frequencies of equal weight."""
    n_omega, n_out, n_in = responses.shape
    n_powers = powers.shape[1]
    R = np.real(powers.conj().T @ powers)
    scale = np.sqrt(np.mean(np.abs(responses) ** 2, axis=(0, 2)))
    M = np.zeros((n_powers * n_in, n_powers * n_in))
    for output in range(n_out):
        if scale[output] == 0:
            continue
        one = responses[:, output] / scale[output]
        Y = -(powers[:, :, None] * one[:, None, :]).reshape(n_omega, -1)
        S = np.real(powers.conj().T @ Y)
        M += np.real(Y.conj().T @ Y) - S.T @ np.linalg.solve(R, S)
    return M


def _compute_poles(
    M: Float[np.ndarray, "n n"], n_in: int, order: int, step: float, start: float
) -> list[tuple[complex, np.ndarray]]:
    """Stable poles and participation factors from the block Frobenius form of the denominator."""
    rest = np.linalg.lstsq(M[n_in:, n_in:], -M[n_in:, :n_in], rcond=None)[0]
    blocks = rest.reshape(order, n_in, n_in)  # A_1 ... A_p with A_0 = 1
    frobenius = np.zeros((n_in * order, n_in * order))
    frobenius[n_in:, :-n_in] = np.eye(n_in * (order - 1))
    # With w = 1/z: (1 + A_1 / w + ...) v = 0 is w^p v = -(A_1 w^(p-1) + ... + A_p) v.
    frobenius[:n_in] = -np.concatenate([block.T for block in blocks], axis=1)
    values, vectors = np.linalg.eig(frobenius)
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value == 0:
            continue
        root = complex(np.log(complex(value)) / step)
        pole = complex(root.real, root.imag + start)
        if pole.imag <= start or pole.real >= 0 or -pole.real > MOST_DAMPED * abs(pole):
            continue
        found.append((pole, vector[-n_in:]))
    return found


def _compare(one: np.ndarray, other: np.ndarray) -> float:
    """MAC of two participation vectors."""
    product = abs(np.vdot(one, other)) ** 2
    return float(product / (np.vdot(one, one).real * np.vdot(other, other).real))


def _compare_orders(
    order: int, value: complex, participation: np.ndarray, before: list[StabilizationPole]
) -> StabilizationPole:
    size = abs(value)
    damping = -value.real / size
    near = [pole for pole in before if abs(pole.omega - size) <= _FREQUENCY_TOLERANCE * size]
    is_stable = any(
        abs(pole.damping - damping) <= _DAMPING_TOLERANCE * damping
        and _compare(participation, pole.participation) > _SAME_PARTICIPATION
        for pole in near
    )
    return StabilizationPole(order, value, participation, is_stable, bool(near))


@dataclass(frozen=True, slots=True, eq=False)
class PoleColumn:
    """A column of the stabilisation diagram: the same pole, stable over several orders."""

    value: complex
    participation: Complex[np.ndarray, " n_references"]


def find_columns(poles: tuple[StabilizationPole, ...]) -> tuple[PoleColumn, ...]:
    """Find the columns of a stabilisation diagram, by frequency.

    Of each the pole of the median damping over its orders is returned.
    """
    stable = sorted((pole for pole in poles if pole.stable), key=lambda pole: pole.omega)
    if not stable:
        return ()
    n_orders = len({pole.order for pole in poles})
    columns: list[list[StabilizationPole]] = []
    for pole in stable:
        for column in columns:
            middle = column[len(column) // 2]
            if (
                abs(pole.omega - middle.omega) < _FREQUENCY_TOLERANCE * pole.omega
                and pole.order not in {other.order for other in column}
                and _compare(pole.participation, middle.participation) > _SAME_COLUMN
            ):
                column.append(pole)
                break
        else:
            columns.append([pole])
    found = []
    for column in columns:
        if len(column) < max(3, _LEAST_ORDERS * n_orders):
            continue
        dampings = np.array([pole.damping for pole in column])
        best = column[int(np.argsort(dampings)[len(column) // 2])]
        found.append(PoleColumn(best.value, best.participation))
    return tuple(sorted(found, key=lambda one: abs(one.value)))


def compute_mode_indicator(
    responses: Complex[np.ndarray, "n_omega n_outputs n_references"],
) -> Float[np.ndarray, "n_omega n_indicators"]:
    """Complex mode indicator function: singular values of the responses at each frequency.

    Each mode is a peak; modes of nearly one frequency are peaks of several singular values, if
    there are several references.

    Notes
    -----
    Source: Shih, Tsuei, Allemang and Brown (1988), doi:10.1016/0888-3270(88)90060-X.
    """
    return np.linalg.svd(responses, compute_uv=False)


# --- Modes of a structure from measured frequency responses, with their standard deviations -------


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredModes:
    """Modes identified in the band of frequency responses.

    ``omega`` are natural frequencies [rad/s], ``damping`` damping ratios [1], ``std_omega`` and
    ``std_damping`` their standard deviations by the covariance of the estimator. ``shapes``
    (n_modes, n_outputs) are per unit eta: of one kg m2 of generalised mass where ``scaled`` (a
    driving point was measured), else of largest component one. ``fitted`` is the response of
    these modes and of the out-of-band modes, ``unmodelled`` are frequencies where the residuals
    resemble a mode that is not identified [rad/s].
    """

    omega: Float[np.ndarray, " n_modes"]
    damping: Float[np.ndarray, " n_modes"]
    std_omega: Float[np.ndarray, " n_modes"]
    std_damping: Float[np.ndarray, " n_modes"]
    shapes: Complex[np.ndarray, "n_modes n_outputs"]
    scaled: bool
    fitted: Complex[np.ndarray, "n_omega n_outputs n_references"]
    unmodelled: Float[np.ndarray, " n_unmodelled"]


def identify_modes(
    omega: Float[np.ndarray, " n_omega"],
    responses: Complex[np.ndarray, "n_omega n_outputs n_references"],
    columns: tuple[PoleColumn, ...],
    quantity: str,
    driving: tuple[tuple[int, int], ...] = (),
    line_correlation: float = 1.0,
    std: Float[np.ndarray, "n_omega n_outputs n_references"] | None = None,
    *,
    is_fixed: bool = False,
) -> MeasuredModes:
    """Identify the modes in the band of frequency responses by maximum likelihood.

    Parameters
    ----------
    omega
        Frequencies, all positive. [rad/s]
    responses
        ``displacement``, ``velocity`` or ``acceleration``, as ``quantity`` states, per force.
    columns
        Stable poles, the start values; modes that are missing there are added.
    driving
        Pairs (output, reference) at one point in one direction; they give the scale.
    line_correlation, std
        Of the noise over frequency, see ``fit_modal_model``.
    is_fixed
        Whether the modes are those of ``columns``; none is added or removed.

    Raises
    ------
    BadInput
        If there is no mode, or the quantity is unknown.

    Notes
    -----
    Estimator and covariance: see ``fit_modal_model``.
    """
    if quantity not in POWERS:
        raise BadInput(
            f"a response is of {', '.join(POWERS)}, not '{quantity}'", code="bad-quantity"
        )
    n_in = responses.shape[2]
    model, unmodelled = fit_modal_model(
        omega,
        responses,
        quantity,
        np.array([column.value for column in columns], dtype=complex),
        np.array([column.participation for column in columns], dtype=complex).reshape(-1, n_in),
        line_correlation,
        std,
        is_fixed=is_fixed,
    )
    std_omega, std_damping = model.compute_std()
    size = np.abs(model.poles)
    inside = (size >= omega[0]) & (size <= omega[-1])
    if not inside.any():
        raise BadInput(
            "the responses do not differ from noise by any mode in this band; take a wider band, "
            "or check that they are frequency responses per force",
            code="no-modes",
        )
    poles = model.poles[inside]
    shapes, scaled = _scale_shapes(
        model.shapes[inside], model.participation[inside], poles, driving
    )
    return MeasuredModes(
        omega=np.abs(poles),
        damping=-np.real(poles) / np.abs(poles),
        std_omega=std_omega[inside],
        std_damping=std_damping[inside],
        shapes=shapes,
        scaled=scaled,
        fitted=model.fitted,
        unmodelled=unmodelled,
    )


def _scale_shapes(
    psi: Complex[np.ndarray, "n_modes n_outputs"],
    part: Complex[np.ndarray, "n_modes n_references"],
    roots: Complex[np.ndarray, " n_modes"],
    driving: tuple[tuple[int, int], ...],
) -> tuple[Complex[np.ndarray, "n_modes n_outputs"], bool]:
    """Scale shapes to unit generalised mass by a driving point, else to largest one.

    A residue of a structure with proportional damping is phi_o phi_d / (2 j omega_d m); at a
    driving point it gives phi_d itself.
    """
    if not driving:
        largest = np.argmax(np.abs(psi), axis=1)
        return psi / psi[np.arange(psi.shape[0]), largest][:, None], False
    # The driving point with the largest motion in a mode gives its scale.
    outputs, references = np.array(driving).T
    best = np.argmax(np.abs(psi[:, outputs] * part[:, references]), axis=1)
    modes = np.arange(psi.shape[0])
    residue = part[modes, references[best]] * 2j * np.imag(roots)
    at_point = np.sqrt(psi[modes, outputs[best]] * residue + 0j)
    return psi * (residue / at_point)[:, None], True
