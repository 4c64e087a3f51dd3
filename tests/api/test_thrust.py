"""The thrust table of an aircraft is set, refused with the location of the error, and deleted."""

from __future__ import annotations

from fastapi.testclient import TestClient

TEXT = "rpm,273,293\n30000,10,9\n90000,200,180\n"


def test_thrust_table_is_set_and_deleted(client: TestClient):
    where = "/api/v1/aircraft/1/thrust"
    given = client.put(where, json={"engines": ["n1", "n2"], "text": TEXT, "source": "bench"})
    assert given.status_code == 200
    table = given.json()["thrust"]
    assert table["engines"] == ["n1", "n2"]
    assert table["thrust_n"] == [[10.0, 9.0], [200.0, 180.0]]
    assert client.get("/api/v1/aircraft/1").json()["thrust"] == table
    bad = client.put(where, json={"engines": ["n1"], "text": TEXT.replace("180", "much")})
    assert bad.status_code == 422
    assert bad.json()["code"] == "bad-thrust-table"
    assert "row 3, column 3" in bad.json()["detail"]
    assert client.get("/api/v1/aircraft/1").json()["thrust"] == table
    assert client.delete(where).json()["thrust"] is None
    assert (
        client.put("/api/v1/aircraft/99/thrust", json={"engines": ["a"], "text": TEXT}).status_code
        == 404
    )
