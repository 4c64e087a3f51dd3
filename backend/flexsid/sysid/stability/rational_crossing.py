"""Flutter of a frequency shape by rational functions: a second method beside p-k."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.sensors import SensorRows
from flexsid.sysid.stability.root_tracking import FlutterCrossing
from flexsid.sysid.stability.state_family import Aeroelastic

AGREEMENT = 0.003
"""Of the flutter speed, within which both methods agree: 0.02 % for 16 to 80 strips of FLEX-28U."""

_REACHES = (0.005, 0.02, 0.1)  # of the airspeed, to either side: the search for the crossing


def find_rational_crossing(
    aircraft: Aeroelastic, crossing: FlutterCrossing, density: float
) -> tuple[float, float] | None:
    """Find the flutter speed of the state matrix with lag states near a p-k crossing.

    Parameters
    ----------
    aircraft
        With a frequency shape.
    crossing
        Of the p-k method.
    density
        Of the air. [kg/m3]

    Returns
    -------
    tuple
        Airspeed [m/s] and frequency [rad/s]; None if no root crosses the axis within 10 % of the
        airspeed.

    Notes
    -----
    The root nearest to the crossing, with the trim of the known condition as in the p-k method;
    lags as in ``fit_rational_functions``.
    """
    assert aircraft.shape is not None
    table, body = aircraft.derivatives, aircraft.derivatives.body
    shape = aircraft.shape.select(table.modes, table.inputs)
    sensors = SensorRows((), np.zeros((4, 0, body.size + len(table.modes))))

    def compute_root(airspeed: float) -> complex:
        condition = replace(aircraft.condition, airspeed=airspeed, density=density)
        model = AeroelasticModel(condition, aircraft.modes, table.inputs, sensors, body, shape)
        roots = np.linalg.eigvals(model.state_space(table).A)
        return complex(roots[np.argmin(np.abs(roots - 1j * crossing.frequency))])

    for reach in _REACHES:
        low, high = crossing.airspeed * (1.0 - reach), crossing.airspeed * (1.0 + reach)
        if compute_root(low).real < 0.0 <= compute_root(high).real:
            at = float(brentq(lambda V: compute_root(V).real, low, high, xtol=1e-6 * high))
            return at, compute_root(at).imag
    return None
