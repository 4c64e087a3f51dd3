"""Errors of mode shapes at sensors as parameters: their outputs, sensitivities and sizes.

A finite element model has the shape of a mode at a sensor within a few percent at best. An error
e of mode j at an output adds e c (j omega)^p eta_j to it: p = 2 for accelerometers, 1 for gyros and
vanes, 0 for attitudes and strain gauges, the highest power of its row in the sensor equations, and
c the largest coefficient of any mode there, so that maneuvers at other airspeeds share the error.
The rotation of a vane has errors of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.parameters import ROTATION_ERROR, SHAPE_ERRORS, Extra
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.sensors import POSITION


class ShapeErrors:
    """Errors of mode shapes of an experiment.

    Parameters
    ----------
    experiment
        Model, frequencies and instruments.
    errors
        Row among the parameters of single outputs, index in theta, and place of each error.
    """

    def __init__(self, experiment: Experiment, errors: Sequence[tuple[int, int, Extra]]) -> None:
        model = experiment.model
        self._rows = np.array([row for row, _, _ in errors])
        self._index = np.array([k for _, k, _ in errors])
        self._outputs = np.array([e.output for _, _, e in errors])
        self._motions = model.n_rigid + np.array([e.mode for _, _, e in errors])
        units = {kind: _compute_unit_outputs(experiment, kind) for kind in SHAPE_ERRORS}
        self._unit_outputs = np.stack([units[e.kind][:, e.output] for _, _, e in errors], axis=1)

    def add(
        self,
        theta: Float[np.ndarray, " n_theta"],
        sensors: Complex[np.ndarray, "n_omega n_y n_r"],
    ) -> None:
        """Add the errors to the outputs per motion, in place."""
        change = self._unit_outputs * theta[self._index]
        np.add.at(sensors.transpose(1, 2, 0), (self._outputs, self._motions), change.T)

    def differentiate(
        self,
        motion: Complex[np.ndarray, "n_omega n_r"],
        delayed: Complex[np.ndarray, "n_omega n_y"] | None,
        own: Complex[np.ndarray, "n_own n_omega"],
    ) -> None:
        """Write the sensitivities of the outputs to the errors into their rows."""
        change = self._unit_outputs * motion[:, self._motions]
        if delayed is not None:
            change *= delayed[:, self._outputs]
        own[self._rows] = change.T


def list_shape_errors(
    model: AeroelasticModel,
    sizes: Float[np.ndarray, "4 n_y n_modes"],
    std: Mapping[int, float],
) -> dict[str, float]:
    """List the standard deviation of the error of every mode shape at every output, by name.

    Parameters
    ----------
    model
        Sensors and modes.
    sizes
        Coefficients of the sensor equations for shapes of their root mean square at every point: a
        sensor near a node has no smaller error than its neighbours.
    std
        Standard deviation of the shape of each mode relative to its root mean square, by number;
        no errors of modes that are not in it. [1]
    """
    found = {}
    for kind in SHAPE_ERRORS:
        powers, shapes = _collect_shapes(model, kind)
        largest = np.abs(shapes).max(axis=1, initial=0.0)
        for output in np.flatnonzero(largest):
            name, size = model.outputs[output], sizes[powers[output], output] / largest[output]
            for number, own in zip(model.modes.numbers, size.tolist(), strict=True):
                if (error := std.get(number, 0.0) * own) > 0.0:
                    found[f"{kind}_{name}_{number}"] = error
    return found


def _compute_unit_outputs(experiment: Experiment, kind: str) -> Complex[np.ndarray, "n_omega n_y"]:
    """Compute the recorded outputs per unit of an error and of the motion of its mode."""
    powers, shapes = _collect_shapes(experiment.model, kind)
    largest = np.abs(shapes).max(axis=1, initial=0.0)
    unit = (1j * experiment.omega[:, None]) ** (powers - POSITION)
    return largest * unit * experiment.instruments


def _collect_shapes(
    model: AeroelasticModel, kind: str
) -> tuple[np.ndarray, Float[np.ndarray, "n_y n_modes"]]:
    """Return the power of s of a kind of error at each output, and the shapes there.

    The highest one with modal motion, or for rotations that below it: vanes measure translation
    over airspeed and rotation alike. The tilt of an accelerometer is two powers below its
    acceleration, and small against it. The power is an index of ``SensorRows.polynomial``; shapes
    are zero without modal motion.
    """
    of_modes = model.sensors.polynomial[:, :, model.n_rigid :]
    has_motion = (of_modes != 0.0).any(axis=2)
    powers = len(has_motion) - 1 - has_motion[::-1].argmax(axis=0)
    if kind == ROTATION_ERROR:
        powers = powers - 1
    shapes = of_modes[np.maximum(powers, 0), np.arange(powers.size)]
    return powers, np.where(powers[:, None] >= 0, shapes, 0.0)
