"""Records of a roll mode with its actuator, and of a helicopter in hover; numpy and scipy only.

Motion is integrated over time from rest, faster than it is sampled, and sensors add noise.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import scipy

RATE_HZ = 50.0
_STEPS = 10  # of the integration per sample
GRAVITY = 9.81

ROLL = {"L_p": -3.2, "L_da": 14.0, "servo": 18.0}
HOVER = {
    **{"X_u": -0.03, "M_u": 0.04, "M_q": -0.9, "M_p": 0.25, "M_lon": 5.0, "servo_lon": 12.0},
    **{"Y_v": -0.06, "L_v": -0.07, "L_p": -2.6, "L_q": -0.7, "L_lat": 11.0, "servo_lat": 15.0},
}
"""True parameters, in SI and rad."""

_ROLL_NOISE = {"p": 0.01}
_HOVER_NOISE = {"u": 0.05, "q": 2e-3, "theta": 2e-3, "v": 0.05, "p": 4e-3, "phi": 2e-3}
_UNITS = {
    **dict.fromkeys(("aileron", "longitudinal", "lateral", "theta", "phi"), "rad"),
    **dict.fromkeys(("p", "q"), "rad/s"),
    **dict.fromkeys(("u", "v"), "m/s"),
}


def simulate_roll(seed: int, duration_s: float = 30.0) -> dict[str, np.ndarray]:
    """Return a record of roll rate after a 3-2-1-1 and a sweep of the aileron's command."""
    d = ROLL
    A = np.array([[d["L_p"], d["L_da"]], [0.0, -d["servo"]]])
    B = np.array([[0.0], [d["servo"]]])
    time = _list_times(duration_s)
    command = _make_inputs(time, 1.0, 0.05)
    states = _integrate(A, B, command[:, None])
    return _record(time, {"aileron": command}, {"p": states[:, 0]}, _ROLL_NOISE, seed)


def simulate_hover(seed: int, duration_s: float = 40.0) -> dict[str, np.ndarray]:
    """Return a record of a helicopter in hover, whose pilot holds the attitude between inputs.

    Two cubics, of surge with pitch and of sway with roll, coupled by the rates, and an actuator
    in each axis: eight states, of which both cubics are unstable.
    """
    d = HOVER
    A = np.zeros((8, 8))  # u, q, theta, v, p, phi, and the two actuators
    A[0, [0, 2]] = d["X_u"], -GRAVITY
    A[1, [0, 1, 4, 6]] = d["M_u"], d["M_q"], d["M_p"], d["M_lon"]
    A[2, 1] = A[5, 4] = 1.0
    A[3, [3, 5]] = d["Y_v"], GRAVITY
    A[4, [3, 1, 4, 7]] = d["L_v"], d["L_q"], d["L_p"], d["L_lat"]
    A[6, 6], A[7, 7] = -d["servo_lon"], -d["servo_lat"]
    B = np.zeros((8, 2))
    B[6, 0], B[7, 1] = d["servo_lon"], d["servo_lat"]
    pilot = np.zeros((2, 8))
    pilot[0, [0, 1, 2]] = 0.004, -0.15, -0.35
    pilot[1, [3, 4, 5]] = -0.003, -0.03, -0.2
    time = _list_times(duration_s)
    inputs = np.stack([_make_inputs(time, 2.0, 0.02), _make_inputs(time, 9.0, 0.02)], axis=1)
    states = _integrate(A + B @ pilot, B, inputs)
    sticks = inputs + states @ pilot.T
    outputs = dict(zip(_HOVER_NOISE, states.T, strict=False))
    moved = {"longitudinal": sticks[:, 0], "lateral": sticks[:, 1]}
    return _record(time, moved, outputs, _HOVER_NOISE, seed)


def write_own_record(folder: Path, columns: Mapping[str, np.ndarray]) -> tuple[Path, Path]:
    """Write a record and the mapping for its import; return both files."""
    record, mapping = folder / "own.csv", folder / "own.toml"
    table = np.stack(list(columns.values()), axis=1)
    np.savetxt(record, table, "%.9g", ",", header=",".join(columns), comments="")
    inputs = [name for name in columns if name in ("aileron", "longitudinal", "lateral")]
    kinds = {"p": ("gyro", "x"), "q": ("gyro", "y"), "phi": ("attitude", "x")}
    kinds |= {"theta": ("attitude", "y")}
    sensors = ", ".join(
        f'{{ name = "{name}", kind = "{kind}", axis = "{axis}" }}'
        for name, (kind, axis) in kinds.items()
        if name in columns
    )
    surfaces = ", ".join(f'{{ name = "{name}" }}' for name in inputs)
    channels = "".join(
        f'[[channels]]\ncolumn = "{name}"\nunit = "{_UNITS[name]}"\n'
        f'role = "{"input" if name in inputs else "output"}"\n'
        for name in columns
        if name != "t"
    )
    mapping.write_text(
        f"""flight = {{ number = 1 }}
time = {{ column = "t" }}
[maneuver]
label = "own model"
axis = "lateral"
condition.airspeed = {{ value = 30, unit = "m/s" }}
condition.density = {{ value = 1.2, unit = "kg/m3" }}
condition.fuel_fraction = {{ value = 0, unit = "%" }}
[aircraft]
name = "Own"
surfaces = [{surfaces}]
sensors = [{sensors}]
geometry.area = {{ value = 1, unit = "m2" }}
geometry.chord = {{ value = 0.3, unit = "m" }}
geometry.span = {{ value = 3, unit = "m" }}
mass.fuel = [0]
mass.mass = {{ values = [10], unit = "kg" }}
mass.pitch_inertia = {{ values = [1], unit = "kg*m2" }}
mass.roll_inertia = {{ values = [1], unit = "kg*m2" }}
mass.yaw_inertia = {{ values = [1], unit = "kg*m2" }}
mass.x_cg = {{ values = [0], unit = "m" }}
{channels}"""
    )
    return record, mapping


def _list_times(duration_s: float) -> np.ndarray:
    rate = RATE_HZ * _STEPS
    return np.arange(round(duration_s * rate) + 1) / rate


def _smooth(values: np.ndarray) -> np.ndarray:
    """Return the values with edges of 0.2 s."""
    edge = np.hanning(round(0.2 * RATE_HZ * _STEPS))
    return np.convolve(values, edge / edge.sum(), "same")


def _make_inputs(time: np.ndarray, begin_s: float, size: float) -> np.ndarray:
    """Return a 3-2-1-1 and a sweep to 2.5 Hz that follows it."""
    edges = begin_s + np.cumsum([0.0, 1.2, 0.8, 0.4, 0.4])
    signs = np.array([0.0, 1.0, -1.0, 1.0, -1.0, 0.0])
    steps = signs[np.searchsorted(edges, time, "right")]
    after = np.clip(time - edges[-1] - 1.0, 0.0, 20.0)
    sweep = np.sin(2.0 * np.pi * (0.1 * after + 0.06 * after**2)) * (after > 0.0) * (after < 20.0)
    return size * (_smooth(steps) + 0.7 * _smooth(sweep))


def _integrate(A: np.ndarray, B: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """Integrate from rest, exactly for inputs that are straight lines between steps."""
    n_x, n_u = B.shape
    step = 1.0 / (RATE_HZ * _STEPS)
    whole = np.zeros((n_x + 2 * n_u, n_x + 2 * n_u))
    whole[:n_x, :n_x], whole[:n_x, n_x : n_x + n_u] = A * step, B * step
    whole[n_x : n_x + n_u, n_x + n_u :] = np.eye(n_u)
    moved = scipy.linalg.expm(whole)[:n_x]
    states = np.zeros((len(inputs), n_x))
    for k in range(len(inputs) - 1):
        change = inputs[k + 1] - inputs[k]
        states[k + 1] = moved @ np.concatenate([states[k], inputs[k], change])
    return states


def _record(
    time: np.ndarray,
    inputs: Mapping[str, np.ndarray],
    outputs: Mapping[str, np.ndarray],
    noise: Mapping[str, float],
    seed: int,
) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    columns = {"t": time[::_STEPS]}
    columns |= {name: values[::_STEPS] for name, values in inputs.items()}
    for name, std in noise.items():
        samples = outputs[name][::_STEPS]
        columns[name] = samples + std * rng.normal(size=samples.size)
    return columns
