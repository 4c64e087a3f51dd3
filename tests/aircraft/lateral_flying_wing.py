"""The antisymmetric half of FLEX-28 from the data beside the project, in SI units."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import interpolate

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.importers.aircraft import _combine_pairs, _combine_surfaces
from flexsid.records.aircraft import Aircraft, DerivativePrediction, Sensor, Surface
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, VANE
from flexsid.sysid.modes import ModeTable, StructuralModes
from flexsid.units import factor

FOLDER = Path(__file__).parents[2].parent / "shared/data/flex28_lateral"
FOOT, INERTIA = factor("ft", "length"), factor("slug*ft2", "inertia")

needs_records = pytest.mark.skipif(not FOLDER.exists(), reason="data beside the project")


@cache
def load_source() -> dict[str, Any]:
    return json.loads((FOLDER / "flex28_lateral.json").read_text(encoding="utf-8"))


def interpolate_fuel(values: Any, fuel: float) -> np.ndarray:
    source = load_source()
    return interpolate.interp1d(source["fuel_fraction"], np.array(values), axis=0)(fuel)


def build_mode_table() -> ModeTable:
    """The eight antisymmetric modes over fuel."""
    source = load_source()
    fuel = np.array(source["fuel_fraction"])
    empty, full = np.array(source["zeta_empty"]), np.array(source["zeta_full"])
    omega = np.array(source["omega_rad_s"])
    shape = np.stack([np.array(one) for one in source["modeshape_at"].values()], axis=2)
    strain = np.stack([np.array(one) for one in source["strain"].values()], axis=2)
    return ModeTable(
        fuel=fuel,
        numbers=tuple(source["mode_number"]),
        omega=omega,
        zeta=empty + fuel[:, None] * (full - empty),
        mass=np.full(omega.shape, source["generalized_mass"] * INERTIA),
        points=tuple(source["modeshape_at"]),
        shape=shape * np.repeat([FOOT, 1.0], 3),
        gauges=tuple(source["strain"]),
        strain=strain * factor("ustrain", "strain"),
    )


def select_modes(table: ModeTable, numbers: tuple[int, ...]) -> ModeTable:
    """The table with some of its modes."""
    columns = [table.numbers.index(number) for number in numbers]
    arrays = ("omega", "zeta", "mass", "shape", "strain")
    return replace(table, numbers=numbers, **{n: getattr(table, n)[:, columns] for n in arrays})


def modes_at(fuel: float, count: int) -> StructuralModes:
    table = build_mode_table()
    return table.at(fuel).select(table.numbers[:count])


def derivatives_at(fuel: float, count: int) -> DerivativeTable:
    """True derivatives at a fuel fraction; the other modes are truncated."""
    source = load_source()
    tables = []
    for at_fuel in source["derivatives"]:
        rows = [at_fuel[name] for name in ("CY", "Cl", "Cn")] + at_fuel["CQ"]
        tables.append(
            [
                [row["beta"], row["p"], row["r"], *row["eta"], *row["etadot"], *row["delta"]]
                for row in rows
            ]
        )
    modes, inputs = tuple(source["mode_number"]), tuple(source["surfaces"])
    table = DerivativeTable(modes, inputs, interpolate_fuel(tables, fuel), LATERAL)
    return table.select(modes[:count], inputs)


def condition_at(
    airspeed_ft_s: float, fuel: float, product_slug_ft2: float | None = None
) -> FlightCondition:
    """Level flight, with another product of inertia if one is given."""
    source = load_source()

    def at(name: str) -> float:
        return float(interpolate_fuel(source[name], fuel))

    product = at("Ixz") if product_slug_ft2 is None else product_slug_ft2
    density, area = source["rho"] * factor("slug/ft3", "density"), source["S"] * FOOT**2
    mass, airspeed = at("mass_slug") * factor("slug", "mass"), airspeed_ft_s * FOOT
    lift = mass * GRAVITY / (0.5 * density * airspeed**2 * area)
    return FlightCondition(
        airspeed=airspeed,
        density=density,
        mass=mass,
        pitch_inertia=1.0,
        area=area,
        chord=source["cbar"] * FOOT,
        alpha=lift / source["CL_alpha"],
        x_cg=at("xcg_struct") * FOOT,
        z_cg=at("zcg_struct") * FOOT,
        span=source["b"] * FOOT,
        roll_inertia=at("Ixx") * INERTIA,
        yaw_inertia=at("Izz") * INERTIA,
        product_of_inertia=product * INERTIA,
    )


def describe_lateral_aircraft() -> Aircraft:
    """FLEX-28 with antisymmetric surfaces, lateral sensors and its inertia in roll and yaw."""
    source, symmetric = load_source(), describe_aircraft(load_truth())
    noise = source["noise_sigma"]

    def add(name: str, kind: str, point: str, axis: str, std: float) -> Sensor:
        x, y, z = (FOOT * value for value in source["points_struct"][point])
        return Sensor(
            name=name,
            kind=kind,
            point=point,
            axis=axis,
            location_m=(x, y, z),
            instrument=kind,
            noise_std=std,
        )

    sensors = (
        *symmetric.sensors,
        add("beta", VANE.kind, "boom", "z", noise["vane_rad"]),
        add("p", GYRO.kind, "nose_gyro", "x", noise["gyro_rad_s"]),
        add("r", GYRO.kind, "nose_gyro", "z", noise["gyro_rad_s"]),
        add("phi", ATTITUDE.kind, "egi_att", "x", noise["attitude_rad"]),
    )
    mass = replace(
        symmetric.mass,
        roll_inertia_kg_m2=tuple((INERTIA * np.array(source["Ixx"])).tolist()),
        yaw_inertia_kg_m2=tuple((INERTIA * np.array(source["Izz"])).tolist()),
        product_of_inertia_kg_m2=tuple((INERTIA * np.array(source["Ixz"])).tolist()),
    )
    surfaces = tuple(
        Surface(
            name=name,
            instrument="potentiometer",
            servo="servo",
            noise_std_rad=noise["pot_rad"] / np.sqrt(2.0),
        )
        for name in source["surfaces"]
    )
    return replace(
        symmetric,
        name="FLEX-28 lateral",
        mass=mass,
        surfaces=(*symmetric.surfaces, *surfaces),
        sensors=sensors,
        combinations=(
            *symmetric.combinations,
            *_combine_pairs(("antisymmetric",), symmetric.sensors),
        ),
    )


def describe_independent_aircraft() -> Aircraft:
    """FLEX-28 with ten single surfaces, and their parts as inputs of both axes."""
    lateral = describe_lateral_aircraft()
    singles = tuple(
        Surface(
            name=f"{name[:-1]}{side}",
            instrument="potentiometer",
            servo="servo",
            noise_std_rad=load_source()["noise_sigma"]["pot_rad"],
        )
        for name in load_source()["surfaces"]
        for side in "lr"
    )
    parts, combinations = _combine_surfaces(("symmetric", "antisymmetric"), singles)
    return replace(
        lateral,
        surfaces=(*singles, *parts),
        combinations=(*lateral.combinations, *combinations),
    )


def build_whole_mode_table() -> ModeTable:
    """All modes of FLEX-28, the antisymmetric ones as in the lateral data."""
    truth, lateral = load_truth(), build_mode_table()
    modes = truth.modes
    columns = [modes.numbers.index(number) for number in lateral.numbers]
    points = [modes.points.index(name) for name in lateral.points]
    gauges = [modes.gauges.index(name) for name in lateral.gauges]
    omega, zeta = modes.omega.copy(), modes.zeta.copy()
    shape, strain = modes.shape.copy(), modes.strain.copy()
    omega[:, columns], zeta[:, columns] = lateral.omega, lateral.zeta
    for own, column in enumerate(columns):
        shape[:, column, points] = lateral.shape[:, own]
        strain[:, column, gauges] = lateral.strain[:, own]
    return replace(modes, omega=omega, zeta=zeta, shape=shape, strain=strain)


MAPPING = """
[aircraft]
name = "FLEX-28 lateral"

[flight]
number = 201

[maneuver]
label = "{file}"
axis = "lateral"

[maneuver.condition]
airspeed = { field = "airspeed_ft_s", unit = "ft/s" }
density = { field = "rho", unit = "slug/ft3" }
fuel_fraction = { field = "fuel_fraction" }

[excitation]
period = { field = "period_s", unit = "s" }
first = { field = "first_harmonic" }
per_input = { field = "harmonics_per_input" }
stride = { field = "harmonic_stride" }
order = { field = "interleaving", name = "{label}" }

[time]
column = "t_s"

[[channels]]
array = "inputs"
labels = "input_names"
unit = "rad"
role = "input"

[[channels]]
array = "multisine_command"
labels = "input_names"
name = "{label}_command"
unit = "rad"
role = "command"

[[channels]]
array = "outputs"
labels = "output_names"
role = "output"

[channels.unit]
alpha = "rad"
beta = "rad"
p = "rad/s"
q = "rad/s"
r = "rad/s"
theta = "rad"
phi = "rad"
psi = "rad"
"a?_*" = "g"
"s_*" = "ustrain"
"""


def add_lateral_aircraft(
    store: Store, error: float = 0.2, n_modes: int = 8, *, noise: bool = True
) -> Aircraft:
    """Store the aircraft with its modal table and a prediction that is wrong by up to a share.

    It has as many modes, and noise on the surfaces, as the aircraft that flew.
    """
    table = build_mode_table()
    table = select_modes(table, table.numbers[:n_modes])
    values = derivatives_at(0.5, n_modes).named()
    symmetric = (False,) * n_modes
    aircraft = describe_lateral_aircraft()
    aircraft = aircraft if noise else without_surface_noise(aircraft)
    return _add_aircraft(store, aircraft, table, symmetric, values, error)


def add_independent_aircraft(
    store: Store, error: float = 0.2, n_modes: int = 8, *, noise: bool = True
) -> Aircraft:
    """Store the aircraft with single surfaces, modes of both axes and a prediction of both."""
    truth, antisymmetric = load_truth(), build_mode_table().numbers[:n_modes]
    values = derivatives_at(0.5, n_modes).named() | truth.derivatives_at(0.5, n_modes).named()
    numbers = tuple(sorted((*truth.symmetric[:n_modes], *antisymmetric)))
    table = select_modes(build_whole_mode_table(), numbers)
    symmetric = tuple(number in truth.symmetric for number in numbers)
    aircraft = describe_independent_aircraft()
    aircraft = aircraft if noise else without_surface_noise(aircraft)
    return _add_aircraft(store, aircraft, table, symmetric, values, error)


def without_surface_noise(aircraft: Aircraft) -> Aircraft:
    """The aircraft with exact potentiometers."""
    surfaces = tuple(replace(surface, noise_std_rad=None) for surface in aircraft.surfaces)
    return replace(aircraft, surfaces=surfaces)


def _add_aircraft(
    store: Store,
    described: Aircraft,
    table: ModeTable,
    symmetric: tuple[bool, ...],
    values: dict[str, float],
    error: float,
) -> Aircraft:
    names = load_source()["mode_names"]
    aircraft = store.aircraft.add(described)
    save = store.arrays.put
    store.modal_tables.add(
        ModalTable(
            aircraft_id=aircraft.id or 0,
            name="FEM",
            kind=ModalKind.FEM,
            fuel=tuple(table.fuel.tolist()),
            numbers=table.numbers,
            names=tuple(names.get(str(n), f"mode {n}") for n in table.numbers),
            symmetric=symmetric,
            points=table.points,
            gauges=table.gauges,
            arrays={
                "omega": save(table.omega),
                "shape_std": save(np.zeros_like(table.omega)),  # those of the truth
                "zeta": save(table.zeta),
                "mass": save(table.mass),
                "shape": save(table.shape),
                "strain": save(table.strain),
            },
        )
    )
    wrong = 1.0 + error * np.random.default_rng(3).uniform(-1.0, 1.0, len(values))
    store.predictions.add(
        DerivativePrediction(
            aircraft_id=aircraft.id or 0,
            source="Panel code",
            kind="panel code",
            fuel=(0.5,),
            names=tuple(values),
            values=save((np.array(list(values.values())) * wrong)[None]),
        )
    )
    return aircraft


def read_truth(record: str, axis: str = "lateral") -> dict[str, float]:
    """True derivatives of a record by name."""
    with np.load(FOLDER / f"records/{record}.npz") as data:
        lateral = axis == "lateral"
        columns = data["true_lateral_columns" if lateral else "true_columns"].tolist()
        modes = data["lateral_modes" if lateral else "symmetric_modes"].tolist()
        modal = data["true_CQ_lateral" if lateral else "true_CQ"]
        forces = ("CY", "Cl", "Cn") if lateral else ("CZ", "Cm")
        rows = {name: data[f"true_{name}"] for name in forces}
        rows |= {f"CQ{m}": row for m, row in zip(modes, modal, strict=True)}
    numbered = {}
    for column in columns:
        head = column.rstrip("0123456789")
        is_modal = head in ("eta", "etadot")
        numbered[column] = f"{head}{modes[int(column[len(head) :]) - 1]}" if is_modal else column
    return {
        f"{row}_{numbered[column]}": float(value)
        for row, values in rows.items()
        for column, value in zip(columns, values, strict=True)
    }
