"""Cache of results: computed once for the same contents, again after changes."""

from __future__ import annotations

import threading

import pytest

from flexsid.workflow.cache import load_or_compute


def test_result_is_computed_once_for_the_same_contents():
    found: list[int] = []

    def find() -> int:
        found.append(1)
        return len(found)

    assert [load_or_compute(("test", [1, 2.5]), find) for _ in range(3)] == [1, 1, 1]
    assert load_or_compute(("test", [1, 2.6]), find) == 2


def test_concurrent_requests_share_one_computation():
    begun, go = threading.Event(), threading.Event()
    calls: list[int] = []

    def find() -> str:
        calls.append(1)
        begun.set()
        go.wait(10.0)
        return "result"

    results: list[str] = []
    askers = [
        threading.Thread(target=lambda: results.append(load_or_compute(("at once",), find)))
        for _ in range(4)
    ]
    for asker in askers:
        asker.start()
    assert begun.wait(10.0)
    go.set()
    for asker in askers:
        asker.join(10.0)
    assert results == ["result"] * 4
    assert len(calls) == 1


def test_failed_computation_is_repeated():
    def fail() -> int:
        raise ValueError("not yet")

    with pytest.raises(ValueError, match="not yet"):
        load_or_compute(("fails",), fail)
    assert load_or_compute(("fails",), lambda: 5) == 5
