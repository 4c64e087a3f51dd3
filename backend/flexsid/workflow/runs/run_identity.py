"""Identity: two requests with equal inputs are one run.

The hash covers what was recorded and assumed (maneuvers, aircraft, modal tables,
predictions), what was asked for, and the version of the numerical methods.
"""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

import sqlalchemy as sa

from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.run import Aerodynamics, EstimationRun, OutOfBandModes, Provenance
from flexsid.records.sealed_names import with_sealed_names
from flexsid.request_models import check_request
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.content import hash_content, hash_maneuvers, hash_record, hash_records
from flexsid.storage.store import Store
from flexsid.storage.tables import channels
from flexsid.workflow.fits.estimation_task import METHODS
from flexsid.workflow.modal_data.modal_tables import find_modal_tables, list_corrections
from flexsid.workflow.runs.starts import refuse_double_count

Tables = tuple[int | None, int | None]


class RunHasher:
    """Computes the hashes of runs; records that many runs share are read once."""

    def __init__(self, store: Store, maneuver_ids: tuple[int, ...]) -> None:
        self._store = store
        self._maneuvers = hash_maneuvers(store.database, maneuver_ids)
        self._assumed: dict[tuple[object, ...], str] = {}
        self._starts: dict[int, str | None] = {}
        self._tables: dict[tuple[object, ...], Tables] = {}

    def has_maneuver(self, maneuver_id: int) -> bool:
        """Whether a maneuver exists."""
        return maneuver_id in self._maneuvers

    def hash_run(self, run: EstimationRun, start_hash: str | None = None) -> EstimationRun:
        """Return a run with its hashes and with the ids of the modal tables that it uses.

        A table that is imported later must not change the provenance of a run, and one
        that a run uses must not be deleted.

        Parameters
        ----------
        run
            The run as requested.
        start_hash
            ``input_hash`` of the run that supplies the start values where it is not stored yet.
        """
        involved = (run.maneuver_id, *run.settings.additional_maneuver_ids)
        for number in involved:
            if number not in self._maneuvers:
                raise UnknownRecord(f"there is no maneuver {number}")
        run = self._with_tables(run)
        data = hash_content([[self._maneuvers[n][1] for n in involved], self._assumptions(run)])
        settings: dict[str, Any] = asdict(run.settings)
        if run.settings.out_of_band_modes is OutOfBandModes.OMITTED:
            del settings["out_of_band_modes"]  # as hashed before the setting existed
        if run.settings.aerodynamics is Aerodynamics.QUASI_STEADY:
            del settings["aerodynamics"]
        settings["start_run_id"] = start_hash or self._get_start_hash(run)
        # The saved model structure is part of the identity of a run.
        saved = [run.structure_id, run.structure_version]
        asked = [run.method.value, asdict(run.structure), saved, settings, METHODS]
        if run.prediction_id is not None:  # of all predictions that the data include
            asked.append({"prediction": run.prediction_id})
        return replace(
            run, data_hash=data, input_hash=hash_content([data, with_sealed_names(asked)])
        )

    def _get_start_hash(self, run: EstimationRun) -> str | int | None:
        """Return the hash of the run that supplies the start values; its id without a hash."""
        number = run.settings.start_run_id
        if number is None:
            return None
        if number not in self._starts:
            self._starts[number] = self._store.runs.get(number).input_hash
        return self._starts[number] or number

    def _with_tables(self, run: EstimationRun) -> EstimationRun:
        aircraft = self._maneuvers[run.maneuver_id][0]
        named = (aircraft, run.modal_table_id, run.damping_table_id)
        involved = (run.maneuver_id, *run.settings.additional_maneuver_ids)
        key = (*named, involved)
        if key not in self._tables:
            try:
                modal, damping = find_modal_tables(self._store, *named, involved)
            except BadInput:  # raised again when the run is prepared
                self._tables[key] = named[1:]
            else:
                # A table supplies the damping itself where no damping table exists.
                self._tables[key] = (modal.id, (damping or modal).id)
        modal_id, damping_id = self._tables[key]
        return replace(run, modal_table_id=modal_id, damping_table_id=damping_id)

    def _assumptions(self, run: EstimationRun) -> str:
        """Hash of aircraft, tables and predictions: the named one, or all available ones.

        The prior of retained modes may be of another prediction than the named one.
        """
        aircraft = self._maneuvers[run.maneuver_id][0]
        is_retaining = run.settings.out_of_band_modes is OutOfBandModes.RETAINED
        prediction_id = None if is_retaining else run.prediction_id
        key = (aircraft, run.modal_table_id, run.damping_table_id, prediction_id)
        if key not in self._assumed:
            tables = [t for t in (run.modal_table_id, run.damping_table_id) if t is not None]
            predictions = [p.id for p in self._store.predictions.find(aircraft_id=aircraft) if p.id]
            named = None if prediction_id is None else [prediction_id]
            assumed: list[Any] = [
                hash_record(self._store.database, "aircraft", [aircraft]),
                tables,
                hash_record(self._store.database, "modal_tables", tables),
                hash_record(self._store.database, "predictions", named or predictions),
            ]
            # Names and symmetries of modes that somebody corrected; most tables have none.
            if corrected := list_corrections(self._store, tables):
                assumed.append(corrected)
            # A version that is undone is no default, although it is still there.
            written = self._store.write_backs.find(aircraft_id=aircraft)
            if undone := [one.id for one in written if one.undone_at is not None]:
                assumed.append({"undone": undone})
            self._assumed[key] = hash_content(assumed)
        return self._assumed[key]


def add_hashes(store: Store, run: EstimationRun) -> EstimationRun:
    """Return one run that is requested with its hashes.

    Raises
    ------
    BadInput
        If a setting or the structure has a value that its class does not allow, or the run names a
        version with the data of its own records.
    Conflict
        If a maneuver was deleted.
    """
    check_ranges(run)
    with store.reading():
        refuse_deleted(store, (run.maneuver_id, *run.settings.additional_maneuver_ids))
        refuse_double_count(store, run)
        return hash_request(store, run)


def check_ranges(run: EstimationRun) -> None:
    """Refuse structure, settings and limits that a run may not have, by whichever door it came.

    A run of an earlier release, which had other ranges, is computed and shown as it was stored.

    Raises
    ------
    BadInput
        With the field, its value and what is allowed.
    """
    for part in (run.structure, run.settings, run.limits):
        check_request(part)


def hash_request(store: Store, run: EstimationRun) -> EstimationRun:
    """Return a run with its hashes, unchecked."""
    involved = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    return RunHasher(store, involved).hash_run(run)


def hash_provenance(
    store: Store, run: EstimationRun, aircraft_id: int, used: dict[str, tuple[int | None, ...]]
) -> Provenance:
    """Hash the records that a run is computed from, in the transaction that reads them.

    They may have been corrected since the run was requested; the hash covers the values read.

    Parameters
    ----------
    store
        Database of the records.
    run
        The run that is prepared.
    aircraft_id
        Aircraft of its maneuvers.
    used
        Further records by kind, as {"modal table": (2, 3)}; None stands for none.
    """
    maneuvers = dict.fromkeys((run.maneuver_id, *run.settings.additional_maneuver_ids))
    records = {"maneuver": tuple(maneuvers), "aircraft": (aircraft_id,), **used}
    names = [
        f"{noun} {number}"
        for noun, numbers in records.items()
        for number in dict.fromkeys(numbers)
        if number is not None
    ]
    found = hash_request(store, run)
    return Provenance(
        rests_on=hash_records(store.database, names),
        data_hash=found.data_hash,
        input_hash=run.input_hash if found.data_hash == run.data_hash else found.input_hash,
    )


def list_run_contents(
    store: Store, run_ids: tuple[int, ...], maneuver_ids: tuple[int, ...] = ()
) -> tuple[object, ...]:
    """List all records on which models of these runs, and refits of them, depend.

    The data of further maneuvers are added.
    """
    runs = [store.runs.get(number) for number in run_ids]
    used = {number for run in runs for number in run.settings.additional_maneuver_ids}
    used |= {run.maneuver_id for run in runs} | set(maneuver_ids)
    maneuvers = [store.maneuvers.get(number) for number in sorted(used)]
    samples = sa.select(channels.c.maneuver_id, channels.c.name, channels.c.array)
    with store.database.reading() as connection:
        arrays = connection.execute(samples.where(channels.c.maneuver_id.in_(used))).all()
    aircraft_ids = sorted({maneuver.aircraft_id for maneuver in maneuvers})
    return (
        runs,
        maneuvers,
        sorted(map(tuple, arrays)),
        [step for number in sorted(used) for step in store.conditioning.find(maneuver_id=number)],
        [store.aircraft.get(number) for number in aircraft_ids],
        [store.modal_tables.find(aircraft_id=number) for number in aircraft_ids],
        [store.predictions.find(aircraft_id=number) for number in aircraft_ids],
        store.mode_corrections.find(),
    )
