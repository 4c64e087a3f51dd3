"""Finished values small enough to check a drawing by hand."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import orjson
import plotly.graph_objects as go
import pytest


def assert_drawable(spec: dict[str, Any]) -> None:
    """Return a check that plotly accepts a figure, that it is JSON, and that it has no NaN."""
    assert set(spec) == {"data", "layout"}
    go.Figure(spec)  # raises on an unknown field or a wrong value
    json.dumps(orjson.loads(orjson.dumps(spec)), allow_nan=False)
    _assert_finite(spec)
    for owned_by_the_page in ("template", "paper_bgcolor", "plot_bgcolor", "font", "height"):
        assert owned_by_the_page not in spec["layout"]


def _assert_finite(node: object) -> None:
    if isinstance(node, dict):
        for child in node.values():
            _assert_finite(child)
    elif isinstance(node, list):
        for child in node:
            _assert_finite(child)
    else:
        assert not isinstance(node, np.generic | np.ndarray), "plain data only"
        assert not isinstance(node, float) or np.isfinite(node)


@pytest.fixture(scope="session")
def drawable():
    return assert_drawable


@pytest.fixture(scope="session")
def numbers():
    """Read a column as a list, packed or not."""
    import base64

    def read(column: Any) -> list[float | None]:
        if isinstance(column, list):
            return column
        return np.frombuffer(base64.b64decode(column["bdata"]), f"<{column['dtype']}").tolist()

    return read
