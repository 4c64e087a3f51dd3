"""Records of a rigid aircraft by exact nonlinear kinematics, and the mapping for their import.

Numpy only. Rates of the body and airspeed are chosen, incidences and attitude integrated, and the
specific force is what they imply: nothing is linear, and the airspeed varies.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

RATE_HZ, DURATION_S, FINE = 50.0, 16.0, 10
GRAVITY, DENSITY = 9.80665, 0.9
AREA, CHORD, SPAN = 12.0, 1.2, 10.0
VANE, ACCELEROMETER = (3.0, 0.0, 0.0), (0.8, 0.0, 0.1)  # ahead of the c.g., right, below [m]
UNITS = {
    **dict.fromkeys(("alpha", "beta", "theta", "phi"), "rad"), **dict.fromkeys("pqr", "rad/s"),
    **dict.fromkeys(("ax", "ay", "az"), "m/s2"),
}  # fmt: skip
NOISE = {
    **dict.fromkeys(("alpha", "beta"), 4e-4), **dict.fromkeys(("theta", "phi"), 3e-4),
    **dict.fromkeys("pqr", 8e-4), **dict.fromkeys(("ax", "ay", "az"), 0.02), "airspeed": 0.05,
}  # fmt: skip
SENSORS = {
    "alpha": ("vane", "y"), "beta": ("vane", "z"), "theta": ("attitude", "y"),
    "phi": ("attitude", "x"), "p": ("gyro", "x"), "q": ("gyro", "y"), "r": ("gyro", "z"),
    "ax": ("accelerometer", "x"), "ay": ("accelerometer", "y"), "az": ("accelerometer", "z"),
}  # fmt: skip
AXES = {
    "longitudinal": ("alpha", "q", "theta", "az"),
    "lateral": ("beta", "p", "r", "phi", "ay"),
    "combined": tuple(UNITS),
}


@dataclass(frozen=True, slots=True)
class PlantedFault:
    """What the recorder does to one sensor; ``arm`` [m] is ahead of the declared place."""

    sensor: str = ""
    delay_s: float = 0.0
    scale: float = 1.0
    arm: float = 0.0
    held_hz: float = 0.0


def record_flight(
    seed: int,
    axis: str = "longitudinal",
    fault: PlantedFault | None = None,
    airspeed_change: float = 0.3,
    noise: float = 1.0,
) -> dict[str, np.ndarray]:
    """Return columns of one record by name, with ``t``, ``elevator`` and ``airspeed``.

    ``noise`` multiplies that of all sensors.
    """
    fault = fault or PlantedFault()
    rng = np.random.default_rng(seed)
    time, motion = _fly(rng, axis, airspeed_change)
    places = {"alpha": VANE, "beta": VANE, **dict.fromkeys(("ax", "ay", "az"), ACCELEROMETER)}
    columns = {"t": time[::FINE]}
    columns["elevator"] = 0.05 * motion["elevator"][::FINE]
    for name in (*AXES[axis], "airspeed"):
        ahead = fault.arm if name == fault.sensor else 0.0
        place = np.array(places.get(name, (0.0, 0.0, 0.0)))
        place[0] += ahead
        true = _measure(name, motion, place)
        late = fault.delay_s if name == fault.sensor else 0.0
        values = np.interp(time[::FINE] - late, time, true)
        values = values + noise * NOISE[name] * rng.normal(size=values.size)
        if name == fault.sensor:
            values = values * fault.scale
            if fault.held_hz:
                every = round(RATE_HZ / fault.held_hz)
                values = values[np.arange(values.size) // every * every]
        columns[name] = values
    return columns


def _fly(
    rng: np.random.Generator, axis: str, airspeed_change: float
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    rate = RATE_HZ * FINE
    time = np.arange(round(DURATION_S * rate)) / rate
    level = 40.0 * rng.uniform(0.7, 1.6)
    speed = level * (1.0 + airspeed_change * (0.5 - 0.5 * np.cos(np.pi * time / DURATION_S)))
    quiet = np.zeros_like(time)
    p, q, r = (
        _respond(time, rng, size) if axis in wanted else quiet
        for size, wanted in (
            (0.35, ("lateral", "combined")),
            (0.25, ("longitudinal", "combined")),
            (0.12, ("lateral", "combined")),
        )
    )
    lift, side = rng.uniform(1.0, 2.0), rng.uniform(0.3, 0.6)
    rates = np.stack([p, q, r], axis=1)
    states = np.zeros((time.size, 4))
    states[0] = 0.05, 0.0, 0.0, 0.05
    for k in range(time.size - 1):  # Heun: a first-order rule would make the states late
        slope = _turn(states[k], rates[k], lift, side)
        ahead = _turn(states[k] + slope / rate, rates[k + 1], lift, side)
        states[k + 1] = states[k] + (slope + ahead) / (2.0 * rate)
    alpha, beta, phi, theta = states.T
    u, v, w = (
        speed * np.cos(alpha) * np.cos(beta), speed * np.sin(beta),
        speed * np.sin(alpha) * np.cos(beta),
    )  # fmt: skip
    u_rate, v_rate, w_rate = (np.gradient(x, 1 / rate) for x in (u, v, w))
    force = {
        "ax": u_rate + q * w - r * v + GRAVITY * np.sin(theta),
        "ay": v_rate + r * u - p * w - GRAVITY * np.cos(theta) * np.sin(phi),
        "az": w_rate + p * v - q * u - GRAVITY * np.cos(theta) * np.cos(phi),
    }
    motion = {"airspeed": speed, "alpha": alpha, "beta": beta, "phi": phi, "theta": theta}
    motion |= force | {"p": p, "q": q, "r": r, "elevator": np.tanh(q / 0.1)}
    return time, motion


def _turn(state: np.ndarray, rates: np.ndarray, lift: float, side: float) -> np.ndarray:
    """Rates of angle of attack, sideslip, bank and pitch angle."""
    a, b, f, t = state
    roll, pitch, yaw = rates
    turn = pitch * np.sin(f) + yaw * np.cos(f)
    return np.array([
        pitch - (roll * np.cos(a) + yaw * np.sin(a)) * np.tan(b) - lift * (a - 0.05),
        roll * np.sin(a) - yaw * np.cos(a) - side * b,
        roll + np.tan(t) * turn,
        pitch * np.cos(f) - yaw * np.sin(f),
    ])  # fmt: skip


def _respond(time: np.ndarray, rng: np.random.Generator, size: float) -> np.ndarray:
    """Rate of a damped oscillation to pulses at random times; it does not end at rest."""
    omega, zeta = 2 * np.pi * rng.uniform(0.5, 1.2), rng.uniform(0.35, 0.6)
    edges = np.sort(rng.uniform(1.0, DURATION_S - 1.0, 8))
    pulses = np.array([0, 1, -1, 1, -1, 0, 1, -1, 0])[np.searchsorted(edges, time)]
    short = time[: time.size // 4]
    kernel = np.exp(-zeta * omega * short) * np.sin(omega * np.sqrt(1 - zeta**2) * short)
    response = np.gradient(np.convolve(pulses, kernel)[: time.size])
    smooth = np.hanning(round(0.1 / (time[1] - time[0])))
    response = np.convolve(response, smooth / smooth.sum(), "same")
    return size * response / np.abs(response).max()


def _measure(name: str, motion: Mapping[str, np.ndarray], place: np.ndarray) -> np.ndarray:
    if name in ("alpha", "beta"):
        u, v, w = (
            motion["airspeed"] * np.cos(motion["alpha"]) * np.cos(motion["beta"]),
            motion["airspeed"] * np.sin(motion["beta"]),
            motion["airspeed"] * np.sin(motion["alpha"]) * np.cos(motion["beta"]),
        )
        omega = np.stack([motion[axis] for axis in "pqr"], axis=1)
        wind = np.stack([u, v, w], axis=1) + np.cross(omega, place)
        if name == "alpha":
            return np.arctan2(wind[:, 2], wind[:, 0])
        return np.arcsin(wind[:, 1] / np.linalg.norm(wind, axis=1))
    if name in ("ax", "ay", "az"):
        omega = np.stack([motion[axis] for axis in "pqr"], axis=1)
        rate = np.gradient(omega, 1.0 / (RATE_HZ * FINE), axis=0)
        arm = np.cross(rate, place) + np.cross(omega, np.cross(omega, place))
        return motion[name] + arm[:, "xyz".index(name[1])]
    return motion[name]


def write_flight(
    folder: Path, columns: Mapping[str, np.ndarray], axis: str, label: str = "flight"
) -> tuple[Path, Path]:
    """Write a record and the mapping for its import; return both files."""
    folder.mkdir(parents=True, exist_ok=True)
    record, mapping = folder / "record.csv", folder / "mapping.toml"
    table = np.stack(list(columns.values()), axis=1)
    np.savetxt(record, table, "%.9g", ",", header=",".join(columns), comments="")
    names = [name for name in columns if name in UNITS]
    sensors = ", ".join(
        f'{{ name = "{n}", kind = "{SENSORS[n][0]}", axis = "{SENSORS[n][1]}", '
        f"location = {_locate(n)} }}"
        for n in names
    )
    text = f"""flight = {{ number = 1 }}
time = {{ column = "t" }}
[maneuver]
label = "{label}"
axis = "{axis}"
condition.airspeed = {{ field = "airspeed", unit = "m/s" }}
condition.density = {{ value = {DENSITY}, unit = "kg/m3" }}
condition.fuel_fraction = {{ value = 0, unit = "%" }}
condition.alpha = {{ value = 0.05, unit = "rad" }}
[aircraft]
name = "Kinematic {label}"
surfaces = [{{ name = "elevator" }}]
sensors = [{sensors}]
geometry.area = {{ value = {AREA}, unit = "m2" }}
geometry.chord = {{ value = {CHORD}, unit = "m" }}
geometry.span = {{ value = {SPAN}, unit = "m" }}
mass.fuel = [0]
mass.mass = {{ values = [900], unit = "kg" }}
mass.pitch_inertia = {{ values = [1500], unit = "kg*m2" }}
mass.x_cg = {{ values = [0], unit = "m" }}
"""
    roles = {"elevator": "input", "airspeed": "condition"}
    for name in ("elevator", "airspeed", *names):
        role = roles.get(name, "output")
        unit = "m/s" if name == "airspeed" else UNITS.get(name, "rad")
        text += f'[[channels]]\ncolumn = "{name}"\nname = "{name}"\n'
        text += f'unit = "{unit}"\nrole = "{role}"\n'
    mapping.write_text(text)
    return record, mapping


def _locate(name: str) -> str:
    place = VANE if name in ("alpha", "beta") else ACCELEROMETER if name[0] == "a" else (0, 0, 0)
    values = [-place[0], place[1], -place[2]]  # structural axes: aft, right, up
    return f'{{ values = {values}, unit = "m" }}'
