"""Write a drawn flight as strange recorders do: names, units, dialects, sides and order drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from drawn_aircraft import Aircraft, G
from simulated_flight import Record

DEG = 180 / np.pi
# Units of a recorder with the factor from SI, by quantity.
UNITS: dict[str, tuple[tuple[str, float], ...]] = {
    "angle": (("deg", DEG), ("rad", 1.0)),
    "rate": (("deg/s", DEG), ("rad/s", 1.0)),
    "acceleration": (("g", 1 / G), ("m/s^2", 1.0), ("ft/s^2", 1 / 0.3048)),
    "strain": (("ue", 1e6), ("microstrain", 1e6)),
    "speed": (("kt", 1 / 0.514444), ("m/s", 1.0), ("ft/s", 1 / 0.3048)),
    "length": (("ft", 1 / 0.3048), ("m", 1.0)),
    "percent": (("%", 1.0),),
    "temperature": (("degC", 1.0),),
}
# The words of a quantity as engineers shorten them.
WORDS: dict[str, tuple[str, ...]] = {
    "alpha": ("AOA_BOOM", "Alpha_Vane", "alfa_1", "AngleOfAttack", "AOA"),
    "q": ("PitchRate", "Q_IMU", "INS_Q", "PITCH_RT", "GYRO_Q"),
    "theta": ("Theta_INS", "PITCH_ATT", "PitchAngle", "THETA_EGI", "pitch_attitude"),
    "airspeed": ("TAS_1", "TAS_ADC", "Vtrue", "TrueAirspeed", "TAS"),
    "altitude": ("ALT_BARO", "Hp_ADC", "PressAlt", "ALTITUDE_MSL", "baro_altitude"),
    "fuel": ("FUELQTY", "FuelRemaining", "FUEL_TOT", "fuel_pct", "FUEL"),
    "temperature": ("OAT", "TEMP_AMB", "SAT_ADC", "T_static", "OutsideAirTemp"),
}
SURFACES: dict[str, tuple[str, ...]] = {
    "elevator": ("ELEV", "elevator", "DE", "Elev", "ELE"),
    "wf": ("WF", "wf", "WingFlap", "TEF", "FLAP"),
}
DIALECTS = ((",", "."), (";", ","), ("\t", "."), (";", "."))


@dataclass(frozen=True)
class Truth:
    """What a column is: its role, quantity, unit, and name in flexsid if it has one.

    ``of`` is the surface or sensor of the aircraft.
    """

    role: str
    unit: str
    name: str | None = None
    side: str = ""
    of: str = ""


@dataclass(frozen=True)
class DrawnFile:
    """A file, and the truth of every column but time."""

    path: Path
    truth: dict[str, Truth]
    time: str


def write_drawn_file(
    rng: np.random.Generator, folder: Path, aircraft: Aircraft, record: Record
) -> DrawnFile:
    """Write the record of a flight; half of the names are scrambled, half of the units missing."""
    n = len(record.inputs)
    time = np.arange(n) / record.rate
    style = _draw_style(rng)
    columns: list[tuple[str, str, np.ndarray, Truth]] = []

    def add(words: str, quantity: str, si: np.ndarray, role: str, name: str | None, **more: str):
        unit, factor = UNITS[quantity][rng.integers(len(UNITS[quantity]))]
        columns.append((words, unit, si * factor, Truth(role, unit, name, **more)))

    both = rng.random() < 0.5  # sides recorded apart
    sign = -1.0 if both and rng.random() < 0.3 else 1.0
    for number, name in enumerate(aircraft.truth.inputs):
        word = SURFACES["elevator" if name == "elevator" else "wf"]
        word = word[rng.integers(len(word))] + ("" if name == "elevator" else name[2])
        trim = rng.uniform(-3, 3) / DEG
        for prefix, role, table in (
            ("POS_", "input", record.inputs),
            ("CMD_", "command", record.commands),
        ):
            if role == "command" and not record.records_commands:
                continue
            for side, factor in (("L", 1.0), ("R", sign)) if both else (("", 1.0),):
                noise = 2e-5 * rng.normal(size=n) if role == "input" else 0.0
                word_of_side = prefix + word + (f"_{side}H" if side else "")
                signal = factor * (table[:, number] + trim) + noise
                add(word_of_side, "angle", signal, role, None, side=side, of=name)
    for index, sensor in enumerate(aircraft.sensors):
        signal = record.outputs[:, index]
        if sensor.kind == "accelerometer":
            upward = 1.0
            place = sensor.name.split("_", 1)[1].upper()
            add(
                f"AZ_{place}", "acceleration", upward * (signal - G), "output", None, of=sensor.name
            )
        elif sensor.kind == "strain":
            place = sensor.name.split("_")[1].upper()
            add(f"SG_{place}", "strain", signal + 2e-4, "output", None, of=sensor.name)
        else:
            at = {"alpha": aircraft.alpha, "theta": aircraft.alpha}.get(sensor.name, 0.0)
            words = WORDS[sensor.name]
            quantity = "rate" if sensor.kind == "gyro" else "angle"
            word = words[rng.integers(len(words))]
            add(word, quantity, signal + at, "output", sensor.name, of=sensor.name)
    drift = np.cumsum(rng.normal(size=n)) / np.sqrt(n)
    slow: tuple[tuple[str, str, np.ndarray, str], ...] = (
        ("airspeed", "speed", aircraft.airspeed + 0.3 * drift, "airspeed"),
        ("altitude", "length", 1200 + 3 * drift, "altitude"),
        ("fuel", "percent", np.round(60 - time / time[-1], 1), "fuel_fraction"),
        ("temperature", "temperature", 12 + 0.05 * drift, "temperature"),
    )
    for key, quantity, signal, name in slow:
        words = WORDS[key]
        word = words[rng.integers(len(words))]
        add(word, quantity, signal, "condition", name)
    return _write(rng, folder, columns, time, style)


def _draw_style(rng: np.random.Generator) -> Callable[[str, str], str]:
    forms: Sequence[Callable[[str, str], str]] = (
        lambda name, unit: f"{name}({unit})" if unit else name,
        lambda name, unit: f"{name} [{unit}]" if unit else name,
        lambda name, unit: name.lower(),
        lambda name, unit: name,
    )
    return forms[int(rng.integers(len(forms)))]


def _write(
    rng: np.random.Generator,
    folder: Path,
    columns: list[tuple[str, str, np.ndarray, Truth]],
    time: np.ndarray,
    style: Callable[[str, str], str],
) -> DrawnFile:
    order = rng.permutation(len(columns))
    separator, point = DIALECTS[rng.integers(len(DIALECTS))]
    scrambled = rng.random(len(columns)) < 0.5
    stated = rng.random(len(columns)) < 0.5
    names, table, truth = ["Time"], [time], {}
    for k in order:
        words, unit, samples, own = columns[k]
        words = f"CH{k:03d}" if scrambled[k] else words
        name = style(words, unit if stated[k] else "")
        while name in names:
            name += "x"
        names.append(name)
        table.append(samples)
        truth[name] = own
    rows = [
        separator.join(f"{value:.8g}".replace(".", point) for value in row)
        for row in np.column_stack(table)
    ]
    path = folder / "recording.csv"
    path.write_text("\n".join([separator.join(names), *rows]) + "\n", encoding="utf-8")
    return DrawnFile(path, truth, "Time")
