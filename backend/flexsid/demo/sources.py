"""FLEX-28 on the ground: modal tables, vibration test, predictions, model structures, mini-GVT.

A simple model: the aircraft is on its gear, which adds stiffness to every mode;
there is no airflow, and the inertia of the surfaces excites the structure.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy import fft

from flexsid.demo.aircraft import build_anti_alias_filter, describe_aircraft
from flexsid.demo.flex28 import INPUTS, Truth, UnsteadyTruth, load_nodes, load_truth
from flexsid.demo.flights import FlownManeuver, describe_excitation, design_fta, sample_excitation
from flexsid.demo.truth_flight import RATE_HZ, Recorder
from flexsid.records.aircraft import DerivativePrediction, UnsteadyPrediction
from flexsid.records.decision import ModelStructure, Structure
from flexsid.records.maneuver import GROUND, Condition, Maneuver
from flexsid.records.modal_data import MeasuredResponses, ModalKind, ModalTable
from flexsid.sysid.model.derivatives import (
    DerivativeTable,
    list_derivative_names,
    parse_derivative,
    variables,
)
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.sensor_models import ACCELEROMETER, STRAIN
from flexsid.sysid.modes import StructuralModes
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs
from flexsid.workflow.importing.flight_import import compute_largest_correlation
from flexsid.workflow.modal_data.computed_predictions import KIND, compute_spread

# --- Data of FLEX-28 before flight: modal tables, predictions, model structures -------------------

SaveArray = Callable[[np.ndarray], str]
"""Stores an array and returns its name."""

_NAMES = {7: "SW1B", 8: "AW1B", 9: "SW1T", 10: "AW1T", 11: "SFA", 12: "SWL"}

# Inviscid panel code: surface effectiveness too large, damping too small.
_PANEL_BIAS = {"alpha": 1.08, "q": 0.88, "eta": 1.10, "etadot": 0.90, "surface": 1.18}
_RESIDUAL = 0.003  # of frequencies: of an updated finite element model from those of a test
_REFERENCE_K = 0.15  # of flutter
# A stiff half-span model on a splitter plate, at low Reynolds number.
_TUNNEL_BIAS = {"alpha": 0.95, "surface": 0.86}


def build_modal_tables(
    truth: Truth, aircraft_id: int, save: SaveArray
) -> tuple[ModalTable, ModalTable]:
    """Return the updated finite element model, which is exact, and the ground vibration test."""
    modes = truth.modes
    places, shapes = load_nodes()
    symmetric = tuple(kind == "S" for kind in truth.source["mode_class"])
    names = tuple(
        _NAMES.get(number, f"{kind}{number}")
        for number, kind in zip(modes.numbers, truth.source["mode_class"], strict=True)
    )
    finite_elements = ModalTable(
        aircraft_id=aircraft_id,
        name="FEM",
        kind=ModalKind.FEM,
        fuel=tuple(modes.fuel.tolist()),
        numbers=modes.numbers,
        names=names,
        symmetric=symmetric,
        points=modes.points,
        gauges=modes.gauges,
        arrays={
            "omega": save(modes.omega),
            "omega_std": save(_RESIDUAL * modes.omega),
            "shape_std": save(np.zeros_like(modes.omega)),
            "mass": save(modes.mass),
            "shape": save(modes.shape),
            "strain": save(modes.strain),
            "nodes": save(places),
            "node_shape": save(shapes),
        },
        origin=(
            "beam finite element model of FLEX-28, updated from its ground vibration test; 25 modes"
            " at 17 fuel weights"
        ),
    )
    residual = 1.0 + _RESIDUAL * np.random.default_rng(7).standard_normal((2, modes.omega.shape[1]))
    ends = [0, -1]
    ground_test = ModalTable(
        aircraft_id=aircraft_id,
        name="GVT",
        kind=ModalKind.GVT,
        fuel=tuple(modes.fuel[ends].tolist()),
        numbers=modes.numbers,
        names=names,
        symmetric=symmetric,
        arrays={"omega": save(modes.omega[ends] * residual), "zeta": save(modes.zeta[ends])},
        origin="ground vibration test at empty and full fuel",
    )
    return finite_elements, ground_test


def build_predictions(
    truth: Truth, aircraft_id: int, save: SaveArray
) -> tuple[DerivativePrediction, DerivativePrediction]:
    """Return two predictions with typical, reproducible errors of their kind.

    A panel code or, of unsteady aerodynamics, a doublet lattice; and a wind tunnel test.
    """
    names = list_derivative_names(truth.symmetric, INPUTS)
    true = truth.derivatives.reshape(truth.fuel.size, -1)
    noise = np.random.default_rng(28).standard_normal((2, len(names)))
    measured = [
        place
        for place, name in enumerate(names)
        if parse_derivative(name)[0] in ("CZ", "Cm") and _group(name) in _TUNNEL_BIAS
    ]
    own = tuple(names[place] for place in measured)
    tunnel_factor = np.array([_TUNNEL_BIAS[_group(name)] for name in own])
    values = true[:, measured] * (tunnel_factor + 0.03 * noise[1, measured])
    tunnel = DerivativePrediction(
        aircraft_id=aircraft_id,
        source="Wind tunnel, half-span model",
        kind="wind tunnel",
        fuel=tuple(truth.fuel.tolist()),
        names=own,
        values=save(values),
        std_errors=save(0.03 * np.abs(values) + 0.002),
        note="stiff model, moments transferred to the centre of gravity at each fuel weight",
    )
    if truth.unsteady is not None:
        return build_lattice_prediction(truth, truth.unsteady, aircraft_id, save), tunnel
    panel_factor = np.array([_PANEL_BIAS[_group(name)] for name in names]) + 0.08 * noise[0]
    panel = DerivativePrediction(
        aircraft_id=aircraft_id,
        source="Panel code",
        kind="panel code",
        fuel=tuple(truth.fuel.tolist()),
        names=names,
        values=save(true * panel_factor),
        note="inviscid, eight symmetric modes; no error bounds are known",
    )
    return panel, tunnel


def build_lattice_prediction(
    truth: Truth, unsteady: UnsteadyTruth, aircraft_id: int, save: SaveArray
) -> DerivativePrediction:
    """Return the doublet lattice of FLEX-28U as a prediction at the k of flutter."""
    names = list_derivative_names(truth.symmetric, INPUTS)
    at = int(np.searchsorted(unsteady.k, _REFERENCE_K))
    values = np.real(unsteady.predicted[:, at])
    n_fuel, n_k = unsteady.predicted.shape[:2]
    return DerivativePrediction(
        aircraft_id=aircraft_id,
        source="Doublet lattice",
        kind=KIND,
        fuel=tuple(unsteady.fuel.tolist()),
        names=names,
        values=save(values.reshape(n_fuel, -1)),
        std_errors=save(
            compute_spread(values, variables(truth.symmetric, INPUTS)).reshape(n_fuel, -1)
        ),
        note=f"320 boxes on the right half, Mach 0.1, derivatives at k = {_REFERENCE_K:g}",
        unsteady=UnsteadyPrediction(
            k=tuple(unsteady.k.tolist()),
            reference_k=_REFERENCE_K,
            coefficients=save(unsteady.predicted.reshape(n_fuel, n_k, -1)),
            mach=0.1,
            n_boxes=320,
            geometry=hashlib.sha256(truth.name.encode()).hexdigest(),
        ),
    )


def build_model_structures(aircraft_id: int) -> tuple[ModelStructure, ...]:
    """Return the default model structures, with all surfaces and usable sensors."""
    steps = (
        ("SP + SW1B", (7,), "for FTA 503, whose band ends below SW1T"),
        ("SP + SW1B + SW1T", (7, 9), "for FTA 506; SFA and SWL remain as bias"),
        ("SP + four modes", (7, 9, 11, 12), "for FTA 506: SW1B, SW1T, SFA, SWL"),
    )
    return tuple(
        ModelStructure(
            aircraft_id=aircraft_id,
            name=name,
            structure=Structure(modes=modes, fixed={}),
            note=note,
        )
        for name, modes, note in steps
    )


def _group(name: str) -> str:
    variable = parse_derivative(name)[1].rstrip("0123456789")
    return variable if variable in _PANEL_BIAS else "surface"


# --- A ground vibration test of FLEX-28 on soft springs: simulated measured responses -------------

_BAND_HZ = (2.0, 30.0)
_STEP_HZ = 0.05
_NOISE = 0.01
_SHAKERS = ((1, "z"), (2, "z"), (1, "x"))
"""Tip (1 and 2) and direction of each shaker."""


def build_measured_responses(
    truth: Truth, aircraft_id: int, save: Callable[[np.ndarray], str]
) -> MeasuredResponses:
    """Return responses to shakers at the wing tips, at empty fuel and about sixty points."""
    places, shapes = load_nodes()
    modes = truth.modes.at(0.0)
    phi = np.asarray(shapes[0, :, :, :3], dtype=float) * np.array([-1.0, 1.0, -1.0])
    hertz = np.arange(*_BAND_HZ, _STEP_HZ)
    s = 2j * np.pi * hertz[:, None]
    gain = s**2 / (modes.mass * (s**2 + 2.0 * modes.zeta * modes.omega * s + modes.omega**2))
    nodes = np.arange(0, places.shape[0], 3)
    outputs = [(int(node), 2) for node in nodes]
    winglets = [int(node) for node in nodes if places[node, 2] > 0.1]
    outputs += [(node, 1) for node in winglets] + [(int(node), 0) for node in nodes[::3]]
    tips = np.argsort(np.abs(places[nodes, 1]))[-2:]
    shakers = [(int(nodes[tips[k - 1]]), "xyz".index(axis)) for k, axis in _SHAKERS]
    outputs += [shaker for shaker in shakers if shaker not in outputs]
    at = np.array([phi[:, node, axis] for node, axis in outputs])
    pushed = np.array([phi[:, node, axis] for node, axis in shakers])
    values = np.einsum("wm,om,rm->wor", gain, at, pushed)
    rng = np.random.default_rng(28)
    level = _NOISE * np.sqrt(np.mean(np.abs(values) ** 2, axis=0))
    noise = rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape)
    values = values + level * noise / np.sqrt(2.0)
    return MeasuredResponses(
        aircraft_id=aircraft_id,
        name="GVT at empty fuel",
        fuel=0.0,
        quantity="acceleration",
        outputs=tuple(f"{node + 1}+{'xyz'[axis]}" for node, axis in outputs),
        references=tuple(f"{node + 1}+{'xyz'[axis]}" for node, axis in shakers),
        arrays={
            "frequency": save(hertz),
            "values": save(values),
            "nodes": save(places[[node for node, _ in outputs]]),
            "directions": save(np.eye(3)[[axis for _, axis in outputs]]),
        },
        notes=("Responses are in m/s2/N.",),
        origin="synthetic, with one percent of noise",
    )


# --- FLEX-28 on the runway: the short record before and after each flight (mini-GVT) --------------

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
