"""Consistency check of proposals."""

from __future__ import annotations

from itertools import chain

from flexsid.errors import BadInput, Conflict
from flexsid.records.decision import LinkedComparison, StructureProposal
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.model_structures.run_results import refuse_altered


def check_proposal(store: Store, proposal: StructureProposal) -> tuple[int, str]:
    """Check a proposal; return its aircraft and axis.

    Raises
    ------
    UnknownRecord
        If a structure, run, prediction or figure does not exist.
    BadInput
        If they belong to different aircraft, a run has no result, or limits are reversed.
    """
    proposed = get_version(store, proposal.structure.id, proposal.structure.version)
    aircraft_id = store.model_structures.get(proposal.structure.id).aircraft_id
    if proposal.changes is not None:
        before = get_version(store, proposal.changes.id, proposal.changes.version)
        other = store.model_structures.get(proposal.changes.id).aircraft_id
        _check_aircraft(f"model structure {proposal.changes.id}", other, aircraft_id)
        if before.structure == proposed.structure:
            raise BadInput(
                "the proposed model structure is identical to the one it changes; modify it first",
                code="no-change",
            )
    for quantity, (low, high) in proposal.limits.items():
        if not low < high:
            raise BadInput(
                f"the limits of {quantity.value} are {low:g} and {high:g}; the first must lie "
                "below the second",
                code="bad-limits",
                quantity=quantity.value,
            )
    compared = chain.from_iterable(one.run_ids for one in proposal.comparisons)
    for run_id in dict.fromkeys((*proposal.run_ids, *compared)):
        _check_run(store, run_id, aircraft_id)
    for comparison in proposal.comparisons:
        _check_comparison(store, comparison, aircraft_id)
    for figure_id in proposal.figure_ids:
        store.frozen_figures.get(figure_id)
    return aircraft_id, proposed.structure.axis


def _check_run(store: Store, run_id: int, aircraft_id: int) -> None:
    run = store.runs.get(run_id)
    _check_aircraft(f"run {run_id}", store.maneuvers.get(run.maneuver_id).aircraft_id, aircraft_id)
    refuse_altered(run)
    if run.deleted_at is not None:
        raise Conflict(
            f"run {run_id} was deleted; restore it before using it as evidence", code="deleted"
        )
    if run.result is None:
        raise BadInput(
            f"run {run_id} is {run.state.value} and has no result; link runs that succeeded",
            code="run-without-result",
            run_id=run_id,
        )


def _check_comparison(store: Store, comparison: LinkedComparison, aircraft_id: int) -> None:
    if not comparison.run_ids:
        raise BadInput("a comparison needs at least one run", code="no-run")
    for prediction_id in comparison.prediction_ids:
        other = store.predictions.get(prediction_id).aircraft_id
        _check_aircraft(f"prediction {prediction_id}", other, aircraft_id)


def _check_aircraft(what: str, other: int, aircraft_id: int) -> None:
    if other != aircraft_id:
        raise BadInput(
            f"{what} belongs to another aircraft than the proposed model structure",
            code="wrong-aircraft",
        )
