"""Identity: two requests with equal inputs are one run.

The hash covers what was recorded and assumed (maneuvers, aircraft, modal tables,
predictions), what was asked for, and the release of the software.
"""

from __future__ import annotations

from dataclasses import asdict, replace

from flexsid import __version__
from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.run import EstimationRun, Provenance
from flexsid.records.sealed_names import with_sealed_names
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.content import hash_content, hash_maneuvers, hash_record, hash_records
from flexsid.storage.store import Store
from flexsid.workflow.modal_data.aligned_modes import find_modal_tables

Tables = tuple[int | None, int | None]


class RunHasher:
    """Computes the hashes of runs; records that many runs share are read once."""

    def __init__(self, store: Store, maneuver_ids: tuple[int, ...]) -> None:
        self._store = store
        self._maneuvers = hash_maneuvers(store.database, maneuver_ids)
        self._assumed: dict[tuple[int, int | None, int | None, int | None], str] = {}
        self._tables: dict[tuple[int, int | None, int | None], Tables] = {}

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
            ``input_hash`` of the run that supplies the start values, if any.
        """
        involved = (run.maneuver_id, *run.settings.additional_maneuver_ids)
        for number in involved:
            if number not in self._maneuvers:
                raise UnknownRecord(f"there is no maneuver {number}")
        run = self._with_tables(run)
        data = hash_content([[self._maneuvers[n][1] for n in involved], self._assumptions(run)])
        settings = asdict(run.settings)
        settings["start_run_id"] = start_hash or settings["start_run_id"]
        # The saved model structure is part of the identity of a run.
        saved = [run.structure_id, run.structure_version]
        asked = [run.method.value, asdict(run.structure), saved, settings, __version__]
        return replace(
            run, data_hash=data, input_hash=hash_content([data, with_sealed_names(asked)])
        )

    def _with_tables(self, run: EstimationRun) -> EstimationRun:
        aircraft = self._maneuvers[run.maneuver_id][0]
        key = (aircraft, run.modal_table_id, run.damping_table_id)
        if key not in self._tables:
            try:
                modal, damping = find_modal_tables(self._store, *key)
            except BadInput:  # raised again when the run is prepared
                self._tables[key] = key[1:]
            else:
                # A table supplies the damping itself where no damping table exists.
                self._tables[key] = (modal.id, (damping or modal).id)
        modal_id, damping_id = self._tables[key]
        return replace(run, modal_table_id=modal_id, damping_table_id=damping_id)

    def _assumptions(self, run: EstimationRun) -> str:
        """Hash of aircraft, tables and predictions: the named one, or all available ones."""
        aircraft = self._maneuvers[run.maneuver_id][0]
        key = (aircraft, run.modal_table_id, run.damping_table_id, run.prediction_id)
        if key not in self._assumed:
            tables = [t for t in (run.modal_table_id, run.damping_table_id) if t is not None]
            predictions = [p.id for p in self._store.predictions.find(aircraft_id=aircraft) if p.id]
            named = None if run.prediction_id is None else [run.prediction_id]
            self._assumed[key] = hash_content(
                [
                    hash_record(self._store.database, "aircraft", [aircraft]),
                    tables,
                    hash_record(self._store.database, "modal_tables", tables),
                    hash_record(self._store.database, "predictions", named or predictions),
                ]
            )
        return self._assumed[key]


def add_hashes(store: Store, run: EstimationRun) -> EstimationRun:
    """Return one run with its hashes.

    Raises
    ------
    Conflict
        If a maneuver was deleted.
    """
    with store.reading():
        refuse_deleted(store, (run.maneuver_id, *run.settings.additional_maneuver_ids))
        return _add_hashes(store, run)


def _add_hashes(store: Store, run: EstimationRun) -> EstimationRun:
    start = run.settings.start_run_id
    start_hash = None if start is None else store.runs.get(start).input_hash
    involved = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    return RunHasher(store, involved).hash_run(run, start_hash)


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
    found = _add_hashes(store, run)
    return Provenance(
        rests_on=hash_records(store.database, names),
        data_hash=found.data_hash,
        input_hash=run.input_hash if found.data_hash == run.data_hash else found.input_hash,
    )
