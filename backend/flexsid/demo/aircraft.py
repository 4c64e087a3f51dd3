"""FLEX-28 as defined in the workbench: geometry, mass, surfaces, sensors and instruments."""

from __future__ import annotations

import re
from math import pi
from typing import Any

import numpy as np

from flexsid.demo.flex28 import INPUTS, Truth
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    DragPolar,
    FlutterTable,
    Geometry,
    MassTable,
    Sensor,
    Surface,
    ThrustTable,
)
from flexsid.records.flutter import ControlLaw, Controller
from flexsid.sysid.model.sensor_models import (
    ACCELEROMETER,
    ATTITUDE,
    GYRO,
    STRAIN,
    VANE,
    Butterworth,
    Instrument,
    SecondOrder,
)
from flexsid.units import factor

_RIGHT_ACCELEROMETERS = ("az_mfr", "az_mar", "az_ofr", "az_oar", "ax_oar", "ay_wlr")

_DESCRIPTION = (
    "Invented flexible flying wing of 28 ft span with two full-span rows of trailing-edge "
    "surfaces. Every number comes from a beam finite element model and a {} lattice "
    "made for this purpose; none is of a real aircraft."
)


_STATIC_N = 300.0  # of one engine in standard air
_HELD_S = 1e-3  # zero-order hold of the flight computer; half of it is a delay


def describe_aircraft(truth: Truth) -> Aircraft:
    """Return the definition of the aircraft, with exact airframe data and typical noise."""
    source = truth.source
    noise = source["noise_sigma"]
    drag = source["drag"]
    return Aircraft(
        name=truth.name,
        description=_DESCRIPTION.format("vortex" if truth.unsteady is None else "doublet"),
        geometry=Geometry(area_m2=truth.area, chord_m=truth.chord, span_m=truth.span),
        mass=MassTable(
            fuel=tuple(truth.fuel.tolist()),
            mass_kg=tuple(truth.mass.tolist()),
            pitch_inertia_kg_m2=tuple(truth.pitch_inertia.tolist()),
            x_cg_m=tuple(truth.x_cg.tolist()),
            z_cg_m=tuple(truth.z_cg.tolist()),
            mass_std=0.0,  # the airframe data are those of the truth
            inertia_std=0.0,
        ),
        surfaces=tuple(
            Surface(
                name=name,
                instrument="potentiometer",
                servo="servo",
                noise_std_rad=noise["pot_rad"],
            )
            for name in INPUTS
        ),
        sensors=_sensors(truth),
        combinations=_combinations(source),
        instruments=_instruments(source),
        polar=DragPolar(
            cd_min=drag["CDmin"],
            oswald=drag["e"],
            aspect_ratio=drag["AR"],
            lift_slope=float(-truth.derivatives[:, 0, 0].mean()),
        ),
        flutter=FlutterTable(
            fuel=tuple(truth.flutter_fuel.tolist()), speed_m_s=tuple(truth.flutter_speed.tolist())
        ),
        thrust=build_thrust_table(),
    )


def build_thrust_table() -> ThrustTable:
    """Return the thrust of two turbojets: cubic in rotation speed, decreasing with temperature."""
    rpm = np.arange(30e3, 100e3, 10e3)
    kelvin = np.array([263.15, 288.15, 313.15])
    newton = _STATIC_N * (rpm[:, None] / rpm[-1]) ** 3 * np.sqrt(288.15 / kelvin)
    return ThrustTable(
        engines=("engine_speed_l", "engine_speed_r"),
        engine_speed_rad_s=tuple((rpm * factor("rpm", "angular rate")).tolist()),
        total_temperature_k=tuple(kelvin.tolist()),
        thrust_n=tuple(tuple(row) for row in np.round(newton, 1).tolist()),
        source="Invented ground test of one engine",
    )


def describe_controller(truth: Truth, aircraft_id: int) -> Controller:
    """Return the control law; its linear schedule is defined by two airspeeds."""
    law = truth.controller
    corner = law.filter_corner
    lagged = ((-corner, 0.0), (0.0, -corner)), ((corner, 0.0), (0.0, corner))
    lowest = law.low_speed + law.least_gain * (law.high_speed - law.low_speed)
    return Controller(
        aircraft_id=aircraft_id,
        name="Pitch-rate and attitude feedback",
        reads=("q", "theta"),
        drives=law.surfaces,
        laws=tuple(
            ControlLaw(
                airspeed_m_s=float(airspeed),
                A=lagged[0],
                B=lagged[1],
                C=tuple(tuple(row) for row in (-law.gains_at(airspeed)).tolist()),
                D=((0.0, 0.0),) * len(law.surfaces),
            )
            for airspeed in (lowest, law.high_speed)
        ),
        delay_s=law.delay_s,
    )


def build_anti_alias_filter(source: dict[str, Any]) -> Butterworth:
    """Return the anti-alias filter of all recorded channels."""
    return _butterworth(source["dynamics"]["antialias"])


def _butterworth(entry: dict[str, Any]) -> Butterworth:
    return Butterworth(order=entry["order"], corner=2.0 * pi * entry["fc_hz"])


def _instruments(source: dict[str, Any]) -> dict[str, Instrument]:
    """Return sensor dynamics, anti-alias filter and delay by kind of channel."""
    dynamics = source["dynamics"]
    last = build_anti_alias_filter(source)
    delay = dynamics["channel_delay_s"]

    def second_order(kind: str) -> SecondOrder:
        entry = dynamics[kind]
        return SecondOrder(natural_frequency=entry["wn"], damping=entry["zeta"])

    return {
        "servo": Instrument(
            elements=(second_order("actuator"),),
            delay_s=dynamics["actuator"]["delay_s"] + 0.5 * _HELD_S,
        ),
        "potentiometer": Instrument(elements=(_butterworth(dynamics["pot_filter"]), last)),
        "accelerometer": Instrument(
            elements=(second_order("accelerometer"), last), delay_s=delay["accel"]
        ),
        "gyro": Instrument(elements=(second_order("gyro"), last), delay_s=delay["gyro"]),
        "vane": Instrument(elements=(last,), delay_s=delay["vane"]),
        "attitude": Instrument(elements=(last,), delay_s=delay["attitude"]),
        "strain": Instrument(elements=(last,), delay_s=delay["strain"]),
    }


def _sensors(truth: Truth) -> tuple[Sensor, ...]:
    """Return all 45 sensors in recording order: alpha, q, theta, accelerometers, gauges."""
    noise = truth.source["noise_sigma"]
    place = truth.locations

    def at(name: str, kind: str, point: str, axis: str, std: float) -> Sensor:
        x, y, z = map(float, place.get(point, (0.0, 0.0, 0.0)))
        return Sensor(
            name=name,
            kind=kind,
            point=point,
            axis=axis,
            location_m=(x, y, z),
            instrument=kind,
            noise_std=std,
        )

    in_g = noise["accel_g"] * factor("g", "acceleration")
    return (
        at("alpha", VANE.kind, "boom", "y", noise["vane_rad"]),
        at("q", GYRO.kind, "nose_gyro", "y", noise["gyro_rad_s"]),
        at("theta", ATTITUDE.kind, "egi_att", "y", noise["attitude_rad"]),
        *(
            at(entry["id"], ACCELEROMETER.kind, entry["point"], entry["axis"], in_g)
            for entry in truth.source["accelerometers"]
        ),
        *(
            at(
                f"s_{gauge}",
                STRAIN.kind,
                gauge,
                "y",
                noise["strain_ue"] * factor("ustrain", "strain"),
            )
            for gauge in truth.modes.gauges
        ),
    )


def _combinations(source: dict[str, Any]) -> tuple[Combination, ...]:
    """Return symmetric parts of left and right pairs (Eq. 3).

    Lateral accelerometers measure a symmetric motion with opposite signs.
    """
    side = re.compile("r(?=_|$)")  # in az_ofr, s_bend1r, s_ros3r_m45
    names = (*_RIGHT_ACCELEROMETERS, *(f"s_{gauge}" for gauge in source["strain"]))
    return tuple(
        Combination(
            name=side.sub("s", name),
            terms=((side.sub("l", name), 0.5), (name, -0.5 if name.startswith("ay") else 0.5)),
        )
        for name in names
        if side.search(name)
    )
