"""Store: access to all stored data."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Unpack

from flexsid.records.account import Account, ApiToken, AuditEvent, LoginSession, Membership
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.decision import (
    Decision,
    DecisionEvent,
    FrozenFigure,
    ModelStructure,
    ReviewRules,
    SeenEvents,
    StructureVersion,
)
from flexsid.records.excitation import ExcitationDesign, PreflightSimulation
from flexsid.records.flutter import Controller, FlutterSummary
from flexsid.records.global_model import GlobalModelVersion
from flexsid.records.job import Job
from flexsid.records.live import Acknowledgement, LiveStream, LiveTestPoint, RecordedState
from flexsid.records.maneuver import (
    Channel,
    ConditioningStep,
    Flight,
    FlightChannel,
    Maneuver,
    StoredMapping,
)
from flexsid.records.modal_data import MeasuredResponses, ModalTable, ModeCorrection
from flexsid.records.note import NoteRevision, SavedView
from flexsid.records.quality import ManeuverQuality
from flexsid.records.run import Batch, RunTemplate
from flexsid.records.search import StructureSearch
from flexsid.records.write_back import WriteBack
from flexsid.storage import tables
from flexsid.storage.access import Quotas
from flexsid.storage.arrays import Arrays, ModalShapes
from flexsid.storage.database import Database
from flexsid.storage.lists.list_query import Facets, Page, read_tags
from flexsid.storage.lists.maneuver_list import (
    ManeuverFilters,
    ManeuverItem,
    count_maneuvers,
    select_maneuvers,
)
from flexsid.storage.lists.run_list import RunFilters, RunItem, Runs, count_runs, select_runs
from flexsid.storage.recordings import Recordings
from flexsid.storage.repository import Repository


class Store:
    """Records by kind, arrays by content, in a migrated database.

    Safe for use from several threads. Every call is a separate transaction
    unless it is in ``with store.transaction():`` or, where it reads,
    ``with store.reading():``.
    """

    def __init__(
        self,
        database: Database,
        quotas: Quotas | None = None,
        recordings: Recordings | None = None,
    ) -> None:
        self.database = database
        self.recordings = recordings
        self.quotas = Quotas() if quotas is None else quotas
        self.arrays = Arrays(database)
        self.aircraft = Repository(database, tables.aircraft, Aircraft, "aircraft")
        self.flights = Repository(database, tables.flights, Flight, "flight")
        self.maneuvers = Repository(
            database, tables.maneuvers, Maneuver, "maneuver", copied=_condition_columns
        )
        self.channels = Repository(database, tables.channels, Channel, "channel")
        self.flight_channels = Repository(
            database, tables.flight_channels, FlightChannel, "channel of a flight"
        )
        self.conditioning = Repository(
            database, tables.conditioning_steps, ConditioningStep, "conditioning step"
        )
        self.qualities = Repository(
            database, tables.maneuver_quality, ManeuverQuality, "quality of a maneuver"
        )
        self.mappings = Repository(database, tables.mappings, StoredMapping, "mapping")
        self.modal_tables = Repository(database, tables.modal_tables, ModalTable, "modal table")
        self.modal_shapes = ModalShapes(database, self.arrays)
        self.mode_corrections = Repository(
            database, tables.mode_corrections, ModeCorrection, "correction of a mode"
        )
        self.flutter_summaries = Repository(
            database, tables.flutter_summaries, FlutterSummary, "flutter summary"
        )
        self.measured_responses = Repository(
            database, tables.measured_responses, MeasuredResponses, "set of measured responses"
        )
        self.predictions = Repository(
            database, tables.predictions, DerivativePrediction, "prediction"
        )
        self.write_backs = Repository(database, tables.write_backs, WriteBack, "write-back")
        self.model_structures = Repository(
            database, tables.model_structures, ModelStructure, "model structure"
        )
        self.structure_versions = Repository(
            database, tables.structure_versions, StructureVersion, "version of a model structure"
        )
        self.designs = Repository(database, tables.designs, ExcitationDesign, "excitation design")
        self.review_rules = Repository(
            database, tables.review_rules, ReviewRules, "version of the rules of review"
        )
        self.decisions = Repository(database, tables.decisions, Decision, "decision")
        self.decision_events = Repository(
            database, tables.decision_events, DecisionEvent, "event of a decision"
        )
        self.global_model_versions = Repository(
            *(database, tables.global_model_versions, GlobalModelVersion),
            "version of a global model",
        )
        self.frozen_figures = Repository(
            database, tables.frozen_figures, FrozenFigure, "frozen figure"
        )
        self.looks = Repository(database, tables.looks, SeenEvents, "look")
        self.controllers = Repository(database, tables.controllers, Controller, "controller")
        self.preflight_simulations = Repository(
            database, tables.preflight_simulations, PreflightSimulation, "preflight simulation"
        )
        self.live_streams = Repository(database, tables.live_streams, LiveStream, "stream")
        self.live_states = Repository(
            database, tables.live_states, RecordedState, "state of a stream"
        )
        self.live_test_points = Repository(
            database, tables.live_test_points, LiveTestPoint, "test point of a stream"
        )
        self.live_acknowledgements = Repository(
            database, tables.live_acknowledgements, Acknowledgement, "acknowledgement"
        )
        self.jobs = Repository(database, tables.jobs, Job, "job")
        self.runs = Runs(database, self.jobs)
        self.searches = Repository(database, tables.searches, StructureSearch, "search")
        self.saved_views = Repository(database, tables.saved_views, SavedView, "saved view")
        self.run_templates = Repository(
            database, tables.run_templates, RunTemplate, "template of runs"
        )
        self.notes = Repository(database, tables.notes, NoteRevision, "note")
        self.batches = Repository(database, tables.batches, Batch, "batch")
        self.audit_events = Repository(
            database, tables.audit_events, AuditEvent, "event of the audit log"
        )
        self.accounts = Repository(database, tables.accounts, Account, "account")
        self.memberships = Repository(database, tables.memberships, Membership, "membership")
        self.login_sessions = Repository(database, tables.login_sessions, LoginSession, "session")
        self.api_tokens = Repository(database, tables.api_tokens, ApiToken, "token")

    @classmethod
    def open(
        cls,
        url: str,
        site_key: Path | None = None,
        quotas: Quotas | None = None,
        recordings: str | None = None,
    ) -> Store:
        """Open the store at a database address; the file ``site_key`` signs what it issues.

        The chunks of long recordings are at the address ``recordings``.
        """
        chunks = None if recordings is None else Recordings(recordings)
        return cls(Database(url, site_key=site_key), quotas, chunks)

    def close(self) -> None:
        """Close all connections."""
        self.database.close()

    def transaction(self) -> AbstractContextManager[object]:
        """Commit all changes of the block, or none if it raises."""
        return self.database.transaction()

    def reading(self) -> AbstractContextManager[object]:
        """Read one consistent state of everything inside; nothing can be written in the block."""
        return self.database.reading()

    def maneuver_page(
        self,
        *,
        sort: str = "id",
        limit: int | None = 100,
        after: str | None = None,
        **filters: Unpack[ManeuverFilters],
    ) -> Page[ManeuverItem]:
        """Return one page of the filtered list of maneuvers (all with ``limit=None``)."""
        with self.database.reading() as connection:
            return select_maneuvers(connection, filters, sort, limit, after)

    def maneuver_facets(self, **filters: Unpack[ManeuverFilters]) -> Facets:
        """Count the list of maneuvers, and the items of each choice of a filter."""
        with self.database.reading() as connection:
            return count_maneuvers(connection, filters)

    def tags_of_maneuver(self, maneuver_id: int) -> list[str]:
        """Return the tags of one maneuver."""
        with self.database.reading() as connection:
            return read_tags(connection, tables.maneuver_tags, [maneuver_id])[maneuver_id]

    def run_page(
        self,
        *,
        sort: str = "-id",
        limit: int = 100,
        after: str | None = None,
        **filters: Unpack[RunFilters],
    ) -> Page[RunItem]:
        """Return one page of the filtered list of runs."""
        return select_runs(self.database, filters, sort, limit, after)

    def run_facets(self, **filters: Unpack[RunFilters]) -> Facets:
        """Count the list of runs, and the items of each choice of a filter."""
        with self.database.reading() as connection:
            return count_runs(connection, filters)


def _condition_columns(maneuver: Maneuver) -> dict[str, Any]:
    condition = maneuver.condition
    return {
        "airspeed_m_s": condition.airspeed_m_s,
        "dynamic_pressure_pa": condition.dynamic_pressure_pa,
        "fuel_fraction": condition.fuel_fraction,
    }
