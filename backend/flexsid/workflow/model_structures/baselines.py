"""Baselines: approved model structures by flight condition."""

from __future__ import annotations

from dataclasses import dataclass

from flexsid.errors import BadInput
from flexsid.records.decision import Decision, DecisionState, EventKind, Limits
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import StructureVersion
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.condition_ranges import is_in_range
from flexsid.workflow.model_structures.model_structures import get_version


@dataclass(frozen=True, slots=True, kw_only=True)
class Baseline:
    """An approved model structure, its decision and its range of conditions."""

    decision_id: int
    title: str
    limits: Limits
    approved_by: tuple[str, ...]
    structure: StructureVersion


def list_baselines(store: Store, aircraft_id: int) -> list[Baseline]:
    """Return the baselines of a campaign, the last approved one first."""
    return [_build_baseline(store, decision) for decision in list_approved(store, aircraft_id)]


def find_baseline(store: Store, maneuver: Maneuver) -> Baseline | None:
    """Return the baseline of a maneuver: the last approved one whose range contains it."""
    for decision in list_approved(store, maneuver.aircraft_id):
        if decision.axis == maneuver.axis and is_in_range(maneuver, decision.proposal.limits):
            return _build_baseline(store, decision)
    return None


def require_baseline(store: Store, maneuver_ids: tuple[int, ...]) -> Baseline:
    """Return the baseline for a run without a model structure.

    Raises
    ------
    BadInput
        If there is none, or maneuvers fitted together have different baselines.
    """
    found = [find_baseline(store, store.maneuvers.get(number)) for number in maneuver_ids]
    first = found[0]
    if first is None:
        raise BadInput(
            f"no model structure is approved for the condition of maneuver {maneuver_ids[0]}; give "
            "the run a model structure, in full or as structure_id",
            code="no-structure",
        )
    for number, other in zip(maneuver_ids, found, strict=True):
        if other is None or other.structure.id != first.structure.id:
            raise BadInput(
                f"maneuver {number} has another baseline than maneuver {maneuver_ids[0]}; give "
                "the run a model structure",
                code="baselines-differ",
            )
    return first


def _build_baseline(store: Store, decision: Decision) -> Baseline:
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
    """Return the approved decisions, the last adopted one first.

    Where two ranges contain a condition, the later decision applies. The order is that of the
    event ids: clocks are set back, and those of two servers differ.
    """
    found = store.decisions.find(aircraft_id=aircraft_id, state=DecisionState.APPROVED)
    adoptions = {
        event.decision_id: event.id or 0
        for one in found
        for event in store.decision_events.find(decision_id=one.id, kind=EventKind.ADOPTED)
    }
    return sorted(found, key=lambda one: adoptions[one.id or 0], reverse=True)
