"""Notes: on maneuvers, runs, modes and derivatives, with edit history, in the run's report."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient
from tests.api.team import Act

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


def add(act: Act, subject: str, key: str, text: str = "seen", **more: Any) -> Any:
    body = {"subject": subject, "key": key, "text": text, **more}
    return act("Ann", "post", "notes", body)


def test_notes_on_all_that_a_run_rests_on_are_in_its_report(act: Act, client: TestClient) -> None:
    run = client.get("/api/v1/runs/1").json()
    derivative, mode = run["parameters"][0]["name"], str(run["structure"]["modes"][0])
    for subject, key, more in (
        ("run", "1", {}),
        ("maneuver", str(run["maneuver_id"]), {}),
        ("mode", mode, {"aircraft_id": 1}),
        ("derivative", derivative, {"aircraft_id": 1}),
        ("derivative", "Cl_p", {"aircraft_id": 1}),
    ):
        stored = add(act, subject, key, f"**about** {subject} {key}", **more)
        assert stored.status_code == 201, stored.text
    listed = [note["key"] for note in client.get("/api/v1/notes?run_id=1").json()["items"]]
    assert listed == ["1", str(run["maneuver_id"]), mode, derivative]
    assert len(client.get("/api/v1/notes?aircraft_id=1").json()["items"]) == 5
    (own,) = client.get(f"/api/v1/notes?maneuver_id={run['maneuver_id']}").json()["items"]
    assert (own["author"], own["author_verified"]) == ("Ann", False)
    report = client.get("/api/v1/reports/run/1").text
    assert f"<strong>about</strong> mode {mode}" in report
    assert "Cl_p" not in report


def test_an_edit_adds_a_revision_and_a_deletion_retains_them(act: Act, client: TestClient) -> None:
    note = add(act, "run", "1", "first").json()
    address = f"notes/{note['id']}"
    edited = act("Ann", "put", address, {"revision": 1, "text": "second"}).json()
    assert (edited["text"], edited["revision"]) == ("second", 2)
    stale = act("Ann", "put", address, {"revision": 1, "text": "third"})
    assert (stale.status_code, stale.json()["code"]) == (409, "stale-edit")
    other = act("Bo", "put", address, {"revision": 2, "text": "mine"})
    assert (other.status_code, other.json()["code"]) == (409, "not-your-note")
    assert act("Bo", "delete", f"{address}?revision=2", None).status_code == 409
    assert act("Ann", "delete", f"{address}?revision=2", None).status_code == 204
    assert client.get("/api/v1/notes?run_id=1").json()["items"] == []
    stored = client.get(f"/api/v1/{address}").json()
    assert stored["is_deleted"]
    assert [one["text"] for one in stored["revisions"]] == ["first", "second", ""]
    again = act("Ann", "put", address, {"revision": 3, "text": "back"})
    assert again.json()["code"] == "deleted"


def test_markdown_brings_neither_markup_nor_images(act: Act) -> None:
    text = (
        "<script>alert(1)</script> [a](javascript:alert(1)) ![b](https://example.org/b.png)"
        " <b onclick=x>c</b>\n\n| d |\n| - |\n| *e* |"
    )
    html = add(act, "run", "1", text).json()["html"]
    for tag in ("<script", "<img", "<b ", "href"):
        assert tag not in html.replace('href="https://example.org/b.png"', "")
    assert "<td><em>e</em></td>" in html


def test_notes_on_nothing_are_refused(act: Act) -> None:
    cases: list[tuple[str, str, dict[str, Any], int, str]] = [
        ("run", "99", {}, 404, "unknown-record"),
        ("run", "one", {}, 422, "bad-key"),
        ("maneuver", "01", {}, 422, "bad-key"),
        ("mode", "7", {}, 422, "no-aircraft"),
        ("mode", "99", {"aircraft_id": 1}, 422, "unknown-mode"),
        ("derivative", "CX_y", {"aircraft_id": 1}, 422, "unknown-derivative"),
        ("flight", "1", {}, 422, "invalid-request"),
        ("run", "1", {"text": "  "}, 422, "invalid-request"),
    ]
    for subject, key, more, status, code in cases:
        refused = add(act, subject, key, **more)
        assert (refused.status_code, refused.json()["code"]) == (status, code), refused.text
