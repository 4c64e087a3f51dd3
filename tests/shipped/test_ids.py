"""An id has one form, in addresses, queries and forms: nothing else names a record."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import pytest
from shipped import Client, serving

FORMS = ("1.0", "+1", "1_0", "01", " 1", "00000000000000000000000001", "\u0661", "1e0")
"""Texts that a lenient parser takes for 1 or 10."""


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("server")
    with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
        yield server.connect()


def list_addresses(client: Client, number: str) -> Iterator[str]:
    """List every address that can be read, with a text in place of each id, one at a time."""
    for path, methods in client.get("/api/v1/openapi.json")["paths"].items():
        if "get" not in methods or "event-stream" in str(methods["get"]["responses"]):
            continue
        parameters = methods["get"].get("parameters", [])
        integers = [one for one in parameters if "integer" in str(one["schema"])]
        for odd in integers:
            address, query = path, []
            for one in parameters:
                value = quote(number if one is odd else "1")
                if one["in"] == "path":
                    address = address.replace(f"{{{one['name']}}}", value)
                elif one["in"] == "query" and (one is odd or one.get("required")):
                    query.append(f"{one['name']}={value}")
            yield address + ("?" + "&".join(query) if query else "")


@pytest.mark.parametrize("number", FORMS)
def test_no_address_takes_another_form_of_a_number(client: Client, number: str) -> None:
    addresses = list(list_addresses(client, number))
    assert len(addresses) > 100
    found = {one: client.request("get", one).status_code for one in addresses}
    assert {one: status for one, status in found.items() if status != 422} == {}


def test_no_list_of_ids_and_no_form_takes_another(client: Client, tmp_path: Path) -> None:
    matrices = tmp_path / "controller.json"
    matrices.write_text("{}")
    for number in FORMS:
        if number.strip() == number:  # blanks may stand between ids
            lists = client.request("get", "comparisons", params={"run_ids": number})
            assert lists.status_code == 422, number
            assert "is not an id" in lists.text
        form = {"aircraft_id": number, "name": "roll"}
        files = [("file", (matrices.name, matrices.read_bytes()))]
        sent = client.request("post", "controllers/files", data=form, files=files)
        assert (sent.status_code, sent.json()["code"]) == (422, "invalid-request"), number
        assert "valid integer" in sent.text
