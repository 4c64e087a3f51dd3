"""A workbench served over HTTP."""

from __future__ import annotations

import pytest

from flexsid.client import Workbench


@pytest.fixture
def workbench(live_url: str) -> Workbench:
    return Workbench(live_url)
