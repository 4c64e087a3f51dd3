"""The sheet on which the demonstration opens: its runs, proposal and predictions.

They are requested as soon as their maneuvers are stored, while the rest of the campaign is
simulated at the lowest priority.
"""

from __future__ import annotations

import time

from flexsid.demo.flex28 import NAME
from flexsid.jobs.kind import submit
from flexsid.jobs.kinds import CROSS_PREDICTION, FLUTTER
from flexsid.records.decision import ModelProposal, StructureReference
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method, RunSettings, RunState
from flexsid.storage import batches
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.model_structures.model_structures import get_structure_of_run
from flexsid.workflow.review import decision_review
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import attach_proposal_basis
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery

RECORD, REPEAT = "1-04 FTA 506", "5-01 FTA 506"
"""Maneuver of the sheet, and the one that repeats it at another fuel."""

SMALLER, PROPOSAL = "SP + SW1B", "SP + SW1B + SW1T"
"""Model structures: the one that is proposed, and the one that it changes."""

AUTHOR = "Demonstration"
_LONGEST_WAIT_S = 600.0
_POLL_S = 1.0
_N_RUNS = 5


def find_record(store: Store) -> Maneuver | None:
    """Find the maneuver of the sheet; None before it is stored."""
    for aircraft in store.aircraft.find(name=NAME):
        for maneuver in store.maneuvers.find(aircraft_id=aircraft.id, label=RECORD):
            if maneuver.deleted_at is None:
                return maneuver
    return None


class FirstSheet:
    """Requests what the sheet rests on, each part when the parts before it are stored.

    Parameters
    ----------
    store
        The demonstration, to which this process adds the maneuvers.
    """

    def __init__(self, store: Store) -> None:
        self._store = store
        self._had_record = find_record(store) is not None
        self._runs: dict[tuple[str, Method, str], int] = {}
        self._is_proposed = False

    def advance(self) -> None:
        """Request what can be requested now; nothing where the record was there before."""
        if self._had_record:
            return
        for label, structure, methods in (
            (RECORD, PROPOSAL, (Method.OE, Method.FRE, Method.EE)),
            (RECORD, SMALLER, (Method.OE,)),
            (REPEAT, PROPOSAL, (Method.OE,)),
        ):
            self._request_runs(label, structure, methods)
        if len(self._runs) == _N_RUNS and not self._is_proposed and self._has_succeeded():
            self._propose()
            self._is_proposed = True

    def finish(self) -> None:
        """Wait until all is requested; give up where a run fails or no server computes it."""
        end = time.monotonic() + _LONGEST_WAIT_S
        while self._runs and not self._is_proposed and time.monotonic() < end:
            states = {self._store.runs.get(number).state for number in self._runs.values()}
            if states & {RunState.FAILED, RunState.CANCELLED}:
                return
            self.advance()
            time.sleep(_POLL_S)

    def _request_runs(self, label: str, structure: str, methods: tuple[Method, ...]) -> None:
        record = find_record(self._store)
        if record is None or all((label, one, structure) in self._runs for one in methods):
            return
        found = self._store.maneuvers.find(aircraft_id=record.aircraft_id, label=label)
        reference = self._find_structure(record, structure)
        if not found or reference is None:
            return
        content, version = get_structure_of_run(self._store, None, reference.id, reference.version)
        for method in methods:
            run = EstimationRun(
                maneuver_id=found[0].id or 0,
                method=method,
                structure=content,
                settings=RunSettings(),
                structure_id=reference.id,
                structure_version=version,
                author=AUTHOR,
            )
            run = add_hashes(self._store, attach_proposal_basis(self._store, run))
            stored, _ = batches.add_once(self._store, run)
            self._runs[label, method, structure] = stored.id or 0

    def _find_structure(self, record: Maneuver, name: str) -> StructureReference | None:
        for one in self._store.model_structures.find(aircraft_id=record.aircraft_id, name=name):
            return StructureReference(id=one.id or 0, version=one.version)
        return None

    def _has_succeeded(self) -> bool:
        runs = map(self._store.runs.get, self._runs.values())
        return all(run.state is RunState.SUCCEEDED for run in runs)

    def _propose(self) -> None:
        """Propose the model structure of the sheet, and predict from the runs of both."""
        store = self._store
        record = find_record(store)
        assert record is not None
        before = self._find_structure(record, SMALLER)
        after = self._find_structure(record, PROPOSAL)
        if before is None or after is None:
            return
        runs = {
            name: tuple(n for (_, _, structure), n in self._runs.items() if structure == name)
            for name in (SMALLER, PROPOSAL)
        }
        decision_review.propose(
            store,
            ModelProposal(
                title=PROPOSAL,
                structure=after,
                changes=before,
                limits={},
                reasoning="SW1T lies in the band that FTA 506 excites.",
                run_ids=runs[PROPOSAL],
            ),
            AUTHOR,
        )
        reference = self._runs[RECORD, Method.OE, PROPOSAL]
        other = self._runs[RECORD, Method.OE, SMALLER]
        repeat = store.maneuvers.find(aircraft_id=record.aircraft_id, label=REPEAT)[0].id or 0
        for ids in ((reference,), runs[PROPOSAL], runs[SMALLER]):
            query = FlutterQuery(run_ids=ids)
            submit(store, FLUTTER, query, AUTHOR, f"{len(ids)} runs of the first sheet")
        for ids in ((reference,), (reference, other)):
            query = CrossPredictionQuery(run_ids=ids, maneuver_ids=(repeat,))
            submit(store, CROSS_PREDICTION, query, AUTHOR, f"{REPEAT} by the first sheet")
