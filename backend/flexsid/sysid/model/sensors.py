"""Sensor equations: outputs per rigid and elastic motion (Eq. 17), as polynomials in s.

With the motion r of rigid body and modes every output is a known combination
y = (P_-1 / s + P_0 + P_1 s + P_2 s^2) r: theta = q/s, etadot = s eta, and
forces are expressed by the accelerations. No derivative enters P, so that one
model serves all three estimators without C and D of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.model.condition import FlightCondition

INTEGRAL, POSITION, RATE, ACCELERATION = range(4)


@dataclass(frozen=True, slots=True)
class SensorRows:
    """Coefficients of 1/s, 1, s, s^2 for each output; axis 0 is the power."""

    names: tuple[str, ...]
    polynomial: Float[np.ndarray, "4 n_y n_r"]

    def response(
        self, omega: Float[np.ndarray, " n_omega"]
    ) -> Complex[np.ndarray, "n_omega n_y n_r"]:
        """Compute the outputs per unit motion at each frequency. [output unit]

        Raises
        ------
        BadInput
            If a frequency is not above zero.
        """
        w = np.asarray(omega, dtype=float)
        if not np.all(w > 0.0):
            raise BadInput(
                "a frequency is 0 Hz or negative, where motion has no frequency response; begin "
                "the band above 0 Hz",
                code="frequency-at-zero",
            )
        powers = np.stack([1.0 / w, np.ones_like(w), w, w * w], axis=1)
        weighted = np.array([-1j, 1.0, 1j, -1.0])[:, None] * self.polynomial.reshape(4, -1)
        response = (powers @ weighted.view(float)).view(complex)
        return response.reshape(w.size, *self.polynomial.shape[1:])

    def rigid_only(self, n_rigid: int) -> SensorRows:
        """Return the same sensors without elastic response (C_e = 0, Fig. 11)."""
        polynomial = self.polynomial.copy()
        polynomial[:, :, n_rigid:] = 0.0
        return SensorRows(self.names, polynomial)


@dataclass(frozen=True, slots=True, eq=False)
class Mounting:
    """Where a sensor is mounted: position in body axes at the c.g. [m], and the modes there.

    ``translation`` and ``rotation`` are the shapes at its point [m, rad], ``strain`` is that of
    its gauge. What the sensor does not measure is zero.
    """

    position: tuple[float, float, float]
    translation: Float[np.ndarray, "3 n_modes"]
    rotation: Float[np.ndarray, "3 n_modes"]
    strain: Float[np.ndarray, " n_modes"]

    @property
    def n_modes(self) -> int:
        """Number of modes."""
        return self.strain.size


def stack_rows(names: Sequence[str], rows: Sequence[Float[np.ndarray, "4 n_r"]]) -> SensorRows:
    """Stack single rows to one set."""
    return SensorRows(tuple(names), np.stack(rows, axis=1))


def body_axes(
    location: tuple[float, float, float], condition: FlightCondition
) -> tuple[float, float, float]:
    """Transform a structural location (x aft, y right, z up) to body axes at the c.g. [m]"""
    x, y, z = location
    return condition.x_cg - x, y, condition.z_cg - z


def strain_row(
    strain: Float[np.ndarray, " n_modes"], n_rigid: int = 2
) -> Float[np.ndarray, "4 n_r"]:
    """Build the row of a strain gauge from the modal strains, after the rigid-body motions. [1]"""
    row = np.zeros((4, n_rigid + strain.size))
    row[POSITION, n_rigid:] = strain
    return row
