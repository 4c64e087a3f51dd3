"""Requests of a team of analysts, for the tests of decisions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Act = Callable[..., Any]


def proposal(**changes: Any) -> dict[str, Any]:
    return {
        "title": "SP + SW1B at low speed",
        "structure": {"id": 1, "version": 1},
        "limits": {"dynamic_pressure_pa": [0.0, 5000.0]},
        "reasoning": "SW1T lies above the band",
        "run_ids": [1],
        "comparisons": [{"run_ids": [1], "prediction_ids": [1], "coefficient": "Cm"}],
        **changes,
    }


def propose(act: Act, name: str = "Ann", **changes: Any) -> dict[str, Any]:
    response = act(name, "post", "decisions", proposal(**changes))
    assert response.status_code == 201, response.text
    return response.json()


def vote(act: Act, name: str, decision: dict[str, Any], vote: str = "approve") -> Any:
    body = {
        "revision": decision["revision"],
        "vote": vote,
        "text": f"{vote} it is",
        "despite": "flown next",
    }
    return act(name, "post", f"decisions/{decision['id']}/votes", body)


def set_rules(act: Act, quorum: int, own_allowed: bool = False, version: int = 0) -> None:
    body = {"quorum": quorum, "own_allowed": own_allowed, "version": version, "reason": "agreed"}
    assert act("Cy", "put", "review-rules/1", body).status_code == 200
