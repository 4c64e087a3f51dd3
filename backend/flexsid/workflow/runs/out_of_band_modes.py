"""Modes beyond the band: what a fit starts from, and where it must not end.

The lines see little more of such a mode than its quasi-static response. Equation error
then gives values that are mostly noise, and a fit that starts there may move the mode into
the band, where it explains noise that all sensors share: likelier, and wrong.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.stability.poles import NamedPole

_MOVED = 0.6  # of the frequency in vacuo: no airspeed lowers one so far


def calmed(
    parameters: Parameters,
    values: Float[np.ndarray, " n_theta"],
    beyond: Sequence[int],
    predicted: DerivativeTable | None,
) -> DerivativeTable:
    """Table of values that noise did not set.

    Parameters
    ----------
    parameters
        Derivatives only.
    values
        Theirs, from equation error.
    beyond
        Places of the modes above the highest line.
    predicted
        Where their derivatives are taken from; without it they keep frequency and damping
        that they have in vacuo.
    """
    n = len(parameters.base.modes)
    rows, columns = parameters.rows, parameters.columns
    place = np.asarray(beyond, dtype=int)
    own = np.isin(rows, 2 + place)
    moved = np.isin(columns, np.r_[2 + place, 2 + n + place])
    elastic = (columns >= 2) & (columns < 2 + 2 * n)
    if predicted is None:
        table = np.where(moved | (own & elastic), 0.0, values)
    else:
        table = np.where(own | moved, predicted.values[rows, columns], values)
    return parameters.table(table)


def strayed(
    poles: Sequence[NamedPole],
    beyond: Sequence[tuple[str, float]],
    highest: float,
) -> tuple[NamedPole, ...]:
    """Poles of modes above the band that a fit has moved into it.

    Parameters
    ----------
    poles
        Of the identified model.
    beyond
        Name and frequency in vacuo of the modes above the highest line. [rad/s]
    highest
        Highest line. [rad/s]
    """
    limits = {name: min(highest, _MOVED * omega) for name, omega in beyond}
    return tuple(p for p in poles if p.frequency < limits.get(p.name, 0.0))


def remarks_on(poles: Sequence[NamedPole], highest: float) -> list[str]:
    """What an analyst must know of modes that have strayed."""
    lowest = {p.name: p.frequency for p in sorted(poles, key=lambda p: -p.frequency)}
    return [
        f"{name} lies above the highest line ({highest / 2 / np.pi:.3g} Hz), but its pole came out "
        f"at {frequency / 2 / np.pi:.3g} Hz, where it explains noise or what the model lacks. "
        "Derivatives and their standard errors mislead: leave the mode out, hold its derivatives, "
        "or give them priors at a prediction."
        for name, frequency in lowest.items()
    ]
