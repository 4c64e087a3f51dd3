"""Axes of sensors and symmetry of surfaces: declared, else from names."""

from __future__ import annotations

import re

from flexsid.records.aircraft import Aircraft, Sensor, SensorKind, SurfaceSymmetry
from flexsid.sysid.preparation.symmetry import find_pairs

PITCH_AXIS = "y"
"""Axis about which gyros, attitudes and vanes take part in a longitudinal motion."""

_NAMED: dict[SensorKind, tuple[tuple[str, str], ...]] = {
    SensorKind.GYRO: (
        ("x", r"p|rollrate|roll|gyrox|wx"),
        ("y", r"q|pitchrate|pitch|gyroy|wy"),
        ("z", r"r|yawrate|yaw|gyroz|wz"),
    ),
    SensorKind.ATTITUDE: (
        ("x", r"phi|roll|rollangle|bank|bankangle"),
        ("y", r"the|theta|pitch|pitchangle"),
        ("z", r"psi|yaw|yawangle|heading"),
    ),
    SensorKind.VANE: (("y", r"alpha|alfa|aoa"), ("z", r"beta|aos|sideslip")),
    SensorKind.ACCELEROMETER: tuple((axis, rf"(?:acc|accel|a|n){axis}") for axis in "xyz"),
}
"""Axis by common names of sensors of each kind."""

_ANTISYMMETRIC = re.compile(
    r"ail|ailerons?|da|rdr|rud|rudders?|dr|asym|antisym|antisymmetric|anti|diff|differential"
)
_SIDE = re.compile(r"l|r|lh|rh|left|right")
_STRIP = re.compile(r"(?:bf|wf\d?)(?P<part>[alrs])")  # names of this software; see nomenclature
_PARTS: dict[str, SurfaceSymmetry] = {
    "a": "antisymmetric",
    "s": "symmetric",
    "l": "single",
    "r": "single",
}


def find_axis_in_name(kind: SensorKind, name: str) -> str | None:
    """Find the axis in the name of a sensor: x for ``p_egi``, z for ``beta``; else None.

    The first part of a name decides, or two together (``roll_rate_2``), else the last
    (``egi_p``).
    """
    parts = name.lower().split("_")
    for written in ("".join(parts[:2]), parts[0], "".join(parts[-2:]), parts[-1]):
        for axis, pattern in _NAMED.get(kind, ()):
            if re.fullmatch(pattern, written):
                return axis
    return None


def find_contradicting_axis(sensor: Sensor) -> str | None:
    """Find an axis in the name of a sensor that contradicts its record."""
    named = find_axis_in_name(sensor.kind, sensor.name)
    return None if named == sensor.axis else named


def get_symmetry(aircraft: Aircraft, name: str) -> SurfaceSymmetry:
    """Return the symmetry of a surface: declared, else from its name, else a symmetric pair.

    Single surfaces are those called left or right (``elevator_l``, ``wf1r``), antisymmetric
    ones ailerons, rudders and half differences (``wf1a``).
    """
    declared: SurfaceSymmetry | None = next(
        (s.symmetry for s in aircraft.surfaces if s.name == name), None
    )
    return declared or _symmetry_in_name(name, [surface.name for surface in aircraft.surfaces])


def symmetric_surfaces(aircraft: Aircraft) -> tuple[str, ...]:
    """Surfaces that excite symmetric motion."""
    names = (surface.name for surface in aircraft.surfaces)
    return tuple(name for name in names if get_symmetry(aircraft, name) != "antisymmetric")


def _symmetry_in_name(name: str, others: list[str]) -> SurfaceSymmetry:
    lower = name.lower()
    own = _STRIP.fullmatch(lower)
    if own is not None:
        return _PARTS[own["part"]]
    words = lower.split("_")
    if any(_SIDE.fullmatch(word) for word in words[1:]) or words[0] in ("left", "right"):
        return "single"
    if any(name in pair[:2] for pair in find_pairs(others)):
        return "single"
    if any(_ANTISYMMETRIC.fullmatch(word) for word in words):
        return "antisymmetric"
    if lower.endswith("a") and f"{lower[:-1]}s" in [other.lower() for other in others]:
        return "antisymmetric"
    return "symmetric"
