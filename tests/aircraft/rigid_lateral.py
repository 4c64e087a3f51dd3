"""Lateral motion of the aircraft of ``rigid_record``, flown at the same time; numpy only."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from rigid_record import AIRSPEED, AREA, DENSITY, MASS, RATE_HZ, SPAN, write_record

DERIVATIVES = {
    "CY_beta": -0.6, "CY_p": 0.0, "CY_r": 0.0, "CY_aileron": 0.05,
    "Cl_beta": -0.09, "Cl_p": -0.45, "Cl_r": 0.12, "Cl_aileron": -0.12,
    "Cn_beta": 0.08, "Cn_p": -0.04, "Cn_r": -0.15, "Cn_aileron": 0.01,
}  # fmt: skip
ROLL_INERTIA, YAW_INERTIA = 4000.0, 11000.0
NOISE = {"beta": 2e-4, "p": 5e-4, "r": 5e-4, "phi": 2e-4, "ay": 0.01}
_UNITS = {"aileron": "rad", "beta": "rad", "p": "rad/s", "r": "rad/s", "phi": "rad", "ay": "m/s2"}
_SENSORS = {"beta": ("vane", "z"), "p": ("gyro", "x"), "r": ("gyro", "z"),
            "phi": ("attitude", "x"), "ay": ("accelerometer", "y")}  # fmt: skip
_STEPS, _GRAVITY = 10, 9.80665


def simulate_lateral(
    duration_s: float, deflect: Callable[[np.ndarray], np.ndarray], seed: int = 1
) -> dict[str, np.ndarray]:
    """Integrate sideslip, roll and yaw from trim by Heun's rule, and add noise of the sensors."""
    rate = RATE_HZ * _STEPS
    time = np.arange(round(duration_s * rate)) / rate
    aileron, d, reduced = deflect(time), DERIVATIVES, SPAN / (2 * AIRSPEED)
    force = 0.5 * DENSITY * AIRSPEED**2 * AREA
    scales = np.array([force / MASS, force * SPAN / ROLL_INERTIA, force * SPAN / YAW_INERTIA])
    motion = np.array([1.0, reduced, reduced])
    table = np.array([[d[f"{row}_{c}"] for c in ("beta", "p", "r")] for row in ("CY", "Cl", "Cn")])
    of_surface = scales * np.array([d[f"{row}_aileron"] for row in ("CY", "Cl", "Cn")])
    system, effect = np.zeros((4, 4)), np.r_[of_surface, 0.0]
    system[:3, :3] = scales[:, None] * table * motion
    side = np.r_[system[0, :3], 0.0], effect[0]  # specific force
    system[0] /= AIRSPEED
    system[0, 2:] += -1.0, _GRAVITY / AIRSPEED
    system[3, 1], effect[0] = 1.0, effect[0] / AIRSPEED
    states = np.zeros((time.size, 4))
    for k in range(time.size - 1):
        slope = system @ states[k] + effect * aileron[k]
        next_slope = system @ (states[k] + slope / rate) + effect * aileron[k + 1]
        states[k + 1] = states[k] + (slope + next_slope) / (2 * rate)
    columns = {"aileron": aileron, **dict(zip(("beta", "p", "r", "phi"), states.T, strict=True))}
    columns["ay"] = states @ side[0] + side[1] * aileron
    columns = {name: values[::_STEPS] for name, values in columns.items()}
    rng = np.random.default_rng(seed)
    for name, std in NOISE.items():
        columns[name] = columns[name] + std * rng.normal(size=columns[name].size)
    return columns


def write_both(folder: Path, columns: dict[str, np.ndarray]) -> tuple[Path, Path]:
    """Write a record of both motions with a mapping that does not state the axis."""
    record, mapping = write_record(folder, columns, "Rigid with ailerons")
    sensors = "".join(
        f'{{ name = "{n}", kind = "{kind}", axis = "{axis}" }}, '
        for n, (kind, axis) in _SENSORS.items()
    )
    inertia = "".join(
        f'mass.{axis}_inertia = {{ values = [{value}], unit = "kg*m2" }}\n'
        for axis, value in (("roll", ROLL_INERTIA), ("yaw", YAW_INERTIA))
    )
    text = mapping.read_text().replace('axis = "longitudinal"\n', "")
    text = text.replace("surfaces = [", 'surfaces = [{ name = "aileron" }, ')
    text = text.replace("sensors = [", f"sensors = [{sensors}").replace(
        "mass.x_cg", f"{inertia}mass.x_cg"
    )
    text += "".join(
        f'[[channels]]\ncolumn = "{name}"\nunit = "{unit}"\n'
        f'role = "{"input" if name == "aileron" else "output"}"\n'
        for name, unit in _UNITS.items()
    )
    mapping.write_text(text)
    return record, mapping
