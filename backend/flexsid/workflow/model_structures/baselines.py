"""Baselines: approved model structures by flight condition, and approved global models."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import inf

from flexsid.errors import BadInput
from flexsid.records.decision import (
    Decision,
    DecisionState,
    EventKind,
    LimitedQuantity,
    Limits,
    StructureReference,
    StructureVersion,
)
from flexsid.records.global_model import GlobalModelVersion
from flexsid.records.maneuver import Maneuver
from flexsid.storage.store import Store
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.model_structures.model_structures import get_version

_ALL = (-inf, inf)


def read_quantities(maneuver: Maneuver) -> dict[LimitedQuantity, float | None]:
    """Read the flight condition of a maneuver; None where it is unknown."""
    condition = maneuver.condition
    return {
        LimitedQuantity.DYNAMIC_PRESSURE: condition.dynamic_pressure_pa,
        LimitedQuantity.FUEL: condition.fuel_fraction,
        LimitedQuantity.AIRSPEED: condition.airspeed_m_s,
        LimitedQuantity.AIRSPEED_RATIO: maneuver.airspeed_ratio,
        LimitedQuantity.ALPHA: condition.alpha_rad,
    }


def is_in_range(maneuver: Maneuver, limits: Limits) -> bool:
    """Whether a maneuver is in a range; an unknown quantity is in no limits."""
    values = read_quantities(maneuver)
    for quantity, (low, high) in limits.items():
        value = values[quantity]
        if value is None or not low <= value <= high:
            return False
    return True


def is_overlapping(one: Limits, other: Limits) -> bool:
    """Whether two ranges share more than a boundary."""
    return all(
        max(one.get(q, _ALL)[0], other.get(q, _ALL)[0])
        < min(one.get(q, _ALL)[1], other.get(q, _ALL)[1])
        for q in {*one, *other}
    )


def is_covered(limits: Limits, by: Iterable[Limits]) -> bool:
    """Whether several ranges together cover a range."""
    others = list(by)
    for index, other in enumerate(others):
        if is_overlapping(limits, other):
            rest = others[index + 1 :]
            return all(is_covered(piece, rest) for piece in _subtract_range(limits, other))
    return False


def _subtract_range(limits: Limits, other: Limits) -> list[Limits]:
    """Return the parts of a range outside another that it overlaps; boundaries are inside."""
    pieces: list[Limits] = []
    left = dict(limits)
    for quantity, (low, high) in other.items():
        own_low, own_high = left.get(quantity, _ALL)
        if own_low < low:
            pieces.append({**left, quantity: (own_low, low)})
        if high < own_high:
            pieces.append({**left, quantity: (high, own_high)})
        left[quantity] = (max(low, own_low), min(high, own_high))
    return pieces


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
    return [
        _build_baseline(store, decision, decision.proposal.structure)
        for decision in list_approved(store, aircraft_id)
        if decision.proposal.structure is not None
    ]


def find_baseline(store: Store, maneuver: Maneuver, axis: str | None = None) -> Baseline | None:
    """Return the baseline of a maneuver: the last approved one whose range contains it.

    In its own axis by default.
    """
    own = find_body(maneuver.axis).axis if axis is None else axis
    for decision in list_approved(store, maneuver.aircraft_id):
        structure = decision.proposal.structure
        if structure is None or decision.axis != own:
            continue
        if is_in_range(maneuver, decision.proposal.limits):
            return _build_baseline(store, decision, structure)
    return None


def find_approved_global_model(
    store: Store, aircraft_id: int, axis: str
) -> GlobalModelVersion | None:
    """Return the approved version of the global model of an axis; None without one."""
    for decision in list_approved(store, aircraft_id):
        number = decision.proposal.global_model_id
        if number is not None and decision.axis == axis:
            return store.global_model_versions.get(number)
    return None


def require_baseline(store: Store, maneuver_ids: tuple[int, ...], axis: str) -> Baseline:
    """Return the baseline for a run of an axis without a model structure.

    Raises
    ------
    BadInput
        If there is none, or maneuvers fitted together have different baselines.
    """
    found = [find_baseline(store, store.maneuvers.get(number), axis) for number in maneuver_ids]
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


def _build_baseline(store: Store, decision: Decision, reference: StructureReference) -> Baseline:
    assert decision.id is not None
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
