"""Model structures: kept by version, checked against the aircraft, brought to a maneuver."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.aircraft import Aircraft
from flexsid.records.axes import symmetric_surfaces
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import (
    FixedTo,
    HeldBy,
    ModelStructure,
    Structure,
    StructureVersion,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import derivative_names
from flexsid.workflow.aircraft.aircraft_models import define_outputs
from flexsid.workflow.aircraft.derivative_predictions import prediction_at
from flexsid.workflow.aircraft.instruments import channels_of, with_instruments
from flexsid.workflow.aircraft.longitudinal import (
    require_pitch_sensor,
    require_symmetric_inputs,
    require_symmetric_part,
)
from flexsid.workflow.model_structures.run_results import refuse_altered


class StaleEdit(Conflict):
    """Somebody else has changed the record since it was read."""

    code = "stale-edit"


class UnknownVersion(Conflict):
    """An edit names a version that does not exist."""

    code = "unknown-version"


def add_structure(store: Store, wanted: ModelStructure) -> ModelStructure:
    """Keep a new model structure; this is its first version.

    Raises
    ------
    BadInput
        If it does not fit the aircraft, or a derivative is in two states.
    Conflict
        If another structure of the aircraft has this name.
    """
    with store.transaction():
        check_structure(store, store.aircraft.get(wanted.aircraft_id), wanted.structure)
        _check_name(store, wanted)
        kept = store.model_structures.add(replace(wanted, version=1, changed_at=None))
        store.structure_versions.add(_version_of(kept))
    return kept


def _check_name(store: Store, wanted: ModelStructure) -> None:
    """Refuse a name by which two structures would be talked of."""
    for other in store.model_structures.find(aircraft_id=wanted.aircraft_id, name=wanted.name):
        if other.id != wanted.id:
            raise Conflict(
                f"model structure {other.id} is called {wanted.name!r} already; edit that one, or"
                " choose another name",
                code="name-taken",
                structure_id=other.id,
            )


def edit_structure(
    store: Store,
    structure_id: int,
    version: int,
    *,
    name: str,
    structure: Structure,
    note: str,
    author: str,
) -> ModelStructure:
    """Keep a new version in front of the one that was edited; the older ones stay.

    Raises
    ------
    StaleEdit
        If ``version`` is not the newest any more; it carries the newest, the one
        that was edited and what was sent.
    Conflict
        If another structure of the aircraft has this name.
    """
    with store.transaction():
        current = store.model_structures.get(structure_id)
        check_structure(store, store.aircraft.get(current.aircraft_id), structure)
        edited = replace(
            current,
            name=name,
            structure=structure,
            note=note,
            author=author,
            version=version + 1,
            changed_at=datetime.now(UTC),
        )
        if name != current.name:
            _check_name(store, edited)
        if not store.model_structures.advance(edited):
            raise _stale(store, current, version, edited)
        store.structure_versions.add(_version_of(edited))
    return edited


def get_version(store: Store, structure_id: int, version: int | None = None) -> StructureVersion:
    """Return one version of a model structure, the newest by default."""
    wanted = store.model_structures.get(structure_id).version if version is None else version
    found = store.structure_versions.find(structure_id=structure_id, version=wanted)
    if not found:
        raise UnknownRecord(f"model structure {structure_id} has no version {wanted}")
    return found[0]


def structure_of_run(
    store: Store, given: Structure | None, structure_id: int | None, version: int | None
) -> tuple[Structure, int | None]:
    """Return the structure that a run asks for, and the version of the record it names.

    Raises
    ------
    BadInput
        If there is none, or what is given in full is not what the record says.
    """
    if structure_id is None:
        if given is None or version is not None:
            raise BadInput(
                "give the run a structure, in full or as structure_id", code="no-structure"
            )
        return given, None
    kept = get_version(store, structure_id, version)
    if given is not None and given != kept.structure:
        raise BadInput(
            f"the structure is not version {kept.version} of model structure {structure_id}; "
            "leave one of the two out",
            code="other-structure",
            structure_id=structure_id,
            version=kept.version,
        )
    return kept.structure, kept.version


def brought_to(
    store: Store, structure: Structure, aircraft: Aircraft, maneuver: Maneuver
) -> tuple[Structure, Aircraft]:
    """Put numbers where a structure names sources, and its instruments into the aircraft.

    Raises
    ------
    BadInput
        If a source does not know a derivative, or a channel or instrument is unknown or
        named twice.
    """
    _refuse_twice(structure)
    fixed = {
        name: _value_of(store, name, source, maneuver)
        for name, source in structure.fixed_to.items()
    }
    fixed |= structure.fixed | dict.fromkeys(structure.absent, 0.0)
    return replace(structure, fixed=fixed), with_instruments(aircraft, structure)


def check_structure(store: Store, aircraft: Aircraft, structure: Structure) -> None:
    """Refuse what no run of this aircraft could use.

    Raises
    ------
    BadInput
        Naming the mode, channel, derivative or source that does not fit.
    """
    _check_modes(store, aircraft, structure.modes)
    _refuse_twice(structure)
    surfaces = tuple(surface.name for surface in aircraft.surfaces)
    for name in structure.inputs:
        if name not in surfaces:
            raise BadInput(
                f"'{name}' is not a surface of {aircraft.name}; surfaces are {', '.join(surfaces)}",
                code="unknown-input",
                input=name,
            )
    require_symmetric_inputs(aircraft, structure.inputs)
    for output in define_outputs(aircraft, structure.outputs):
        require_symmetric_part(output.name, output.terms)
        for sensor, _ in output.terms:
            require_pitch_sensor(sensor)
    for name in (*structure.delays, *structure.instruments):
        channels_of(aircraft, name)
    with_instruments(aircraft, structure)
    _check_states(
        structure,
        derivative_names(structure.modes, structure.inputs or symmetric_surfaces(aircraft)),
    )
    for name, source in structure.fixed_to.items():
        _check_source(store, aircraft, name, source)


def _refuse_twice(structure: Structure) -> None:
    """An output that counts twice would seem known better than it is."""
    named = (("mode", structure.modes), ("input", structure.inputs), ("output", structure.outputs))
    for what, names in named:
        for place, name in enumerate(names):
            if name in names[:place]:
                raise BadInput(f"{what} {name} is named twice; name it once", code="named-twice")


def _check_modes(store: Store, aircraft: Aircraft, modes: tuple[int, ...]) -> None:
    known = {n for table in store.modal_tables.find(aircraft_id=aircraft.id) for n in table.numbers}
    for mode in modes:
        if mode not in known:
            raise BadInput(
                f"mode {mode} is in no modal table of {aircraft.name}; its modes are "
                f"{', '.join(map(str, sorted(known))) or 'none'}",
                code="unknown-mode",
                mode=mode,
            )
    if len(set(modes)) < len(modes):
        raise BadInput(f"a mode is named twice: {', '.join(map(str, modes))}", code="unknown-mode")


def _check_states(structure: Structure, known: tuple[str, ...]) -> None:
    states = {
        "free": structure.free or (),
        "absent": structure.absent,
        "fixed to a number": tuple(structure.fixed),
        "fixed to a source": tuple(structure.fixed_to),
    }
    seen: dict[str, str] = {}
    for state, names in states.items():
        for name in names:
            if name not in known:
                raise BadInput(
                    f"'{name}' is not a derivative of these modes and inputs",
                    code="unknown-derivative",
                    name=name,
                )
            if name in seen:
                raise BadInput(
                    f"'{name}' is {seen[name]} and {state}; a derivative has one state",
                    code="two-states",
                    name=name,
                )
            seen[name] = state


def _check_source(store: Store, aircraft: Aircraft, name: str, source: FixedTo) -> None:
    if source.source is HeldBy.PREDICTION:
        prediction = store.predictions.get(source.id)
        fits, known = prediction.aircraft_id == aircraft.id, name in prediction.names
    else:
        run = store.runs.get(source.id)
        fits = store.maneuvers.get(run.maneuver_id).aircraft_id == aircraft.id
        known = run.result is not None and name in _values_of_run(store, source.id)
    if not fits:
        raise BadInput(
            f"{source.source} {source.id} is of another aircraft", code="wrong-aircraft", name=name
        )
    if not known:
        raise _without_value(name, source)


def _value_of(store: Store, name: str, source: FixedTo, maneuver: Maneuver) -> float:
    if source.source is HeldBy.RUN:
        values = _values_of_run(store, source.id)
    else:
        fuel = maneuver.condition.fuel_fraction
        found = prediction_at(store, store.predictions.get(source.id), fuel)
        values = {key: value for key, (value, _) in found.items()}
    if name not in values:
        raise _without_value(name, source)
    return values[name]


def _values_of_run(store: Store, run_id: int) -> dict[str, float]:
    run = store.runs.get(run_id)
    refuse_altered(run)
    result = run.result
    if result is None:
        return {}
    return result.held | {p.name: p.value for p in result.parameters}


def _without_value(name: str, source: FixedTo) -> BadInput:
    return BadInput(
        f"'{name}' is fixed to {source.source} {source.id}, which has no value for it; "
        "fix it to another source or to a number",
        code="no-value",
        name=name,
    )


def _version_of(record: ModelStructure) -> StructureVersion:
    assert record.id is not None
    return StructureVersion(
        structure_id=record.id,
        version=record.version,
        name=record.name,
        structure=record.structure,
        note=record.note,
        author=record.author,
        created_at=record.changed_at or record.created_at,
    )


def _stale(store: Store, current: ModelStructure, version: int, sent: ModelStructure) -> Conflict:
    assert current.id is not None
    base = store.structure_versions.find(structure_id=current.id, version=version)
    if not base:
        return UnknownVersion(f"model structure {current.id} has no version {version}")
    return StaleEdit(
        f"version {version} of '{current.name}' was edited, but {current.author or 'somebody'} "
        f"has saved version {current.version} since; look at both and save again on top of it",
        current=_version_of(current),
        base=base[0],
        sent=_version_of(replace(sent, version=version)),
    )
