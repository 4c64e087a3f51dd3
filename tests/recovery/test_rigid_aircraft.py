"""A rigid transport from a text file to derivatives in both axes, without a modal table."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from file_imports import import_maneuver
from scipy import signal

from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.records.views import TransferFunction
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import RIGID_BODIES, DerivativeTable
from flexsid.sysid.model.rigid_body import Mounting, stack_rows
from flexsid.sysid.model.sensor_models import find_sensor_model
from flexsid.sysid.modes import StructuralModes
from flexsid.workflow.measurements.maneuver_spectra import read_spectra
from flexsid.workflow.measurements.reconstruction import ReconstructionQuery, reconstruct
from flexsid.workflow.measurements.recording import select_frequencies
from flexsid.workflow.measurements.transfer_functions import (
    TransferFunctionQuery,
    estimate_transfer_function,
)
from flexsid.workflow.runs.estimation import compute_run, prepare
from flexsid.workflow.runs.run_proposal import propose_run

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])

RATE_HZ = 50.0
DURATION_S = 40.0
CONDITION = FlightCondition(
    airspeed=70.0,
    density=1.0,
    mass=4600.0,
    pitch_inertia=32_000.0,
    area=39.0,
    chord=1.98,
    alpha=0.05,
    span=19.8,
    roll_inertia=21_000.0,
    yaw_inertia=46_000.0,
    product_of_inertia=1_500.0,
)
TRUE = {
    "longitudinal": {
        "CZ_alpha": -5.6, "CZ_q": -8.0, "CZ_de": -0.45,
        "Cm_alpha": -1.3, "Cm_q": -25.0, "Cm_de": -1.7,
    },
    "lateral": {
        "CY_beta": -0.9, "CY_p": -0.2, "CY_r": 0.6, "CY_da": -0.05, "CY_dr": 0.3,
        "Cl_beta": -0.12, "Cl_p": -0.55, "Cl_r": 0.19, "Cl_da": -0.2, "Cl_dr": 0.04,
        "Cn_beta": 0.13, "Cn_p": -0.06, "Cn_r": -0.19, "Cn_da": 0.01, "Cn_dr": -0.14,
    },
}  # fmt: skip
INPUTS = {"longitudinal": ("de",), "lateral": ("da", "dr")}
OUTPUTS = {
    "longitudinal": {
        "alpha": ("vane", "y"), "q": ("gyro", "y"), "theta": ("attitude", "y"),
        "az": ("accelerometer", "z"),
    },
    "lateral": {
        "beta": ("vane", "z"), "p": ("gyro", "x"), "r": ("gyro", "z"), "phi": ("attitude", "x"),
        "ay": ("accelerometer", "y"),
    },
}  # fmt: skip
STEPS = {
    "longitudinal": ((2.0, 3.5, 1), (3.5, 4.5, -1), (4.5, 5.0, 1), (5.0, 5.5, -1)),
    "lateral": ((2.0, 3.0, 1), (3.0, 5.0, -1), (5.0, 6.0, 1)),
}
UNITS = {"az": "m/s2", "ay": "m/s2"} | dict.fromkeys(("p", "q", "r"), "rad/s")

MAPPING = """
[aircraft]
name = "Transport"
[aircraft.geometry]
area = { value = 39.0, unit = "m2" }
chord = { value = 1.98, unit = "m" }
span = { value = 19.8, unit = "m" }
[aircraft.mass]
fuel = [0.5]
mass = { values = [4600.0], unit = "kg" }
pitch_inertia = { values = [32000.0], unit = "kg*m2" }
roll_inertia = { values = [21000.0], unit = "kg*m2" }
yaw_inertia = { values = [46000.0], unit = "kg*m2" }
inertia_tensor_xz = { values = [-1500.0], unit = "kg*m2" }
x_cg = { values = [0.0], unit = "m" }
[[aircraft.surfaces]]
name = "de"
[[aircraft.surfaces]]
name = "da"
[[aircraft.surfaces]]
name = "dr"
"""


def simulate(axis: str) -> dict[str, np.ndarray]:
    """A 3-2-1-1 or doublets of every surface, and the response of the sensors."""
    body, none = RIGID_BODIES[axis], np.zeros((3, 0))
    modes = StructuralModes(
        (), np.zeros(0), np.zeros(0), np.zeros(0), (), np.zeros((0, 3, 0)), np.zeros((0, 3, 0)),
        (), np.zeros((0, 0)),
    )  # fmt: skip
    mounting = Mounting((0.0, 0.0, 0.0), none, none, np.zeros(0))
    rows = [
        find_sensor_model(kind).build_row(about, body, mounting, CONDITION)
        for kind, about in OUTPUTS[axis].values()
    ]
    sensors = stack_rows(tuple(OUTPUTS[axis]), rows)
    model = AeroelasticModel(CONDITION, modes, INPUTS[axis], sensors, body)
    system = model.state_space(DerivativeTable.from_names((), INPUTS[axis], TRUE[axis], body))
    time = np.arange(0.0, DURATION_S, 1.0 / RATE_HZ)
    deflections = np.zeros((time.size, len(INPUTS[axis])))
    for k in range(len(INPUTS[axis])):
        for start, stop, sign in STEPS[axis]:
            own = (time >= start + 4.0 * k) & (time < stop + 4.0 * k)
            deflections[own, k] = 0.04 * sign
    # Deflections are limited in band, as those of a real servo are.
    numerator, denominator = signal.butter(2, 3.0, fs=RATE_HZ)
    deflections = signal.lfilter(numerator, denominator, deflections, axis=0)
    fine = signal.StateSpace(system.A, system.B, system.C, system.D)
    _, outputs, _ = signal.lsim(fine, deflections, time)
    columns: dict[str, np.ndarray] = {"t": time}
    columns |= dict(zip(INPUTS[axis], deflections.T, strict=True))
    columns |= dict(zip(OUTPUTS[axis], np.asarray(outputs).T, strict=True))
    return columns


def write_mapping(axis: str, names: Iterable[str], label: str) -> str:
    lines = [MAPPING]
    for sensors in OUTPUTS.values():
        for name, (kind, about) in sensors.items():
            lines.append(
                f'[[aircraft.sensors]]\nname = "{name}"\nkind = "{kind}"\naxis = "{about}"'
            )
    lines.append(f'[flight]\nnumber = 1\n[maneuver]\nlabel = "{label}"\naxis = "{axis}"')
    lines.append(
        '[maneuver.condition]\nairspeed = { value = 70.0, unit = "m/s" }\n'
        'density = { value = 1.0, unit = "kg/m3" }\nalpha = { value = 0.05, unit = "rad" }\n'
        '[time]\ncolumn = "t"'
    )
    for name in names:
        role = "input" if name in INPUTS[axis] else "output"
        unit = UNITS.get(name, "rad")
        lines.append(f'[[channels]]\ncolumn = "{name}"\nunit = "{unit}"\nrole = "{role}"')
    return "\n".join(lines)


def add_record(
    store: Store, folder: Path, axis: str, columns: dict[str, np.ndarray], label: str
) -> int:
    file = folder / "flight.csv"
    np.savetxt(
        file, np.stack(list(columns.values()), axis=1), delimiter=",", header=",".join(columns),
        comments="", fmt="%.12g",
    )  # fmt: skip
    names = [name for name in columns if name != "t"]
    number = import_maneuver(store, [file], write_mapping(axis, names, label)).id
    assert number is not None
    return number


def add_flight(store: Store, folder: Path, axis: str) -> int:
    return add_record(store, folder, axis, simulate(axis), axis)


@pytest.mark.parametrize("axis", ["longitudinal", "lateral"])
def test_a_text_file_gives_derivatives_in_every_axis(
    store: Store, tmp_path: Path, axis: str
) -> None:
    number = add_flight(store, tmp_path, axis)
    proposed = propose_run(store, [number])
    assert proposed.structure == Structure(modes=(), fixed={}, axis=axis)
    assert set(proposed.outputs) == set(OUTPUTS[axis])
    motion = reconstruct(store, ReconstructionQuery(maneuver_id=number))
    assert motion.n_motions == RIGID_BODIES[axis].size
    # The simulated deflections are linear between samples, which the transform does not know.
    for method, tolerance in ((Method.EE, 0.006), (Method.OE, 0.006)):
        run = EstimationRun(
            maneuver_id=number,
            method=method,
            structure=proposed.structure,
            settings=RunSettings(band_hz=(0.05, 2.0)),
        )
        found = compute_run(prepare(store, run), lambda progress: None)
        values = dict(zip(found.estimate.names, found.estimate.values.tolist(), strict=True))
        assert set(values) == set(TRUE[axis])
        for name, expected in TRUE[axis].items():
            largest = max(abs(v) for n, v in TRUE[axis].items() if n[:2] == name[:2])
            error = abs(values[name] - expected) / max(abs(expected), 0.05 * largest)
            assert error < tolerance, (method, name, values[name], expected)


def fit(
    store: Store,
    number: int,
    surface: str,
    output: str,
    zeros: int | None = None,
    poles: int | None = None,
) -> TransferFunction:
    query = TransferFunctionQuery(
        maneuver_id=number, input=surface, output=output, zeros=zeros, poles=poles
    )
    return estimate_transfer_function(store, query).function


def test_equivalent_systems_of_a_rigid_aircraft(store: Store, tmp_path: Path) -> None:
    """Pitch rate and pitch angle over elevator have the short period, with the usual orders."""
    number = add_flight(store, tmp_path, "longitudinal")
    for output, integrators in (("q", 0), ("theta", 1)):
        found = fit(store, number, "de", output)
        assert (found.n_zeros, found.n_poles, found.integrators) == (1, 2, integrators)
        (pole,) = found.poles
        assert pole.frequency_rad_s == pytest.approx(3.3017, rel=0.005)
        assert pole.damping == pytest.approx(0.5682, rel=0.005)
        assert abs(found.delay_s) < 0.005
        assert found.mismatch_cost < 1.0
        assert found.warnings == ()


def test_a_second_surface_that_moves_is_reported(store: Store, tmp_path: Path) -> None:
    number = add_flight(store, tmp_path, "lateral")
    found = fit(store, number, "da", "p", zeros=2, poles=3)
    assert (found.n_zeros, found.n_poles) == (2, 3)
    assert found.warnings[0].startswith("dr also moves in this maneuver")


def test_a_final_pitch_angle_is_continued_from_the_last_sample(
    store: Store, tmp_path: Path
) -> None:
    maneuver = store.maneuvers.get(add_flight(store, tmp_path, "longitudinal"))
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    frequencies = select_frequencies(maneuver, (0.05, 1.0))
    theta, q = read_spectra(store, maneuver, aircraft, ("theta", "q"), frequencies).values.T
    np.testing.assert_allclose(theta * 1j * frequencies.omega, q, rtol=1e-3)
