"""Aircraft: geometry, mass against fuel, surfaces, sensors and their instruments."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from flexsid.sysid.model.instruments import Instrument


class SensorKind(StrEnum):
    """Measured quantity of a sensor; selects its row in the output equations."""

    ACCELEROMETER = "accelerometer"
    GYRO = "gyro"
    ATTITUDE = "attitude"
    VANE = "vane"
    STRAIN = "strain"


@dataclass(frozen=True, slots=True, kw_only=True)
class Geometry:
    """Reference dimensions of the wing."""

    area_m2: float
    chord_m: float
    span_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MassTable:
    """Mass properties against fuel fraction; centre of gravity in structural axes."""

    fuel: tuple[float, ...]
    mass_kg: tuple[float, ...]
    pitch_inertia_kg_m2: tuple[float, ...]
    x_cg_m: tuple[float, ...]
    z_cg_m: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustTable:
    """Thrust of one engine, measured in a ground test, against the state of the engine.

    ``engines`` are the condition channels of the rotation speeds, one for each engine.
    ``thrust_n`` has a row for every rotation speed and a column for every total temperature
    of the air; one temperature alone means that thrust does not depend on it.
    """

    engines: tuple[str, ...]
    engine_speed_rad_s: tuple[float, ...]
    total_temperature_k: tuple[float, ...]
    thrust_n: tuple[tuple[float, ...], ...]
    source: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class DragPolar:
    """Parabolic polar, for trim angle of attack and thrust without record or table."""

    cd_min: float
    oswald: float
    aspect_ratio: float
    lift_slope: float


SurfaceSymmetry = Literal["symmetric", "antisymmetric", "single"]
"""Surfaces of one channel: pair in phase, pair in antiphase, or one side."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """A control surface, or a pair moved as one.

    ``symmetry`` of None leaves it to the name; see ``symmetry_of``. ``instrument`` lies
    between the true deflection and its recording. Where the command was recorded instead,
    ``actuator`` turns it into the true deflection. ``servo`` lies between command and
    deflection where both were recorded; control loops are broken in front of it.
    """

    name: str
    instrument: str | None = None
    actuator: str | None = None
    servo: str | None = None
    noise_std_rad: float | None = None
    symmetry: SurfaceSymmetry | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """One sensor: kind, location and instrument.

    ``point`` names a row of the modal table's ``points`` (``gauges`` for a
    strain gauge). Locations are in structural axes: x aft, y right, z up [m].
    ``noise_std`` is in the SI unit of the channel.
    """

    name: str
    kind: SensorKind
    point: str
    axis: str = "z"
    location_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    instrument: str | None = None
    noise_std: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Combination:
    """A channel made of others, e.g. ``az_ofs = 0.5 az_ofl + 0.5 az_ofr`` (Eq. 3)."""

    name: str
    terms: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterTable:
    """Predicted open-loop flutter speed against fuel; campaigns are planned in V/V_f."""

    fuel: tuple[float, ...]
    speed_m_s: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Aircraft:
    """Everything about one airframe that does not change from maneuver to maneuver."""

    name: str
    geometry: Geometry
    mass: MassTable
    surfaces: tuple[Surface, ...]
    sensors: tuple[Sensor, ...]
    combinations: tuple[Combination, ...] = ()
    instruments: dict[str, Instrument]
    polar: DragPolar | None = None
    flutter: FlutterTable | None = None
    thrust: ThrustTable | None = None
    description: str = ""
    id: int | None = None
