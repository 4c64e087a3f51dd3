"""Definition of an aircraft before its first flight, and its correction."""

from __future__ import annotations

from dataclasses import fields, replace

from flexsid.errors import BadInput, Conflict
from flexsid.importers.mapping import parse_aircraft
from flexsid.records.aircraft import Aircraft, MassTable
from flexsid.storage.store import Store


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
    merged: dict[str, tuple[float, ...] | None] = {"fuel": tuple(fuels)}
    for one in fields(MassTable):
        if one.name in ("fuel", "mass_std", "inertia_std"):
            continue
        columns = [(getattr(table, one.name), row) for table, row in (rows[f] for f in fuels)]
        is_known = all(column is not None for column, _ in columns)
        merged[one.name] = tuple(column[row] for column, row in columns) if is_known else None
    merged_table = MassTable(**merged)  # pyright: ignore[reportArgumentType]
    return replace(
        merged_table,
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
