"""NASA T-2 (GTM) subscale transport as a rigid aircraft with published derivatives.

Values of flights 41 and 15 are those of AIAA 2015-2704, Table 3, as transcribed by a third party.
"""

from __future__ import annotations

import numpy as np

from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.longitudinal import accelerometer_row, gyro_row, vane_row
from flexsid.sysid.model.sensors import stack_rows
from flexsid.sysid.modes import StructuralModes

_FOOT, _SLUG = 0.3048, 14.593902937206364  # m, kg
FLIGHTS: dict[int, dict[str, float]] = {
    41: {"V": 139.1, "rho": 0.0022927, "m": 1.639, "Iyy": 4.651, "natural": 7.112, "zeta": 0.435,
         "CZ_alpha": -3.933, "CZ_q": -15.11, "CZ_de": -0.143,
         "Cm_alpha": -1.667, "Cm_q": -46.36, "Cm_de": -1.676},
    15: {"V": 136.0, "rho": 0.0022765, "m": 1.646, "Iyy": 4.652, "natural": 6.470, "zeta": 0.449,
         "CZ_alpha": -3.828, "CZ_q": -16.39, "CZ_de": -0.125,
         "Cm_alpha": -1.437, "Cm_q": -44.76, "Cm_de": -1.722},
}  # fmt: skip


def build_rigid_model(flight: int) -> tuple[AeroelasticModel, DerivativeTable]:
    """Build the model of a flight and its published derivatives."""
    p = FLIGHTS[flight]
    condition = FlightCondition(
        airspeed=p["V"] * _FOOT,
        density=p["rho"] * _SLUG / _FOOT**3,
        mass=p["m"] * _SLUG,
        pitch_inertia=p["Iyy"] * _SLUG * _FOOT**2,
        area=5.902 * _FOOT**2,
        chord=0.915 * _FOOT,
    )
    none = np.zeros((3, 0))
    origin = (0.0, 0.0, 0.0)
    rows = [
        vane_row((0.5, 0.0, 0.0), none, none, condition),
        gyro_row(none),
        accelerometer_row("z", origin, none, none, condition),
    ]
    empty = np.zeros(0)
    modes = StructuralModes(
        (), empty, empty, empty, (), np.zeros((0, 3, 0)), np.zeros((0, 3, 0)), (), np.zeros((0, 0))
    )
    model = AeroelasticModel(condition, modes, ("de",), stack_rows(("alpha", "q", "az"), rows))
    return model, DerivativeTable.from_names((), ("de",), p)
