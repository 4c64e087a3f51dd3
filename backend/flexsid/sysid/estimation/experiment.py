"""Experiment: measured spectra and model of one maneuver, and its free parameters."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, coefficients, variables
from flexsid.sysid.spectra.residual_spectrum import compute_noise_correlation

# --- Experiment: measured spectra and model of one maneuver ---------------------------------------

_INDEPENDENT = 0.01  # correlation of two frequencies without effect on a test


@dataclass(frozen=True, slots=True)
class Experiment:
    """Measured spectra of one maneuver.

    ``instruments`` is each output's measured over true response; that of the inputs is
    removed. Frequencies of one ``group`` are contiguous and share a noise covariance: one
    group for OE, one per input for FRE. For data computed from other data points, ``source``
    is the latter, and ``gain`` the factor of their noise in each frequency here. ``edges_s``
    are the times at which the record may begin or end in motion, ``window_s`` begin and end
    of the transformed record, None if unknown. [s] With ``free_ends`` nothing was assumed of the
    motion there; else attitudes keep their last level. ``first_end`` is the number of the first
    of these times among those of all experiments of a fit.
    """

    name: str
    model: AeroelasticModel
    instruments: Complex[np.ndarray, "n_omega n_y"]
    omega: Float[np.ndarray, " n_omega"]
    inputs: Complex[np.ndarray, "n_omega n_u"]
    measured: Complex[np.ndarray, "n_omega n_y"]
    group: np.ndarray
    group_names: tuple[str, ...]
    source: Experiment | None = None
    gain: Complex[np.ndarray, "n_omega n_source"] | None = None
    edges_s: tuple[float, ...] = ()
    window_s: tuple[float, float] | None = None
    free_ends: bool = False
    first_end: int = 0

    def noise_correlation(self) -> Complex[np.ndarray, "n_omega n_omega"] | None:
        """Compute the correlation between frequencies of white noise of the record, if any.

        Notes
        -----
        Data computed from others as G Z have the covariance G C G^H; this is its correlation.
        """
        if self.source is not None and self.gain is not None:
            correlation = self.source.noise_correlation()
            spread = self.gain if correlation is None else self.gain @ correlation
            covariance = spread @ self.gain.conj().T
            size = np.sqrt(np.real(np.diag(covariance)))
            return covariance / np.outer(size, size)
        if self.window_s is None:
            return None
        found = compute_noise_correlation(self.omega, *self.window_s)
        return None if np.abs(found - np.eye(len(found))).max() < _INDEPENDENT else found


# --- Parameters: the free quantities of an estimator and their place in the model -----------------

_EXTRA = re.compile(r"^(delay|scale|omega|zeta|shape_error|rotation_error|shape)_(.+)$")
SHAPE_ERROR, ROTATION_ERROR = SHAPE_ERRORS = ("shape_error", "rotation_error")
"""Kinds of errors of mode shapes at outputs."""


def is_shape_error(name: str) -> bool:
    """Whether a parameter is the error of a mode shape at an output."""
    return name.startswith(tuple(f"{kind}_" for kind in SHAPE_ERRORS))


@dataclass(frozen=True, slots=True)
class Extra:
    """A free quantity other than a derivative.

    ``delay`` [s] and ``scale`` [1] belong to an output; ``omega`` and ``zeta``
    are factors on the table's frequency and damping of a mode; ``shape`` is a
    factor on the shape of one mode at one output, ``shape_error`` is added to it,
    relative to the largest shape of any mode there, and ``rotation_error`` to the
    rotation of a flow vane. An index that a kind does not need is 0.
    """

    kind: str
    output: int = 0
    mode: int = 0

    @property
    def neutral(self) -> float:
        """Value without effect."""
        return 0.0 if self.kind in ("delay", *SHAPE_ERRORS) else 1.0


@dataclass(frozen=True, slots=True)
class Parameters:
    """Free quantities by name, with the table of all fixed derivatives.

    The first ``rows.size`` entries of theta are derivatives (row, column of the
    table), the rest are ``extras``.
    """

    names: tuple[str, ...]
    start: Float[np.ndarray, " n_theta"]
    base: DerivativeTable
    rows: np.ndarray
    columns: np.ndarray
    extras: tuple[Extra, ...]

    def table(self, theta: Float[np.ndarray, " n_theta"]) -> DerivativeTable:
        """The full table of derivatives at theta."""
        values = self.base.values.copy()
        values[self.rows, self.columns] = theta[: self.rows.size]
        return replace(self.base, values=values)


def select_parameters(
    start: DerivativeTable,
    free: Sequence[str] | None,
    outputs: tuple[str, ...],
    extras: Sequence[str] = (),
    fixed: Mapping[str, float] | None = None,
) -> Parameters:
    """Select the free parameters and fix the others.

    Parameters
    ----------
    start
        Starting values; derivatives that are not free are fixed there.
    free
        Names of the free derivatives; None frees every derivative of the table.
    outputs
        Names of the outputs of delays and scale factors.
    extras
        Names such as ``delay_q``, ``scale_alpha``, ``omega_7``, ``zeta_7``,
        ``shape_q_7``, ``shape_error_q_7``.
    fixed
        Values of derivatives that are fixed at another value than the start.

    Raises
    ------
    BadInput
        If a name is unknown, or no parameter is free.
    """
    row_names = coefficients(start.modes, start.body)
    column_names = variables(start.modes, start.inputs, start.body)
    places = {
        f"{row}_{column}": (i, j)
        for i, row in enumerate(row_names)
        for j, column in enumerate(column_names)
    }
    fixed = dict(fixed or {})
    for name in [*fixed, *(free or ())]:
        if name not in places:
            raise BadInput(
                f"'{name}' is not a derivative of this model; it has rows "
                f"{', '.join(row_names)} and columns {', '.join(column_names)}",
                code="unknown-derivative",
                name=name,
            )
    for name, value in fixed.items():
        if not np.isfinite(value):
            raise BadInput(
                f"'{name}' is to be fixed at {value}; give a finite number",
                code="not-finite",
                name=name,
            )
    selected = [name for name in (free if free is not None else places) if name not in fixed]
    values = start.values.copy()
    for name, value in fixed.items():
        values[places[name]] = value
    found = tuple(_parse_extra(name, outputs, start.modes) for name in extras)
    names = (*selected, *extras)
    if not names:
        raise BadInput(
            "no parameter is free; select at least one derivative to estimate",
            code="no-free-parameter",
        )
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise BadInput(f"'{twice}' occurs twice among the free parameters; remove one", name=twice)
    where = np.array([places[name] for name in selected], dtype=int).reshape(-1, 2)
    theta = np.concatenate([values[where[:, 0], where[:, 1]], [x.neutral for x in found]])
    return Parameters(
        names=names,
        start=theta,
        base=replace(start, values=values),
        rows=where[:, 0],
        columns=where[:, 1],
        extras=found,
    )


def _parse_extra(name: str, outputs: tuple[str, ...], modes: tuple[int, ...]) -> Extra:
    match = _EXTRA.match(name)
    if match is None:
        raise BadInput(
            f"'{name}' is neither a derivative nor one of delay_<output>, scale_<output>, "
            "omega_<mode>, zeta_<mode>, shape_<output>_<mode>",
            code="unknown-parameter",
            name=name,
        )
    kind, rest = match[1], match[2]
    output, mode = rest, None
    if kind in ("omega", "zeta"):
        output, mode = None, rest
    elif kind in ("shape", *SHAPE_ERRORS):
        output, _, mode = rest.rpartition("_")
        if not (output and mode.isdigit()):
            raise BadInput(
                f"'{name}' should be shape_<output>_<mode>, such as shape_{outputs[0]}_"
                f"{modes[0] if modes else 7}",
                code="unknown-parameter",
                name=name,
            )
    if output is not None and output not in outputs:
        raise BadInput(
            f"'{name}' belongs to output '{output}', which is not fitted; outputs are "
            f"{', '.join(outputs)}",
            code="unknown-output",
            name=name,
        )
    if mode is not None and (not mode.isdigit() or int(mode) not in modes):
        raise BadInput(
            f"'{name}' belongs to mode {mode}, which is not in the model; modes are "
            f"{', '.join(map(str, modes)) or 'none'}",
            code="unknown-mode",
            name=name,
        )
    return Extra(
        kind,
        0 if output is None else outputs.index(output),
        0 if mode is None else modes.index(int(mode)),
    )


# --- Physical limits of the parameters of instruments and structure -------------------------------

LONGEST_DELAY_S = 0.2  # no recorder delays a channel longer
_LIMITS = {
    "delay": (-LONGEST_DELAY_S, LONGEST_DELAY_S),
    "scale": (0.0, np.inf),  # a sensor of the wrong sign is corrected, not estimated
    "omega": (0.0, np.inf),
    "zeta": (0.0, np.inf),  # a structure in vacuo is damped
}


def find_parameters_at_limits(
    parameters: Parameters, theta: Float[np.ndarray, " n_theta"]
) -> Bool[np.ndarray, " n_theta"]:
    """Find the parameters at or beyond a limit; derivatives and shapes have none.

    Parameters
    ----------
    parameters, theta
        Free parameters and their estimated values.
    """
    found = np.zeros(theta.size, dtype=bool)
    for k, extra in enumerate(parameters.extras, start=parameters.rows.size):
        low, high = _LIMITS.get(extra.kind, (-np.inf, np.inf))
        found[k] = not low < theta[k] < high
    return found
