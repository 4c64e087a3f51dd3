"""Request models of runs, batches and model structures."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from flexsid.api.models.requests import (
    Author,
    Id,
    Request,
    Text,
    Title,
    Version,
)
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Limits, Method, RunSettings
from flexsid.request_models import body_of
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_templates import apply_run_template


@body_of(Structure)
class StructureRequest(Request):
    """A model structure; see ``Structure``."""

    def to_record(self) -> Structure:
        """Return the structure to be stored."""
        return self.make_record(Structure)


@body_of(RunSettings)
class SettingsRequest(Request):
    """Settings of the estimation, apart from the model structure."""


@body_of(Limits)
class LimitsRequest(Request):
    """Time and memory limits of a run; it is stopped beyond them."""


Priority = Annotated[int, Field(strict=True, ge=-100, le=100)]


class RunOptions(Request):
    """Settings, modal tables, prediction and limits of runs; omitted ids are the latest.

    With ``run_template_id``, settings that are omitted are those of the template.
    """

    settings: SettingsRequest | None = None
    modal_table_id: Id | None = None
    damping_table_id: Id | None = None
    prediction_id: Id | None = None
    run_template_id: Id | None = None
    priority: Priority = 0
    limits: LimitsRequest | None = None

    def make_run(self, **more: Any) -> EstimationRun:
        """Return a run to be queued, with its resolved structure."""
        settings = (self.settings or SettingsRequest()).make_record(RunSettings)
        return self.make_record(EstimationRun, settings=settings, **more)

    def apply_template(self, store: Store, run: EstimationRun) -> EstimationRun:
        """Return a run with the settings of the template, if one is named."""
        if self.run_template_id is None:
            return run
        given = frozenset(() if self.settings is None else self.settings.model_fields_set)
        return apply_run_template(store, run, self.run_template_id, given)


class RunRequest(RunOptions):
    """Estimate a model of one maneuver by one method.

    Omitted ids default to the aircraft's latest tables and the prediction that covers most of the
    derivatives. The structure is given in full, or by ``structure_id`` (in
    ``structure_version``, the newest if omitted).
    """

    maneuver_id: Id
    method: Method
    structure: StructureRequest | None = None
    structure_id: Id | None = None
    structure_version: Version | None = None
    author: Author = ""


class RunTemplateRequest(Request):
    """A run whose method and settings are saved under a name."""

    run_id: Id
    name: Title
    note: Text = ""


class RunTemplateEditRequest(Request):
    """A run whose method and settings follow ``revision`` of a template."""

    run_id: Id
    revision: Version
    note: Text = ""


class BatchStructure(Request):
    """A model structure of a batch: in full, or by id, in its newest version if none is given."""

    structure: StructureRequest | None = None
    structure_id: Id | None = None
    structure_version: Version | None = None


class BatchRequest(RunOptions):
    """Estimate many maneuvers by each of the methods, with each of the structures.

    With ``from_equation_error``, OE and FRE runs wait for the EE run of the same maneuver and
    structure, and use its estimates as starting values.
    """

    name: Title
    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=20_000)]
    methods: Annotated[tuple[Method, ...], Field(min_length=1, max_length=3)]
    structures: Annotated[tuple[BatchStructure, ...], Field(max_length=100)] = ()
    from_equation_error: Annotated[bool, Field(strict=True)] = False

    def make_template(
        self, structure: Structure, structure_id: int | None, version: int | None, analyst: str
    ) -> EstimationRun:
        """Return the common part of the runs with one structure."""
        return self.make_run(
            maneuver_id=self.maneuver_ids[0],
            method=self.methods[0],
            structure=structure,
            structure_id=structure_id,
            structure_version=version,
            author=analyst,
        )


class ModelStructureRequest(Request):
    """A model structure to store under a name."""

    aircraft_id: Id
    name: Title
    structure: StructureRequest
    note: Text = ""


class StructureEditRequest(Request):
    """A new version of a model structure.

    ``version`` is the version that was edited; the header ``If-Match`` can give it instead.
    """

    name: Title
    structure: StructureRequest
    note: Text = ""
    version: Version | None = None
