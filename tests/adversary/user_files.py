"""Write a flight as its users would: a record, arrays of modes and derivatives, and the mapping."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from drawn_aircraft import Aircraft, Knowledge, Sensor
from simulated_flight import LAG_DAMPING, LEAD_S, Record

_UNITS = {
    "gyro": ("deg/s", 180 / np.pi), "attitude": ("deg", 180 / np.pi), "vane": ("deg", 180 / np.pi),
    "accelerometer": ("g", 1 / 9.80665), "strain": ("ustrain", 1e6),
}  # fmt: skip


def write_files(
    folder: Path, aircraft: Aircraft, knowledge: Knowledge, record: Record, number: int = 1
) -> tuple[list[Path], str]:
    """Return the files of a flight, and the text of their mapping.

    The first flight of an aircraft has its models, the others name it.
    """
    files = [folder / "record.csv"]
    _write_record(files[0], aircraft, record)
    maneuver = _describe_maneuver(aircraft, knowledge, record, number)
    channels = _describe_channels(aircraft, record)
    if number > 1:
        return files, "\n".join((f'[aircraft]\nname = "{aircraft.name}"', maneuver, channels))
    files.append(folder / "models.npz")
    _write_models(files[1], aircraft, knowledge)
    described = _describe_aircraft(aircraft, knowledge, record)
    models = _describe_models(aircraft, knowledge)
    return files, "\n".join((described, maneuver, channels, models))


def _write_record(file: Path, aircraft: Aircraft, record: Record) -> None:
    names, columns = list(aircraft.truth.inputs), [record.inputs * 180 / np.pi]
    if record.records_commands:
        names += [f"{name}_command" for name in aircraft.truth.inputs]
        columns.append(record.commands * 180 / np.pi)
    names += [sensor.name for sensor in aircraft.sensors]
    columns.append(record.outputs * [_UNITS[sensor.kind][1] for sensor in aircraft.sensors])
    table = np.hstack(columns)
    time = np.arange(len(table)) / record.rate
    header = ",".join(["t", *names])
    with file.open("w") as text:
        text.write(header + "\n")
        row = ",".join(["%.7g"] * len(names)) + "\n"
        text.writelines(f"{t:.6f}," + row % tuple(v) for t, v in zip(time, table, strict=True))


def _write_models(file: Path, aircraft: Aircraft, knowledge: Knowledge) -> None:
    points = np.array([sensor.point for sensor in aircraft.sensors])
    turn = np.array([-1.0, 1.0, -1.0])
    arrays: dict[str, np.ndarray] = {
        "points": np.column_stack([_nodes(aircraft), _place(aircraft, points)])
    }
    shapes = aircraft.shapes[: len(knowledge.numbers)]
    errors = knowledge.assumed.shape_std * knowledge.assumed.shapes[: len(shapes)]
    for number, shape, error in zip(knowledge.numbers, shapes, errors, strict=True):
        motion = shape.at(aircraft.wing, points) * np.tile(turn, 2)
        motion = motion + error[:, :6] * np.sqrt(np.mean(motion**2, axis=0))
        arrays[f"shape_{number}"] = np.column_stack([_nodes(aircraft), motion])
    arrays["frequency"] = knowledge.omega / (2 * np.pi)
    arrays["damping"] = knowledge.zeta
    arrays["mass"] = np.full(len(shapes), aircraft.generalized_mass)
    gauges = [sensor.gauge for sensor in aircraft.sensors if sensor.gauge]
    strains = [[one.strain(aircraft.wing, *gauge) for gauge in gauges] for one in shapes]
    gauged = [k for k, sensor in enumerate(aircraft.sensors) if sensor.gauge]
    true = 1e6 * np.array(strains).reshape(len(shapes), -1)
    size = np.sqrt(np.sum(true**2, axis=1, keepdims=True) / max(len(gauged), 1))
    arrays["strain"] = true + size * errors[:, gauged, 6]
    arrays["derivatives"] = knowledge.table
    np.savez(file, **arrays)  # pyrefly: ignore[bad-argument-type]


def _describe_aircraft(aircraft: Aircraft, knowledge: Knowledge, record: Record) -> str:
    wing, assumed = aircraft.wing, knowledge.assumed
    lagged = next((s.lag for s in aircraft.sensors if s.lag), 0.0)
    lines = [
        "[aircraft]", f'name = "{aircraft.name}"', 'pairs = ["symmetric"]',
        f"geometry.area = {_quantity(wing.area, 'm2')}",
        f"geometry.chord = {_quantity(wing.chord, 'm')}",
        f"geometry.span = {_quantity(wing.span, 'm')}",
        "mass.fuel = [0]",
        f"mass.mass = {_quantity(assumed.mass * wing.mass, 'kg')}",
        f"mass.pitch_inertia = {_quantity(assumed.inertia * wing.pitch_inertia, 'kg*m2')}",
        f"mass.x_cg = {_quantity(aircraft.x_cg, 'm')}",
    ]  # fmt: skip
    for name in aircraft.truth.inputs:
        lines += ["[[aircraft.surfaces]]", f'name = "{name}"', 'symmetry = "symmetric"']
    for sensor in aircraft.sensors:
        lines += ["[[aircraft.sensors]]", f'name = "{sensor.name}"', f'kind = "{sensor.kind}"']
        place = ", ".join(f"{v:.9g}" for v in _place(aircraft, np.array([sensor.point]))[0])
        lines.append(f'location = {{ values = [{place}], unit = "m" }}')
        if sensor.axis:
            lines.append(f'axis = "{sensor.axis}"')
        if sensor.lag:
            lines.append('instrument = "lag"')
        if record.states_noise:
            lines.append(f"noise_std = {_noise(aircraft, record, sensor):.6g}")
    if lagged:
        lines.append("[aircraft.instruments.lag]")
        natural = f'{{ value = {lagged:.9g}, unit = "rad/s" }}'
        element = f'type = "second-order", natural_frequency = {natural}, damping = {LAG_DAMPING}'
        lines.append(f"elements = [{{ {element} }}]")
    return "\n".join(lines)


def _describe_maneuver(
    aircraft: Aircraft, knowledge: Knowledge, record: Record, number: int
) -> str:
    multisine, airspeed = record.multisine, knowledge.assumed.airspeed * aircraft.airspeed
    order = ", ".join(f'"{name}"' for name in aircraft.truth.inputs)
    return f"""[flight]
number = {number}
[maneuver]
label = "multisine {number}"
axis = "longitudinal"
condition.airspeed = {_quantity(airspeed, "m/s")}
condition.density = {_quantity(aircraft.density, "kg/m3")}
condition.fuel_fraction = {{ value = 0, unit = "%" }}
condition.alpha = {_quantity(aircraft.alpha, "rad")}
condition.thrust = {_quantity(aircraft.thrust, "N")}
[excitation]
period = {_quantity(multisine.period, "s")}
start = {_quantity(LEAD_S, "s")}
first = {{ value = {multisine.first} }}
per_input = {{ value = {multisine.per_input} }}
stride = {{ value = {multisine.stride} }}
order = [{order}]
[time]
column = "t"
"""


def _describe_channels(aircraft: Aircraft, record: Record) -> str:
    inputs = aircraft.truth.inputs
    rows = [(name, "deg", "input") for name in inputs]
    if record.records_commands:
        rows += [(f"{name}_command", "deg", "command") for name in inputs]
    rows += [(s.name, _UNITS[s.kind][0], "output") for s in aircraft.sensors]
    return "\n".join(
        f'[[channels]]\ncolumn = "{name}"\nunit = "{unit}"\nrole = "{role}"\n'
        'confirmed = ["too-large", "too-small"]'
        for name, unit, role in rows
    )


def _describe_models(aircraft: Aircraft, knowledge: Knowledge) -> str:
    numbers = knowledge.numbers
    names = [f'"{shape.name}"' for shape in aircraft.shapes[: len(numbers)]]
    points = ", ".join(f"{s.name} = {k + 1}" for k, s in enumerate(aircraft.sensors))
    gauges = [f'"{s.name}"' for s in aircraft.sensors if s.gauge]
    strain = (
        f'strain = {{ field = "strain", gauges = [{", ".join(gauges)}], unit = "ustrain" }}'
        if gauges
        else ""
    )
    assumed = knowledge.assumed
    stated = f"shape_std = {{ value = {assumed.shape_std:.6g} }}" if assumed.states else ""
    rows = ["CZ", "Cm", *(f"CQ{k}" for k in numbers)]
    columns = ["alpha", "q", *(f"eta{k}" for k in numbers), *(f"etadot{k}" for k in numbers)]
    columns += aircraft.truth.inputs

    def quote(texts: Iterable[str]) -> str:
        return ", ".join(f'"{text}"' for text in texts)

    return f"""[[modal_tables]]
name = "FEM"
kind = "FEM"
numbers = [{", ".join(map(str, numbers))}]
names = [{", ".join(names)}]
symmetric = [{", ".join(["true"] * len(numbers))}]
frequency = {{ field = "frequency", unit = "Hz" }}
damping = {{ field = "damping" }}
mass = {{ field = "mass", unit = "kg*m2" }}
{stated}
{strain}
[modal_tables.shape]
field = "shape_{{number}}"
translation_columns = [2, 3, 4]
rotation_columns = [5, 6, 7]
unit = "m"
coordinates = "points"
coordinate_columns = [2, 3, 4]
coordinate_unit = "m"
points = {{ {points} }}
[[predictions]]
source = "strip theory"
[[predictions.terms]]
field = "derivatives"
coefficients = [{quote(rows)}]
variables = [{quote(columns)}]
"""


def _place(aircraft: Aircraft, points: np.ndarray) -> np.ndarray:
    """Return body coordinates in structural axes: x aft, y right, z up."""
    return np.array([aircraft.x_cg, 0, 0]) + points * [-1, 1, -1]


def _nodes(aircraft: Aircraft) -> np.ndarray:
    return np.arange(1, len(aircraft.sensors) + 1)


def _noise(aircraft: Aircraft, record: Record, sensor: Sensor) -> float:
    k = aircraft.sensors.index(sensor)
    return float(sensor.noise * record.outputs[:, k].std()) or 1e-9


def _quantity(value: float, unit: str) -> str:
    return f'{{ value = {value:.12g}, unit = "{unit}" }}'
