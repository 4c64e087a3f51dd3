"""A file and a mapping of a short-period maneuver of a rigid aircraft, made without flexsid.

Two rows of stick and motion: dalpha/dt = Za/V alpha + q + Zd/V d, dq/dt = Ma alpha + Mq q + Md d
(Etkin and Reid, Dynamics of Flight, 3rd ed., 1996, eq. 6.3,1), at constant airspeed in straight
flight, with white noise of the sensors.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.signal import lsim

RATE_HZ = 50.0
AIRSPEED, DENSITY, AREA, CHORD, MASS, INERTIA = 27.0, 1.1, 0.8, 0.3, 10.0, 1.2
DERIVATIVES = {
    "CZ_alpha": -4.6,
    "CZ_elevator": -0.4,
    "Cm_alpha": -0.8,
    "Cm_q": -18.0,
    "Cm_elevator": -1.3,
}
MAPPING = """
flight = {{ number = 1 }}
time = {{ column = "t" }}
channels = [
    {{ column = "elevator", name = "elevator", unit = "rad", role = "input" }},
    {{ column = "alpha", name = "alpha", unit = "rad", role = "output" }},
    {{ column = "q", name = "q", unit = "rad/s", role = "output" }},
]
[maneuver]
label = "{label}"
axis = "longitudinal"
condition.airspeed = {{ value = 27, unit = "m/s" }}
condition.density = {{ value = 1.1, unit = "kg/m3" }}
condition.fuel_fraction = {{ value = 0, unit = "%" }}
[aircraft]
name = "{aircraft}"
surfaces = [{{ name = "elevator" }}]
sensors = [{{ name = "alpha", kind = "vane" }}, {{ name = "q", kind = "gyro" }}]
geometry.area = {{ value = 0.8, unit = "m2" }}
geometry.chord = {{ value = 0.3, unit = "m" }}
geometry.span = {{ value = 2.6, unit = "m" }}
mass.fuel = [0]
mass.mass = {{ values = [10], unit = "kg" }}
mass.pitch_inertia = {{ values = [1.2], unit = "kg*m2" }}
mass.x_cg = {{ values = [0], unit = "m" }}
"""


def write_record(
    folder: Path, aircraft: str = "Rigid", label: str = "doublet", seed: int = 0
) -> tuple[Path, Path]:
    """Write a record of 12 s with two doublets, and its mapping; return both files."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 12.0, 1.0 / RATE_HZ)
    elevator = np.zeros_like(time)
    for start, width in ((1.0, 0.4), (4.0, 0.8)):
        for k, sign in enumerate((1.0, -1.0)):
            begin = start + k * width
            elevator[(time >= begin) & (time < begin + width)] = sign * np.radians(2.0)
    elevator = np.convolve(elevator, np.hanning(9) / np.hanning(9).sum(), "same")
    motion = lsim(_make_model(), elevator, time)[1]
    noise = rng.standard_normal(motion.shape) * (0.0003, 0.001)
    table = np.column_stack((time, elevator, motion + noise))
    record, mapping = folder / f"{label}.csv", folder / f"{label}.toml"
    np.savetxt(record, table, "%.9g", ",", header="t,elevator,alpha,q", comments="")
    mapping.write_text(MAPPING.format(aircraft=aircraft, label=label))
    return record, mapping


def _make_model() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    force = 0.5 * DENSITY * AIRSPEED**2 * AREA
    c = DERIVATIVES
    lift, moment = force / (MASS * AIRSPEED), force * CHORD / INERTIA
    pitch = CHORD / (2.0 * AIRSPEED)
    a = [[lift * c["CZ_alpha"], 1.0], [moment * c["Cm_alpha"], moment * c["Cm_q"] * pitch]]
    b = [[lift * c["CZ_elevator"]], [moment * c["Cm_elevator"]]]
    return np.array(a), np.array(b), np.eye(2), np.zeros((2, 1))
