"""Many runs requested at once, and settings of runs under a name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.run import Batch, EstimationRun, Method, RunSettings, RunTemplate, Start
from flexsid.storage.bulk import refuse_deleted
from flexsid.storage.jobs import batches
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import StaleEdit
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.run_identity import RunHasher, check_ranges
from flexsid.workflow.runs.run_proposal import apply_proposal, complete_request
from flexsid.workflow.runs.starts import refuse_double_count

# --- Batch: many runs requested at once, put into the queue ---------------------------------------

MAX_RUNS = 20_000


@dataclass(frozen=True, slots=True)
class BatchSubmission:
    """A queued batch and the number of its runs that are new; the others existed already."""

    batch: Batch
    new: int
    total: int


def queue_batch(
    store: Store,
    batch: Batch,
    maneuver_ids: Sequence[int],
    methods: Sequence[Method],
    templates: Sequence[EstimationRun],
    *,
    from_equation_error: bool,
    by_proposal: bool = False,
) -> BatchSubmission:
    """Queue every method for every maneuver and every template.

    Parameters
    ----------
    store
        Database of the runs.
    batch
        Name and author of the batch.
    maneuver_ids, methods
        Maneuvers to fit and methods to fit them by.
    templates
        Model structure and settings; maneuver and method are replaced.
    from_equation_error
        Let OE and FRE start from the EE run of the same maneuver and template, after it.
    by_proposal
        Use the model structure and band that ``propose_run`` proposes for each maneuver.

    Raises
    ------
    BadInput
        If the batch is empty or too large, or its first run of a kind cannot be estimated.
    UnknownRecord
        If a maneuver does not exist.
    """
    maneuvers = tuple(dict.fromkeys(maneuver_ids))
    total = len(maneuvers) * len(methods) * len(templates)
    if not 0 < total <= MAX_RUNS:
        raise BadInput(
            f"the batch has {total} runs; it may have 1 to {MAX_RUNS}", code="batch-size"
        )
    if from_equation_error and Method.EE not in methods:
        raise BadInput(
            "to start from equation error, the batch must also have the method EE",
            code="no-start",
        )
    also = {n for template in templates for n in template.settings.additional_maneuver_ids}
    refuse_deleted(store, (*maneuvers, *also))
    hasher = RunHasher(store, (*maneuvers, *also))
    for number in maneuvers:
        if not hasher.has_maneuver(number):
            raise UnknownRecord(f"there is no maneuver {number}")
    complete = apply_proposal if by_proposal else complete_request
    ordered = sorted(set(methods), key=lambda method: method is not Method.EE)
    for template in templates:  # an error common to all runs is raised here
        check_ranges(template)
        for method in ordered:
            run = replace(template, maneuver_id=maneuvers[0], method=method)
            estimation.prepare(store, complete(store, run))
    requested: list[tuple[EstimationRun, int | None]] = []
    for template in templates:
        for number in maneuvers:
            first: int | None = None
            start_hash: str | None = None
            of_maneuver = complete(store, replace(template, maneuver_id=number))
            refuse_double_count(store, of_maneuver)
            for method in ordered:
                run = replace(of_maneuver, method=method)
                if first is not None and from_equation_error:
                    settings: RunSettings = replace(run.settings, start=Start.RUN)
                    run = hasher.hash_run(replace(run, settings=settings), start_hash)
                    requested.append((run, first))
                    continue
                run = hasher.hash_run(run)
                requested.append((run, None))
                if method is Method.EE:
                    first, start_hash = len(requested) - 1, run.input_hash
    stored, new = batches.add(store, batch, requested)
    return BatchSubmission(stored, new, len(requested))


# --- Templates of runs: settings of a run saved under a name in the campaign ----------------------


def save_run_template(store: Store, run_id: int, name: str, note: str, author: str) -> RunTemplate:
    """Store method and settings of a run as a new template of its campaign.

    Parameters
    ----------
    store
        Database.
    run_id
        Run in any state.
    name
        Name, unique in the campaign regardless of case.
    note
        What it is for.
    author
        Name of the analyst.

    Raises
    ------
    Conflict
        If the campaign has a template of this name.
    UnknownRecord
        If the run does not exist.
    """
    with store.transaction():
        run = store.runs.get(run_id)
        aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
        for other in list_run_templates(store, aircraft_id):
            if other.name.casefold() == name.casefold():
                raise Conflict(
                    f"this campaign has the template '{other.name}'; take another name, or add a"
                    f" revision of template {other.original_id or other.id}",
                    code="name-in-use",
                )
        return store.run_templates.add(
            RunTemplate(
                aircraft_id=aircraft_id,
                name=name,
                method=run.method,
                settings=select_common_settings(run.settings),
                note=note,
                author=author,
            )
        )


def revise_run_template(
    store: Store, template_id: int, revision: int, run_id: int, note: str, author: str
) -> RunTemplate:
    """Store method and settings of a run as the next revision of a template.

    Raises
    ------
    BadInput
        If the run is of another campaign.
    Conflict
        If the template is deleted.
    StaleEdit
        If ``revision`` is not the newest.
    """
    with store.transaction():
        newest = _get_newest(store, template_id, revision)
        run = store.runs.get(run_id)
        aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
        if aircraft_id != newest.aircraft_id:
            raise BadInput(
                f"run {run_id} is of another aircraft than template {template_id}",
                code="wrong-aircraft",
            )
        return _add_revision(
            store,
            replace(
                newest,
                method=run.method,
                settings=select_common_settings(run.settings),
                note=note,
                author=author,
            ),
        )


def delete_run_template(store: Store, template_id: int, revision: int, author: str) -> None:
    """Mark a template as deleted; runs still name its revisions.

    Raises
    ------
    Conflict, StaleEdit
        As ``revise_run_template``.
    """
    with store.transaction():
        newest = _get_newest(store, template_id, revision)
        _add_revision(store, replace(newest, is_deleted=True, author=author))


def list_run_templates(store: Store, aircraft_id: int | None = None) -> list[RunTemplate]:
    """List the newest revisions of the templates of a campaign, or of all, by name."""
    known = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    newest: dict[int, RunTemplate] = {}
    for one in sorted(store.run_templates.find(**known), key=lambda one: one.revision):
        newest[one.original_id or one.id or 0] = one
    found = [one for one in newest.values() if not one.is_deleted]
    return sorted(found, key=lambda one: (one.name.casefold(), one.id))


def get_run_template(store: Store, template_id: int, revision: int | None = None) -> RunTemplate:
    """Return a revision of a template, also if it is deleted; the newest one by default.

    Raises
    ------
    UnknownRecord
        If there is no such template or revision.
    """
    revisions = list_revisions(store, template_id)
    for one in reversed(revisions):
        if revision in (None, one.revision):
            return one
    raise UnknownRecord(f"template {template_id} has no revision {revision}")


def list_revisions(store: Store, template_id: int) -> list[RunTemplate]:
    """List all revisions of a template, oldest first."""
    first = store.run_templates.get(template_id)
    if first.original_id is not None:
        raise UnknownRecord(f"there is no template {template_id}")
    later = store.run_templates.find(original_id=template_id)
    return [first, *sorted(later, key=lambda one: one.revision)]


def find_run_template(store: Store, name: str) -> RunTemplate:
    """Return the newest revision of a template by its name, or by its id.

    Raises
    ------
    BadInput
        If several campaigns have a template of this name.
    UnknownRecord
        If there is none.
    """
    if name.isascii() and name.isdigit():
        return get_run_template(store, int(name))
    every = list_run_templates(store)
    found = [one for one in every if one.name.casefold() == name.casefold()]
    if len(found) > 1:
        ids = ", ".join(str(one.original_id or one.id) for one in found)
        raise BadInput(f"several campaigns have a template '{name}'; give its id: {ids}")
    if not found:
        names = ", ".join(f"'{one.name}'" for one in every) or "none"
        raise UnknownRecord(f"there is no template '{name}'; there are {names}")
    return found[0]


def apply_run_template(
    store: Store, run: EstimationRun, template_id: int, given: frozenset[str] = frozenset()
) -> EstimationRun:
    """Return a run with the settings of the newest revision of a template, which it records.

    Parameters
    ----------
    store
        Database.
    run
        The run as requested.
    template_id
        Id of the template.
    given
        Names of settings that the request has; these stay.

    Raises
    ------
    BadInput
        If the template is of another method or aircraft.
    Conflict
        If it is deleted.
    """
    template = get_run_template(store, template_id)
    _require_present(template, template_id)
    if template.method is not run.method:
        raise BadInput(
            f"template {template_id}, '{template.name}', is of {template.method.value}, and the"
            f" run of {run.method.value}; request {template.method.value}, or no template",
            code="wrong-method",
        )
    if store.maneuvers.get(run.maneuver_id).aircraft_id != template.aircraft_id:
        raise BadInput(
            f"template {template_id} is of another aircraft than maneuver {run.maneuver_id}",
            code="wrong-aircraft",
        )
    own = {name: getattr(run.settings, name) for name in (*given, *_OF_MANEUVER)}
    return replace(
        run,
        settings=replace(template.settings, **own),
        run_template_id=template_id,
        run_template_revision=template.revision,
    )


def list_changed_settings(run: EstimationRun, template: RunTemplate) -> tuple[str, ...]:
    """List the settings of a run that differ from those of its template."""
    common = select_common_settings(run.settings)
    return tuple(
        one.name
        for one in fields(RunSettings)
        if getattr(common, one.name) != getattr(template.settings, one.name)
    )


_OF_MANEUVER = ("additional_maneuver_ids", "priors", "start_run_id")
"""Settings with values of one maneuver or condition, which templates do not have."""


def select_common_settings(settings: RunSettings) -> RunSettings:
    """Return settings without values of one maneuver or of its condition.

    The start from a run becomes the most likely candidate.
    """
    standard = RunSettings()
    start = Start.BEST if settings.start is Start.RUN else settings.start
    own = {name: getattr(standard, name) for name in _OF_MANEUVER}
    return replace(settings, start=start, **own)


def _get_newest(store: Store, template_id: int, revision: int) -> RunTemplate:
    newest = get_run_template(store, template_id)
    _require_present(newest, template_id)
    if newest.revision != revision:
        raise StaleEdit(
            f"you read revision {revision} of template {template_id}, which has revision"
            f" {newest.revision} by now; reload it",
            current=newest,
        )
    return newest


def _require_present(template: RunTemplate, template_id: int) -> None:
    if template.is_deleted:
        raise Conflict(f"template {template_id} was deleted; save a new one", code="deleted")


def _add_revision(store: Store, changed: RunTemplate) -> RunTemplate:
    return store.run_templates.add(
        replace(
            changed,
            id=None,
            created_at=None,
            original_id=changed.original_id or changed.id,
            revision=changed.revision + 1,
        )
    )
