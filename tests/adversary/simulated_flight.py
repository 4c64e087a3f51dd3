"""Fly a multisine: a linear aircraft with servos, feedback, gusts, instruments and noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from drawn_aircraft import Aircraft
from true_model import build_output, build_state_space, make_factors

LEAD_S = 2.0
LAG_DAMPING = 0.7


@dataclass(frozen=True)
class Multisine:
    """Interleaved harmonics of 1/period: first, first + stride, ..., by turns for the inputs."""

    period: float
    first: int
    stride: int
    per_input: int
    commands: np.ndarray  # one period at the rate of the simulation, a column for each input

    def list_harmonics(self, k: int) -> list[int]:
        """Return the harmonics of an input."""
        n_inputs = self.commands.shape[1]
        return [self.first + self.stride * (k + n_inputs * m) for m in range(self.per_input)]


@dataclass(frozen=True)
class Record:
    """What the recorder has: deflections, commands and sensors at its rate."""

    rate: float
    inputs: np.ndarray
    commands: np.ndarray
    outputs: np.ndarray
    multisine: Multisine
    records_commands: bool
    states_noise: bool
    traits: tuple[str, ...]


def fly(rng: np.random.Generator, aircraft: Aircraft, *, in_band: int, rows: int) -> Record:
    """Fly the aircraft with a band that contains its first modes, for at most so many rows."""
    n_inputs = len(aircraft.truth.inputs)
    hertz = aircraft.truth.omega / (2 * np.pi)
    top = float(np.sqrt(hertz[in_band - 1] * hertz[in_band]))
    servo = 2 * np.pi * max(6.0, 1.2 * top) * rng.uniform(1.0, 1.5)
    gains = _draw_gains(rng, n_inputs) if rng.random() < 0.5 else np.zeros((n_inputs, 2))
    plant, output = _close_loop(aircraft, servo, gains)
    growth = np.real(np.linalg.eigvals(plant.system))
    decay = -growth[growth < -0.02].max()
    tail = float(np.clip(5.0 / decay, 3.0, 12.0))
    period = float(round(rng.uniform(16.0, 32.0)))
    usable = rows / (period + tail + LEAD_S)
    rate = float(round(np.clip(np.exp(rng.uniform(np.log(50), np.log(1000))), 8 * top, usable)))
    steps = int(np.ceil(max(400.0, 12 * top) / rate))
    multisine = _design(rng, period, top, n_inputs, rate * steps)
    commands = _place(multisine.commands, rate * steps, period + tail + LEAD_S)
    gusty = rng.random() < 0.3
    gust = 10 ** rng.uniform(-3.5, -2.5) if gusty else 0.0
    states = _simulate(rng, plant, commands, 1 / (rate * steps), gust)
    clean = _measure(aircraft, states @ output.T, 1 / (rate * steps))[::steps]
    deflections = states[::steps, plant.deflections]
    noise = np.array([s.noise for s in aircraft.sensors]) * clean.std(axis=0)
    outputs = clean + noise * rng.normal(size=clean.shape)
    level = float(rng.choice([0.0, 0.003, 0.01]))
    inputs = deflections + level * deflections.std(axis=0) * rng.normal(size=deflections.shape)
    traits = (
        *(["gust"] if gusty else []),
        *(["closed loop"] if gains.any() else []),
        *(["noisy inputs"] if level else []),
    )
    return Record(
        rate, inputs, commands[::steps], outputs, multisine,
        bool(rng.random() < 0.6), bool(rng.random() < 0.5), traits,
    )  # fmt: skip


@dataclass(frozen=True)
class _Plant:
    system: np.ndarray
    commands: np.ndarray
    gust: np.ndarray
    deflections: slice
    gust_rate: float


def _close_loop(aircraft: Aircraft, servo: float, gains: np.ndarray) -> tuple[_Plant, np.ndarray]:
    """Return the plant with servos, feedback of q and theta and a gust, and its outputs."""
    a, b = build_state_space(aircraft, aircraft.truth)
    n, m = len(a), len(aircraft.truth.inputs)
    system = np.zeros((n + 2 * m + 1,) * 2)
    system[:n, :n], system[:n, n : n + m] = a, b
    system[n : n + m, n + m : n + 2 * m] = np.eye(m)
    system[n + m : n + 2 * m, n : n + m] = -(servo**2) * np.eye(m)
    system[n + m : n + 2 * m, n + m : n + 2 * m] = -2 * 0.7 * servo * np.eye(m)
    rows = [build_output(aircraft, sensor) for sensor in aircraft.sensors]
    by_name = {s.name: row for s, row in zip(aircraft.sensors, rows, strict=True)}
    feedback = np.stack([by_name["q"][0], by_name["theta"][0]])
    system[n + m : n + 2 * m, :n] = servo**2 * gains @ feedback
    # An up-gust adds to the angle of attack of all strips, not to the inertial one.
    factors = make_factors(aircraft, aircraft.truth, aircraft.airspeed)
    forces = factors.rows * aircraft.truth.table[:, 0]
    modes = len(aircraft.shapes)
    system[np.r_[0:2, 3 + modes : n], -1] = forces
    gust_rate = aircraft.airspeed / (10 * aircraft.wing.span)
    system[-1, -1] = -gust_rate
    commands = np.zeros((system.shape[0], m))
    commands[n + m : n + 2 * m] = servo**2 * np.eye(m)
    gust = np.zeros(system.shape[0])
    gust[-1] = 1.0
    output = np.array([on_rate @ system[:n] for _, on_rate in rows])
    output[:, :n] += [on_state for on_state, _ in rows]
    for k, sensor in enumerate(aircraft.sensors):
        if sensor.kind == "vane":
            output[k, -1] += 1.0
    return _Plant(system, commands, gust, slice(n, n + m), gust_rate), output


def _draw_gains(rng: np.random.Generator, n_inputs: int) -> np.ndarray:
    """Pitch damping and attitude hold by the first surface (all of them nose down)."""
    gains = np.zeros((n_inputs, 2))
    gains[0] = rng.uniform(0.02, 0.12), rng.uniform(0.02, 0.1)
    return gains


def _design(
    rng: np.random.Generator, period: float, top: float, n_inputs: int, rate: float
) -> Multisine:
    first = int(rng.integers(2, 7))
    available = int(top * period) - first
    stride = max(1, available // (70 * n_inputs))
    per_input = max(7, available // (stride * n_inputs))
    time = np.arange(round(period * rate)) / rate
    columns = []
    for k in range(n_inputs):
        harmonics = first + stride * (k + n_inputs * np.arange(per_input))
        phase = -np.pi * np.arange(per_input) ** 2 / per_input + rng.uniform(0, 2 * np.pi)
        wave = np.zeros(time.size)
        for harmonic, angle in zip(harmonics, phase, strict=True):
            wave += np.sin(2 * np.pi * harmonic / period * time + angle)
        columns.append(np.radians(2.0) * (1 - 0.05 * k) * wave / np.abs(wave).max())
    return Multisine(period, first, stride, per_input, np.stack(columns, axis=1))


def _place(period: np.ndarray, rate: float, duration: float) -> np.ndarray:
    commands = np.zeros((round(duration * rate), period.shape[1]))
    begin = round(LEAD_S * rate)
    commands[begin : begin + len(period)] = period
    return commands


def _simulate(
    rng: np.random.Generator, plant: _Plant, commands: np.ndarray, step: float, gust: float
) -> np.ndarray:
    """Step the exact solution for commands that are held over each step."""
    n, m = plant.commands.shape
    held = np.zeros((n + m, n + m))
    held[:n, :n], held[:n, n:] = plant.system * step, plant.commands * step
    moved = exponential(held)
    turn, drive = moved[:n, :n], commands @ moved[:n, n:].T
    spread = gust * np.sqrt(2 * plant.gust_rate * step)
    drive[:, -1] += spread * rng.normal(size=len(drive))
    states = np.zeros((len(commands), n))
    for k in range(len(commands) - 1):
        states[k + 1] = turn @ states[k] + drive[k]
    return states


def _measure(aircraft: Aircraft, outputs: np.ndarray, step: float) -> np.ndarray:
    """Pass the outputs through the dynamics of their sensors, by the trapezoidal rule."""
    time = step * np.arange(len(outputs))
    outputs = np.stack(
        [
            np.interp(time - sensor.delay, time, own) if sensor.delay else own
            for sensor, own in zip(aircraft.sensors, outputs.T, strict=True)
        ],
        axis=1,
    )
    lagged = [k for k, sensor in enumerate(aircraft.sensors) if sensor.lag]
    if not lagged:
        return outputs
    omega = aircraft.sensors[lagged[0]].lag
    system = np.array([[0.0, 1.0], [-(omega**2), -2 * LAG_DAMPING * omega]])
    held = np.zeros((3, 3))
    held[:2, :2], held[1, 2] = system * step, omega**2 * step
    moved = exponential(held)
    found = outputs.copy()
    state = np.zeros((2, len(lagged)))
    middle = (outputs[1:, lagged] + outputs[:-1, lagged]) / 2
    for k, value in enumerate(middle):
        found[k, lagged] = state[0]
        state = moved[:2, :2] @ state + moved[:2, 2:] * value
    found[-1, lagged] = state[0]
    return found


def exponential(matrix: np.ndarray) -> np.ndarray:
    """Return the matrix exponential, by scaling and squaring of its series."""
    squarings = max(0, int(np.ceil(np.log2(max(np.abs(matrix).sum(axis=1).max(), 1e-9)))) + 3)
    small = matrix / 2**squarings
    term = total = np.eye(len(matrix))
    for k in range(1, 14):
        term = term @ small / k
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total
