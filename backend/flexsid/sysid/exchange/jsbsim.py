"""Rigid aircraft for JSBSim: derivatives about one trim as an aircraft file and its trim.

Source: JSBSim reference manual, https://jsbsim-team.github.io/jsbsim-reference-manual.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Mapping, Sequence
from xml.etree import ElementTree

import numpy as np

from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable

_EPOCH = (1980, 1, 1, 0, 0, 0)
_LATITUDE_DEG = 45.0  # where the gravity is about the standard one
_NEWTON_OF_POUND = 4.4482216152605
_METRE_PER_SECOND_OF_KNOT = 1852.0 / 3600.0
_EARTH_RADIUS_M = 6_356_766.0  # of geopotential altitude in the standard atmosphere
_ALPHA = "aero/flexsid/alpha-from-trim-rad"
_CHORD_RATE, _SPAN_RATE = "aero/ci2vel", "aero/bi2vel"
_MOTIONS: Mapping[str, tuple[str, ...]] = {
    "alpha": (_ALPHA,),
    "q": ("velocities/q-aero-rad_sec", _CHORD_RATE),
    "beta": ("aero/beta-rad",),
    "p": ("velocities/p-aero-rad_sec", _SPAN_RATE),
    "r": ("velocities/r-aero-rad_sec", _SPAN_RATE),
}
_CHORD, _SPAN = "metrics/cbarw-ft", "metrics/bw-ft"
_MOMENTS: Mapping[str, tuple[str, str]] = {
    "Cm": ("PITCH", _CHORD),
    "Cl": ("ROLL", _SPAN),
    "Cn": ("YAW", _SPAN),
}

_Element = ElementTree.Element
# A derivative and the properties by which it is multiplied.
_Term = tuple[float, tuple[str, ...]]


def write_jsbsim(
    name: str,
    condition: FlightCondition,
    altitude_m: float,
    tables: Sequence[DerivativeTable],
    about: str,
) -> bytes:
    """Write a rigid aircraft with linear derivatives about a trim.

    Parameters
    ----------
    name
        Name of the aircraft.
    condition
        Trim, and the reference dimensions, mass and inertia.
    altitude_m
        Geopotential altitude of the standard atmosphere that has the density. [m]
    tables
        Derivatives without modes of the longitudinal axis, the lateral axis, or both.
    about
        Description.

    Returns
    -------
    bytes
        Archive with ``aircraft/<model>/<model>.xml`` and the initial condition ``trim.xml``.

    Notes
    -----
    Lift is C_L0 - CZ (alpha - alpha0, q c/2V, surfaces), with C_L0 from m g cos(gamma) =
    q S C_L0 + T sin(alpha0), and drag is that of steady flight with K of the polar. The side
    force is one of body axes; JSBSim has wind axes, where it has the drag times sideslip
    besides. The thrust is constant along the x axis of the body. Surfaces are the properties
    ``fcs/<surface>-rad``, measured from their trim.
    """
    model = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-") or "aircraft"
    root = _Element("fdm_config", name=model, version="2.0", release="BETA")
    header = ElementTree.SubElement(root, "fileheader")
    _add(header, "author", "flexsid")
    _add(header, "description", f"{name}: {about}")
    _add_metrics(root, condition)
    _add_mass(root, condition)
    ElementTree.SubElement(root, "ground_reactions")
    _add_thrust(root, condition)
    ElementTree.SubElement(root, "propulsion")
    control = ElementTree.SubElement(root, "flight_control", name="surfaces")
    for surface in dict.fromkeys(name for table in tables for name in table.inputs):
        _add(control, "property", _name_surface(surface), value="0.0")
    _add_aerodynamics(root, condition, tables)
    folder = f"aircraft/{model}"
    files = {
        f"{folder}/{model}.xml": root,
        f"{folder}/trim.xml": _describe_trim(condition, altitude_m),
    }
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, element in files.items():
            ElementTree.indent(element)
            content = ElementTree.tostring(element, encoding="utf-8", xml_declaration=True)
            archive.writestr(zipfile.ZipInfo(path, _EPOCH), content)
    return packed.getvalue()


def _add(parent: _Element, tag: str, text: str | float, **attributes: str) -> _Element:
    element = ElementTree.SubElement(parent, tag, attributes)
    element.text = text if isinstance(text, str) else repr(float(text))
    return element


def _add_location(parent: _Element, **attributes: str) -> None:
    """Add the centre of gravity, which is the origin of the structural frame."""
    location = ElementTree.SubElement(parent, "location", {**attributes, "unit": "M"})
    for axis in "xyz":
        _add(location, axis, 0.0)


def _add_metrics(root: _Element, condition: FlightCondition) -> None:
    metrics = ElementTree.SubElement(root, "metrics")
    _add(metrics, "wingarea", condition.area, unit="M2")
    # Without a span no derivative refers to it.
    _add(metrics, "wingspan", condition.span or condition.area / condition.chord, unit="M")
    _add(metrics, "chord", condition.chord, unit="M")
    for name in ("AERORP", "EYEPOINT", "VRP"):
        _add_location(metrics, name=name)


def _add_mass(root: _Element, condition: FlightCondition) -> None:
    balance = ElementTree.SubElement(root, "mass_balance", negated_crossproduct_inertia="false")
    inertia = {
        # Without lateral derivatives nothing turns the aircraft about these axes.
        "ixx": condition.roll_inertia or condition.pitch_inertia,
        "iyy": condition.pitch_inertia or condition.roll_inertia,
        "izz": condition.yaw_inertia or condition.pitch_inertia,
        "ixz": condition.product_of_inertia,
    }
    for name, value in inertia.items():
        _add(balance, name, value, unit="KG*M2")
    _add(balance, "emptywt", condition.mass, unit="KG")
    _add_location(balance, name="CG")


def _add_thrust(root: _Element, condition: FlightCondition) -> None:
    reactions = ElementTree.SubElement(root, "external_reactions")
    force = ElementTree.SubElement(reactions, "force", name="thrust", frame="BODY")
    function = ElementTree.SubElement(force, "function")
    _add(function, "value", condition.thrust / _NEWTON_OF_POUND)
    _add_location(force)
    direction = ElementTree.SubElement(force, "direction")
    for axis, value in zip("xyz", (1.0, 0.0, 0.0), strict=True):
        _add(direction, axis, value)


def _name_surface(surface: str) -> str:
    return f"fcs/{re.sub(r'[^A-Za-z0-9_-]', '-', surface)}-rad"


def _add_aerodynamics(
    root: _Element, condition: FlightCondition, tables: Sequence[DerivativeTable]
) -> None:
    aerodynamics = ElementTree.SubElement(root, "aerodynamics")
    function = ElementTree.SubElement(aerodynamics, "function", name=_ALPHA)
    difference = ElementTree.SubElement(function, "difference")
    _add(difference, "property", "aero/alpha-rad")
    _add(difference, "value", condition.alpha)
    force = condition.dynamic_pressure * condition.area
    weight = condition.mass * GRAVITY
    lift = (weight * np.cos(condition.gamma) - condition.thrust * np.sin(condition.alpha)) / force
    drag = (condition.thrust * np.cos(condition.alpha) - weight * np.sin(condition.gamma)) / force
    terms = {
        coefficient: _list_terms(table, row)
        for table in tables
        for row, coefficient in enumerate(table.body.coefficients)
    }
    normal = terms.get("CZ", [])
    _add_axis(aerodynamics, "LIFT", (), lift, _scale(normal, -1.0))
    polar = _scale(normal, -2.0 * condition.induced_drag * lift)
    _add_axis(aerodynamics, "DRAG", (), drag, polar if condition.induced_drag else [])
    if "CY" in terms:
        _add_axis(aerodynamics, "SIDE", (), 0.0, [*terms["CY"], (drag, _MOTIONS["beta"])])
    for coefficient, (axis, length) in _MOMENTS.items():
        if coefficient in terms:
            _add_axis(aerodynamics, axis, (length,), 0.0, terms[coefficient])


def _list_terms(table: DerivativeTable, row: int) -> list[_Term]:
    factors = [
        *(_MOTIONS[motion] for motion in table.body.motions),
        *((_name_surface(name),) for name in table.inputs),
    ]
    return [
        (float(value), factor)
        for value, factor in zip(table.values[row], factors, strict=True)
        if value != 0.0
    ]


def _scale(terms: Sequence[_Term], factor: float) -> list[_Term]:
    return [(factor * value, properties) for value, properties in terms]


def _add_axis(
    parent: _Element, name: str, lengths: tuple[str, ...], constant: float, terms: Sequence[_Term]
) -> None:
    axis = ElementTree.SubElement(parent, "axis", name=name)
    function = ElementTree.SubElement(axis, "function", name=f"aero/flexsid/{name.lower()}")
    product = ElementTree.SubElement(function, "product")
    for factor in ("aero/qbar-psf", "metrics/Sw-sqft", *lengths):
        _add(product, "property", factor)
    total = ElementTree.SubElement(product, "sum")
    _add(total, "value", constant)
    for value, properties in terms:
        term = ElementTree.SubElement(total, "product")
        _add(term, "value", value)
        for factor in properties:
            _add(term, "property", factor)


def _describe_trim(condition: FlightCondition, altitude_m: float) -> _Element:
    root = _Element("initialize", name="trim")
    geometric = _EARTH_RADIUS_M * altitude_m / (_EARTH_RADIUS_M - altitude_m)
    _add(root, "latitude", _LATITUDE_DEG, unit="DEG")
    _add(root, "longitude", 0.0, unit="DEG")
    _add(root, "altitude", geometric, unit="M")
    _add(root, "vt", condition.airspeed / _METRE_PER_SECOND_OF_KNOT, unit="KTS")
    _add(root, "alpha", np.degrees(condition.alpha), unit="DEG")
    _add(root, "gamma", np.degrees(condition.gamma), unit="DEG")
    for name in ("beta", "phi", "psi"):
        _add(root, name, 0.0, unit="DEG")
    return root
