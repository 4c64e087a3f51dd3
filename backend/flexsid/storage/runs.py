"""Runs: each has the id of its job, whose state it repeats for lists."""

from __future__ import annotations

from dataclasses import replace

import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError

from flexsid.records.job import Job
from flexsid.records.run import EstimationRun
from flexsid.storage.access import storing_in_campaign
from flexsid.storage.database import Database
from flexsid.storage.repository import Repository
from flexsid.storage.run_results import is_altered
from flexsid.storage.tables import maneuvers, runs

ESTIMATION = "estimation"
"""Kind of the jobs that are runs."""

STATE = (
    *("author", "state", "attempt", "priority", "limits", "progress", "error", "worker"),
    *("created_at", "started_at", "finished_at"),
)
"""Fields of a run that are those of its job."""


class Runs(Repository[EstimationRun]):
    """Stores runs, each with its job."""

    def __init__(self, database: Database, jobs: Repository[Job]) -> None:
        super().__init__(database, runs, EstimationRun, "run", derived={"altered": is_altered})
        self._jobs = jobs

    def add(self, record: EstimationRun) -> EstimationRun:
        """Store a new run and its job; return it with its id."""
        with self._database.transaction() as connection:
            of_maneuver = sa.select(maneuvers.c.aircraft_id).where(
                maneuvers.c.id == record.maneuver_id
            )
            with storing_in_campaign(connection.scalar(of_maneuver)):
                job = self._jobs.add(_build_job(record))
            stored = replace(record, id=job.id, created_at=job.created_at)
            try:
                connection.execute(sa.insert(self.table).values(self.encode(stored)))
            except IntegrityError as error:
                raise self._refused(error) from error
        return stored

    def replace(self, record: EstimationRun) -> EstimationRun:
        """Replace the run with the same id, and the state of its job."""
        with self._database.transaction():
            super().replace(record)
            self._jobs.replace(replace(_build_job(record), id=record.id))
        return record

    def delete(self, identity: int) -> None:
        """Delete a run and its job."""
        with self._database.transaction():
            super().delete(identity)
            self._jobs.delete(identity)


def _build_job(run: EstimationRun) -> Job:
    state = {name: getattr(run, name) for name in STATE}
    title = ""
    if run.derivation is not None:
        title = f"derived from run {run.derived_from_run_id}, to {run.derivation.purpose}"
    return Job(kind=ESTIMATION, title=title, after_job_id=run.after_run_id, **state)
