"""Models of requests and responses of runs, batches and model structures."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
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
from flexsid.api.models.responses import extend_record, response_of
from flexsid.nomenclature import describe
from flexsid.records.decision import Structure
from flexsid.records.run import (
    EstimationRun,
    Fit,
    Limits,
    Method,
    ModelAdequacy,
    ParameterEstimate,
    Pole,
    ProposalBasis,
    RetainedModes,
    RunSettings,
    RunTemplate,
)
from flexsid.request_models import body_of
from flexsid.storage.content import find_changes
from flexsid.storage.jobs.job_list import JobError
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_templates import (
    apply_run_template,
    get_run_template,
    list_changed_settings,
)

# --- Request models of runs, batches and model structures -----------------------------------------


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


# --- Response models of estimation runs: request, progress and result -----------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class RunParameter(ParameterEstimate):
    """A parameter estimate with its label.

    ``cramer_rao`` is the bound for the noise that the fit estimated (white, or with a spectrum),
    ``insensitivity`` the standard error if all other parameters were known. ``no_error`` is the
    reason for a missing standard error: the fit did not converge, the parameter ended at its
    limit, or it is not identifiable.
    """

    label: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RunBlock:
    """One set of data points that was fitted, with its outputs."""

    name: str
    outputs: tuple[str, ...]


@response_of(RunTemplate, without=("original_id",))
class RunTemplateItem:
    """A template of runs in one revision; ``id`` is that of all its revisions."""

    created_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class UsedTemplate:
    """Template of a run, in the revision it was requested with, and settings that differ."""

    id: int
    name: str
    revision: int
    changed_settings: tuple[str, ...]


@response_of(
    EstimationRun,
    without=("result", "rests_on", "result_hash", "run_template_id", "run_template_revision"),
)
class Run:
    """An estimation run; ``parameters``, ``fit`` and ``poles`` are present once it succeeded.

    ``prediction_id`` is the requested prediction, once it succeeded the one that was used.
    ``adequacy`` is the result of the tests for remaining model error, and ``symmetry``, of
    those for an asymmetry of the aircraft, where a maneuver excites both axes.
    ``altered`` means that the result or the request does not match the hash stored with it;
    ``changed_since`` names data that were corrected since the run was computed, null if an
    earlier release did not record its input data. ``repeated`` means that the same run had been
    requested before.
    """

    parameters: list[RunParameter]
    fit: Fit | None
    adequacy: ModelAdequacy | None
    symmetry: ModelAdequacy | None
    poles: tuple[Pole, ...]
    blocks: list[RunBlock]
    residualized_prediction: dict[str, float] | None
    retained: RetainedModes | None
    shape_spread: float | None
    error: JobError | None
    changed_since: tuple[str, ...] | None
    proposal: ProposalBasis | None = None
    created_at: datetime
    template: UsedTemplate | None
    repeated: bool


def build_run_response(store: Store, run: EstimationRun, *, repeated: bool = False) -> Run:
    """Make the response of a run."""
    (changed,) = find_changes(store.database, [run.rests_on])
    result = run.result
    return extend_record(
        Run,
        run,
        parameters=[]
        if result is None
        else [
            extend_record(RunParameter, parameter, label=describe(parameter.name).label)
            for parameter in result.parameters
        ],
        fit=result and result.fit,
        adequacy=result and result.adequacy,
        symmetry=result and result.symmetry,
        poles=() if result is None else result.poles,
        blocks=[] if result is None else [extend_record(RunBlock, one) for one in result.blocks],
        prediction_id=run.prediction_id or (result and result.prediction_id),
        residualized_prediction=result and result.residualized_prediction,
        retained=result and result.retained,
        shape_spread=result and result.shape_spread,
        error=run.error and JobError(**run.error),
        changed_since=None if run.rests_on is None else changed,
        template=_describe_template(store, run),
        repeated=repeated,
    )


def build_template_response(template: RunTemplate) -> RunTemplateItem:
    """Make the response of a revision of a template."""
    return extend_record(RunTemplateItem, template, id=template.original_id or template.id)


def _describe_template(store: Store, run: EstimationRun) -> UsedTemplate | None:
    if run.run_template_id is None:
        return None
    template = get_run_template(store, run.run_template_id, run.run_template_revision)
    return UsedTemplate(
        id=run.run_template_id,
        name=template.name,
        revision=template.revision,
        changed_settings=list_changed_settings(run, template),
    )
