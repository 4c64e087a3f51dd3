"""Records of known transfer functions, simulated with scipy alone and stored by the import.

Measured surface and output have noise, white up to the sampling rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from file_imports import import_maneuver
from scipy import signal

from flexsid.records.views import TransferFunction
from flexsid.storage.store import Store
from flexsid.workflow.measurements.transfer_functions import (
    TransferFunctionQuery,
    estimate_transfer_function,
)

FINE_HZ, RATE_HZ = 1000.0, 50.0
BEGIN_S, PERIOD_S, REST_S = 2.0, 20.0, 4.0
AMPLITUDE = 0.04  # [rad]
STEPS = {
    "3-2-1-1": ((2.0, 3.5, 1), (3.5, 4.5, -1), (4.5, 5.0, 1), (5.0, 5.5, -1)),
    "doublet": ((2.0, 3.0, 1), (3.0, 4.0, -1)),
}
HARMONICS = {
    "multisine": tuple(range(2, 61, 2)),
    "six harmonics": (4, 8, 16, 32, 64, 100),
    "part of a multisine": tuple(range(2, 61, 2)),
}
INPUTS = (*STEPS, *HARMONICS)
"""Steps; multisines of one period that begin and end at rest; a part of one, of unknown harmonics,
that begins and ends in motion."""


@dataclass(frozen=True)
class KnownSystem:
    """K (s + zero) e^(-tau s) / (s^i (s^2 + 2 zeta omega s + omega^2)); without zero K e^(...)."""

    sensor: tuple[str, str, str]  # kind, axis and unit
    gain: float
    zero: float | None
    frequency: float
    damping: float
    delay: float
    integrators: int = 0

    def respond(self, time: np.ndarray, deflection: np.ndarray) -> np.ndarray:
        """Simulate the response to a deflection, of which it was at rest before."""
        numerator = [self.gain] if self.zero is None else [self.gain, self.gain * self.zero]
        poles = [1.0, 2.0 * self.damping * self.frequency, self.frequency**2]
        denominator = poles + [0.0] * self.integrators
        # pyrefly: ignore[direct-abstract-base-instantiation]
        system = signal.TransferFunction(numerator, denominator)
        delayed = np.interp(time - self.delay, time, deflection, left=0.0)
        return np.asarray(signal.lsim(system, delayed, time)[1])

    def pair(self, found: TransferFunction) -> list[tuple[str, float, float]]:
        """Pair the errors of gain, zero, pole and delay with their standard errors."""
        (pole,) = found.poles
        pairs = [("gain", found.gain - self.gain, found.gain_std)]
        if self.zero is not None:
            (zero,) = found.zeros
            pairs.append(("zero", -zero.real_rad_s - self.zero, zero.frequency_std_rad_s))
        pairs.append(("frequency", pole.frequency_rad_s - self.frequency, pole.frequency_std_rad_s))
        pairs.append(("damping", pole.damping - self.damping, pole.damping_std))
        pairs.append(("delay", found.delay_s - self.delay, found.delay_std_s))
        return pairs


SYSTEMS = {
    "pitch rate": KnownSystem(("gyro", "y", "rad/s"), -12.0, 1.5, 3.3, 0.5, 0.05),
    "angle of attack": KnownSystem(("vane", "y", "rad"), 9.0, None, 3.3, 0.5, 0.05),
    "pitch angle": KnownSystem(("attitude", "y", "rad"), -12.0, 1.5, 3.3, 0.5, 0.05, 1),
}


def deflect(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return time and deflection at the fine rate, from rest."""
    if name in STEPS:
        time = np.arange(0.0, PERIOD_S, 1.0 / FINE_HZ)
        steps = np.zeros(time.size)
        for start, stop, sign in STEPS[name]:
            steps[(time >= start) & (time < stop)] = AMPLITUDE * sign
        return time, signal.lfilter(*signal.butter(2, 3.0, fs=FINE_HZ), steps)
    harmonics = np.array(HARMONICS[name])
    phases = -np.pi * np.arange(harmonics.size) ** 2 / harmonics.size
    whole = np.arange(0.0, PERIOD_S, 1.0 / FINE_HZ)
    one = np.sin(2.0 * np.pi * np.outer(whole, harmonics) / PERIOD_S + phases).sum(axis=1)
    one = np.roll(one, -int(np.flatnonzero((one[:-1] <= 0.0) & (one[1:] > 0.0))[0]))
    periods = 3 if name.startswith("part") else 1
    lead, rest = (np.zeros(round(s * FINE_HZ)) for s in (BEGIN_S, REST_S))
    motion = np.concatenate([lead, np.tile(one / one.std(), periods), rest])
    return np.arange(motion.size) / FINE_HZ, 0.5 * AMPLITUDE * motion


def simulate(system: KnownSystem, name: str) -> dict[str, np.ndarray]:
    """Simulate time, surface and output at the rate of the recorder, without noise."""
    time, deflection = deflect(name)
    columns = {"t": time, "de": deflection, "y": system.respond(time, deflection)}
    every = slice(None, None, round(FINE_HZ / RATE_HZ))
    if name.startswith("part"):
        every = slice(round(17.3 * FINE_HZ), round(56.6 * FINE_HZ), every.step)
    recorded = {key: values[every] for key, values in columns.items()}
    return recorded | {"t": recorded["t"] - recorded["t"][0]}


def add_noise(
    columns: dict[str, np.ndarray], output: float, surface: float, rng: np.random.Generator
) -> dict[str, np.ndarray]:
    """Add noise in shares of the rms of output and surface."""
    shares = {"t": 0.0, "de": surface, "y": output}
    return {
        key: values + shares[key] * np.std(values) * rng.normal(size=values.size)
        for key, values in columns.items()
    }


def fit(
    store: Store,
    folder: Path,
    system: KnownSystem,
    name: str,
    columns: dict[str, np.ndarray],
    label: str,
) -> TransferFunction:
    """Import a record, and fit the transfer function of the usual orders in the default band."""
    file = folder / "record.csv"
    data = np.stack(list(columns.values()), axis=1)
    np.savetxt(file, data, delimiter=",", header=",".join(columns), comments="", fmt="%.10g")
    known = HARMONICS[name] if name in HARMONICS and not name.startswith("part") else ()
    number = import_maneuver(store, [file], _write_mapping(system, label, known)).id
    assert number is not None
    query = TransferFunctionQuery(maneuver_id=number, input="de", output="y")
    return estimate_transfer_function(store, query).function


def _write_mapping(system: KnownSystem, label: str, harmonics: Sequence[int]) -> str:
    kind, axis, unit = system.sensor
    text = f"""
[aircraft]
name = "{label}"
[aircraft.geometry]
area = {{ value = 39.0, unit = "m2" }}
chord = {{ value = 1.98, unit = "m" }}
span = {{ value = 19.8, unit = "m" }}
[aircraft.mass]
fuel = [0.5]
mass = {{ values = [4600.0], unit = "kg" }}
pitch_inertia = {{ values = [32000.0], unit = "kg*m2" }}
x_cg = {{ values = [0.0], unit = "m" }}
[[aircraft.surfaces]]
name = "de"
[[aircraft.sensors]]
name = "y"
kind = "{kind}"
axis = "{axis}"
[flight]
number = 1
[maneuver]
label = "{label}"
axis = "longitudinal"
[maneuver.condition]
airspeed = {{ value = 70.0, unit = "m/s" }}
density = {{ value = 1.0, unit = "kg/m3" }}
alpha = {{ value = 0.05, unit = "rad" }}
[time]
column = "t"
[[channels]]
column = "de"
unit = "rad"
role = "input"
[[channels]]
column = "y"
unit = "{unit}"
role = "output"
"""
    if harmonics:
        text += f"""
[excitation]
period = {{ value = {PERIOD_S}, unit = "s" }}
start = {{ value = {BEGIN_S}, unit = "s" }}
harmonics = {{ de = {list(harmonics)} }}
"""
    return text
