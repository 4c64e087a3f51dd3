"""A team decides on the model structure: who may do what, and that nothing is edited away."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from typing import Any
from urllib.parse import quote

import pytest
from fastapi.testclient import TestClient

API = "/api/v1"
Act = Callable[..., Any]


@pytest.fixture
def act(client: TestClient) -> Act:
    """Do something under a name: ``act("Ann", "post", "decisions", {...})``."""

    def do(name: str, method: str, path: str, body: Any = None) -> Any:
        headers = {"X-Flexsid-Analyst": quote(name)}
        return client.request(method, f"{API}/{path}", json=body, headers=headers)

    return do


def _proposal(**changes: Any) -> dict[str, Any]:
    return {
        "title": "SP + SW1B at low speed",
        "structure": {"id": 1, "version": 1},
        "limits": {"dynamic_pressure_pa": [0.0, 5000.0]},
        "reasoning": "SW1T lies above the band",
        "run_ids": [1],
        "comparisons": [{"run_ids": [1], "prediction_ids": [1], "coefficient": "Cm"}],
        **changes,
    }


def _propose(act: Act, name: str = "Ann", **changes: Any) -> dict[str, Any]:
    answer = act(name, "post", "decisions", _proposal(**changes))
    assert answer.status_code == 201, answer.text
    return answer.json()


def _vote(act: Act, name: str, decision: dict[str, Any], vote: str = "approve") -> Any:
    body = {"revision": decision["revision"], "vote": vote, "text": f"{vote} it is"}
    return act(name, "post", f"decisions/{decision['id']}/votes", body)


def _rules(act: Act, quorum: int, own_allowed: bool = False, version: int = 0) -> None:
    body = {"quorum": quorum, "own_allowed": own_allowed, "version": version, "reason": "agreed"}
    assert act("Cy", "put", "review-rules/1", body).status_code == 200


def test_nobody_decides_on_their_own_proposal(act: Act) -> None:
    decision = _propose(act)
    for name in ("Ann", "ann", " ANN "):
        for vote in ("approve", "reject", "request-changes"):
            refused = _vote(act, name, decision, vote)
            assert (refused.status_code, refused.json()["code"]) == (409, "own-proposal")
    assert _vote(act, "Bo", decision).json()["state"] == "approved"


def test_who_revised_a_proposal_does_not_decide_on_it_either(act: Act) -> None:
    decision = _propose(act)
    body = {"revision": 1, "proposal": _proposal(title="narrower")}
    revised = act("Bo", "post", f"decisions/{decision['id']}/revisions", body).json()
    assert (revised["revision"], revised["authors"]) == (2, ["Ann", "Bo"])
    for name in ("Ann", "Bo"):
        assert _vote(act, name, revised).json()["code"] == "own-proposal"
    assert _vote(act, "Cy", revised).json()["state"] == "approved"


def test_a_campaign_may_let_one_judge_oneself(act: Act) -> None:
    _rules(act, quorum=1, own_allowed=True)
    assert _vote(act, "Ann", _propose(act)).json()["state"] == "approved"


def test_the_quorum_decides(act: Act) -> None:
    _rules(act, quorum=2)
    decision = _propose(act)
    first = _vote(act, "Bo", decision).json()
    assert (first["state"], first["votes"]) == ("open", {"Bo": "approve"})
    again = _vote(act, "bo", decision).json()
    assert (again["state"], len(again["votes"])) == ("open", 1)
    assert _vote(act, "Cy", decision).json()["state"] == "approved"

    other = _propose(act, title="another")
    _vote(act, "Bo", other, "reject")
    assert _vote(act, "Cy", other).json()["state"] == "open"
    assert _vote(act, "Di", other).json()["state"] == "open", "one stands against it"
    assert _vote(act, "Cy", other, "reject").json()["state"] == "rejected"


def test_asked_for_changes_are_made_and_votes_begin_anew(act: Act) -> None:
    _rules(act, quorum=2)
    decision = _propose(act)
    _vote(act, "Bo", decision)
    asked = _vote(act, "Cy", decision, "request-changes").json()
    assert asked["state"] == "changes-requested"
    assert _vote(act, "Di", decision).json()["state"] == "changes-requested"
    body = {"revision": 1, "proposal": _proposal(reasoning="with the run of FTA 506")}
    revised = act("Ann", "post", f"decisions/{decision['id']}/revisions", body).json()
    assert (revised["state"], revised["revision"], revised["votes"]) == ("open", 2, {})
    late = _vote(act, "Bo", decision)
    assert (late.status_code, late.json()["code"]) == (409, "stale-edit")
    assert late.json()["base"]["reasoning"] == "SW1T lies above the band"
    assert late.json()["current"]["reasoning"] == "with the run of FTA 506"


def test_of_two_revisions_the_later_is_told_of_the_first(act: Act) -> None:
    decision = _propose(act)
    address = f"decisions/{decision['id']}/revisions"
    act("Ann", "post", address, {"revision": 1, "proposal": _proposal(title="hers")})
    late = act("Bo", "post", address, {"revision": 1, "proposal": _proposal(title="his")})
    problem = late.json()
    assert (late.status_code, problem["code"], problem["revision"]) == (409, "stale-edit", 2)
    titles = [problem[which]["title"] for which in ("base", "current", "sent")]
    assert titles == ["SP + SW1B at low speed", "hers", "his"]
    never = act("Bo", "post", address, {"revision": 9, "proposal": _proposal()})
    assert (never.status_code, never.json()["code"]) == (409, "unknown-version")


def test_what_was_decided_stays_open_for_words_only(act: Act) -> None:
    decision = _propose(act)
    _vote(act, "Bo", decision)
    address = f"decisions/{decision['id']}"
    for closed in (
        _vote(act, "Cy", decision, "reject"),
        act("Ann", "post", f"{address}/withdrawal", {"revision": 1, "text": "no"}),
        act("Ann", "post", f"{address}/revisions", {"revision": 1, "proposal": _proposal()}),
    ):
        assert (closed.status_code, closed.json()["code"]) == (409, "decision-closed")
    said = act("Cy", "post", f"{address}/comments", {"text": "good", "derivative": "Cm_q"})
    assert (said.status_code, said.json()["events"][-1]["derivative"]) == (201, "Cm_q")


def test_only_who_proposed_withdraws(act: Act) -> None:
    decision = _propose(act)
    address = f"decisions/{decision['id']}/withdrawal"
    body = {"revision": 1, "text": "the record was cut wrongly"}
    refused = act("Bo", "post", address, body)
    assert (refused.status_code, refused.json()["code"]) == (409, "not-your-proposal")
    assert act("Ann", "post", address, body).json()["state"] == "withdrawn"


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"structure": {"id": 99, "version": 1}}, 404, "unknown-record"),
        ({"structure": {"id": 1, "version": 7}}, 404, "unknown-record"),
        ({"changes": {"id": 99, "version": 1}}, 404, "unknown-record"),
        ({"changes": {"id": 1, "version": 1}}, 422, "no-change"),
        ({"run_ids": [99]}, 404, "unknown-record"),
        ({"comparisons": [{"run_ids": [99]}]}, 404, "unknown-record"),
        ({"comparisons": [{"run_ids": [1], "prediction_ids": [99]}]}, 404, "unknown-record"),
        ({"comparisons": [{"run_ids": []}]}, 422, "invalid-request"),
        ({"figure_ids": [99]}, 404, "unknown-record"),
        ({"limits": {"dynamic_pressure_pa": [500.0, 100.0]}}, 422, "bad-limits"),
        ({"limits": {"fuel_fraction": [0.5, 0.5]}}, 422, "bad-limits"),
        ({"limits": {"temperature": [0.0, 1.0]}}, 422, "invalid-request"),
        ({"reasoning": "   "}, 422, "invalid-request"),
        ({"title": ""}, 422, "invalid-request"),
        ({"author": "Bo"}, 422, "invalid-request"),
    ],
)
def test_a_proposal_that_does_not_hold_together(
    act: Act, change: dict[str, Any], status: int, code: str
) -> None:
    refused = act("Ann", "post", "decisions", _proposal(**change))
    assert (refused.status_code, refused.json()["code"]) == (status, code), refused.text
    assert act("Ann", "get", "decisions").json()["items"] == []


def test_what_does_not_exist_and_who_has_no_name(act: Act, client: TestClient) -> None:
    decision = _propose(act)
    for path, body in (
        ("comments", {"text": "x"}),
        ("votes", {"revision": 1, "vote": "approve", "text": "x"}),
        ("revisions", {"revision": 1, "proposal": _proposal()}),
        ("withdrawal", {"revision": 1, "text": "x"}),
        ("seen", None),
    ):
        assert act("Bo", "post", f"decisions/99/{path}", body).status_code == 404
        unnamed = client.post(f"{API}/decisions/{decision['id']}/{path}", json=body)
        assert unnamed.status_code == 422, unnamed.text
        blank = act(" ", "post", f"decisions/{decision['id']}/{path}", body)
        assert blank.json()["code"] == "no-analyst"
    for path in ("decisions/99", "decisions/99/audit", "review-rules/99", "frozen-figures/99"):
        assert act("Bo", "get", path).status_code == 404
    about = {"text": "x", "derivative": "Cm_eta9"}
    refused = act("Bo", "post", f"decisions/{decision['id']}/comments", about)
    assert (refused.status_code, refused.json()["code"]) == (422, "unknown-derivative")
    assert len(client.get(f"{API}/decisions/{decision['id']}").json()["events"]) == 1


def test_rules_change_openly_and_not_over_each_other(act: Act) -> None:
    assert act("Ann", "get", "review-rules/1").json()["current"]["quorum"] == 1
    _rules(act, quorum=2)
    body = {"quorum": 1, "own_allowed": True, "version": 0, "reason": "faster"}
    late = act("Ann", "put", "review-rules/1", body)
    assert (late.status_code, late.json()["code"]) == (409, "stale-edit")
    assert late.json()["current"]["quorum"] == 2
    assert act("Ann", "put", "review-rules/1", body | {"quorum": 0}).status_code == 422
    history = act("Ann", "get", "review-rules/1").json()
    assert [(one["version"], one["author"]) for one in history["items"]] == [(1, "Cy")]


def test_new_runs_take_the_baseline_of_their_condition(act: Act) -> None:
    wanted = {"maneuver_id": 1, "method": "EE"}
    assert act("Ann", "post", "runs", wanted).json()["code"] == "no-structure"
    elsewhere = _propose(act, title="slow", limits={"airspeed_m_s": [0.0, 1.0]})
    _vote(act, "Bo", elsewhere)
    assert act("Ann", "post", "runs", wanted).json()["code"] == "no-structure"
    everywhere = _propose(act, title="everywhere", limits={}, structure={"id": 2, "version": 1})
    _vote(act, "Bo", everywhere)
    asked = act("Ann", "post", "runs", wanted)
    assert asked.status_code == 202, asked.text
    assert (asked.json()["structure_id"], asked.json()["structure_version"]) == (2, 1)
    here = _propose(act, title="here", limits={"fuel_fraction": [0.0, 1.0]})
    _vote(act, "Bo", here)
    found = act("Ann", "get", "maneuver-baselines?maneuver_ids=1").json()["items"][0]
    assert found["baseline"]["decision_id"] == here["id"]
    assert found["baseline"]["structure"]["structure_id"] == 1
    # It holds a part of the range only, so the one before it stays the baseline elsewhere.
    before = act("Ann", "get", f"decisions/{everywhere['id']}").json()
    assert (before["state"], before["events"][-1]["kind"]) == ("approved", "narrowed")


def test_a_later_baseline_of_the_whole_range_supersedes(act: Act) -> None:
    first = _propose(act)
    _vote(act, "Bo", first)
    halves = [
        _propose(act, title=str(limits), limits={"dynamic_pressure_pa": limits})
        for limits in ([0.0, 2000.0], [2000.0, 9000.0])
    ]
    _vote(act, "Bo", halves[0])
    assert act("Ann", "get", f"decisions/{first['id']}").json()["state"] == "approved"
    _vote(act, "Bo", halves[1])
    gone = act("Ann", "get", f"decisions/{first['id']}").json()
    assert (gone["state"], gone["superseded_by"]) == ("superseded", halves[1]["id"])
    kinds = [event["kind"] for event in gone["events"]]
    assert kinds == ["proposed", "voted", "adopted", "narrowed", "superseded"]
    assert gone["structure"]["structure"]["modes"] == [7]
    baselines = act("Ann", "get", "baselines?aircraft_id=1").json()["items"]
    assert [one["decision_id"] for one in baselines] == [halves[1]["id"], halves[0]["id"]]


def test_a_figure_stays_as_it_was(act: Act) -> None:
    wanted = {"kind": "fit", "query": "run_id=1", "title": "Fit of run 1"}
    kept = act("Ann", "post", "frozen-figures", wanted)
    assert kept.status_code == 201, kept.text
    shown = act("Ann", "get", "figures/fit?run_id=1").json()
    frozen = act("Ann", "get", f"figures/frozen?figure_id={kept.json()['id']}")
    assert frozen.json() == shown
    decision = _propose(act, figure_ids=[kept.json()["id"]])
    assert decision["figures"][0]["title"] == "Fit of run 1"
    for change, status in (
        ({"query": "run_id=99"}, 404),
        ({"query": "run_id=x"}, 422),
        ({"kind": "nothing"}, 404),
        ({"kind": "../runs"}, 422),
        ({"query": "run_id=1&format=csv"}, 422),
    ):
        refused = act("Ann", "post", "frozen-figures", wanted | change)
        assert refused.status_code == status, refused.text
        assert refused.headers["content-type"] == "application/problem+json"


def test_everybody_is_told_what_waits_and_what_is_new(act: Act) -> None:
    def told(name: str) -> tuple[list[str], list[str]]:
        found = act(name, "get", "notifications").json()
        return [w["what"] for w in found["waiting"]], [c["what"] for c in found["changes"]]

    decision = _propose(act)
    assert told("Ann") == ([], [])
    assert told("Bo") == (["review"], ["proposed"])
    act("Bo", "post", f"decisions/{decision['id']}/seen")
    assert told("bo") == (["review"], [])
    _vote(act, "Bo", decision, "request-changes")
    assert told("Bo") == ([], [])
    assert told("Ann") == (["revise"], ["request-changes"])
    body = {"revision": 1, "proposal": _proposal(title="better")}
    act("Ann", "post", f"decisions/{decision['id']}/revisions", body)
    assert told("Bo") == (["review"], ["revised"])
    act("Bo", "post", "notifications/seen")
    assert told("Bo") == (["review"], [])
    structure = act("Bo", "get", "model-structures/1").json()
    edit = {"name": "x", "structure": {"modes": [7], "absent": ["CZ_q"]}, "version": 1}
    act("Ann", "put", f"model-structures/{structure['id']}", edit)
    assert told("Bo")[1] == ["version 2"]
    act("Bo", "post", "model-structures/1/seen")
    assert told("Bo")[1] == []


def test_the_trail_tells_the_whole_story(act: Act, client: TestClient) -> None:
    _rules(act, quorum=1)
    figure = act(
        "Ann", "post", "frozen-figures", {"kind": "fit", "query": "run_id=1", "title": "Fit *1*"}
    ).json()
    decision = _propose(act, figure_ids=[figure["id"]])
    address = f"decisions/{decision['id']}"
    remark = {"text": "# <b>not significant</b>\n| anywhere", "derivative": "CZ_q"}
    act("Bo", "post", f"{address}/comments", remark)
    edit = {"name": "SP + SW1B", "structure": {"modes": [7], "absent": ["CZ_q"]}, "version": 1}
    act("Bo", "put", "model-structures/1", edit)
    _vote(act, "Cy", decision, "request-changes")
    changed = _proposal(
        structure={"id": 1, "version": 2}, changes={"id": 1, "version": 1}, reasoning="as Bo says"
    )
    act("Ann", "post", f"{address}/revisions", {"revision": 1, "proposal": changed})
    _vote(act, "Cy", {"id": decision["id"], "revision": 2})

    trail = act("Di", "get", f"{address}/audit").json()
    assert trail == act("Di", "get", "decisions/audit?aircraft_id=1").json() | {
        "exported_at": trail["exported_at"]
    }
    (audited,) = trail["decisions"]
    assert audited["whole"] is True
    assert audited["changed_since"] == []
    events = audited["events"]
    told = [(one["kind"], one["vote"], one["author"], one["text"]) for one in events]
    assert told == [
        ("proposed", None, "Ann", "SW1T lies above the band"),
        ("commented", None, "Bo", "# <b>not significant</b>\n| anywhere"),
        ("voted", "request-changes", "Cy", "request-changes it is"),
        ("revised", None, "Ann", "as Bo says"),
        ("voted", "approve", "Cy", "approve it is"),
        ("adopted", None, "Cy", "by Cy; quorum 1"),
    ]
    previous = ""
    for event in events:
        assert hashlib.sha256(event["sealed"].encode()).hexdigest() == event["hash"]
        sealed = json.loads(event["sealed"])
        assert sealed["previous_hash"] == previous
        assert {name: event[name] for name in sealed} == sealed
        assert event["author_verified"] is False
        assert event["software"]["source"]
        assert {"structure 1 version 1", "run 1", "maneuver 1", "prediction 1"} <= set(
            events[0]["data"]
        )
        previous = event["hash"]
    assert events[3]["data_hash"] != events[2]["data_hash"]
    assert audited["figures"][0]["spec"] == act("Di", "get", "figures/fit?run_id=1").json()

    text = act("Di", "get", f"{address}/audit?format=markdown").text
    for event in events:
        assert event["hash"] in text
        assert event["data_hash"] in text
    for said in ("CZ_q: free → absent", "Cy (unverified) asked for changes", "as Bo says"):
        assert said in text
    assert "\\<b\\>not significant" in text
    assert "Fit \\*1\\*" in text
    assert "\n# \\<b" not in text


def test_the_database_itself_refuses_to_rewrite_what_was_said(act: Act, flown_url: str) -> None:
    decision = _propose(act)
    file = flown_url.removeprefix("sqlite:///")
    with closing(sqlite3.connect(file)) as connection:
        for statement in (
            "UPDATE decision_events SET text = 'never said'",
            "DELETE FROM decision_events",
            "UPDATE structure_versions SET note = 'never written'",
            "DELETE FROM structure_versions",
        ):
            with pytest.raises(sqlite3.IntegrityError, match="append-only"):
                connection.execute(statement)
        # Whoever goes around that is found out.
        connection.execute("DROP TRIGGER decision_events_no_update")
        connection.execute("UPDATE decision_events SET text = 'never said'")
        connection.commit()
    (audited,) = act("Di", "get", f"decisions/{decision['id']}/audit").json()["decisions"]
    assert audited["whole"] is False
    text = act("Di", "get", f"decisions/{decision['id']}/audit?format=markdown").text
    assert "tampered" in text


def test_what_a_decision_rests_on_is_watched(act: Act, flown_url: str) -> None:
    decision = _propose(act)
    with closing(sqlite3.connect(flown_url.removeprefix("sqlite:///"))) as connection:
        connection.execute("UPDATE runs SET result = json_set(result, '$.fit.cost', 1.5)")
        connection.commit()
    (audited,) = act("Di", "get", f"decisions/{decision['id']}/audit").json()["decisions"]
    assert audited["changed_since"] == ["run 1 (changed)"]
    assert audited["whole"] is True
