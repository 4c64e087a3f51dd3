"""Record of a rigid aircraft and the mapping for its import; numpy only."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

RATE_HZ = 100.0
DERIVATIVES = {
    "CZ_alpha": -5.2, "CZ_q": -7.0, "CZ_elevator": -0.4,
    "Cm_alpha": -0.6, "Cm_q": -14.0, "Cm_elevator": -1.3,
}  # fmt: skip
SHORT_PERIOD_HZ = 0.41  # undamped; damping ratio 0.56
AIRSPEED, DENSITY, AREA, CHORD, SPAN, MASS, INERTIA = 60.0, 1.0, 18.0, 1.8, 10.0, 2200.0, 7500.0
NOISE = {"alpha": 2e-4, "q": 5e-4, "theta": 2e-4, "az": 0.01}
_STEPS = 10  # of the integration per sample
_UNITS = {"elevator": "rad", "alpha": "rad", "q": "rad/s", "theta": "rad", "az": "m/s2"}
_KINDS = {"alpha": "vane", "q": "gyro", "theta": "attitude", "az": "accelerometer"}


def write_record(
    folder: Path, columns: dict[str, np.ndarray], aircraft: str = "Rigid"
) -> tuple[Path, Path]:
    """Write a record and the mapping for its import; return both files.

    The condition is that of the aircraft; its airspeed is the column of this name, if any.
    """
    record, mapping = folder / "record.csv", folder / "mapping.toml"
    table = np.stack(list(columns.values()), axis=1)
    np.savetxt(record, table, "%.9g", ",", header=",".join(columns), comments="")
    mapping.write_text(_format_mapping(aircraft, has_airspeed="airspeed" in columns))
    return record, mapping


def make_pulses(time: np.ndarray, *pulses: tuple[float, int]) -> np.ndarray:
    """Pulses of (duration, sign) from 1 s on, with smooth edges and constant between them."""
    edges = 1.0 + np.cumsum([0.0, *(duration for duration, _ in pulses)])
    signs = np.array([0, *(sign for _, sign in pulses), 0])
    steps = signs[np.searchsorted(edges, time, "right")].astype(float)
    edge = np.hanning(round(0.12 / (time[1] - time[0])))
    return np.round(0.03 * np.convolve(steps, edge / edge.sum(), "same"), 6)


def simulate_doublet() -> dict[str, np.ndarray]:
    """Return a record of 7.5 s with a doublet."""
    return simulate(7.5, lambda time: make_pulses(time, (0.6, 1), (0.6, -1)))


def simulate(
    duration_s: float, deflect: Callable[[np.ndarray], np.ndarray], seed: int = 1
) -> dict[str, np.ndarray]:
    """Integrate the short period from trim, and add noise of the sensors."""
    rate = RATE_HZ * _STEPS
    time = np.arange(round(duration_s * rate)) / rate
    elevator = deflect(time)
    d, reduced = DERIVATIVES, CHORD / (2 * AIRSPEED)
    force = 0.5 * DENSITY * AIRSPEED**2 * AREA
    lift, moment = force / (MASS * AIRSPEED), force * CHORD / INERTIA
    system = np.array(
        [[lift * d["CZ_alpha"], 1 + lift * d["CZ_q"] * reduced, 0],
         [moment * d["Cm_alpha"], moment * d["Cm_q"] * reduced, 0],
         [0, 1, 0]]
    )  # fmt: skip
    effect = np.array([lift * d["CZ_elevator"], moment * d["Cm_elevator"], 0])
    states = np.zeros((time.size, 3))
    for k in range(time.size - 1):  # trapezoidal rule for the input, midpoint for the states
        between = (elevator[k] + elevator[k + 1]) / 2
        half = states[k] + (system @ states[k] + effect * elevator[k]) / (2 * rate)
        states[k + 1] = states[k] + (system @ half + effect * between) / rate
    turn = states @ system.T + elevator[:, None] * effect
    rng = np.random.default_rng(seed)
    columns = {"t": time, "elevator": elevator, "alpha": states[:, 0], "q": states[:, 1]}
    columns |= {"theta": states[:, 2], "az": AIRSPEED * (turn[:, 0] - states[:, 1])}
    columns = {name: values[::_STEPS] for name, values in columns.items()}
    for name, std in NOISE.items():
        columns[name] = columns[name] + std * rng.normal(size=columns[name].size)
    return columns


def _format_mapping(aircraft: str, *, has_airspeed: bool) -> str:
    geometry = ", ".join(
        f'{name} = {{ value = {value}, unit = "{unit}" }}'
        for name, value, unit in (("area", AREA, "m2"), ("chord", CHORD, "m"), ("span", SPAN, "m"))
    )
    sensors = ", ".join(f'{{ name = "{n}", kind = "{kind}" }}' for n, kind in _KINDS.items())
    channels = "".join(
        f'[[channels]]\ncolumn = "{name}"\nunit = "{unit}"\n'
        f'role = "{"input" if name == "elevator" else "output"}"\n'
        for name, unit in _UNITS.items()
    )
    airspeed = 'field = "airspeed"' if has_airspeed else f"value = {AIRSPEED}"
    return f"""flight = {{ number = 1 }}
time = {{ column = "t" }}
[maneuver]
label = "pulses"
axis = "longitudinal"
condition.airspeed = {{ {airspeed}, unit = "m/s" }}
condition.density = {{ value = {DENSITY}, unit = "kg/m3" }}
condition.fuel_fraction = {{ value = 0, unit = "%" }}
[aircraft]
name = "{aircraft}"
surfaces = [{{ name = "elevator" }}]
sensors = [{sensors}]
geometry = {{ {geometry} }}
mass.fuel = [0]
mass.mass = {{ values = [{MASS}], unit = "kg" }}
mass.pitch_inertia = {{ values = [{INERTIA}], unit = "kg*m2" }}
mass.x_cg = {{ values = [0], unit = "m" }}
{channels}"""
