"""Decision events are append-only, on any database."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace

import pytest
from sqlalchemy.exc import DBAPIError
from tests.api.team import Act, proposal, propose, set_rules, vote

from flexsid.errors import BadInput
from flexsid.storage.database import make_engine, parse_url
from flexsid.storage.store import Store
from flexsid.workflow.maintenance.printed_reports import check_signed_file


def test_later_baseline_of_whole_range_supersedes(act: Act) -> None:
    first = propose(act)
    vote(act, "Bo", first)
    halves = [
        propose(act, title=str(limits), limits={"dynamic_pressure_pa": limits})
        for limits in ([0.0, 2000.0], [2000.0, 9000.0])
    ]
    vote(act, "Bo", halves[0])
    assert act("Ann", "get", f"decisions/{first['id']}").json()["state"] == "approved"
    vote(act, "Bo", halves[1])
    gone = act("Ann", "get", f"decisions/{first['id']}").json()
    assert (gone["state"], gone["superseded_by"]) == ("superseded", halves[1]["id"])
    kinds = [event["kind"] for event in gone["events"]]
    assert kinds == ["proposed", "voted", "adopted", "narrowed", "superseded"]
    assert gone["structure"]["structure"]["modes"] == [7]
    baselines = act("Ann", "get", "baselines?aircraft_id=1").json()["items"]
    assert [one["decision_id"] for one in baselines] == [halves[1]["id"], halves[0]["id"]]


def test_audit_trail_contains_all_events(act: Act) -> None:
    set_rules(act, quorum=1)
    figure = act(
        "Ann", "post", "frozen-figures", {"kind": "fit", "query": "run_id=1", "title": "Fit *1*"}
    ).json()
    decision = propose(act, figure_ids=[figure["id"]])
    address = f"decisions/{decision['id']}"
    remark = {"text": "# <b>not significant</b>\n| anywhere", "derivative": "CZ_q"}
    act("Bo", "post", f"{address}/comments", remark)
    edit = {"name": "SP + SW1B", "structure": {"modes": [7], "absent": ["CZ_q"]}, "version": 1}
    act("Bo", "put", "model-structures/1", edit)
    vote(act, "Cy", decision, "request-changes")
    changed = proposal(
        structure={"id": 1, "version": 2},
        changes={"id": 1, "version": 1},
        reasoning="as Bo proposes",
    )
    act("Ann", "post", f"{address}/revisions", {"revision": 1, "proposal": changed})
    vote(act, "Cy", {"id": decision["id"], "revision": 2})

    file = act("Di", "get", f"{address}/audit")
    trail = file.json()
    assert trail == act("Di", "get", "decisions/audit?aircraft_id=1").json() | {
        name: trail[name] for name in ("exported_at", "signature")
    }
    (audited,) = trail["decisions"]
    if trail["signature"] is not None:  # a database server has no key of the site
        assert check_signed_file(file.content).n_events == len(audited["events"])
        with pytest.raises(BadInput):
            check_signed_file(file.content.replace(b"Ann", b"Bob", 1))
    assert audited["whole"] is True
    assert audited["changed_since"] == []
    events = audited["events"]
    history = [(one["kind"], one["vote"], one["author"], one["text"]) for one in events]
    assert history == [
        ("proposed", None, "Ann", "SW1T lies above the band"),
        ("commented", None, "Bo", "# <b>not significant</b>\n| anywhere"),
        ("voted", "request-changes", "Cy", "request-changes it is"),
        ("revised", None, "Ann", "as Bo proposes"),
        (
            *("voted", "approve", "Cy"),
            "approve it is\n\nDespite the open warnings\n"
            "- No attached run estimated the proposed model structure.\n"
            "- Run 1 estimated another model structure than the proposed one.\n\nflown next",
        ),
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
    for statement in ("CZ_q: free → absent", "Cy (unverified) asked for changes", "as Bo proposes"):
        assert statement in text
    assert "\\<b\\>not significant" in text
    assert "Fit \\*1\\*" in text
    assert "\n# \\<b" not in text


def test_database_refuses_to_change_events(act: Act, flown_url: str) -> None:
    decision = propose(act)
    engine = make_engine(parse_url(flown_url))
    for statement in (
        "UPDATE decision_events SET text = 'changed'",
        "DELETE FROM decision_events",
        "UPDATE structure_versions SET note = 'changed'",
        "DELETE FROM structure_versions",
    ):
        with pytest.raises(DBAPIError, match="append-only"), engine.begin() as connection:
            connection.exec_driver_sql(statement)
    # A change without the trigger is detected by the hash chain.
    with engine.begin() as connection:
        if engine.dialect.name == "postgresql":
            connection.exec_driver_sql("DROP FUNCTION flexsid_append_only() CASCADE")
        else:
            connection.exec_driver_sql("DROP TRIGGER decision_events_no_update")
        connection.exec_driver_sql("UPDATE decision_events SET text = 'changed'")
    engine.dispose()
    (audited,) = act("Di", "get", f"decisions/{decision['id']}/audit").json()["decisions"]
    assert audited["whole"] is False
    text = act("Di", "get", f"decisions/{decision['id']}/audit?format=markdown").text
    assert "modified after they were written" in text


def test_changed_evidence_is_reported(act: Act, flown_url: str) -> None:
    decision = propose(act)
    stored = Store.open(flown_url)
    run = stored.runs.get(1)
    stored.runs.replace(replace(run, versions={"flexsid": "0"}))
    stored.close()
    (audited,) = act("Di", "get", f"decisions/{decision['id']}/audit").json()["decisions"]
    assert audited["changed_since"] == ["run 1 (changed)"]
    assert audited["whole"] is True
