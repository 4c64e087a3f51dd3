"""Baselines: which approved structure holds at a condition."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.errors import BadInput
from flexsid.records.decision import Decision, DecisionState, EventKind, Limits
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import StructureVersion
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.condition_ranges import lies_in
from flexsid.workflow.model_structures.model_structures import get_version


@dataclass(frozen=True, slots=True, kw_only=True)
class Baseline:
    """An approved structure, the decision behind it, and where it holds."""

    decision_id: int
    title: str
    limits: Limits
    approved_by: tuple[str, ...]
    structure: StructureVersion


def list_baselines(store: Store, aircraft_id: int) -> list[Baseline]:
    """Return the baselines of a campaign, the one that was approved last first."""
    return [_baseline(store, decision) for decision in list_approved(store, aircraft_id)]


def baseline_of(store: Store, maneuver: Maneuver) -> Baseline | None:
    """Return the baseline of a maneuver: the one approved last whose range holds it."""
    for decision in list_approved(store, maneuver.aircraft_id):
        if decision.axis == maneuver.axis and lies_in(maneuver, decision.proposal.limits):
            return _baseline(store, decision)
    return None


def baseline_of_run(store: Store, maneuver_ids: tuple[int, ...]) -> Baseline:
    """Return the baseline that a run without a structure takes.

    Raises
    ------
    BadInput
        If there is none, or maneuvers fitted together have different ones.
    """
    found = [baseline_of(store, store.maneuvers.get(number)) for number in maneuver_ids]
    first = found[0]
    if first is None:
        raise BadInput(
            f"no structure was approved for the condition of maneuver {maneuver_ids[0]}; give the "
            "run a structure, in full or as structure_id",
            code="no-structure",
        )
    for number, other in zip(maneuver_ids, found, strict=True):
        if other is None or other.structure.id != first.structure.id:
            raise BadInput(
                f"maneuver {number} has another baseline than maneuver {maneuver_ids[0]}; give "
                "the run a structure",
                code="baselines-differ",
            )
    return first


def _baseline(store: Store, decision: Decision) -> Baseline:
    assert decision.id is not None
    reference = decision.proposal.structure
    return Baseline(
        decision_id=decision.id,
        title=decision.proposal.title,
        limits=decision.proposal.limits,
        approved_by=tuple(decision.votes),
        structure=get_version(store, reference.id, reference.version),
    )


def list_approved(store: Store, aircraft_id: int) -> list[Decision]:
    """Return the decisions that stand approved, the one adopted last first.

    Where two ranges hold a condition, the later one counts. Later is what stands later in the
    record of events: clocks are set back, and those of two servers differ.
    """
    found = store.decisions.find(aircraft_id=aircraft_id, state=DecisionState.APPROVED)
    adoptions = {
        event.decision_id: event.id or 0
        for one in found
        for event in store.decision_events.find(decision_id=one.id, kind=EventKind.ADOPTED)
    }
    return sorted(found, key=lambda one: adoptions[one.id or 0], reverse=True)
