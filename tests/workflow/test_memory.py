"""A user relies on: answers found once while nothing changed, and anew when something did."""

from __future__ import annotations

import threading

import pytest

from flexsid.workflow.cache import remembered


def test_an_answer_is_found_once_for_the_same_contents():
    found: list[int] = []

    def find() -> int:
        found.append(1)
        return len(found)

    assert [remembered(("test", [1, 2.5]), find) for _ in range(3)] == [1, 1, 1]
    assert remembered(("test", [1, 2.6]), find) == 2


def test_many_who_ask_at_once_wait_for_one_answer():
    begun, go = threading.Event(), threading.Event()
    calls: list[int] = []

    def find() -> str:
        calls.append(1)
        begun.set()
        go.wait(10.0)
        return "answer"

    answers: list[str] = []
    askers = [
        threading.Thread(target=lambda: answers.append(remembered(("at once",), find)))
        for _ in range(4)
    ]
    for asker in askers:
        asker.start()
    assert begun.wait(10.0)
    go.set()
    for asker in askers:
        asker.join(10.0)
    assert answers == ["answer"] * 4
    assert len(calls) == 1


def test_what_failed_is_tried_again():
    def fail() -> int:
        raise ValueError("not yet")

    with pytest.raises(ValueError, match="not yet"):
        remembered(("fails",), fail)
    assert remembered(("fails",), lambda: 5) == 5
