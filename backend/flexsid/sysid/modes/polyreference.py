"""Modal parameters from measured frequency responses: poly-reference least squares."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.modes.assurance import compute_mac

_FREQUENCY_TOLERANCE = 0.01  # relative change from one order to the next of a stable frequency
_DAMPING_TOLERANCE = 0.05  # relative change from one order to the next of a stable damping ratio
_SAME_PARTICIPATION = 0.95  # least MAC of participation vectors of a stable pole
_MOST_DAMPED = 0.3  # damping ratio: larger ones are not structural modes
_POWER = {"displacement": 0, "velocity": 1, "acceleration": 2}


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


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredModes:
    """Modes found in frequency responses.

    ``std_omega`` and ``std_damping`` are the scatter over the model orders in which each
    mode was stable, ``shapes`` (n_modes, n_outputs) per unit eta: of one kg m2 of generalised
    mass where ``scaled`` (a driving point was measured), else of largest component one.
    ``fitted`` is the response of these modes and of the out-of-band modes.
    """

    omega: Float[np.ndarray, " n_modes"]
    damping: Float[np.ndarray, " n_modes"]
    std_omega: Float[np.ndarray, " n_modes"]
    std_damping: Float[np.ndarray, " n_modes"]
    shapes: Complex[np.ndarray, "n_modes n_outputs"]
    scaled: bool
    fitted: Complex[np.ndarray, "n_omega n_outputs n_references"]


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
        If there are fewer frequencies than a model of this order needs.

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
            code="too-few-lines",
        )
    span = float(omega[-1] - omega[0])
    step = np.pi / (1.02 * span)
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
        root = complex(np.log(value) / step)
        pole = complex(root.real, root.imag + start)
        if pole.imag <= start or pole.real >= 0 or -pole.real > _MOST_DAMPED * abs(pole):
            continue
        found.append((pole, vector[-n_in:]))
    return found


def _compare_orders(
    order: int, value: complex, participation: np.ndarray, before: list[StabilizationPole]
) -> StabilizationPole:
    size = abs(value)
    damping = -value.real / size
    frequency_holds = stable = False
    for pole in before:
        if abs(pole.omega - size) > _FREQUENCY_TOLERANCE * size:
            continue
        frequency_holds = True
        same = compute_mac(participation[None], pole.participation[None])[0, 0]
        if (
            abs(pole.damping - damping) <= _DAMPING_TOLERANCE * damping
            and same > _SAME_PARTICIPATION
        ):
            stable = True
    return StabilizationPole(order, value, participation, stable, frequency_holds)


@dataclass(frozen=True, slots=True, eq=False)
class PoleColumn:
    """A column of the stabilisation diagram: the same pole, stable over several orders."""

    value: complex
    participation: Complex[np.ndarray, " n_references"]
    n_stable: int
    std_omega: float
    std_damping: float


def find_columns(
    poles: tuple[StabilizationPole, ...], share: float = 0.3
) -> tuple[PoleColumn, ...]:
    """Find the columns of a stabilisation diagram.

    Parameters
    ----------
    poles
        Of all orders.
    share
        Least share of the orders in which a mode must be stable.

    Returns
    -------
    tuple of Cluster
        By frequency; of each the pole of the median damping over its orders.
    """
    stable = sorted((pole for pole in poles if pole.stable), key=lambda pole: pole.omega)
    if not stable:
        return ()
    n_orders = len({pole.order for pole in poles})
    columns: list[list[StabilizationPole]] = []
    for pole in stable:
        for column in columns:
            middle = column[len(column) // 2]
            alike = compute_mac(pole.participation[None], middle.participation[None])[0, 0]
            near = abs(pole.omega - middle.omega) < _FREQUENCY_TOLERANCE * pole.omega
            apart = pole.order not in {other.order for other in column}
            if near and apart and alike > 0.9:
                column.append(pole)
                break
        else:
            columns.append([pole])
    found = []
    for column in columns:
        if len(column) < max(3, share * n_orders):
            continue
        dampings = np.array([pole.damping for pole in column])
        best = column[int(np.argsort(dampings)[len(column) // 2])]
        found.append(
            PoleColumn(
                best.value,
                best.participation,
                len(column),
                float(np.std([pole.omega for pole in column])),
                float(np.std(dampings)),
            )
        )
    return tuple(sorted(found, key=lambda one: abs(one.value)))


def fit_shapes(
    omega: Float[np.ndarray, " n_omega"],
    responses: Complex[np.ndarray, "n_omega n_outputs n_references"],
    columns: tuple[PoleColumn, ...],
    quantity: str,
    driving: tuple[tuple[int, int], ...] = (),
) -> MeasuredModes:
    """Fit shapes to frequency responses, poles and participation factors given.

    Parameters
    ----------
    omega, responses
        Frequencies and responses per force.
    columns
        Modes.
    quantity
        ``displacement``, ``velocity`` or ``acceleration``.
    driving
        Pairs (output, reference) at one point in one direction; they give the scale.

    Raises
    ------
    BadInput
        If there is no mode, or the quantity is unknown.

    Notes
    -----
    Least-squares frequency domain (LSFD): residues are the products of shape and
    participation; modes below and above the band add s^-2 and constant terms.
    """
    if not columns:
        raise BadInput(
            "no pole is stable over enough orders; take more orders or a narrower band",
            code="no-modes",
        )
    if quantity not in _POWER:
        raise BadInput(
            f"a response is of {', '.join(_POWER)}, not '{quantity}'", code="bad-quantity"
        )
    n_omega, n_out, n_in = responses.shape
    s = 1j * omega
    lift = s ** _POWER[quantity]
    roots = np.array([column.value for column in columns])
    part = np.stack([column.participation for column in columns])
    # Unknown psi (complex) and residual terms (real) of each output; n_omega * n_in equations.
    first = lift[:, None] / (s[:, None] - roots)
    second = lift[:, None] / (s[:, None] - roots.conj())
    a = first[:, None, :] * part.T[None]
    b = second[:, None, :] * part.conj().T[None]
    real_columns, imaginary_columns = a + b, 1j * (a - b)
    residual = np.zeros((n_omega, n_in, 2 * n_in), dtype=complex)
    for reference in range(n_in):
        residual[:, reference, reference] = lift / s**2
        residual[:, reference, n_in + reference] = lift
    design = np.concatenate([real_columns, imaginary_columns, residual], axis=2)
    design = design.reshape(n_omega * n_in, -1)
    stacked = np.concatenate([np.real(design), np.imag(design)])
    norm = np.linalg.norm(stacked, axis=0)
    norm[norm == 0] = 1.0
    data = np.transpose(responses, (0, 2, 1)).reshape(n_omega * n_in, n_out)
    both = np.concatenate([np.real(data), np.imag(data)])
    solution = np.linalg.lstsq(stacked / norm, both, rcond=None)[0] / norm[:, None]
    n = len(columns)
    psi = solution[:n] + 1j * solution[n : 2 * n]
    fitted = (design @ solution).reshape(n_omega, n_in, n_out).transpose(0, 2, 1)
    shapes, scaled = _scale_shapes(psi, part, roots, driving)
    return MeasuredModes(
        omega=np.abs(roots),
        damping=-np.real(roots) / np.abs(roots),
        std_omega=np.array([column.std_omega for column in columns]),
        std_damping=np.array([column.std_damping for column in columns]),
        shapes=shapes,
        scaled=scaled,
        fitted=fitted,
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
    shapes = np.empty_like(psi)
    for mode in range(psi.shape[0]):
        # The driving point with the largest motion in this mode gives its scale.
        output, reference = max(
            driving, key=lambda pair: abs(psi[mode, pair[0]] * part[mode, pair[1]])
        )
        factor = 2j * np.imag(roots[mode])
        at_point = np.sqrt(psi[mode, output] * part[mode, reference] * factor + 0j)
        shapes[mode] = psi[mode] * part[mode, reference] * factor / at_point
    return shapes, True
