"""A long record of speed, pitch and throttle from a file to derivatives and the phugoid."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from file_imports import import_maneuver
from long_flight import AREA, CHORD, INERTIA, INPUTS, MASS, PROBE_M, Flight, simulate

from flexsid.records.run import EstimationRun, Method
from flexsid.storage.store import Store
from flexsid.sysid.model.airspeed import AIRSPEED
from flexsid.workflow.measurements.reconstruction import ReconstructionQuery, reconstruct
from flexsid.workflow.runs.estimation import compute_run, prepare
from flexsid.workflow.runs.run_proposal import propose_run

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])

FLIGHT = Flight(0.0)
PHUGOID = -0.02677 + 0.16807j
"""Root of the linearised equations. [rad/s]"""
NOISE = {
    "alpha": 2e-4, "q": 2e-4, "theta": 1e-4, "ax": 0.01, "az": 0.02, "vt": 0.03,
}  # fmt: skip
KINDS = {
    "alpha": ("vane", "y", "rad"), "q": ("gyro", "y", "rad/s"), "theta": ("attitude", "y", "rad"),
    "ax": ("accelerometer", "x", "m/s2"), "az": ("accelerometer", "z", "m/s2"),
    "vt": ("airspeed", "x", "m/s"),
}  # fmt: skip


def write_mapping() -> str:
    c = FLIGHT.condition
    x, _, z = PROBE_M
    lines = [
        f"""
[aircraft]
name = "Transport"
[aircraft.geometry]
area = {{ value = {AREA}, unit = "m2" }}
chord = {{ value = {CHORD}, unit = "m" }}
span = {{ value = 19.8, unit = "m" }}
[aircraft.mass]
fuel = [0.5]
mass = {{ values = [{MASS}], unit = "kg" }}
pitch_inertia = {{ values = [{INERTIA}], unit = "kg*m2" }}
x_cg = {{ values = [0.0], unit = "m" }}
"""
    ]
    lines += [f'[[aircraft.surfaces]]\nname = "{name}"' for name in INPUTS]
    for name, (kind, axis, _) in KINDS.items():
        at = (-x, 0.0, -z) if kind in ("accelerometer", "airspeed") else (0.0, 0.0, 0.0)
        lines.append(
            f'[[aircraft.sensors]]\nname = "{name}"\nkind = "{kind}"\naxis = "{axis}"\n'
            f'location = {{ values = {list(at)}, unit = "m" }}\nnoise_std = {NOISE[name]}'
        )
    lines.append(
        '[flight]\nnumber = 1\n[maneuver]\nlabel = "long"\naxis = "longitudinal"\n'
        '[maneuver.condition]\nairspeed = { value = 70.0, unit = "m/s" }\n'
        'density = { value = 1.0, unit = "kg/m3" }\n'
        f'alpha = {{ value = {c.alpha}, unit = "rad" }}\n'
        f'thrust = {{ value = {c.thrust}, unit = "N" }}\n[time]\ncolumn = "t"'
    )
    units = dict.fromkeys(INPUTS, "rad") | {"throttle": "1"}
    units |= {name: unit for name, (_, _, unit) in KINDS.items()}
    for name, unit in units.items():
        role = "input" if name in INPUTS else "output"
        lines.append(
            f'[[channels]]\ncolumn = "{name}"\nunit = "{unit}"\nrole = "{role}"\n'
            'confirmed = ["too-small"]'
        )
    return "\n".join(lines)


@cache
def fly(scale: float) -> Mapping[str, np.ndarray]:
    return MappingProxyType(simulate(FLIGHT, scale))


def add_record(store: Store, folder: Path, scale: float, noise: float = 0.0) -> int:
    columns = dict(fly(scale))
    rng = np.random.default_rng(4)
    for name, std in NOISE.items():
        columns[name] = columns[name] + noise * std * rng.normal(size=columns[name].size)
    file = folder / "long.csv"
    np.savetxt(
        file, np.stack(list(columns.values()), axis=1), delimiter=",", header=",".join(columns),
        comments="", fmt="%.14g",
    )  # fmt: skip
    number = import_maneuver(store, [file], write_mapping()).id
    assert number is not None
    return number


def estimate(store: Store, number: int, method: Method):
    proposed = propose_run(store, [number], axis=AIRSPEED.axis)
    assert proposed.structure.axis == AIRSPEED.axis
    assert set(proposed.outputs) == set(KINDS)
    run = EstimationRun(
        maneuver_id=number,
        method=method,
        structure=proposed.structure,
        settings=proposed.settings,
    )
    return compute_run(prepare(store, run), lambda progress: None)


@pytest.mark.parametrize(
    ("method", "tolerance"),
    [(Method.EE, 0.05), pytest.param(Method.OE, 0.002, marks=pytest.mark.long)],
)
def test_a_record_of_small_motion_gives_every_derivative_and_the_phugoid(
    store: Store, tmp_path: Path, method: Method, tolerance: float
) -> None:
    found = estimate(store, add_record(store, tmp_path, scale=0.002), method)
    values = dict(zip(found.estimate.names, found.estimate.values.tolist(), strict=True))
    truth = FLIGHT.derivatives()
    assert values.keys() == truth.keys()
    for name, expected in truth.items():
        # Weak terms are compared with the largest one of their coefficient.
        row = [abs(v) for n, v in truth.items() if n[:2] == name[:2] and not n.endswith("_q")]
        error = abs(values[name] - expected) / max(abs(expected), 0.5 * max(row))
        assert error < tolerance, (name, values[name], expected)
    poles = {pole.name: pole.value for pole in found.poles}
    assert list(poles) == ["SP", "PH"]
    assert poles["PH"] == pytest.approx(PHUGOID, rel=0.005)


@pytest.mark.parametrize("method", [pytest.param(Method.EE, marks=pytest.mark.long), Method.OE])
def test_the_truth_is_within_the_standard_errors_of_a_noisy_record(
    store: Store, tmp_path: Path, method: Method
) -> None:
    found = estimate(store, add_record(store, tmp_path, scale=0.1, noise=1.0), method)
    truth = FLIGHT.derivatives()
    error = found.estimate.values - np.array([truth[name] for name in found.estimate.names])
    assert np.mean(np.abs(error) < 2.0 * found.estimate.std_errors) > 0.85
    (phugoid,) = (pole for pole in found.poles if pole.name == "PH")
    assert abs(phugoid.value.imag - PHUGOID.imag) < 2.0 * phugoid.imag_std


def test_motion_with_airspeed_is_reconstructed(store: Store, tmp_path: Path) -> None:
    number = add_record(store, tmp_path, scale=0.1, noise=1.0)
    found = reconstruct(
        store, ReconstructionQuery(maneuver_id=number, axis="longitudinal-airspeed")
    )
    assert found.offered == (
        "CZ", "Cm", "CX", "alpha", "q", "V", "qdot", "Vdot",
    )  # fmt: skip
    speed = next(trace for trace in found.traces if trace.name == "V")
    assert speed.unit == "m/s"
    true = fly(0.1)
    expected = np.interp(found.time_s, true["t"], true["vt"])  # of the probe, nearly
    expected -= expected.mean()
    error = speed.values - speed.values.mean() - expected
    assert np.std(error) < 0.1 * np.std(expected)
