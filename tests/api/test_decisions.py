"""Review of model structures: proposals, votes, quorum and permissions."""

from __future__ import annotations

from typing import Any, cast

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from tests.api.team import Act, proposal, propose, set_rules, vote

API = "/api/v1"

# The storage of decisions is tested on both databases in test_decision_records.
pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


def test_author_does_not_vote_on_own_proposal(act: Act) -> None:
    decision = propose(act)
    for name in ("Ann", "ann", " ANN "):
        for choice in ("approve", "reject", "request-changes"):
            refused = vote(act, name, decision, choice)
            assert (refused.status_code, refused.json()["code"]) == (409, "own-proposal")
    assert vote(act, "Bo", decision).json()["state"] == "approved"


def test_an_approval_despite_open_warnings_states_why(act: Act) -> None:
    decision = propose(act)  # whose run has another model structure
    votes = f"decisions/{decision['id']}/votes"
    body = {"revision": 1, "vote": "approve", "text": "ok"}
    refused = act("Bo", "post", votes, body)
    assert (refused.status_code, refused.json()["code"]) == (409, "open-warnings")
    assert "No attached run estimated the proposed model structure." in refused.json()["detail"]
    assert act("Bo", "post", votes, {**body, "vote": "request-changes"}).status_code == 201
    approved = act("Bo", "post", votes, {**body, "despite": "estimated tomorrow"}).json()
    voted = next(one for one in reversed(approved["events"]) if one["kind"] == "voted")
    assert voted["text"].startswith("ok\n\nDespite the open warnings\n- No attached run")
    assert voted["text"].endswith("estimated tomorrow")


def test_author_of_revision_does_not_vote(act: Act) -> None:
    decision = propose(act)
    body = {"revision": 1, "proposal": proposal(title="narrower")}
    revised = act("Bo", "post", f"decisions/{decision['id']}/revisions", body).json()
    assert (revised["revision"], revised["authors"]) == (2, ["Ann", "Bo"])
    for name in ("Ann", "Bo"):
        assert vote(act, name, revised).json()["code"] == "own-proposal"
    assert vote(act, "Cy", revised).json()["state"] == "approved"


def test_rules_may_allow_own_votes(act: Act) -> None:
    set_rules(act, quorum=1, own_allowed=True)
    assert vote(act, "Ann", propose(act)).json()["state"] == "approved"


def test_quorum_decides(act: Act) -> None:
    set_rules(act, quorum=2)
    decision = propose(act)
    first = vote(act, "Bo", decision).json()
    assert (first["state"], first["votes"]) == ("open", {"Bo": "approve"})
    again = vote(act, "bo", decision).json()
    assert (again["state"], len(again["votes"])) == ("open", 1)
    assert vote(act, "Cy", decision).json()["state"] == "approved"

    other = propose(act, title="another")
    vote(act, "Bo", other, "reject")
    assert vote(act, "Cy", other).json()["state"] == "open"
    assert vote(act, "Di", other).json()["state"] == "open", "one stands against it"
    assert vote(act, "Cy", other, "reject").json()["state"] == "rejected"


def test_revision_resets_votes(act: Act) -> None:
    set_rules(act, quorum=2)
    decision = propose(act)
    vote(act, "Bo", decision)
    asked = vote(act, "Cy", decision, "request-changes").json()
    assert asked["state"] == "changes-requested"
    assert vote(act, "Di", decision).json()["state"] == "changes-requested"
    body = {"revision": 1, "proposal": proposal(reasoning="with the run of FTA 506")}
    revised = act("Ann", "post", f"decisions/{decision['id']}/revisions", body).json()
    assert (revised["state"], revised["revision"], revised["votes"]) == ("open", 2, {})
    late = vote(act, "Bo", decision)
    assert (late.status_code, late.json()["code"]) == (409, "stale-edit")
    assert late.json()["base"]["reasoning"] == "SW1T lies above the band"
    assert late.json()["current"]["reasoning"] == "with the run of FTA 506"


def test_second_of_two_revisions_is_stale(act: Act) -> None:
    decision = propose(act)
    address = f"decisions/{decision['id']}/revisions"
    act("Ann", "post", address, {"revision": 1, "proposal": proposal(title="hers")})
    late = act("Bo", "post", address, {"revision": 1, "proposal": proposal(title="his")})
    problem = late.json()
    assert (late.status_code, problem["code"], problem["revision"]) == (409, "stale-edit", 2)
    titles = [problem[which]["title"] for which in ("base", "current", "sent")]
    assert titles == ["SP + SW1B at low speed", "hers", "his"]
    never = act("Bo", "post", address, {"revision": 9, "proposal": proposal()})
    assert (never.status_code, never.json()["code"]) == (409, "unknown-version")


def test_closed_decision_accepts_comments_only(act: Act) -> None:
    decision = propose(act)
    vote(act, "Bo", decision)
    address = f"decisions/{decision['id']}"
    for closed in (
        vote(act, "Cy", decision, "reject"),
        act("Ann", "post", f"{address}/withdrawal", {"revision": 1, "text": "no"}),
        act("Ann", "post", f"{address}/revisions", {"revision": 1, "proposal": proposal()}),
    ):
        assert (closed.status_code, closed.json()["code"]) == (409, "decision-closed")
    choice = act("Cy", "post", f"{address}/comments", {"text": "good", "derivative": "Cm_q"})
    assert (choice.status_code, choice.json()["events"][-1]["derivative"]) == (201, "Cm_q")


def test_only_author_withdraws(act: Act) -> None:
    decision = propose(act)
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
def test_inconsistent_proposal_is_refused(
    act: Act, change: dict[str, Any], status: int, code: str
) -> None:
    refused = act("Ann", "post", "decisions", proposal(**change))
    assert (refused.status_code, refused.json()["code"]) == (status, code), refused.text
    assert act("Ann", "get", "decisions").json()["items"] == []


def test_unknown_decision_and_missing_analyst_are_refused(act: Act, client: TestClient) -> None:
    decision = propose(act)
    for path, body in (
        ("comments", {"text": "x"}),
        ("votes", {"revision": 1, "vote": "approve", "text": "x"}),
        ("revisions", {"revision": 1, "proposal": proposal()}),
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


def test_rules_have_versions_and_refuse_stale_edits(act: Act) -> None:
    assert act("Ann", "get", "review-rules/1").json()["current"]["quorum"] == 1
    set_rules(act, quorum=2)
    body = {"quorum": 1, "own_allowed": True, "version": 0, "reason": "faster"}
    late = act("Ann", "put", "review-rules/1", body)
    assert (late.status_code, late.json()["code"]) == (409, "stale-edit")
    assert late.json()["current"]["quorum"] == 2
    assert act("Ann", "put", "review-rules/1", body | {"quorum": 0}).status_code == 422
    history = act("Ann", "get", "review-rules/1").json()
    assert [(one["version"], one["author"]) for one in history["items"]] == [(1, "Cy")]


def test_new_runs_use_baseline_of_their_condition(act: Act) -> None:
    payload = {"maneuver_id": 1, "method": "EE"}
    assert act("Ann", "post", "runs", payload).json()["structure_id"] is None
    elsewhere = propose(act, title="slow", limits={"airspeed_m_s": [0.0, 1.0]})
    vote(act, "Bo", elsewhere)
    of_band = act("Ann", "get", "maneuvers/1/run-proposal").json()
    assert of_band["basis"]["source"] == "band"
    everywhere = propose(act, title="everywhere", limits={}, structure={"id": 2, "version": 1})
    vote(act, "Bo", everywhere)
    asked = act("Ann", "post", "runs", payload)
    assert asked.status_code == 202, asked.text
    assert (asked.json()["structure_id"], asked.json()["structure_version"]) == (2, 1)
    basis = asked.json()["proposal"]
    assert (basis["source"], basis["decision_id"]) == ("approved-baseline", everywhere["id"])
    batch = {"name": "all", "maneuver_ids": [1], "methods": ["OE"]}
    assert act("Ann", "post", "batches", batch).status_code == 202
    (queued,) = act("Ann", "get", "runs?structure_id=2&method=OE").json()["items"]
    assert queued["structure_version"] == 1
    here = propose(act, title="here", limits={"fuel_fraction": [0.0, 1.0]})
    vote(act, "Bo", here)
    found = act("Ann", "get", "maneuver-baselines?maneuver_ids=1").json()["items"][0]
    assert found["baseline"]["decision_id"] == here["id"]
    assert found["baseline"]["structure"]["structure_id"] == 1
    # It covers part of the range only; the earlier baseline remains valid elsewhere.
    before = act("Ann", "get", f"decisions/{everywhere['id']}").json()
    assert (before["state"], before["events"][-1]["kind"]) == ("approved", "narrowed")


def test_frozen_figure_is_stored(act: Act) -> None:
    payload = {"kind": "fit", "query": "run_id=1", "title": "Fit of run 1"}
    stored = act("Ann", "post", "frozen-figures", payload)
    assert stored.status_code == 201, stored.text
    shown = act("Ann", "get", "figures/fit?run_id=1").json()
    frozen = act("Ann", "get", f"figures/frozen?figure_id={stored.json()['id']}")
    assert frozen.json() == shown
    decision = propose(act, figure_ids=[stored.json()["id"]])
    assert decision["figures"][0]["title"] == "Fit of run 1"
    for change, status in (
        ({"query": "run_id=99"}, 404),
        ({"query": "run_id=x"}, 422),
        ({"kind": "nothing"}, 404),
        ({"kind": "../runs"}, 422),
        ({"query": "run_id=1&format=csv"}, 422),
    ):
        refused = act("Ann", "post", "frozen-figures", payload | change)
        assert refused.status_code == status, refused.text
        assert refused.headers["content-type"] == "application/problem+json"


def test_a_decision_freezes_the_sheet_that_it_was_made_on(act: Act) -> None:
    decision = propose(act)
    assert decision["sheets"] == []
    before = act("Bo", "get", "conditions/1/sheet").json()
    (sheet,) = vote(act, "Bo", decision).json()["sheets"]
    assert (sheet["kind"], sheet["query"]) == ("condition-sheet", "condition_id=1")
    frozen = f"conditions/1/sheet?figure_id={sheet['id']}"
    assert act("Bo", "get", frozen).json() == before
    act("Cy", "post", "runs", {"maneuver_id": 1, "method": "FRE"})
    assert act("Bo", "get", "conditions/1/sheet").json() != before
    assert act("Bo", "get", frozen).json() == before
    drawn = f"figures/condition-derivatives?condition_id=1&figure_id={sheet['id']}"
    assert act("Bo", "get", drawn).status_code == 200
    (audited,) = act("Bo", "get", f"decisions/{decision['id']}/audit").json()["decisions"]
    sealed = audited["events"][-1]["data"]
    assert sealed[f"sheet {sheet['id']}"] == sheet["array"]
    assert not any("sheet" in name for name in audited["changed_since"])
    figure = act(
        "Ann", "post", "frozen-figures", {"kind": "fit", "query": "run_id=1", "title": "f"}
    )
    other = act("Bo", "get", f"conditions/1/sheet?figure_id={figure.json()['id']}")
    assert (other.status_code, other.json()["code"]) == (422, "not-a-sheet")


@pytest.mark.parametrize("path", ["runs/1", "conditions/1"])
def test_a_notebook_reads_what_its_address_names(client: TestClient, path: str) -> None:
    found = client.get(f"{API}/{path}/notebook")
    assert found.headers["content-type"].startswith("application/x-ipynb+json")
    notebook = found.json()
    assert notebook["nbformat"] == 4
    code = ["".join(one["source"]) for one in notebook["cells"] if one["cell_type"] == "code"]
    for cell in code:
        compile(cell, path, "exec")
    assert "Workbench('http" in code[0]


def test_a_notebook_reads_from_the_address_of_the_server(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Behind a proxy the host that a request names may be another."""
    state = cast(FastAPI, client.app).state
    monkeypatch.setattr(
        state, "settings", state.settings.model_copy(update={"url": "https://x.example/"})
    )
    for path in ("runs/1", "conditions/1"):
        found = client.get(f"{API}/{path}/notebook")
        assert "Workbench('https://x.example'" in found.text


def test_derivatives_of_a_sheet_are_a_table(client: TestClient) -> None:
    sheet = client.get(f"{API}/conditions/1/sheet").json()
    head, *lines = client.get(f"{API}/conditions/1/derivatives").text.splitlines()
    assert head.startswith("name,unit,source,value,std_error")
    values = [one for row in sheet["rows"] for one in row["values"] if one is not None]
    assert len(lines) == len(values) > 0


def test_notifications_list_awaiting_reviews_and_changes(act: Act) -> None:
    def list_notifications(name: str) -> tuple[list[str], list[str]]:
        found = act(name, "get", "notifications").json()
        return [w["what"] for w in found["waiting"]], [c["what"] for c in found["changes"]]

    decision = propose(act)
    assert list_notifications("Ann") == ([], [])
    assert list_notifications("Bo") == (["review"], ["proposed"])
    act("Bo", "post", f"decisions/{decision['id']}/seen")
    assert list_notifications("bo") == (["review"], [])
    vote(act, "Bo", decision, "request-changes")
    assert list_notifications("Bo") == ([], [])
    assert list_notifications("Ann") == (["revise"], ["request-changes"])
    body = {"revision": 1, "proposal": proposal(title="better")}
    act("Ann", "post", f"decisions/{decision['id']}/revisions", body)
    assert list_notifications("Bo") == (["review"], ["revised"])
    act("Bo", "post", "notifications/seen")
    assert list_notifications("Bo") == (["review"], [])
    structure = act("Bo", "get", "model-structures/1").json()
    edit = {"name": "x", "structure": {"modes": [7], "absent": ["CZ_q"]}, "version": 1}
    act("Ann", "put", f"model-structures/{structure['id']}", edit)
    assert list_notifications("Bo")[1] == ["version 2"]
    act("Bo", "post", "model-structures/1/seen")
    assert list_notifications("Bo")[1] == []
