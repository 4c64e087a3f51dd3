"""Control laws and other given dynamics as state-space systems, also from transfer functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.instruments import Instrument

Polynomial = Sequence[float]
_PADE = 3


@dataclass(frozen=True, slots=True)
class Law:
    """u = K y at one airspeed, the sign in K; as given, until ``check_laws`` has seen it. [m/s]"""

    airspeed: float
    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray


def law_at(
    laws: Sequence[Law], airspeed: float, reads: tuple[str, ...], drives: tuple[str, ...]
) -> StateSpace:
    """A scheduled law at an airspeed: matrices linear between those given, held beyond."""
    ordered = sorted(laws, key=lambda law: law.airspeed)
    speeds = [law.airspeed for law in ordered]
    place = int(np.clip(np.searchsorted(speeds, airspeed), 1, max(1, len(ordered) - 1)))
    low, high = ordered[place - 1], ordered[min(place, len(ordered) - 1)]
    width = high.airspeed - low.airspeed
    share = float(np.clip((airspeed - low.airspeed) / width, 0.0, 1.0)) if width > 0.0 else 0.0
    A, B, C, D = (
        (1.0 - share) * one + share * other
        for one, other in ((low.A, high.A), (low.B, high.B), (low.C, high.C), (low.D, high.D))
    )
    states = tuple(f"law_{k + 1}" for k in range(A.shape[0]))
    return StateSpace(A, B, C, D, states, reads, drives)


def check_laws(laws: Sequence[Law], reads: tuple[str, ...], drives: tuple[str, ...]) -> None:
    """Refuse matrices that do not fit each other or what is read and driven.

    Raises
    ------
    BadInput
        With the matrix, the shape it has and the one it must have.
    """
    if not laws:
        raise BadInput("the controller has no law; give A, B, C, D or transfer functions")
    n = laws[0].A.shape[0]
    for law in laws:
        wanted = {
            "A": (n, n), "B": (n, len(reads)), "C": (len(drives), n), "D": (len(drives), len(reads))
        }  # fmt: skip
        for name, shape in wanted.items():
            matrix = getattr(law, name)
            if matrix.shape != shape:
                raise BadInput(
                    f"{name} at {law.airspeed:g} m/s is {matrix.shape[0]} by {matrix.shape[-1]};"
                    f" with {n} states, {len(reads)} signals read and {len(drives)} surfaces driven"
                    f" it must be {shape[0]} by {shape[1]}",
                    code="wrong-shape",
                    matrix=name,
                )
            if not np.all(np.isfinite(matrix)):
                raise BadInput(f"{name} at {law.airspeed:g} m/s holds what is no number")
    if len({law.airspeed for law in laws}) < len(laws):
        raise BadInput("two laws of the controller have the same airspeed")


def from_transfer(
    elements: Mapping[tuple[int, int], tuple[Polynomial, Polynomial]], n_driven: int, n_read: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Realise transfer functions by surface and signal; what is left out is zero.

    Raises
    ------
    BadInput
        If a numerator is of higher degree than its denominator, or a denominator is zero.
    """
    parts = []
    D = np.zeros((n_driven, n_read))
    for (row, column), (numerator, denominator) in elements.items():
        a, b, c, d = _realise(numerator, denominator)
        D[row, column] += d
        into, out = np.zeros((a.shape[0], n_read)), np.zeros((n_driven, a.shape[0]))
        into[:, column], out[row] = b, c
        parts.append((a, into, out))
    sizes = [a.shape[0] for a, _, _ in parts]
    A = np.zeros((sum(sizes), sum(sizes)))
    start = 0
    for (a, _, _), size in zip(parts, sizes, strict=True):
        A[start : start + size, start : start + size] = a
        start += size
    B = np.concatenate([b for _, b, _ in parts]) if parts else np.zeros((0, n_read))
    C = np.concatenate([c for _, _, c in parts], axis=1) if parts else np.zeros((n_driven, 0))
    return A, B, C, D


def chain_of(instruments: Sequence[Instrument], names: tuple[str, ...]) -> StateSpace:
    """One instrument or actuator per signal, side by side, delays left out."""
    elements = {}
    for k, instrument in enumerate(instruments):
        numerator, denominator = np.ones(1), np.ones(1)
        for element in instrument.elements:
            own = element.polynomials()
            numerator = np.polymul(numerator, own[0])
            denominator = np.polymul(denominator, own[1])
        elements[k, k] = numerator.tolist(), denominator.tolist()
    A, B, C, D = from_transfer(elements, len(names), len(names))
    return StateSpace(A, B, C, D, tuple(f"actuator_{k + 1}" for k in range(len(A))), names, names)


def delay_of(seconds: Sequence[float], names: tuple[str, ...]) -> StateSpace:
    """Delays side by side as all-pass systems (Pade, third order)."""
    powers = range(_PADE, -1, -1)
    elements = {}
    for k, tau in enumerate(seconds):
        if tau > 0.0:
            weights = [
                factorial(2 * _PADE - p)
                * factorial(_PADE)
                / (factorial(2 * _PADE) * factorial(p) * factorial(_PADE - p))
                * tau**p
                for p in powers
            ]
            signed = [w * (-1.0) ** p for w, p in zip(weights, powers, strict=True)]
            elements[k, k] = signed, weights
        else:
            elements[k, k] = (1.0,), (1.0,)
    A, B, C, D = from_transfer(elements, len(names), len(names))
    return StateSpace(A, B, C, D, tuple(f"delay_{k + 1}" for k in range(len(A))), names, names)


def series(first: StateSpace, then: StateSpace) -> StateSpace:
    """The first system's outputs drive the second's inputs of the same names.

    Inputs of the second that the first does not drive stay inputs.
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


def _realise(
    numerator: Polynomial, denominator: Polynomial
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Controllable canonical form of one transfer function, highest power first."""
    den = np.trim_zeros(np.asarray(denominator, dtype=float), "f")
    num = np.trim_zeros(np.asarray(numerator, dtype=float), "f")
    if den.size == 0:
        raise BadInput("a denominator of a transfer function is zero", code="bad-transfer")
    n = den.size - 1
    if num.size > den.size:
        raise BadInput(
            f"a numerator of degree {num.size - 1} stands over a denominator of degree {n}; a law"
            " that can be flown has at most the same",
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
