"""Definition of an aircraft before its first flight, and its predicted derivatives."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import fields, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.importers.mapping import parse_aircraft
from flexsid.records.aircraft import Aircraft, DerivativePrediction, MassTable
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.model.frequency_shape import (
    SMALLEST_RATIO,
    FrequencyShape,
    build_frequency_shape,
)
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.signals import interpolate
from flexsid.workflow.aircraft.written_back import read_written_versions

# --- Predicted derivatives at the fuel fraction of a maneuver -------------------------------------


class _StoredRecord(Protocol):
    @property
    def id(self) -> int | None: ...


Record = TypeVar("Record", bound=_StoredRecord)


def select_by_id(known: Iterable[Record], number: int, noun: str, *, code: str) -> Record:
    """Select a record of an aircraft by its id.

    Raises
    ------
    BadInput
        If the aircraft has no such record.
    """
    for record in known:
        if record.id == number:
            return record
    raise BadInput(
        f"{noun} {number} does not belong to the aircraft of the maneuver",
        code=code,
        **{f"{noun.replace(' ', '_')}_id": number},
    )


def interpolate_prediction(
    store: Store, prediction: DerivativePrediction, fuel: float
) -> dict[str, tuple[float, float | None]]:
    """Interpolate value and standard error (None where not given) of predicted derivatives."""
    at = np.array(prediction.fuel, dtype=float)
    values = interpolate(at, np.asarray(store.arrays.get(prediction.values)), fuel)
    errors: list[float | None] = [None] * len(prediction.names)
    if prediction.std_errors is not None:
        table = interpolate(at, np.asarray(store.arrays.get(prediction.std_errors)), fuel)
        errors = [float(e) if np.isfinite(e) else None for e in table]
    return {
        name: (float(value), error)
        for name, value, error in zip(prediction.names, values, errors, strict=True)
        if np.isfinite(value)
    }


def interpolate_values(
    store: Store, prediction: DerivativePrediction, fuel: float
) -> dict[str, float]:
    """Interpolate the values of predicted derivatives."""
    found = interpolate_prediction(store, prediction, fuel)
    return {name: value for name, (value, _) in found.items()}


def load_frequency_shape(
    store: Store,
    prediction: DerivativePrediction,
    fuel: float,
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
    body: RigidBody,
    smallest_ratio: float = SMALLEST_RATIO,
    *,
    coarse_mesh: bool = False,
) -> FrequencyShape:
    """Load the frequency shape of a model's derivatives at a fuel fraction.

    ``smallest_ratio`` is that of ``build_frequency_shape``; ``coarse_mesh`` loads the shape of the
    mesh with half the divisions along the chord. What the lattice does not predict is unshaped.

    Raises
    ------
    BadInput
        If the prediction was not computed by reduced frequency, or has no coarser mesh.
    """
    unsteady = prediction.unsteady
    if unsteady is None:
        raise BadInput(
            f"prediction '{prediction.source}' has no frequency shape; compute one from the "
            "planform, or estimate a quasi-steady model",
            code="no-frequency-shape",
        )
    coefficients = unsteady.coarse_coefficients if coarse_mesh else unsteady.coefficients
    if coefficients is None:
        raise BadInput(
            f"prediction '{prediction.source}' has no coarser mesh; compute it again with an even "
            "number of divisions along the chord",
            code="no-coarse-mesh",
        )
    every = np.asarray(store.arrays.get(coefficients))
    at = np.array(prediction.fuel, dtype=float)
    flat = every.reshape(at.size, -1)
    values = interpolate(at, np.real(flat), fuel) + 1j * interpolate(at, np.imag(flat), fuel)
    values = values.reshape(every.shape[1:])
    known = interpolate_prediction(store, prediction, fuel)
    by_name = zip(prediction.names, values.T, strict=True)
    predicted = {name: column for name, column in by_name if name in known}
    k = np.array(unsteady.k)
    return build_frequency_shape(
        modes, inputs, k, predicted, unsteady.reference_k, body, smallest_ratio
    )


def select_shaped_prediction(
    store: Store,
    aircraft_id: int,
    prediction_id: int | None,
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
    body: RigidBody,
    candidates: Sequence[DerivativePrediction] | None = None,
) -> DerivativePrediction:
    """Select the requested prediction, or the newest that has a frequency shape for all of these.

    Raises
    ------
    BadInput
        If the requested one has no frequency shape, or none has.
    """
    if prediction_id is not None:
        known = store.predictions.find(aircraft_id=aircraft_id)
        found = select_by_id(known, prediction_id, "prediction", code="wrong-prediction")
    else:
        names = set(list_derivative_names(modes, inputs, body))
        known = list_default_predictions(store, aircraft_id) if candidates is None else candidates
        covering = [p for p in known if p.unsteady is not None and names <= set(p.names)]
        found = max(covering, key=lambda p: p.id or 0, default=None)
    if found is None or found.unsteady is None:
        raise BadInput(
            "the aircraft has no prediction with a frequency shape for these modes and inputs; "
            "compute one from the planform, or estimate a quasi-steady model",
            code="no-frequency-shape",
        )
    return found


def list_default_predictions(
    store: Store, aircraft_id: int, maneuver_ids: Sequence[int] = ()
) -> list[DerivativePrediction]:
    """List the predictions that a run of these maneuvers may have by default, newest version first.

    Versions that were undone, or contain the data of these maneuvers, are none of them.
    """
    written = read_written_versions(store, aircraft_id, maneuver_ids)
    known = written.list_defaults(store.predictions.find(aircraft_id=aircraft_id))
    return sorted(known, key=written.rank, reverse=True)


def list_predicted_modes(
    prediction: DerivativePrediction, known: Iterable[int], body: RigidBody = LONGITUDINAL
) -> tuple[int, ...]:
    """List the modes whose generalised force the prediction covers."""
    return tuple(m for m in known if f"CQ{m}_{body.motions[0]}" in prediction.names)


def select_prediction(
    store: Store,
    aircraft_id: int,
    prediction_id: int | None,
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
    body: RigidBody = LONGITUDINAL,
    candidates: Sequence[DerivativePrediction] | None = None,
) -> DerivativePrediction | None:
    """Select the requested prediction, or the one that covers most of these derivatives.

    ``candidates`` are those that may be a default, as ``list_default_predictions``; of several that
    cover as many, the first one is selected.

    Raises
    ------
    BadInput
        If the requested prediction belongs to another aircraft.
    """
    if prediction_id is not None:
        known = store.predictions.find(aircraft_id=aircraft_id)
        return select_by_id(known, prediction_id, "prediction", code="wrong-prediction")
    names = set(list_derivative_names(modes, inputs, body))
    known = list_default_predictions(store, aircraft_id) if candidates is None else candidates
    covering = [p for p in known if names & set(p.names)]
    return max(covering, key=lambda p: len(names & set(p.names)), default=None)


# --- Definition of an aircraft before its first flight, and its correction ------------------------


def add_aircraft(store: Store, text: str) -> Aircraft:
    """Add an aircraft without a recording.

    Parameters
    ----------
    store
        Store.
    text
        TOML: the ``[aircraft]`` part of a mapping.

    Raises
    ------
    BadInput
        Naming the key that is missing, misspelt or of the wrong kind.
    Conflict
        If there is an aircraft of this name.
    """
    definition = parse_aircraft(text)
    with store.transaction():
        _check_name(store, definition, None)
        return store.aircraft.add(definition)


def replace_aircraft(store: Store, aircraft_id: int, text: str) -> Aircraft:
    """Correct the definition of an aircraft; a thrust table that it omits stays.

    Runs state that the data of the aircraft were changed since.

    Raises
    ------
    UnknownRecord
        If the aircraft does not exist.
    BadInput
        As of ``add_aircraft``, or if recordings need a sensor or surface that is omitted.
    Conflict
        If there is another aircraft of this name.
    """
    definition = parse_aircraft(text)
    with store.transaction():
        former = store.aircraft.get(aircraft_id)
        _check_name(store, definition, aircraft_id)
        omitted = sorted(_list_names(former) - _list_names(definition))
        if omitted and store.flights.find(aircraft_id=aircraft_id):
            raise BadInput(
                f"The definition omits {', '.join(omitted)}, and flights were recorded with "
                f"'{former.name}'. Retain its surfaces and sensors; further ones may be added.",
                code="aircraft-in-use",
                key="aircraft.sensors",
            )
        thrust = definition.thrust or former.thrust
        return store.aircraft.replace(replace(definition, id=aircraft_id, thrust=thrust))


def set_mass_table(store: Store, aircraft_id: int, table: MassTable) -> Aircraft:
    """Set the mass properties of an aircraft at some fuel weights, and retain those at all others.

    Runs state that its data were changed since.

    Raises
    ------
    UnknownRecord
        If the aircraft does not exist.
    """
    with store.transaction():
        aircraft = store.aircraft.get(aircraft_id)
        return store.aircraft.replace(replace(aircraft, mass=merge_masses(aircraft.mass, table)))


def merge_masses(known: MassTable, new: MassTable) -> MassTable:
    """Return a mass table with the rows of the new one, and the known ones at other fuel weights.

    A quantity that is not given at every fuel weight of the result is not given at any. Standard
    deviations are the larger ones.
    """
    rows = {fuel: (known, row) for row, fuel in enumerate(known.fuel)}
    rows |= {fuel: (new, row) for row, fuel in enumerate(new.fuel)}
    fuels = sorted(rows)
    merged: dict[str, Any] = {"fuel": tuple(fuels)}
    for one in fields(MassTable):
        if one.name in ("fuel", "mass_std", "inertia_std"):
            continue
        columns = [(getattr(table, one.name), row) for table, row in (rows[f] for f in fuels)]
        is_known = all(column is not None for column, _ in columns)
        merged[one.name] = tuple(column[row] for column, row in columns) if is_known else None
    return replace(
        MassTable(**merged),
        mass_std=max(known.mass_std, new.mass_std),
        inertia_std=max(known.inertia_std, new.inertia_std),
    )


def _check_name(store: Store, definition: Aircraft, aircraft_id: int | None) -> None:
    others = [one for one in store.aircraft.find(name=definition.name) if one.id != aircraft_id]
    if others:
        raise Conflict(
            f"There is an aircraft '{definition.name}' already; give this one another name.",
            code="already-exists",
        )


def _list_names(aircraft: Aircraft) -> set[str]:
    items = (*aircraft.surfaces, *aircraft.sensors, *aircraft.combinations)
    return {item.name for item in items}
