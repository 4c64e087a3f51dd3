"""Grey-box model: a function that returns A, B, C, D, its parameters, and its derivatives."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import StateSpace

_COMPLEX_STEP = 1e-20  # of the size of a parameter: no difference is taken, so that none cancels
_STEP = 6e-6  # of the size of a parameter: cube root of the rounding, for central differences
_SAME = 1e-5  # of the larger derivative: the truncation and rounding of central differences
_RESOLVED = 1e-9  # of the largest element of a matrix over a step: differences below are rounding

Matrices = tuple[Any, Any, Any, Any]

StateArrays = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""A, B, C, D, or their derivatives by one parameter."""


@dataclass(frozen=True, slots=True)
class GreyBoxParameter:
    """Parameter of a grey-box model.

    Parameters
    ----------
    name
        Name, by which the function reads its value.
    start
        Starting value.
    unit
        Unit, as text.
    prior
        Value and standard deviation that are known before the fit; None without.
    """

    name: str
    start: float
    unit: str = ""
    prior: tuple[float, float] | None = None

    @property
    def size(self) -> float:
        """Size of steps: that of the starting value, or of its prior where that is zero."""
        spread = 1.0 if self.prior is None else self.prior[1]
        return abs(self.start) or spread


@dataclass(frozen=True, slots=True, kw_only=True)
class GreyBox:
    """A grey-box model: matrices as a function of parameters and condition.

    Parameters
    ----------
    title
        What it models.
    matrices
        Function ``(parameters, condition) -> A, B, C, D`` of the parameters by name and of the
        flight condition (a ``FlightCondition``, or what the caller of the fit gives).
    parameters
        Names, starting values, units and priors.
    inputs, outputs
        Units by name of the channels, in the order of the columns of B and the rows of C.
    states
        Names of the states; by default ``x1`` and so on.
    """

    title: str
    matrices: Callable[[Mapping[str, Any], Any], Matrices]
    parameters: Sequence[GreyBoxParameter]
    inputs: Mapping[str, str]
    outputs: Mapping[str, str]
    states: Sequence[str] = ()

    def __post_init__(self) -> None:
        """Refuse a model without parameters or channels, or with values that are not usable.

        Raises
        ------
        BadInput
            Naming what is missing or wrong.
        """
        for what in ("parameters", "inputs", "outputs"):
            if not getattr(self, what):
                raise _refuse(f"'{self.title}' has no {what}")
        names = [one.name for one in self.parameters]
        for name in names:
            if names.count(name) > 1:
                raise _refuse(f"'{self.title}' has two parameters '{name}'")
        for one in self.parameters:
            if not np.isfinite(one.start):
                raise _refuse(f"the start of '{one.name}' is {one.start}; expected a number")
            if one.prior is not None and not (np.isfinite(one.prior[0]) and one.prior[1] > 0.0):
                raise _refuse(
                    f"the prior of '{one.name}' is {one.prior}; expected a value and a positive "
                    "standard deviation"
                )

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(one.name for one in self.parameters)

    @property
    def starts(self) -> Float[np.ndarray, " n_theta"]:
        """Starting values."""
        return np.array([one.start for one in self.parameters], dtype=float)

    def evaluate(self, theta: Float[np.ndarray, " n_theta"], condition: Any) -> StateSpace:
        """Return the system at parameters and a condition.

        Raises
        ------
        BadInput
            If the shapes do not agree with each other and with the names of states and channels,
            or an element is no real number.
        """
        found = self._call(theta, condition)
        for name, matrix in zip("ABCD", found, strict=True):
            if np.iscomplexobj(matrix):
                raise _refuse(f"'{self.title}' returns a complex {name}; expected real numbers")
        A, B, C, D = found
        states = self._name_states(len(A))
        return StateSpace(A, B, C, D, states, tuple(self.inputs), tuple(self.outputs))

    def _call(self, theta: np.ndarray, condition: Any) -> StateArrays:
        values = dict(zip(self.names, theta.tolist(), strict=True))
        returned = self.matrices(values, condition)
        if not isinstance(returned, tuple) or len(returned) != 4:
            raise _refuse(f"'{self.title}' must return A, B, C, D")
        try:
            arrays = [np.atleast_2d(np.asarray(matrix)) for matrix in returned]
        except ValueError as error:
            raise _refuse(f"a matrix of '{self.title}' has rows of different lengths") from error
        n_x, n_u, n_y = arrays[0].shape[0], len(self.inputs), len(self.outputs)
        shapes = (n_x, n_x), (n_x, n_u), (n_y, n_x), (n_y, n_u)
        for name, matrix, shape in zip("ABCD", arrays, shapes, strict=True):
            if matrix.shape != shape:
                raise _refuse(
                    f"{name} of '{self.title}' is {_show(matrix.shape)}; expected {_show(shape)} "
                    f"for {n_x} states, {n_u} inputs and {n_y} outputs"
                )
            if matrix.dtype.kind not in "biufc":
                raise _refuse(f"{name} of '{self.title}' has an element that is no number")
        kind = complex if any(np.iscomplexobj(one) for one in arrays) else float
        A, B, C, D = (matrix.astype(kind) for matrix in arrays)
        return A, B, C, D

    def _name_states(self, n_states: int) -> tuple[str, ...]:
        if self.states and len(self.states) != n_states:
            raise _refuse(f"'{self.title}' names {len(self.states)} states; A has {n_states}")
        return tuple(self.states) or tuple(f"x{k}" for k in range(1, n_states + 1))


def is_analytic(model: GreyBox, theta: Float[np.ndarray, " n_theta"], condition: Any) -> bool:
    """Return whether the complex step differentiates the matrices at these parameters.

    It does not where the function uses an absolute value, a real part or a comparison of
    the parameters, or converts them to real numbers; central differences then disagree.
    """
    try:
        exact = differentiate(model, theta, condition, analytic=True)
    except (TypeError, ValueError, AttributeError, np.exceptions.ComplexWarning):
        return False
    compared = differentiate(model, theta, condition, analytic=False)
    at = model._call(theta, condition)
    steps = _list_steps(model, theta)
    for one, other, step in zip(exact, compared, steps, strict=True):
        for a, b, matrix in zip(one, other, at, strict=True):
            size = max(float(np.max(np.abs(b), initial=0.0)), float(np.max(np.abs(a), initial=0.0)))
            rounding = _RESOLVED * float(np.max(np.abs(matrix), initial=0.0)) / step
            if not np.all(np.abs(a - b) <= _SAME * size + rounding):
                return False
    return True


def differentiate(
    model: GreyBox, theta: Float[np.ndarray, " n_theta"], condition: Any, *, analytic: bool
) -> list[StateArrays]:
    """Differentiate the matrices by every parameter.

    Parameters
    ----------
    model, theta, condition
        Model, parameters and condition.
    analytic
        Whether by complex step, else by central differences.

    Notes
    -----
    dM/dtheta = Im M(theta + i h) / h for a function M that is analytic and real on the real axis.
    Source: Squire and Trapp (1998), doi:10.1137/S003614459631241X.
    """
    if not analytic:
        return [
            _divide(
                model.evaluate(_move(theta, k, step), condition),
                model.evaluate(_move(theta, k, -step), condition),
                step,
            )
            for k, step in enumerate(_list_steps(model, theta))
        ]
    result = []
    for k, one in enumerate(model.parameters):
        step = _COMPLEX_STEP * one.size
        with warnings.catch_warnings():
            warnings.simplefilter("error", np.exceptions.ComplexWarning)
            found = model._call(_move(theta, k, 1j * step), condition)
        A, B, C, D = (np.imag(matrix) / step for matrix in found)
        result.append((A, B, C, D))
    return result


def _list_steps(model: GreyBox, theta: np.ndarray) -> list[float]:
    sizes = (max(abs(v), one.size) for v, one in zip(theta.tolist(), model.parameters, strict=True))
    return [_STEP * size for size in sizes]


def _move(theta: np.ndarray, k: int, step: float | complex) -> np.ndarray:
    moved = theta.astype(type(step))
    moved[k] += step
    return moved


def _divide(above: StateSpace, below: StateSpace, step: float) -> StateArrays:
    return (
        (above.A - below.A) / (2.0 * step),
        (above.B - below.B) / (2.0 * step),
        (above.C - below.C) / (2.0 * step),
        (above.D - below.D) / (2.0 * step),
    )


def _refuse(message: str) -> BadInput:
    return BadInput(message, code="bad-model")


def _show(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))
