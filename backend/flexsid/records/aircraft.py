"""Aircraft: geometry, mass, surfaces, sensors and their axes, instruments, predictions."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated, Literal

from flexsid.allowed import Allowed, Name, Share, Text
from flexsid.sysid.model.sensor_models import Instrument, SensorModel, find_sensor_model
from flexsid.sysid.preparation.resampling import find_pairs

_Numbers = tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Geometry:
    """Reference dimensions of the wing."""

    area_m2: Annotated[float, Allowed(gt=0.0, text="the reference area")]
    chord_m: Annotated[float, Allowed(gt=0.0, text="the reference chord")]
    span_m: Annotated[float, Allowed(gt=0.0, text="the reference span")]


@dataclass(frozen=True, slots=True, kw_only=True)
class MassTable:
    """Mass properties against fuel fraction; centre of gravity in structural axes.

    Inertia in roll and yaw, and the product of inertia (integral of x z dm in body axes), are
    those of the lateral-directional model. ``mass_std`` and ``inertia_std`` are the standard
    deviations of mass and moments of inertia, relative to them. [1]
    """

    fuel: Annotated[_Numbers, Allowed(text="the fuel fractions, increasing")]
    mass_kg: Annotated[_Numbers, Allowed(text="the mass at each fuel fraction")]
    pitch_inertia_kg_m2: Annotated[_Numbers, Allowed(text="the pitching moment of inertia")]
    x_cg_m: Annotated[_Numbers, Allowed(text="the centre of gravity, positive aft")]
    z_cg_m: Annotated[_Numbers, Allowed(text="the centre of gravity, positive up; else zero")]
    roll_inertia_kg_m2: Annotated[_Numbers | None, Allowed(text="inertia in roll")] = None
    yaw_inertia_kg_m2: Annotated[_Numbers | None, Allowed(text="inertia in yaw")] = None
    product_of_inertia_kg_m2: Annotated[
        _Numbers | None, Allowed(text="the integral of x z dm in body axes")
    ] = None
    mass_std: Annotated[Share, Allowed(text="standard deviation of the mass, relative to it")] = (
        0.02
    )
    inertia_std: Annotated[
        Share, Allowed(text="standard deviation of the moments of inertia, relative to them")
    ] = 0.02


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustTable:
    """Thrust of one engine, measured in a ground test, against the state of the engine.

    ``engines`` are the condition channels of the rotation speeds, one for each engine.
    ``thrust_n`` has a row for every rotation speed and a column for every total temperature
    of the air; one temperature alone means that thrust does not depend on it.
    """

    engines: Annotated[
        tuple[str, ...], Allowed(text="the channels of the rotation speeds, one per engine")
    ]
    engine_speed_rad_s: Annotated[_Numbers, Allowed(text="the rotation speeds, increasing")]
    total_temperature_k: tuple[float, ...]
    thrust_n: tuple[tuple[float, ...], ...]
    source: Annotated[Text, Allowed(text="where the table is from")] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class DragPolar:
    """Parabolic polar, for trim angle of attack and thrust without record or table."""

    cd_min: Annotated[float, Allowed(gt=0.0, text="the least drag coefficient")]
    oswald: Annotated[float, Allowed(gt=0.0, text="the Oswald efficiency")]
    aspect_ratio: Annotated[float, Allowed(gt=0.0, text="the aspect ratio")]
    lift_slope: Annotated[float, Allowed(gt=0.0, text="the lift-curve slope, per rad")]


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

    name: Annotated[Name, Allowed(text="the name of the surface")]
    instrument: Annotated[str | None, Allowed(text="instrument from deflection to recording")] = (
        None
    )
    actuator: Annotated[str | None, Allowed(text="instrument from recording to deflection")] = None
    servo: Annotated[str | None, Allowed(text="instrument from command to deflection")] = None
    noise_std_rad: Annotated[float | None, Allowed(gt=0.0, text="standard deviation of noise")] = (
        None
    )
    symmetry: Annotated[SurfaceSymmetry | None, Allowed(text="symmetry; else from the name")] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """One sensor: kind, location and instrument.

    ``kind`` names its type, one of ``sensor_models``. ``point`` names a row of the modal
    table's ``points`` (``gauges`` for a strain gauge). Locations are in structural axes: x aft,
    y right, z up [m].
    ``noise_std`` is in the SI unit of the channel.
    """

    name: Annotated[Name, Allowed(text="the name of the sensor")]
    kind: Annotated[str, Allowed(text="the type of sensor")]
    point: Annotated[str, Allowed(text="row of the modal table; else the name")]
    axis: str = "z"
    location_m: Annotated[
        tuple[float, float, float], Allowed(text="coordinates: x aft, y right, z up")
    ] = (0.0, 0.0, 0.0)
    instrument: Annotated[str | None, Allowed(text="instrument from quantity to recording")] = None
    noise_std: Annotated[
        float | None, Allowed(gt=0.0, text="standard deviation of the noise, in SI")
    ] = None

    @property
    def model(self) -> SensorModel:
        """The model of its type.

        Raises
        ------
        BadInput
            If the package that added the type is not installed.
        """
        return find_sensor_model(self.kind)


@dataclass(frozen=True, slots=True, kw_only=True)
class Combination:
    """A channel made of others, e.g. ``az_ofs = 0.5 az_ofl + 0.5 az_ofr`` (Eq. 3)."""

    name: Annotated[Name, Allowed(text="the name of the sum")]
    terms: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterTable:
    """Predicted open-loop flutter speed against fuel; campaigns are planned in V/V_f."""

    fuel: Annotated[_Numbers, Allowed(text="the fuel fractions")]
    speed_m_s: Annotated[_Numbers, Allowed(text="the flutter speed at each fuel fraction")]


@dataclass(frozen=True, slots=True, kw_only=True)
class Aircraft:
    """Everything about one airframe that does not change from maneuver to maneuver."""

    name: Annotated[Name, Allowed(text="name in the database")]
    geometry: Annotated[Geometry, Allowed(text="reference dimensions")]
    mass: Annotated[MassTable, Allowed(text="mass properties")]
    surfaces: Annotated[tuple[Surface, ...], Allowed(text="control surfaces, at least one")]
    sensors: Annotated[tuple[Sensor, ...], Allowed(text="sensors")]
    combinations: Annotated[tuple[Combination, ...], Allowed(text="weighted sums of channels")] = ()
    instruments: Annotated[dict[str, Instrument], Allowed(text="instruments by name")]
    polar: Annotated[DragPolar | None, Allowed(text="parabolic polar")] = None
    flutter: Annotated[FlutterTable | None, Allowed(text="flutter speed")] = None
    thrust: Annotated[ThrustTable | None, Allowed(text="thrust of one engine")] = None
    description: Annotated[Text, Allowed(text="free text")] = ""
    id: int | None = None


_ANTISYMMETRIC = re.compile(
    r"ail|ailerons?|da|rdr|rud|rudders?|dr|asym|antisym|antisymmetric|anti|diff|differential"
)
_SIDE = re.compile(r"l|r|lh|rh|left|right")
_STRIP = re.compile(r"(?:bf|wf\d?)(?P<part>[alrs])")  # names of this software; see nomenclature
_PARTS: dict[str, SurfaceSymmetry] = {
    "a": "antisymmetric",
    "s": "symmetric",
    "l": "single",
    "r": "single",
}


def find_contradicting_axis(sensor: Sensor) -> str | None:
    """Find an axis in the name of a sensor that contradicts its record."""
    named = sensor.model.find_axis(sensor.name)
    return None if named == sensor.axis else named


def get_symmetry(aircraft: Aircraft, name: str) -> SurfaceSymmetry:
    """Return the symmetry of a surface: declared, else from its name, else a symmetric pair.

    Single surfaces are those called left or right (``elevator_l``, ``wf1r``), antisymmetric
    ones ailerons, rudders and half differences (``wf1a``).
    """
    declared: SurfaceSymmetry | None = next(
        (s.symmetry for s in aircraft.surfaces if s.name == name), None
    )
    return declared or _symmetry_in_name(name, [surface.name for surface in aircraft.surfaces])


def list_surface_parts(aircraft: Aircraft) -> dict[str, tuple[tuple[str, float], ...]]:
    """List the surfaces that combine single ones, with their terms (``wf1a`` of a left and right).

    They are the inputs of both axes where the sides move independently.
    """
    surfaces = {surface.name for surface in aircraft.surfaces}
    return {
        c.name: c.terms
        for c in aircraft.combinations
        if c.name in surfaces and surfaces.issuperset(name for name, _ in c.terms)
    }


def _symmetry_in_name(name: str, others: list[str]) -> SurfaceSymmetry:
    lower = name.lower()
    own = _STRIP.fullmatch(lower)
    if own is not None:
        return _PARTS[own["part"]]
    words = lower.split("_")
    if any(_SIDE.fullmatch(word) for word in words[1:]) or words[0] in ("left", "right"):
        return "single"
    if any(name in pair[:2] for pair in find_pairs(others)):
        return "single"
    if any(_ANTISYMMETRIC.fullmatch(word) for word in words):
        return "antisymmetric"
    if lower.endswith("a") and f"{lower[:-1]}s" in [other.lower() for other in others]:
        return "antisymmetric"
    return "symmetric"


@dataclass(frozen=True, slots=True, kw_only=True)
class Lattice:
    """Boxes on the right half of a computed prediction, at one fuel weight.

    Hashes of arrays: ``corners`` (n, 4, 3) in structural axes [m], ``surface`` (n,) index into
    ``surfaces`` or -1, ``pressures`` complex (len(columns), n) per unit of each variable at the
    reference k, and ``displacements`` (modes, n) along the normals of the boxes per unit eta [m].
    """

    fuel: float
    corners: str
    surfaces: tuple[str, ...]
    surface: str
    columns: tuple[str, ...]
    pressures: str
    modes: tuple[int, ...]
    displacements: str


@dataclass(frozen=True, slots=True, kw_only=True)
class UnsteadyPrediction:
    """Derivatives of a prediction over reduced frequency k = omega cbar/2V, and their provenance.

    ``coefficients`` is the hash of a complex (F, len(k), len(names)) array: the responses to real
    normal washes. The values of the prediction are their real parts at ``reference_k``.
    ``coarse_coefficients`` are those of a mesh with half the divisions along the chord, None where
    there is none.
    ``geometry`` is the hash of panels, surfaces and divisions; ``lattice`` is None in predictions
    of earlier versions and of other programs.
    """

    k: tuple[float, ...]
    reference_k: float
    coefficients: str
    mach: float
    n_boxes: int
    geometry: str
    modal_table_id: int | None = None
    surfaces: tuple[str, ...] = ()  # with hinge and span after snapping to boxes
    coarse_coefficients: str | None = None
    lattice: Lattice | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativeValue:
    """One predicted derivative."""

    name: str
    value: float
    std_error: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class DerivativePrediction:
    """Derivatives by name against fuel; ``values`` is the hash of a (F, len(names)) array.

    ``unsteady`` are those of a computed prediction by reduced frequency, None for others.
    """

    aircraft_id: int
    source: str
    kind: str  # "panel code", "wind tunnel", "simulation", "flight"
    fuel: tuple[float, ...]
    names: tuple[str, ...]
    values: str
    std_errors: str | None = None
    note: str = ""
    unsteady: UnsteadyPrediction | None = None
    id: int | None = None
