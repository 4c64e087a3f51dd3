"""Process that simulates the demonstration while the server runs, first of all its first sheet.

Its maneuvers are simulated first, and its runs requested as soon as they are stored, while the rest
of the campaign is simulated at the lowest priority.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from contextlib import closing, suppress
from multiprocessing.connection import Connection
from types import FrameType

from flexsid.demo.campaign import RECORD, REPEAT, Report, add_campaign
from flexsid.demo.flex28 import NAME
from flexsid.demo.independent_surfaces import add_independent
from flexsid.demo.transport import add_transport
from flexsid.errors import FlexsidError
from flexsid.jobs.child import Program
from flexsid.jobs.health import PartHealth, PartState
from flexsid.jobs.kind import submit
from flexsid.jobs.kinds import CROSS_PREDICTION, FLUTTER
from flexsid.records.decision import ModelProposal, StructureReference
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method, RunSettings, RunState
from flexsid.storage.jobs import batches
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.model_structures.model_structures import get_structure_of_run
from flexsid.workflow.review import decision_review
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import attach_proposal_basis
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery

# --- The sheet on which the demonstration opens: its runs, proposal and predictions ---------------

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

    @property
    def has_records(self) -> bool:
        """Whether the maneuvers of the sheet are stored, so that the rest can wait."""
        return self._had_record or len(self._runs) == _N_RUNS

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
            submit(store, FLUTTER, query, AUTHOR)
        for ids in ((reference,), (reference, other)):
            query = CrossPredictionQuery(run_ids=ids, maneuver_ids=(repeat,))
            submit(store, CROSS_PREDICTION, query, AUTHOR)


# --- All that the demonstration has: the campaign of FLEX-28, and aircraft with other motions -----


def add_demonstration(store: Store, report: Report, *, unsteady: bool, niceness: int = 0) -> None:
    """Simulate and store what is missing, with the arguments of ``add_campaign``."""
    add_campaign(store, report, unsteady=unsteady, niceness=niceness)
    add_transport(store)
    add_independent(store)


# --- Process that simulates the demonstration aircraft while the server runs ----------------------

_STOP_S = 5.0  # longer than the simulation of one maneuver
_NICE = 19
"""Once the first sheet has its maneuvers, runs and pages have priority: the first run of a new user
took 64 s, others 5 s."""


class CampaignProcess:
    """Adds the missing maneuvers of the campaign to a migrated database.

    Parameters
    ----------
    database
        URL of the database.
    report
        Called with the completed fraction and a message after every maneuver.
    unsteady
        True for the campaign of FLEX-28U.
    """

    def __init__(self, database: str, report: Report, *, unsteady: bool = False) -> None:
        self._request = database, unsteady
        self._report = report
        self._program: Program | None = None
        self._thread = threading.Thread(target=self._receive, name="campaign", daemon=True)
        self._health: PartHealth | None = _describe(PartState.STARTING, "starting")

    def start(self) -> None:
        """Start the process."""
        self._program = Program("flexsid.demo.campaign_process")
        self._program.connection.send(self._request)
        self._thread.start()

    def stop(self) -> None:
        """End the process; the next one simulates what is missing then."""
        if self._program is not None:
            self._program.release_lifeline()
            self._thread.join(_STOP_S)
            self._program.kill()
            self._program.close()

    def check_health(self) -> PartHealth | None:
        """Return progress or failure of the simulation; None when the campaign is complete."""
        return self._health

    def _receive(self) -> None:
        program = self._program
        assert program is not None
        with suppress(EOFError, OSError):
            while True:
                fraction, message = program.connection.recv()
                if fraction is None:
                    self._fail(message)
                    return
                self._health = (
                    None
                    if fraction == 1.0
                    else _describe(PartState.STARTING, f"{fraction:.0%}, {message}")
                )
                self._report(fraction, message)
        if self._health is not None:
            self._fail(program.describe_exit())

    def _fail(self, reason: str) -> None:
        text = f"incomplete ({reason}). Start flexsid demo again to add the missing maneuvers"
        self._health = _describe(PartState.DEGRADED, text)


def _describe(state: PartState, text: str) -> PartHealth:
    return PartHealth(
        name="demonstration", state=state, text=f"Simulation of the demonstration campaign: {text}."
    )


def main(arguments: list[str]) -> None:
    """Add the campaign; connection and lifeline are given by file descriptor."""
    connection, lifeline = Connection(int(arguments[0])), int(arguments[1])
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _interrupt_once)
    threading.Thread(target=_interrupt_with, args=(lifeline,), daemon=True).start()
    try:
        database, unsteady = connection.recv()
        with closing(Store.open(database)) as store:
            sheet = None if unsteady else FirstSheet(store)

            def report(fraction: float, message: str) -> None:
                if sheet is not None:
                    sheet.advance()
                if hasattr(os, "nice") and (sheet is None or sheet.has_records):
                    os.nice(_NICE - os.nice(0))
                connection.send((fraction, message))

            add_demonstration(store, report, unsteady=unsteady, niceness=_NICE)
            if sheet is not None:
                sheet.finish()
    except FlexsidError as error:
        connection.send((None, error.message))
    except (KeyboardInterrupt, EOFError, OSError):
        return


def _interrupt_once(number: int, frame: FrameType | None) -> None:
    # Ctrl-C reaches the whole process group, and the end of the server this process again.
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, signal.SIG_IGN)
    raise KeyboardInterrupt


def _interrupt_with(lifeline: int) -> None:
    """Interrupt the main thread when the lifeline closes, so that it ends its own processes."""
    os.read(lifeline, 1)
    os.kill(os.getpid(), signal.SIGINT)


if __name__ == "__main__":
    main(sys.argv[1:])
