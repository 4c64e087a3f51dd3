"""Response models of estimation runs: request, progress and result."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.api.models.response_models import extend_record, response_of
from flexsid.nomenclature import describe
from flexsid.records.run import (
    EstimationRun,
    Fit,
    ModelAdequacy,
    ParameterEstimate,
    Pole,
    ProposalBasis,
    RetainedModes,
)
from flexsid.records.run_template import RunTemplate
from flexsid.storage.content import find_changes
from flexsid.storage.job_list import JobError
from flexsid.storage.store import Store
from flexsid.workflow.runs.run_templates import get_run_template, list_changed_settings


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
