"""FLEX-28 on the runway: the short record before and after each flight (mini-GVT).

A simple model: the aircraft is on its gear, which adds stiffness to every mode;
there is no airflow, and the inertia of the surfaces excites the structure.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy import fft

from flexsid.demo.aircraft import build_anti_alias_filter, describe_aircraft
from flexsid.demo.flex28 import INPUTS, Truth, load_truth
from flexsid.demo.flights import (
    FlownManeuver,
    describe_excitation,
    design_fta,
    sample_excitation,
)
from flexsid.demo.recorder import Recorder
from flexsid.demo.truth_flight import RATE_HZ
from flexsid.records.maneuver import GROUND, Condition, Maneuver
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.sensor_models import ACCELEROMETER, STRAIN
from flexsid.sysid.modes import StructuralModes
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs
from flexsid.workflow.importing.flight_import import compute_largest_correlation

FTA = 506
PEAK_DEG = 4.0
_GEAR_STIFFNESS = 1500.0  # of nose and main gear together, tires included [N/m]
_UNBALANCE = 4e-3  # mass times distance of a surface from its hinge [kg m]
# Points of the hinge reaction of each pair of surfaces.
_HINGES = {
    "bfs": ("ca",),
    "wf1s": ("mal", "mar"),
    "wf2s": ("mfl", "mfr"),
    "wf3s": ("ofl", "ofr"),
    "wf4s": ("oal", "oar"),
}
_SETTLING_S = 10.0


def simulate_ground_test(
    *,
    fuel: float,
    seed: int | tuple[int, ...],
    start_s: float,
    label: str,
    stiffness_lost: float = 0.0,
    noise: bool = True,
) -> FlownManeuver:
    """Simulate excitation of the parked aircraft by its surfaces; record strain and acceleration.

    Parameters
    ----------
    fuel
        Fuel fraction. [1]
    seed
        Seed of the noise.
    start_s
        Time at which the record starts; before take-off it is negative. [s]
    label
        Label of the record.
    stiffness_lost
        Relative stiffness loss of the first bending mode by damage. [1]
    noise
        False gives noise-free channels.
    """
    truth = load_truth()
    aircraft = describe_aircraft(truth)
    multisine = design_fta(FTA, PEAK_DEG)
    excitation, _ = sample_excitation(multisine)

    parked = replace(truth.condition_at(truth.flutter_speed_at(fuel), fuel), alpha=0.0, thrust=0.0)
    condition = Condition(
        airspeed_m_s=0.0,
        density_kg_m3=truth.density,
        fuel_fraction=fuel,
        mass_kg=parked.mass,
        pitch_inertia_kg_m2=parked.pitch_inertia,
        x_cg_m=parked.x_cg,
        z_cg_m=parked.z_cg,
    )
    sensors = tuple(s for s in aircraft.sensors if s.kind in (STRAIN.kind, ACCELEROMETER.kind))
    modes = _add_gear(truth.modes_at(fuel, len(truth.symmetric)), stiffness_lost)
    sensor_model = build_model(
        aircraft,
        replace(condition, airspeed_m_s=parked.airspeed),  # no elastic term depends on it
        modes,
        INPUTS,
        define_outputs(aircraft, [sensor.name for sensor in sensors]),
    ).sensors

    length = fft.next_fast_len(excitation.shape[0] + round(_SETTLING_S * RATE_HZ), real=True)
    omega = 2.0 * np.pi * fft.rfftfreq(length, 1.0 / RATE_HZ)
    s = 1j * np.maximum(omega, 1e-3)
    moved = fft.rfft(excitation, length, axis=0) * _actuator(truth, s)[:, None]
    eta = (s**2)[:, None] * (moved @ _coupling(modes))
    eta /= (s**2)[:, None] + 2.0 * s[:, None] * modes.zeta * modes.omega + modes.omega**2
    measured = np.einsum(
        "fyr,fr->fy", sensor_model.response(np.abs(s))[:, :, LONGITUDINAL.size :], eta
    )
    n_samples = excitation.shape[0]
    generator = np.random.default_rng(seed) if noise else None
    recorder = Recorder(aircraft, build_anti_alias_filter(truth.source), generator)
    surfaces = recorder.surfaces(fft.irfft(moved, length, axis=0)[:n_samples])
    return FlownManeuver(
        maneuver=Maneuver(
            aircraft_id=0,
            flight_id=0,
            label=label,
            fta=FTA,
            start_s=start_s,
            duration_s=n_samples / RATE_HZ,
            condition=condition,
            axis=GROUND,
            excitation=describe_excitation(multisine, start_s),
            max_input_correlation=compute_largest_correlation([c.samples for c in surfaces]),
            note="on the runway, no airflow",
        ),
        channels=(
            *surfaces,
            *recorder.sensors(sensors, fft.irfft(measured, length, axis=0)[:n_samples], parked),
            *recorder.commands(multisine.inputs, excitation),
        ),
        truth=DerivativeTable.from_names(truth.symmetric, INPUTS, {}),
    )


def _add_gear(modes: StructuralModes, lost: float) -> StructuralModes:
    """Return the modes with the stiffness of nose and main gear, and with the damage."""
    stiffness = modes.omega**2 * np.where(np.arange(len(modes.numbers)) == 0, 1.0 - lost, 1.0)
    for leg in ("cf", "ca"):
        travel = modes.translation[modes.points.index(leg), 2]
        stiffness = stiffness + 0.5 * _GEAR_STIFFNESS * travel**2 / modes.mass
    return replace(modes, omega=np.sqrt(stiffness))


def _coupling(modes: StructuralModes) -> np.ndarray:
    """Return the modal force per surface acceleration over modal mass, (n_u, n_modes)."""
    rows = [
        sum(modes.translation[modes.points.index(point), 2] for point in _HINGES[name])
        for name in INPUTS
    ]
    return _UNBALANCE * np.array(rows) / modes.mass


def _actuator(truth: Truth, s: np.ndarray) -> np.ndarray:
    """Return the linear actuator response; limits are not reached on the ground."""
    a = truth.actuator
    lag = s**2 + 2.0 * a.damping * a.natural_frequency * s + a.natural_frequency**2
    return a.natural_frequency**2 / lag * np.exp(-s * a.delay_s)
