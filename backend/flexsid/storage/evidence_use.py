"""Decisions that use runs and maneuvers as evidence, which must not be deleted."""

from __future__ import annotations

from collections.abc import Sequence

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.errors import Conflict
from flexsid.records.decision import DecisionState
from flexsid.storage.tables import decisions, runs

_STANDING = (DecisionState.OPEN, DecisionState.CHANGES_REQUESTED, DecisionState.APPROVED)


def refuse_evidence(connection: Connection, noun: str, ids: Sequence[int]) -> None:
    """Reject the deletion of runs or maneuvers that are evidence of a decision in force.

    Raises
    ------
    Conflict
        If one of them is evidence; names the first, and the decision.
    """
    standing = [state.value for state in _STANDING]
    columns = (decisions.c.id, decisions.c.state, decisions.c.proposal)
    query = sa.select(*columns).where(decisions.c.state.in_(standing)).order_by(decisions.c.id)
    for number, state, proposal in connection.execute(query):
        evidence = set(proposal["run_ids"])
        for comparison in proposal["comparisons"]:
            evidence |= set(comparison["run_ids"])
        if noun == "maneuver":
            evidence = _maneuvers_of(connection, evidence)
        used = [one for one in ids if one in evidence]
        if not used:
            continue
        what = "is evidence of" if noun == "run" else "was estimated from for"
        raise Conflict(
            f"{noun} {used[0]} {what} decision {number}, '{proposal['title']}', which is {state};"
            " it cannot be deleted while the decision is in force. Revise or withdraw the"
            " proposal, or approve one that supersedes it",
            code="is-evidence",
            id=used[0],
            decision_id=number,
        )


def _maneuvers_of(connection: Connection, run_ids: set[int]) -> set[int]:
    query = sa.select(runs.c.maneuver_id, runs.c.settings).where(runs.c.id.in_(run_ids))
    return {
        number
        for first, settings in connection.execute(query)
        for number in (first, *settings.get("additional_maneuver_ids", ()))
    }
