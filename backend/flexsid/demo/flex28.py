"""True parameters of FLEX-28: the numbers of ``data/flex28.json`` in SI units and radians.

FLEX-28U is the same aircraft with unsteady aerodynamics, those of ``data/flex28_unsteady.npz``.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Any

import numpy as np
from scipy import interpolate

from flexsid.errors import BadInput
from flexsid.records.condition_sheet import SimulatedAircraft
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.frequency_shape import FrequencyShape, build_frequency_shape
from flexsid.sysid.modes import ModeTable, StructuralModes
from flexsid.sysid.signals import interpolate as interpolate_rows
from flexsid.sysid.simulation.closed_loop import Actuator, ScheduledController
from flexsid.units import factor

NAME, UNSTEADY_NAME = "FLEX-28", "FLEX-28U"
"""Of the aircraft with quasi-steady and with unsteady aerodynamics."""

INPUTS = ("bfs", "wf1s", "wf2s", "wf3s", "wf4s")
"""Symmetric surface pairs by their names in the workbench."""

_FOOT = factor("ft", "length")
_SLUG = factor("slug", "mass")
_INERTIA = factor("slug*ft2", "inertia")
_DENSITY = factor("slug/ft3", "density")
_MICROSTRAIN = factor("ustrain", "strain")
_DEGREE = factor("deg", "angle")

# Open-loop flutter speed of the eight-mode truth, from its eigenvalues. [ft/s]
_FLUTTER_FUEL = np.linspace(0.0, 1.0, 17)
_FLUTTER_SPEED = (
    198.996, 198.157, 197.447, 196.806, 196.264, 195.777, 195.323, 194.954, 194.603,
    194.285, 194.004, 193.723, 193.470, 193.240, 193.004, 192.819, 192.628,
)  # fmt: skip

# The same of FLEX-28U, by the p-k method. [ft/s]
_UNSTEADY_FLUTTER_SPEED = (209.185, 204.649, 201.118, 195.652)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class UnsteadyTruth:
    """Air forces of FLEX-28U by fuel and reduced frequency, as a doublet lattice predicts them.

    Those of the aircraft are these times ``factors``, which no prediction knows.
    """

    k: np.ndarray
    fuel: np.ndarray
    predicted: np.ndarray  # (fuel, k, rows, columns) of the eight symmetric modes
    factors: np.ndarray  # (rows, columns)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Truth:
    """The simulated aircraft; ``source`` is the content of the file in its units.

    Its derivatives are those at k = 0 where the air forces are ``unsteady``.
    """

    name: str
    source: dict[str, Any]
    fuel: np.ndarray
    area: float
    chord: float
    span: float
    density: float
    mass: np.ndarray
    pitch_inertia: np.ndarray
    x_cg: np.ndarray
    z_cg: np.ndarray
    symmetric: tuple[int, ...]
    modes: ModeTable
    locations: dict[str, np.ndarray]
    derivatives: np.ndarray  # (fuel, rows, columns) of the eight symmetric modes
    flutter_fuel: np.ndarray
    flutter_speed: np.ndarray
    actuator: Actuator
    controller: ScheduledController
    unsteady: UnsteadyTruth | None = None

    def flutter_speed_at(self, fuel: float) -> float:
        """Return the open-loop flutter speed. [m/s]"""
        return float(np.interp(fuel, self.flutter_fuel, self.flutter_speed))

    def modes_at(self, fuel: float, count: int) -> StructuralModes:
        """Return the first ``count`` symmetric modes at a fuel fraction."""
        return self.modes.at(fuel).select(self.symmetric[:count])

    def derivatives_at(self, fuel: float, count: int) -> DerivativeTable:
        """Return the true derivatives at a fuel fraction, with the other modes truncated."""
        values = interpolate.interp1d(self.fuel, self.derivatives, axis=0)(fuel)
        return DerivativeTable(self.symmetric, INPUTS, values).select(
            self.symmetric[:count], INPUTS
        )

    def shape_at(self, fuel: float, count: int) -> FrequencyShape | None:
        """Return the frequency shape of the derivatives; None where they are quasi-steady."""
        if self.unsteady is None:
            return None
        predicted = interpolate_rows(self.unsteady.fuel, self.unsteady.predicted, fuel)
        names = list_derivative_names(self.symmetric, INPUTS)
        by_name = dict(zip(names, predicted.reshape(len(self.unsteady.k), -1).T, strict=True))
        modes = self.symmetric[:count]
        return build_frequency_shape(
            modes, INPUTS, self.unsteady.k, by_name, 0.0, smallest_ratio=0.0
        )

    def without(self, absent: Sequence[str]) -> Truth:
        """Return the aircraft with some derivatives zero, to test model structure determination."""
        if not absent:
            return self
        names = list_derivative_names(self.symmetric, INPUTS)
        unknown = sorted(set(absent) - set(names))
        if unknown:
            raise BadInput(f"FLEX-28 has no derivative {', '.join(unknown)}")
        derivatives = self.derivatives.copy()
        flat = derivatives.reshape(len(derivatives), -1)
        flat[:, [names.index(name) for name in absent]] = 0.0
        return replace(self, derivatives=derivatives)

    def condition_at(self, airspeed: float, fuel: float) -> FlightCondition:
        """Return the trimmed level flight condition: lift equals weight, thrust equals drag."""
        mass = float(np.interp(fuel, self.fuel, self.mass))
        force = 0.5 * self.density * airspeed**2 * self.area
        lift = mass * GRAVITY / force
        drag = self.source["drag"]
        induced = 1.0 / (np.pi * drag["e"] * drag["AR"])
        lift_slope = -float(np.interp(fuel, self.fuel, self.derivatives[:, 0, 0]))
        return FlightCondition(
            airspeed=airspeed,
            density=self.density,
            mass=mass,
            pitch_inertia=float(np.interp(fuel, self.fuel, self.pitch_inertia)),
            area=self.area,
            chord=self.chord,
            alpha=lift / lift_slope,
            thrust=force * (drag["CDmin"] + induced * lift**2),
            x_cg=float(np.interp(fuel, self.fuel, self.x_cg)),
            z_cg=float(np.interp(fuel, self.fuel, self.z_cg)),
            induced_drag=induced,
        )

    def body_position(self, point: str, condition: FlightCondition) -> np.ndarray:
        """Return the position of a point relative to the c.g., in body axes. [m]"""
        aft, right, up = self.locations[point]
        return np.array([condition.x_cg - aft, right, condition.z_cg - up])


@cache
def load_truth(*, unsteady: bool = False) -> Truth:
    """Return FLEX-28, or FLEX-28U with unsteady aerodynamics, read once."""
    if unsteady:
        return _load_unsteady_truth()
    source = json.loads(_data("flex28.json").read_text(encoding="utf-8"))
    dynamics, law = source["dynamics"]["actuator"], source["controller"]
    delay = dynamics["delay_s"]
    return Truth(
        name=NAME,
        source=source,
        fuel=np.array(source["fuel_fraction"]),
        area=source["S"] * _FOOT**2,
        chord=source["cbar"] * _FOOT,
        span=source["b"] * _FOOT,
        density=source["rho"] * _DENSITY,
        mass=np.array(source["mass_slug"]) * _SLUG,
        pitch_inertia=np.array(source["Iyy"]) * _INERTIA,
        x_cg=np.array(source["xcg_struct"]) * _FOOT,
        z_cg=np.array(source["zcg_struct"]) * _FOOT,
        symmetric=tuple(source["sym_modes"]),
        modes=_modes(source),
        locations={
            name: np.array(place) * _FOOT for name, place in source["points_struct"].items()
        },
        derivatives=np.stack([_table(at_fuel) for at_fuel in source["derivatives"]]),
        flutter_fuel=_FLUTTER_FUEL,
        flutter_speed=np.array(_FLUTTER_SPEED) * _FOOT,
        actuator=Actuator(
            natural_frequency=dynamics["wn"],
            damping=dynamics["zeta"],
            delay_s=delay,
            rate_limit=dynamics["rate_limit_deg_s"] * _DEGREE,
            position_limit=dynamics["pos_limit_deg"] * _DEGREE,
        ),
        controller=ScheduledController(
            surfaces=tuple(f"{name}s" for name in law["surf"]),
            gains=np.array(law["K"]),
            low_speed=law["V_lo"] * _FOOT,
            high_speed=law["V_hi"] * _FOOT,
            least_gain=law["g_min"],
            filter_corner=law["filter_wc"],
            # The delay of the file is that of the whole loop, including the actuator.
            delay_s=law["total_delay_s"] - delay,
        ),
    )


def _load_unsteady_truth() -> Truth:
    with _data("flex28_unsteady.npz").open("rb") as stream, np.load(stream) as data:
        unsteady = UnsteadyTruth(
            k=data["k"], fuel=data["fuel"], predicted=data["C"], factors=data["factors"]
        )
    truth = load_truth()
    at_rest = np.real(unsteady.predicted[:, 0]) * unsteady.factors
    return replace(
        truth,
        name=UNSTEADY_NAME,
        derivatives=interpolate_rows(unsteady.fuel, at_rest, truth.fuel),
        flutter_fuel=unsteady.fuel,
        flutter_speed=np.array(_UNSTEADY_FLUTTER_SPEED) * _FOOT,
        unsteady=unsteady,
    )


def load_nodes() -> tuple[np.ndarray, np.ndarray]:
    """Return nodes, (K, 3) in structural axes [m], and their shapes (F, n, K, 6) [m, rad]."""
    with _data("modeshape_grid.npz").open("rb") as stream, np.load(stream) as grid:
        return grid["points_struct"] * _FOOT, _shape_to_si(grid["phi_body"])


def _data(name: str) -> Traversable:
    return resources.files("flexsid.demo").joinpath("data", name)


def _modes(source: dict[str, Any]) -> ModeTable:
    fuel = np.array(source["fuel_fraction"])
    empty, full = np.array(source["zeta_empty"]), np.array(source["zeta_full"])
    omega = np.array(source["omega_rad_s"])
    shapes = np.stack([np.array(shape) for shape in source["modeshape_at"].values()], axis=2)
    strain = np.stack([np.array(gauge) for gauge in source["strain"].values()], axis=2)
    return ModeTable(
        fuel=fuel,
        numbers=tuple(source["mode_number"]),
        omega=omega,
        zeta=empty + fuel[:, None] * (full - empty),
        mass=np.full(omega.shape, source["generalized_mass"] * _INERTIA),
        points=tuple(source["modeshape_at"]),
        shape=_shape_to_si(shapes),
        gauges=tuple(source["strain"]),
        strain=strain * _MICROSTRAIN,
    )


def _shape_to_si(shape: np.ndarray) -> np.ndarray:
    return shape * np.repeat([_FOOT, 1.0], 3).astype(shape.dtype)


def _table(at_fuel: dict[str, Any]) -> np.ndarray:
    rows = [at_fuel["CZ"], at_fuel["Cm"], *at_fuel["CQ"]]
    return np.array(
        [[row["alpha"], row["q"], *row["eta"], *row["etadot"], *row["delta"]] for row in rows]
    )


def _compute_derivatives(fuel: float) -> dict[str, float]:
    truth = load_truth()
    return truth.derivatives_at(fuel, len(truth.symmetric)).named()


SIMULATED = SimulatedAircraft(name=NAME, compute_derivatives=_compute_derivatives)
"""The demonstration, whose sheet of evidence can show the truth."""
