"""The sheet on which the demonstration opens."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from flexsid.api.app import add_page
from flexsid.demo.campaign import RECORD
from flexsid.demo.campaign_process import AUTHOR, FirstSheet, find_record
from flexsid.records.run import Method
from flexsid.storage.store import Store


@pytest.fixture
def flown(flown_file: Path, tmp_path: Path) -> Iterator[Store]:
    shutil.copy(flown_file, tmp_path / "flown.db")
    opened = Store.open(f"sqlite:///{tmp_path}/flown.db")
    yield opened
    opened.close()


def test_runs_are_requested_once_as_soon_as_their_maneuver_is_stored(flown: Store):
    sheet = FirstSheet(flown)
    sheet.advance()
    assert find_record(flown) is None
    (maneuver,) = flown.maneuvers.find()
    flown.maneuvers.replace(replace(maneuver, label=RECORD))
    sheet.advance()
    sheet.advance()
    requested = [run for run in flown.runs.find() if run.author == AUTHOR]
    assert [run.method for run in requested] == [Method.OE, Method.FRE, Method.EE, Method.OE]
    assert {run.structure.modes for run in requested} == {(7, 9), (7,)}


def test_nothing_is_requested_again_of_a_demonstration_that_was_started_before(flown: Store):
    (maneuver,) = flown.maneuvers.find()
    flown.maneuvers.replace(replace(maneuver, label=RECORD))
    sheet = FirstSheet(flown)
    sheet.advance()
    sheet.finish()
    assert [run.author for run in flown.runs.find()] == [""]


def test_the_page_opens_on_another_view_where_there_is_one(tmp_path: Path):
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("the page")
    starts = [None, "/conditions/4"]
    app = FastAPI()
    add_page(app, tmp_path, lambda: starts.pop(0))
    with TestClient(app, follow_redirects=False) as client:
        assert client.get("/").text == "the page"
        opened = client.get("/")
        assert (opened.status_code, opened.headers["location"]) == (307, "/conditions/4")
        assert client.get("/conditions/4", headers={"Accept": "text/html"}).text == "the page"
