"""Model structures by version, checked against the aircraft, and stored results of runs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import UTC, datetime

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.aircraft import Aircraft
from flexsid.records.decision import FixedTo, HeldBy, ModelStructure, Structure, StructureVersion
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, RunResult
from flexsid.storage.audit_recording import hash_value
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.workflow.aircraft.aircraft_models import (
    define_outputs,
    insert_instruments,
)
from flexsid.workflow.aircraft.axes import (
    find_body,
    list_axis_surfaces,
    require_axis_inputs,
    require_axis_output,
)
from flexsid.workflow.aircraft.derivative_predictions import interpolate_values

# --- Results of runs, refused if they were altered ------------------------------------------------


def get_result(run: EstimationRun, use: str = "no model") -> RunResult:
    """Return the result of a run.

    Parameters
    ----------
    run
        The stored run.
    use
        What a run without a result lacks, for the message.

    Raises
    ------
    Conflict
        If it has none, or its stored result was altered.
    """
    refuse_altered(run)
    if run.result is None:
        raise Conflict(
            f"run {run.id} is {run.state.value} and has {use}; choose a run that succeeded",
            code="run-without-result",
            run_id=run.id,
        )
    return run.result


def refuse_altered(run: EstimationRun) -> None:
    """Refuse a run whose request or result was altered after it was stored.

    Raises
    ------
    Conflict
        If it was altered.
    """
    if run.altered:
        raise Conflict(
            f"the stored request or result of run {run.id} was altered after the run finished: it"
            " does not match the hash that was stored with it. Estimate again, or"
            " restore a backup; `flexsid check` lists all altered records",
            code="result-altered",
            run_id=run.id,
        )


def hash_run(run: EstimationRun) -> str:
    """Hash the request and the result of a run."""
    return hash_value(
        [run.method, run.maneuver_id, run.structure, run.settings, run.result, run.versions]
    )


def describe_data_changes(run_id: int | None, changed: tuple[str, ...]) -> str | None:
    """Describe changes of the data since a run was computed; None without changes."""
    if not changed:
        return None
    return (
        f"Data changed since run {run_id} was computed: {', '.join(changed)} (samples, corrections"
        " or assumptions). Its result is that of the earlier data; estimate again."
    )


# --- Model structures: stored by version, checked against the aircraft, resolved for a maneuver


class StaleEdit(Conflict):
    """The record was changed by another user since it was read."""

    code = "stale-edit"


def add_structure(store: Store, record: ModelStructure) -> ModelStructure:
    """Store a new model structure as version 1.

    Raises
    ------
    BadInput
        If it does not fit the aircraft, or a derivative has two states.
    Conflict
        If another structure of the aircraft has this name.
    """
    with store.transaction():
        check_structure(store, store.aircraft.get(record.aircraft_id), record.structure)
        _check_name(store, record)
        stored = store.model_structures.add(replace(record, version=1, changed_at=None))
        store.structure_versions.add(_build_version(stored))
    return stored


def _check_name(store: Store, record: ModelStructure) -> None:
    """Refuse a name that another model structure of the aircraft has."""
    for other in store.model_structures.find(aircraft_id=record.aircraft_id, name=record.name):
        if other.id != record.id:
            raise Conflict(
                f"model structure {other.id} is called {record.name!r} already; edit that one, or"
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
    """Store a new version of the one that was edited; older versions remain.

    Raises
    ------
    StaleEdit
        If ``version`` is not the newest any more; it contains the newest version, the one
        that was edited and the one that was sent.
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
            raise _build_stale_edit_error(store, current, version, edited)
        store.structure_versions.add(_build_version(edited))
    return edited


def get_version(store: Store, structure_id: int, version: int | None = None) -> StructureVersion:
    """Return one version of a model structure, the newest by default."""
    number = store.model_structures.get(structure_id).version if version is None else version
    found = store.structure_versions.find(structure_id=structure_id, version=number)
    if not found:
        raise UnknownRecord(f"model structure {structure_id} has no version {number}")
    return found[0]


def get_structure_of_run(
    store: Store, given: Structure | None, structure_id: int | None, version: int | None
) -> tuple[Structure, int | None]:
    """Return the model structure requested for a run, and its saved version.

    Raises
    ------
    BadInput
        If there is none, or the one given in full differs from the saved one.
    """
    if structure_id is None:
        if given is None or version is not None:
            raise BadInput(
                "give the run a model structure, in full or as structure_id", code="no-structure"
            )
        return given, None
    saved = get_version(store, structure_id, version)
    if given is not None and given != saved.structure:
        raise BadInput(
            f"the model structure differs from version {saved.version} of model structure "
            f"{structure_id}; give one of the two",
            code="other-structure",
            structure_id=structure_id,
            version=saved.version,
        )
    return saved.structure, saved.version


def resolve_structure(
    store: Store, structure: Structure, aircraft: Aircraft, maneuver: Maneuver
) -> tuple[Structure, Aircraft]:
    """Replace the sources of fixed derivatives by values, and instruments of the aircraft.

    Raises
    ------
    BadInput
        If a source has no value of a derivative, or a channel or instrument is unknown or
        named twice.
    """
    _refuse_duplicates(structure)
    fixed = {
        name: _get_source_value(store, name, source, maneuver)
        for name, source in structure.fixed_to.items()
    }
    fixed |= structure.fixed | dict.fromkeys(structure.absent, 0.0)
    return replace(structure, fixed=fixed), insert_instruments(aircraft, structure)


def check_structure(store: Store, aircraft: Aircraft, structure: Structure) -> None:
    """Refuse a model structure that does not fit the aircraft.

    Raises
    ------
    BadInput
        If a mode, channel, derivative or source does not fit.
    """
    _check_modes(store, aircraft, structure.modes)
    _refuse_duplicates(structure)
    surfaces = tuple(surface.name for surface in aircraft.surfaces)
    for name in structure.inputs:
        if name not in surfaces:
            raise BadInput(
                f"'{name}' is not a surface of {aircraft.name}; surfaces are {', '.join(surfaces)}",
                code="unknown-input",
                input=name,
            )
    body = find_body(structure.axis)
    require_axis_inputs(aircraft, structure.inputs, body)
    for output in define_outputs(aircraft, structure.outputs):
        require_axis_output(output.name, output.terms, body)
    insert_instruments(aircraft, structure)
    inputs = structure.inputs or list_axis_surfaces(aircraft, body)
    _check_states(structure, list_derivative_names(structure.modes, inputs, body))
    for name, source in structure.fixed_to.items():
        _check_source(store, aircraft, name, source)


def _refuse_duplicates(structure: Structure) -> None:
    """Refuse names given twice; a duplicated output would bias the standard errors."""
    named = (
        ("mode", structure.modes, "unknown-mode"),
        ("input", structure.inputs, "named-twice"),
        ("output", structure.outputs, "named-twice"),
    )
    for what, names, code in named:
        for index, name in enumerate(names):
            if name in names[:index]:
                raise BadInput(f"{what} {name} is named twice; name it once", code=code)


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
        known = name in _get_run_values(store, source.id)
    if not fits:
        raise BadInput(
            f"{source.source} {source.id} is of another aircraft", code="wrong-aircraft", name=name
        )
    if not known:
        raise _build_missing_value_error(name, source)


def _get_source_value(store: Store, name: str, source: FixedTo, maneuver: Maneuver) -> float:
    if source.source is HeldBy.RUN:
        values = _get_run_values(store, source.id)
    else:
        fuel = maneuver.condition.fuel_fraction
        values = interpolate_values(store, store.predictions.get(source.id), fuel)
    if name not in values:
        raise _build_missing_value_error(name, source)
    return values[name]


def _get_run_values(store: Store, run_id: int) -> dict[str, float]:
    run = store.runs.get(run_id)
    refuse_altered(run)
    if run.result is None:
        return {}
    return run.result.held | {p.name: p.value for p in run.result.parameters}


def _build_missing_value_error(name: str, source: FixedTo) -> BadInput:
    return BadInput(
        f"'{name}' is fixed to {source.source} {source.id}, which has no value for it; "
        "fix it to another source or to a number",
        code="no-value",
        name=name,
    )


def _build_version(record: ModelStructure) -> StructureVersion:
    return StructureVersion(
        structure_id=record.id or 0,
        version=record.version,
        name=record.name,
        structure=record.structure,
        note=record.note,
        author=record.author,
        created_at=record.changed_at or record.created_at,
    )


def _build_stale_edit_error(
    store: Store, current: ModelStructure, version: int, sent: ModelStructure
) -> Conflict:
    base = store.structure_versions.find(structure_id=current.id, version=version)
    if not base:
        return Conflict(
            f"model structure {current.id} has no version {version}", code="unknown-version"
        )
    return StaleEdit(
        f"version {version} of '{current.name}' was edited, but {current.author or 'another user'} "
        f"has saved version {current.version} since; compare both and save again",
        current=_build_version(current),
        base=base[0],
        sent=_build_version(replace(sent, version=version)),
    )


def describe_derivative_state(structure: Structure, name: str) -> str:
    """Describe the state of a derivative: free, absent, or fixed to a value or source."""
    if name in structure.absent:
        return "absent"
    if name in structure.fixed:
        return f"fixed to {structure.fixed[name]:g}"
    if name in structure.fixed_to:
        source = structure.fixed_to[name]
        return f"fixed to {source.source.value} {source.id}"
    if structure.free is None or name in structure.free:
        return "free"
    return "fixed to the start of the run"


def list_structure_differences(
    before: Structure, after: Structure, surfaces: Sequence[str]
) -> list[tuple[str, str, str]]:
    """List differences as (item, before, after); ``surfaces`` are the inputs by default."""
    known = [
        list_derivative_names(one.modes, one.inputs or tuple(surfaces), find_body(one.axis))
        for one in (before, after)
    ]
    rows = [
        (
            name,
            describe_derivative_state(before, name) if name in known[0] else "not in the model",
            describe_derivative_state(after, name) if name in known[1] else "not in the model",
        )
        for name in dict.fromkeys((*known[1], *known[0]))
    ]
    rows += [
        (what, _join_values(one), _join_values(other))
        for what, one, other in (
            ("modes", before.modes, after.modes),
            ("inputs", before.inputs or ("all",), after.inputs or ("all",)),
            ("outputs", before.outputs or ("all",), after.outputs or ("all",)),
            ("also free", before.extra_parameters, after.extra_parameters),
            ("time delays", (before.free_delays,), (after.free_delays,)),
            ("delays", before.delays.items(), after.delays.items()),
            ("instruments", before.instruments.items(), after.instruments.items()),
        )
    ]
    return [row for row in rows if row[1] != row[2]]


def _join_values(values: Iterable[object]) -> str:
    return ", ".join(str(value) for value in values) or "none"
