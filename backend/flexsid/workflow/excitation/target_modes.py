"""Target modes of a design in flight, and the harmonics that it has about each of them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Altitude, Fuel, Id
from flexsid.records.aircraft import Aircraft
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.views import TargetMode, TargetModes
from flexsid.storage.lists.campaign_rows import list_fuel_rates
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import (
    CATALOGUE,
    ELASTIC_GROUPS,
    HARMONICS_PER_SURFACE,
    PHUGOID,
    FlightTestAid,
    Target,
    build_rigid_target,
    build_structural_target,
    count_harmonics,
    find_least_duration,
)
from flexsid.sysid.excitation.designer import DesignSpecification
from flexsid.sysid.model.condition import GRAVITY, FlightCondition
from flexsid.sysid.model.derivatives import RIGID_BODIES, DerivativeTable
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.modes.shapes import may_be
from flexsid.sysid.stability.poles import Aeroelastic, compute_named_roots
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_values,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.excitation.excitation_designs import find_flight_test_aid
from flexsid.workflow.modal_data.modal_tables import AircraftModes, load_modes_of_model

_LARGEST_FUEL = {1: 0.01, 4: 0.03}
"""Share of the fuel that may burn in a maneuver of T and of 4 T, as in those of the paper."""
_RIGID_HZ = 0.1  # free-free models give rigid modes as numerical zeros
_ALL = "all"  # group of the structural modes of a design outside Table 1
_POLES = {"SP": "SP", "DR": "DR", "RS": "roll"}
"""Poles of the models by rigid-body target of Table 1. The models have no phugoid."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetQuery:
    """Aircraft and flight condition of the target modes.

    Without an airspeed only structural modes are targets, at their frequencies in vacuo over all
    fuel weights. The fuel fraction is half by default.
    """

    aircraft_id: Id
    airspeed_m_s: Annotated[
        float | None,
        Allowed(gt=0.0, le=1000.0, text="Without it structural modes in vacuo. [m/s]"),
    ] = None
    fuel_fraction: Fuel = 0.5
    altitude_m: Altitude = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RowTargets:
    """A row of Table 1 on an aircraft: band, resolution [Hz] and harmonics about its targets.

    ``least_duration_s`` is the shortest duration with three harmonics of every surface about each
    target (of all inputs together about a phugoid); ``missing`` are targets without a predicted
    frequency. ``fuel_burnt`` is the share of the fuel that burns meanwhile, as in the assessed
    maneuvers of the aircraft, None without any; one linear model holds where it is at most
    ``largest_fuel_burnt``.
    """

    number: int
    duration_s: float
    least_duration_s: float
    low_hz: float
    high_hz: float
    resolution_hz: float
    harmonics_per_surface: int
    modes: tuple[TargetMode, ...]
    missing: tuple[str, ...]
    reaches_targets: bool
    fuel_burnt: float | None
    largest_fuel_burnt: float


@dataclass(frozen=True, slots=True)
class _FlightModes:
    """Structural modes of an aircraft, and its roots at a condition by motion; None on ground."""

    modes: AircraftModes
    fuel: float
    airspeed_m_s: float | None
    roots: dict[str, complex]


def list_row_targets(
    store: Store, query: TargetQuery, period_s: float, first_harmonic: int = 1
) -> tuple[RowTargets, ...]:
    """Compare all rows of Table 1 with their target modes on an aircraft.

    Parameters
    ----------
    store, query
        Aircraft and flight condition.
    period_s
        T of Table 1. [s]
    first_harmonic
        Lowest harmonic of the surfaces; lower where a target requires it.

    Raises
    ------
    BadInput
        If the condition is impossible.
    """
    flight = _load_flight_modes(store, query)
    with store.database.reading() as connection:
        rates = list_fuel_rates(connection, query.aircraft_id)
    rows = []
    for aid in CATALOGUE.values():
        targets = _list_targets(flight, aid)
        duration = period_s * aid.periods
        surfaces, _ = aid.input_names()
        dealt = aid.harmonics(first_harmonic, targets, duration)
        harmonics = {name: own.tolist() for name, own in dealt.items()}
        every = [harmonic for own in harmonics.values() for harmonic in own]
        low, high = min(every) / duration, max(every) / duration
        modes = _compare(targets, harmonics, duration, (low, high))
        known = {target.group for target in targets}
        groups = aid.targets.split() if query.airspeed_m_s is not None else aid.elastic_targets
        rows.append(
            RowTargets(
                number=aid.number,
                duration_s=duration,
                least_duration_s=find_least_duration(targets, len(surfaces)),
                low_hz=low,
                high_hz=high,
                resolution_hz=1.0 / duration,
                harmonics_per_surface=max(len(harmonics[name]) for name in surfaces),
                modes=modes,
                missing=tuple(group for group in groups if group not in known),
                reaches_targets=all(_is_reached(mode) for mode in modes),
                fuel_burnt=duration * float(np.median(rates)) if rates else None,
                largest_fuel_burnt=_LARGEST_FUEL[aid.periods],
            )
        )
    return tuple(rows)


def find_row_targets(store: Store, fta: int, query: TargetQuery) -> tuple[Target, ...]:
    """Find the targets of a row of Table 1 that have a frequency on an aircraft.

    Raises
    ------
    BadInput
        If Table 1 lacks the row, or the condition is impossible.
    """
    return _list_targets(_load_flight_modes(store, query), find_flight_test_aid(fta))


def compare_target_modes(store: Store, design: ExcitationDesign, query: TargetQuery) -> TargetModes:
    """Compare the harmonics of a design with the modes that it targets on an aircraft.

    A design outside Table 1 is compared with all modes.

    Raises
    ------
    BadInput
        If the condition is impossible.
    """
    aid = None if design.fta is None else find_flight_test_aid(design.fta)
    targets = _list_targets(_load_flight_modes(store, query), aid)
    low, high = find_band(design.specification)
    harmonics = {own.name: list(own.harmonics) for own in design.specification.inputs}
    found = _compare(targets, harmonics, design.specification.duration_s, (low, high))
    return TargetModes(
        low_hz=low, high_hz=high, modes=found, sentence=_describe(low, high, found, aid)
    )


def find_band(specification: DesignSpecification) -> tuple[float, float]:
    """Return the lowest and highest frequency of any input. [Hz]"""
    every = [harmonic for own in specification.inputs for harmonic in own.harmonics]
    return min(every) / specification.duration_s, max(every) / specification.duration_s


def _compare(
    targets: tuple[Target, ...],
    harmonics: dict[str, list[int]],
    duration_s: float,
    band: tuple[float, float],
) -> tuple[TargetMode, ...]:
    return tuple(
        TargetMode(
            **asdict(target),
            in_band=band[0] <= target.frequency_hz <= band[1],
            harmonics_per_surface=count_harmonics(harmonics, duration_s, target),
        )
        for target in targets
    )


def _is_reached(mode: TargetMode) -> bool:
    return mode.in_band and mode.harmonics_per_surface >= HARMONICS_PER_SURFACE


def _load_flight_modes(store: Store, query: TargetQuery) -> _FlightModes:
    """Load the modes of an aircraft, and the roots of its predictions at a condition."""
    aircraft = store.aircraft.get(query.aircraft_id)
    modes, _ = load_modes_of_model(store, query.aircraft_id, None, None, ())
    fuel, airspeed = query.fuel_fraction, query.airspeed_m_s
    if airspeed is None:
        return _FlightModes(modes, fuel, None, {})
    known = {"airspeed": airspeed, "altitude": query.altitude_m, "fuel_fraction": fuel}
    condition = build_flight_condition(aircraft, complete_condition(aircraft, known))
    roots: dict[str, complex] = {}
    for body in (one for one in RIGID_BODIES.values() if one.fast is None):
        roots |= _compute_roots(store, aircraft, modes, fuel, condition, body)
    return _FlightModes(modes, fuel, airspeed, roots)


def _compute_roots(
    store: Store,
    aircraft: Aircraft,
    modes: AircraftModes,
    fuel: float,
    condition: FlightCondition,
    body: RigidBody,
) -> dict[str, complex]:
    """Compute the roots of an axis with the prediction of most derivatives; none without one.

    A prediction without the rigid-body motion of the axis, or an aircraft without its inertia, has
    none either.
    """
    numbers = tuple(n for n in modes.table.numbers if modes.belongs_to(n, body))
    prediction = select_prediction(store, aircraft.id or 0, None, numbers, (), body)
    has_motion = prediction is not None and (
        f"{body.coefficients[0]}_{body.motions[0]}" in prediction.names
    )
    has_inertia = body.symmetry == "symmetric" or (
        condition.roll_inertia > 0.0 and condition.yaw_inertia > 0.0
    )
    if prediction is None or not has_motion or not has_inertia:
        return {}
    numbers = list_predicted_modes(prediction, numbers, body)
    values = interpolate_values(store, prediction, fuel)
    derivatives = DerivativeTable.from_names(numbers, (), values, body)
    structure = modes.table.at(fuel).select(numbers)
    return compute_named_roots(Aeroelastic(condition, structure, derivatives))


def _list_targets(flight: _FlightModes, aid: FlightTestAid | None) -> tuple[Target, ...]:
    """List the targets of a row, or all of a design outside Table 1, that have a frequency."""
    found = []
    for name in (PHUGOID, *_POLES) if aid is None else aid.rigid_targets:
        if name == PHUGOID and flight.airspeed_m_s is not None:
            # Lanchester: omega = sqrt(2) g / V, of an exchange of height and speed.
            hz = np.sqrt(2.0) * GRAVITY / flight.airspeed_m_s / (2.0 * np.pi)
            found.append(build_rigid_target(name, float(hz), None))
        elif _POLES.get(name) in flight.roots:
            root = flight.roots[_POLES[name]]
            hz = abs(root) / (2.0 * np.pi)
            found.append(build_rigid_target(name, hz, -root.real / abs(root)))
    return (*found, *_list_structural_targets(flight, aid))


def _list_structural_targets(flight: _FlightModes, aid: FlightTestAid | None) -> list[Target]:
    modes = flight.modes
    hz = modes.table.omega / (2.0 * np.pi)
    order = [
        int(column) for column in np.argsort(hz.mean(axis=0)) if hz[:, column].min() > _RIGID_HZ
    ]
    groups, axis = {_ALL: slice(None)}, ""
    if aid is not None:
        groups, axis = {group: ELASTIC_GROUPS[group] for group in aid.elastic_targets}, aid.axis
    symmetric = {"symmetric": True, "antisymmetric": False}.get(axis)
    found = []
    for group, columns in groups.items():
        for column in order[columns]:
            number = modes.table.numbers[column]
            if symmetric is not None and not may_be(modes.symmetric[number], symmetric):
                continue
            root = flight.roots.get(str(number))
            damping = float(np.interp(flight.fuel, modes.table.fuel, modes.table.zeta[:, column]))
            if root is not None:
                low = high = abs(root) / (2.0 * np.pi)
                damping = -root.real / abs(root)
            elif flight.airspeed_m_s is not None:
                low = high = float(np.interp(flight.fuel, modes.table.fuel, hz[:, column]))
            else:
                low, high = float(hz[:, column].min()), float(hz[:, column].max())
            name = modes.names[number]
            found.append(build_structural_target(name, group, number, (low, high), damping))
    return found


def _of_phugoid(found: tuple[TargetMode, ...]) -> str:
    has_phugoid = any(mode.group == PHUGOID for mode in found)
    return " (of all inputs together about PH)." if has_phugoid else "."


def _describe(
    low: float, high: float, found: tuple[TargetMode, ...], aid: FlightTestAid | None
) -> str:
    band = f"The harmonics span {low:.3g} to {high:.4g} Hz"
    if aid is not None and not found:
        return f"{band}; the row has no target with a predicted frequency on this aircraft."
    if aid is None:
        within = ", ".join(mode.name for mode in found if mode.in_band) or "none"
        return f"{band}. Modes in this band: {within}."
    short = [mode for mode in found if not _is_reached(mode)]
    if not short:
        return (
            f"{band}, with {HARMONICS_PER_SURFACE} or more harmonics of every surface about all"
            " target modes of the row" + _of_phugoid(found)
        )
    missing = ", ".join(
        f"{mode.name} ({mode.frequency_hz:.4g} Hz, "
        + (f"{mode.harmonics_per_surface} harmonics)" if mode.in_band else "outside the band)")
        for mode in short
    )
    return (
        f"{band}, with fewer than {HARMONICS_PER_SURFACE} harmonics of a surface about these target"
        f" modes of the row: {missing}. Design the row for this aircraft and condition, or extend"
        " the period."
    )
