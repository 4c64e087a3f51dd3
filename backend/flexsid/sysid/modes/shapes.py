"""StructuralModes: the modes of one structure at one fuel weight."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flexsid.errors import BadInput


@dataclass(frozen=True, slots=True)
class StructuralModes:
    """Frequency, damping, generalised mass and shapes at the sensor points.

    Translations [m] and rotations [rad] are per unit eta in body axes, strain
    is per unit eta; eta itself is nondimensional. Mode numbers are the FEM's.
    """

    numbers: tuple[int, ...]
    omega: Float[np.ndarray, " n_modes"]
    zeta: Float[np.ndarray, " n_modes"]
    mass: Float[np.ndarray, " n_modes"]
    points: tuple[str, ...]
    translation: Float[np.ndarray, "n_points 3 n_modes"]
    rotation: Float[np.ndarray, "n_points 3 n_modes"]
    gauges: tuple[str, ...]
    strain: Float[np.ndarray, "n_gauges n_modes"]

    def select(self, numbers: tuple[int, ...]) -> StructuralModes:
        """Return the modes with these numbers, in this order.

        Raises
        ------
        BadInput
            If a number is not in the table.
        """
        unknown = [number for number in numbers if number not in self.numbers]
        if unknown:
            raise BadInput(
                f"mode {unknown[0]} is not in the modal table, which has modes "
                f"{', '.join(map(str, self.numbers))}",
                code="unknown-mode",
                mode=unknown[0],
            )
        index = [self.numbers.index(number) for number in numbers]
        return replace(
            self,
            numbers=tuple(numbers),
            omega=self.omega[index],
            zeta=self.zeta[index],
            mass=self.mass[index],
            translation=self.translation[:, :, index],
            rotation=self.rotation[:, :, index],
            strain=self.strain[:, index],
        )

    def tuned(self, factors: Mapping[str, float]) -> StructuralModes:
        """The same modes with factors on frequency and damping, as ``omega_7`` and ``zeta_7``."""
        frequency = np.array([factors.get(f"omega_{number}", 1.0) for number in self.numbers])
        damping = np.array([factors.get(f"zeta_{number}", 1.0) for number in self.numbers])
        return replace(self, omega=self.omega * frequency, zeta=self.zeta * damping)
