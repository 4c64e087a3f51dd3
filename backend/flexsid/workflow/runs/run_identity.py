"""Identity: two requests with equal inputs are one run.

The hash covers what was recorded and assumed (maneuvers, aircraft, modal tables,
predictions), what was asked for, and the release of the software.
"""

from __future__ import annotations

from dataclasses import asdict, replace

from flexsid import __version__
from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.run import EstimationRun, Provenance
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.content import contents_of, hash_of, maneuver_hashes, record_hash
from flexsid.storage.store import Store
from flexsid.workflow.modal_data.aligned_modes import find_modal_tables

Tables = tuple[int | None, int | None]


class Identities:
    """Gives runs their hashes; reads what many runs share once."""

    def __init__(self, store: Store, maneuver_ids: tuple[int, ...]) -> None:
        self._store = store
        self._maneuvers = maneuver_hashes(store.database, maneuver_ids)
        self._assumed: dict[tuple[int, int | None, int | None, int | None], str] = {}
        self._tables: dict[tuple[int, int | None, int | None], Tables] = {}

    def knows(self, maneuver_id: int) -> bool:
        """Whether there is such a maneuver."""
        return maneuver_id in self._maneuvers

    def of(self, run: EstimationRun, start_hash: str | None = None) -> EstimationRun:
        """Return a run with its hashes, and with the modal tables that it takes by name.

        A table that is imported later must not change what a run says of itself, and one
        that a run takes must not be deleted.

        Parameters
        ----------
        run
            As asked for.
        start_hash
            ``input_hash`` of the run that it starts from, where it starts from one.
        """
        involved = (run.maneuver_id, *run.settings.together_with)
        for number in involved:
            if number not in self._maneuvers:
                raise UnknownRecord(f"there is no maneuver {number}")
        run = self._with_tables(run)
        data = hash_of([[self._maneuvers[n][1] for n in involved], self._assumptions(run)])
        settings = asdict(run.settings)
        settings["start_run_id"] = start_hash or settings["start_run_id"]
        # A run says which kept structure it rests on; one that says another is another run.
        kept = [run.structure_id, run.structure_version]
        asked = [run.method.value, asdict(run.structure), kept, settings, __version__]
        return replace(run, data_hash=data, input_hash=hash_of([data, asked]))

    def _with_tables(self, run: EstimationRun) -> EstimationRun:
        aircraft = self._maneuvers[run.maneuver_id][0]
        key = (aircraft, run.modal_table_id, run.damping_table_id)
        if key not in self._tables:
            try:
                modal, damping = find_modal_tables(self._store, *key)
            except BadInput:  # the run itself will fail with it
                self._tables[key] = key[1:]
            else:
                # A table is its own source of damping where there is no other.
                self._tables[key] = (modal.id, (damping or modal).id)
        modal_id, damping_id = self._tables[key]
        return replace(run, modal_table_id=modal_id, damping_table_id=damping_id)

    def _assumptions(self, run: EstimationRun) -> str:
        """Hash of aircraft, tables and predictions: the one named, or all to choose from."""
        aircraft = self._maneuvers[run.maneuver_id][0]
        key = (aircraft, run.modal_table_id, run.damping_table_id, run.prediction_id)
        if key not in self._assumed:
            tables = [t for t in (run.modal_table_id, run.damping_table_id) if t is not None]
            predictions = [p.id for p in self._store.predictions.find(aircraft_id=aircraft) if p.id]
            named = None if run.prediction_id is None else [run.prediction_id]
            self._assumed[key] = hash_of(
                [
                    record_hash(self._store.database, "aircraft", [aircraft]),
                    tables,
                    record_hash(self._store.database, "modal_tables", tables),
                    record_hash(self._store.database, "predictions", named or predictions),
                ]
            )
        return self._assumed[key]


def identified(store: Store, run: EstimationRun) -> EstimationRun:
    """Return one run with its hashes.

    Raises
    ------
    Conflict
        If a maneuver was deleted.
    """
    with store.reading():
        refuse_deleted(store, (run.maneuver_id, *run.settings.together_with))
        return _identified(store, run)


def _identified(store: Store, run: EstimationRun) -> EstimationRun:
    start = run.settings.start_run_id
    start_hash = None if start is None else store.runs.get(start).input_hash
    involved = (run.maneuver_id, *run.settings.together_with)
    return Identities(store, involved).of(run, start_hash)


def provenance_of(
    store: Store, run: EstimationRun, aircraft_id: int, used: dict[str, tuple[int | None, ...]]
) -> Provenance:
    """Hash what a run is computed from, in the reading in which it is read.

    It may have been corrected since the run was asked for; what counts is what was read.

    Parameters
    ----------
    store
        Where it is read.
    run
        Which is prepared.
    aircraft_id
        Of its maneuvers.
    used
        Further records by kind, as {"modal table": (2, 3)}; None stands for none.
    """
    maneuvers = dict.fromkeys((run.maneuver_id, *run.settings.together_with))
    records = {"maneuver": tuple(maneuvers), "aircraft": (aircraft_id,), **used}
    names = [
        f"{noun} {number}"
        for noun, numbers in records.items()
        for number in dict.fromkeys(numbers)
        if number is not None
    ]
    found = _identified(store, run)
    return Provenance(
        rests_on=contents_of(store.database, names),
        data_hash=found.data_hash,
        input_hash=run.input_hash if found.data_hash == run.data_hash else found.input_hash,
    )
