"""Sensor models, and the instrument between a quantity and its samples.

A further type is one more value of ``_BUILT_IN``, or one that an installed package declares in
the entry points ``flexsid.sensors``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Literal

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.extensions import SENSORS, ExtensionFailed, load_extensions, report_errors
from flexsid.sysid.model import airspeed, lateral, longitudinal
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.rigid_body import Mounting, RigidBody, strain_row
from flexsid.units import dimension

# --- Sensor models: everything that distinguishes one type of sensor, in one value each -----------

Row = Callable[[Mounting, FlightCondition], Float[np.ndarray, "4 n_r"]]
"""Row of a sensor: coefficients of 1/s, 1, s and s2 for the motions of rigid body and modes."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SensorModel:
    """A type of sensor.

    Attributes
    ----------
    kind
        Name of the type, as in the records of aircraft.
    units
        SI units of its channels, the usual one first.
    noise_std
        Standard deviation of the noise where the aircraft record has none. [units[0]]
    rows
        Rows by axis of the model (``longitudinal``, ``lateral``) and axis of the sensor; those
        that are missing measure no motion of that axis. An axis with slow motions has those of
        its fast ones by default.
    senses
        What it measures of a mode; strain is that of gauges, the others are those of points.
    reversed_axes
        Axes whose signal changes sign under reflection in the plane of symmetry.
    calibration
        ``reference`` defines the scale of a comparison of sensors, ``estimated`` is scaled by the
        others, ``uncertain`` is known no better than mode shapes and not checked.
    quantities
        Measured rigid-body quantity by axis, for messages.
    names
        Usual names by axis, regular expressions of lower-case names.
    usual_axis
        Axis where neither the record nor the name has one.
    package
        Package that declares it; empty for those of flexsid.
    """

    kind: str
    units: tuple[str, ...]
    noise_std: float
    rows: Mapping[str, Mapping[str, Row]]
    senses: Literal["translation", "rotation", "strain"]
    reversed_axes: str = ""
    calibration: Literal["reference", "estimated", "uncertain"] = "reference"
    quantities: Mapping[str, str] = field(default_factory=dict[str, str])
    names: Mapping[str, str] = field(default_factory=dict[str, str])
    usual_axis: str = "y"
    package: str = ""

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Dimensions of the units."""
        return tuple(dimension(unit) for unit in self.units)

    def mirror_sign(self, axis: str) -> float:
        """Right over left sensor in a symmetric motion: 1 or -1."""
        return -1.0 if axis in self.reversed_axes else 1.0

    def measures(self, axis: str, body: RigidBody) -> bool:
        """Whether a sensor of this axis can be an output of the model of a rigid body."""
        return self._find_row(axis, body) is not None

    def _find_row(self, axis: str, body: RigidBody) -> Row | None:
        """Find the row in the model of a rigid body, else that of its fast motions."""
        own, fast = self.rows.get(body.axis, {}).get(axis), body.fast
        of_fast = None if fast is None else self.rows.get(fast.axis, {}).get(axis)
        if own is not None or fast is None or of_fast is None:
            return own
        first, n_slow = fast.size, body.size - fast.size

        def extend(at: Mounting, condition: FlightCondition) -> Float[np.ndarray, "4 n_r"]:
            return np.insert(of_fast(at, condition), [first] * n_slow, 0.0, axis=1)

        return extend

    def measures_rigid_body(self, axis: str, body: RigidBody) -> bool:
        """Whether it measures the motion of this rigid body wherever it is mounted."""
        is_own = (axis in self.reversed_axes) == (body.symmetry == "antisymmetric")
        return self.senses != "strain" and is_own and self.measures(axis, body)

    def find_axis(self, name: str) -> str | None:
        """Find the axis in the name of a sensor: x for ``p_egi``, z for ``beta``; else None.

        The first part of a name decides, or two together (``roll_rate_2``), else the last
        (``egi_p``).
        """
        parts = name.lower().split("_")
        for written in ("".join(parts[:2]), parts[0], "".join(parts[-2:]), parts[-1]):
            for axis, pattern in self.names.items():
                if re.fullmatch(pattern, written):
                    return axis
        return None

    def build_row(
        self, axis: str, body: RigidBody, at: Mounting, condition: FlightCondition
    ) -> Float[np.ndarray, "4 n_r"]:
        """Build the row of a sensor for the motions of a rigid body and the modes.

        Raises
        ------
        BadInput
            If it measures no motion of the axis.
        ExtensionFailed
            If the row of another package fails, or is not finite and of shape
            (4, body.size + n_modes).
        """
        build = self._find_row(axis, body)
        if build is None:
            raise BadInput(
                f"a {self.kind} of axis {axis} measures no {body.axis} motion; remove it from the "
                "outputs",
                code="axis-not-supported",
            )
        with report_errors(self.package):
            row = build(at, condition)
        shape = (4, body.size + at.n_modes)
        if self.package and not (np.shape(row) == shape and np.isfinite(row).all()):
            raise ExtensionFailed(
                f"the package {self.package} has no valid row of a {self.kind} of axis {axis}: it "
                f"has shape {np.shape(row)}, expected {shape} of finite numbers",
                package=self.package,
            )
        return row


def find_sensor_model(kind: str) -> SensorModel:
    """Find the model of a type of sensor.

    Raises
    ------
    BadInput
        If neither flexsid nor an installed package has it.
    ExtensionFailed
        If a package fails.
    """
    models = load_sensor_models()
    if kind not in models:
        raise BadInput(
            f"there is no type of sensor '{kind[:40]}'; types are {', '.join(models)}",
            code="unknown-sensor-type",
            kind=kind[:40],
        )
    return models[kind]


@cache
def load_sensor_models() -> Mapping[str, SensorModel]:
    """Load all types of sensors by name, first those of flexsid.

    Raises
    ------
    ExtensionFailed
        If a package cannot be imported, or has a type that exists already.
    """
    models = {model.kind: model for model in _BUILT_IN}
    for _, package, model in load_extensions(SENSORS, SensorModel):
        if model.kind in models:
            raise ExtensionFailed(
                f"the package {package} adds the type of sensor '{model.kind}', which "
                f"{models[model.kind].package or 'flexsid'} has already; rename it",
                package=package,
            )
        with report_errors(package):
            assert model.dimensions  # of known units
        models[model.kind] = replace(model, package=package)
    return models


def _by_axis(row: Callable[..., Float[np.ndarray, "4 n_r"]], axes: str) -> dict[str, Row]:
    return {axis: partial(row, axis) for axis in axes}


ACCELEROMETER = SensorModel(
    kind="accelerometer",
    units=("m/s2",),
    noise_std=0.05,
    rows={
        "longitudinal": _by_axis(longitudinal.mounted_accelerometer_row, "xyz"),
        "lateral": _by_axis(lateral.accelerometer_row, "xyz"),
        "longitudinal-airspeed": _by_axis(airspeed.accelerometer_row, "xyz"),
    },
    senses="translation",
    reversed_axes="y",
    names={axis: rf"(?:acc|accel|a|n){axis}" for axis in "xyz"},
    usual_axis="z",
)

GYRO = SensorModel(
    kind="gyro",
    units=("rad/s",),
    noise_std=1e-3,
    rows={
        "longitudinal": {"y": lambda at, _: longitudinal.gyro_row(at.rotation)},
        "lateral": _by_axis(lateral.gyro_row, "xz"),
    },
    senses="rotation",
    reversed_axes="xz",
    calibration="estimated",
    quantities={"x": "roll rate p", "y": "pitch rate q", "z": "yaw rate r"},
    names={
        "x": r"p|rollrate|roll|gyrox|wx",
        "y": r"q|pitchrate|pitch|gyroy|wy",
        "z": r"r|yawrate|yaw|gyroz|wz",
    },
)

ATTITUDE = SensorModel(
    kind="attitude",
    units=("rad",),
    noise_std=1e-3,
    rows={
        "longitudinal": {"y": lambda at, _: longitudinal.attitude_row(at.rotation)},
        "lateral": {"x": lateral.bank_angle_row},
    },
    senses="rotation",
    reversed_axes="xz",
    quantities={"x": "bank angle phi", "y": "pitch angle theta", "z": "heading psi"},
    names={
        "x": r"phi|roll|rollangle|bank|bankangle",
        "y": r"the|theta|pitch|pitchangle",
        "z": r"psi|yaw|yawangle|heading",
    },
)

VANE = SensorModel(
    kind="vane",
    units=("rad",),
    noise_std=1e-3,
    rows={
        "longitudinal": {
            "y": lambda at, condition: longitudinal.vane_row(
                at.position, at.translation, at.rotation, condition
            )
        },
        "lateral": {"z": lateral.vane_row},
    },
    senses="rotation",
    reversed_axes="xz",
    calibration="estimated",
    quantities={"y": "angle of attack alpha", "z": "sideslip beta"},
    names={"y": r"alpha|alfa|aoa", "z": r"beta|aos|sideslip"},
)

STRAIN = SensorModel(
    kind="strain",
    units=("strain", "1"),
    noise_std=1e-6,
    rows={
        "longitudinal": dict.fromkeys("xyz", lambda at, _: strain_row(at.strain, 2)),
        "lateral": dict.fromkeys("xyz", lambda at, _: strain_row(at.strain, 3)),
    },
    senses="strain",
    calibration="uncertain",
)

AIRSPEED_PROBE = SensorModel(
    kind="airspeed",
    units=("m/s",),
    noise_std=0.2,
    rows={"longitudinal-airspeed": {"x": airspeed.airspeed_row}},
    senses="translation",
    quantities={"x": "airspeed V"},
    names={"x": r"airspeed|tas|vtas|vt"},
    usual_axis="x",
)

_BUILT_IN = (ACCELEROMETER, GYRO, ATTITUDE, VANE, STRAIN, AIRSPEED_PROBE)


# --- Instrument: sensor dynamics, filters and delay between a quantity and its samples ------------


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondOrder:
    """Sensor with unit static gain: wn^2 / (s^2 + 2 zeta wn s + wn^2)."""

    natural_frequency: float
    damping: float

    def polynomials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return numerator and denominator in s, highest power first."""
        wn = self.natural_frequency
        return np.array([wn**2]), np.array([1.0, 2.0 * self.damping * wn, wn**2])


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrder:
    """Lag with unit static gain: wc / (s + wc)."""

    corner: float

    def polynomials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return numerator and denominator in s, highest power first."""
        return np.array([self.corner]), np.array([1.0, self.corner])


@dataclass(frozen=True, slots=True, kw_only=True)
class Butterworth:
    """Analog low-pass filter of given order and corner. [rad/s]"""

    order: int
    corner: float

    def polynomials(self) -> tuple[np.ndarray, np.ndarray]:
        """Return numerator and denominator in s, highest power first."""
        # Without scipy.signal, whose import takes seconds.
        angles = np.pi * (2 * np.arange(self.order) + self.order + 1) / (2 * self.order)
        denominator = np.poly(self.corner * np.exp(1j * angles)).real
        return denominator[-1:], denominator


Element = SecondOrder | FirstOrder | Butterworth


@dataclass(frozen=True, slots=True, kw_only=True)
class Instrument:
    """A chain of elements followed by a pure delay. [s]"""

    elements: tuple[Element, ...] = ()
    delay_s: float = 0.0

    def response(self, omega: Float[np.ndarray, " n_omega"]) -> Complex[np.ndarray, " n_omega"]:
        """Compute the response of the whole chain, delay included: measured over true. [1]"""
        s = 1j * np.asarray(omega, dtype=float)
        response = np.exp(-s * self.delay_s)
        for element in self.elements:
            numerator, denominator = element.polynomials()
            response = response * np.polyval(numerator, s) / np.polyval(denominator, s)
        return response
