"""Figures in the size, font and title of a print."""

from __future__ import annotations

from typing import Any

from fastapi.testclient import TestClient

ENVELOPE = "/api/v1/figures/envelope"


def test_a_figure_has_the_size_font_and_title_of_its_address(client: TestClient) -> None:
    asked = {"width_mm": 25.4, "height_mm": 50.8, "font_pt": 9, "figure_title": "V < V_f"}
    layout: dict[str, Any] = client.get(ENVELOPE, params=asked).json()["layout"]
    assert (layout["width"], layout["height"]) == (96, 192)
    assert layout["font"]["size"] == 12
    assert layout["title"]["text"] == "V &lt; V_f"
    plain = client.get(ENVELOPE).json()["layout"]
    assert not {"width", "height", "font", "title"} & set(plain)


def test_a_size_out_of_range_is_refused(client: TestClient) -> None:
    response = client.get(ENVELOPE, params={"width_mm": 5})
    assert response.status_code == 422
    assert "width_mm" in response.text
