"""Control laws, actuators and delays as state-space systems, also from transfer functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import comb, factorial

import numpy as np
import scipy
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.sensor_models import Instrument
from flexsid.sysid.signals import interpolate

Polynomial = Sequence[float]
_PADE = 3  # order of the approximation of a delay


@dataclass(frozen=True, slots=True)
class Law:
    """Control law u = K y at one airspeed, sign included in K; see ``check_laws``. [m/s]

    ``matrices`` are A, B, C and D.
    """

    airspeed: float
    matrices: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def schedule_law(
    laws: Sequence[Law], airspeed: float, reads: tuple[str, ...], drives: tuple[str, ...]
) -> StateSpace:
    """Interpolate the law at an airspeed, linear between the given ones and constant outside."""
    ordered = sorted(laws, key=lambda law: law.airspeed)
    speeds = np.array([law.airspeed for law in ordered], dtype=float)
    A, B, C, D = (
        interpolate(speeds, np.array(each, dtype=float), airspeed)
        for each in zip(*(law.matrices for law in ordered), strict=True)
    )
    states = tuple(f"law_{k + 1}" for k in range(A.shape[0]))
    return StateSpace(A, B, C, D, states, reads, drives)


def check_laws(laws: Sequence[Law], reads: tuple[str, ...], drives: tuple[str, ...]) -> None:
    """Check that matrices fit each other, the signals read and the surfaces driven.

    Raises
    ------
    BadInput
        With the matrix, its shape and the expected shape.
    """
    if not laws:
        raise BadInput("the controller has no law; give A, B, C, D or transfer functions")
    n = laws[0].matrices[0].shape[0]
    shapes = ((n, n), (n, len(reads)), (len(drives), n), (len(drives), len(reads)))
    for law in laws:
        for name, shape, matrix in zip("ABCD", shapes, law.matrices, strict=True):
            if matrix.shape != shape:
                raise BadInput(
                    f"{name} at {law.airspeed:g} m/s is {matrix.shape[0]} by {matrix.shape[-1]};"
                    f" with {n} states, {len(reads)} signals read and {len(drives)} surfaces driven"
                    f" it must be {shape[0]} by {shape[1]}",
                    code="wrong-shape",
                    matrix=name,
                )
            if not np.all(np.isfinite(matrix)):
                raise BadInput(
                    f"{name} at {law.airspeed:g} m/s has a value that is not finite; give numbers"
                )
    if len({law.airspeed for law in laws}) < len(laws):
        raise BadInput("two laws of the controller have the same airspeed; remove one")


def realise_transfer_functions(
    elements: Mapping[tuple[int, int], tuple[Polynomial, Polynomial]], n_driven: int, n_read: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Realise transfer functions by surface and signal; missing elements are zero.

    Raises
    ------
    BadInput
        If a numerator is of higher degree than its denominator, or a denominator is zero.
    """
    A, B, C = np.zeros((0, 0)), np.zeros((0, n_read)), np.zeros((n_driven, 0))
    D = np.zeros((n_driven, n_read))
    for (row, column), (numerator, denominator) in elements.items():
        a, b, c, d = _realise(numerator, denominator)
        into, out = np.zeros((b.size, n_read)), np.zeros((n_driven, b.size))
        into[:, column], out[row] = b, c
        A, B, C = scipy.linalg.block_diag(A, a), np.vstack([B, into]), np.hstack([C, out])
        D[row, column] += d
    return A, B, C, D


def build_instrument_chain(instruments: Sequence[Instrument], names: tuple[str, ...]) -> StateSpace:
    """Build one instrument or actuator per signal in parallel, without delays."""
    elements = {}
    for k, instrument in enumerate(instruments):
        numerator, denominator = np.ones(1), np.ones(1)
        for element in instrument.elements:
            own = element.polynomials()
            numerator = np.polymul(numerator, own[0])
            denominator = np.polymul(denominator, own[1])
        elements[k, k] = numerator.tolist(), denominator.tolist()
    return _build_parallel(elements, names, "actuator")


def build_delays(seconds: Sequence[float], names: tuple[str, ...]) -> StateSpace:
    """Build delays in parallel as all-pass systems (Pade approximation of third order)."""
    powers = range(_PADE, -1, -1)
    elements: dict[tuple[int, int], tuple[Polynomial, Polynomial]] = {}
    for k, tau in enumerate(seconds):
        if tau > 0.0:
            weights = [
                comb(_PADE, p) * factorial(2 * _PADE - p) / factorial(2 * _PADE) * tau**p
                for p in powers
            ]
            signed = [w * (-1.0) ** p for w, p in zip(weights, powers, strict=True)]
            elements[k, k] = signed, weights
        else:
            elements[k, k] = (1.0,), (1.0,)
    return _build_parallel(elements, names, "delay")


def _build_parallel(
    elements: Mapping[tuple[int, int], tuple[Polynomial, Polynomial]],
    names: tuple[str, ...],
    label: str,
) -> StateSpace:
    A, B, C, D = realise_transfer_functions(elements, len(names), len(names))
    return StateSpace(A, B, C, D, tuple(f"{label}_{k + 1}" for k in range(len(A))), names, names)


def series(first: StateSpace, then: StateSpace) -> StateSpace:
    """Connect two systems in series: outputs of the first to equally named inputs of the second.

    Other inputs of the second remain inputs.
    """
    driven = [then.inputs.index(name) for name in first.outputs]
    free = [k for k in range(len(then.inputs)) if k not in driven]
    n1, n2 = first.A.shape[0], then.A.shape[0]
    B2, D2 = then.B[:, driven], then.D[:, driven]
    return StateSpace(
        A=np.block([[first.A, np.zeros((n1, n2))], [B2 @ first.C, then.A]]),
        B=np.block([[first.B, np.zeros((n1, len(free)))], [B2 @ first.D, then.B[:, free]]]),
        C=np.hstack([D2 @ first.C, then.C]),
        D=np.hstack([D2 @ first.D, then.D[:, free]]),
        states=(*first.states, *then.states),
        inputs=(*first.inputs, *(then.inputs[k] for k in free)),
        outputs=then.outputs,
    )


def discretise(
    A: Float[np.ndarray, "n n"], B: Float[np.ndarray, "n m"], step_s: float
) -> tuple[Float[np.ndarray, "n n"], Float[np.ndarray, "n m"]]:
    """Compute the transition over one step, and the effect of constant inputs over it."""
    n, m = B.shape
    exponential = scipy.linalg.expm(np.block([[A, B], [np.zeros((m, n + m))]]) * step_s)
    return exponential[:n, :n], exponential[:n, n:]


def find_loop_channels(plant: StateSpace, controller: StateSpace) -> tuple[list[int], list[int]]:
    """Find the outputs of a plant that a controller reads, and the inputs that it drives.

    Raises
    ------
    BadInput
        If the plant does not have one of them.
    """
    for names, known, what in (
        (controller.inputs, plant.outputs, "reads"),
        (controller.outputs, plant.inputs, "drives"),
    ):
        missing = [name for name in names if name not in known]
        if missing:
            raise BadInput(
                f"the controller {what} '{missing[0]}', which the model does not have; it has "
                f"{', '.join(known)}",
                code="unknown-channel",
                channel=missing[0],
            )
    read = [plant.outputs.index(name) for name in controller.inputs]
    return read, [plant.inputs.index(name) for name in controller.outputs]


def _realise(
    numerator: Polynomial, denominator: Polynomial
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Realise one transfer function in controllable canonical form, highest power first."""
    den = np.trim_zeros(np.asarray(denominator, dtype=float), "f")
    num = np.trim_zeros(np.asarray(numerator, dtype=float), "f")
    if den.size == 0:
        raise BadInput(
            "a denominator of a transfer function is zero; give at least one coefficient",
            code="bad-transfer",
        )
    n = den.size - 1
    if num.size > den.size:
        raise BadInput(
            f"a transfer function has a numerator of degree {num.size - 1} and a denominator of"
            f" degree {n}; a proper one has at most the same degree",
            code="bad-transfer",
        )
    num = np.concatenate([np.zeros(den.size - num.size), num]) / den[0]
    den = den / den[0]
    A = np.eye(n, k=-1)
    b = np.zeros(n)
    if n:
        A[0] = -den[1:]
        b[0] = 1.0
    return A, b, num[1:] - num[0] * den[1:], float(num[0])
