"""Write-backs from the command line and by the Python client: proposed, written, listed, undone."""

from __future__ import annotations

import json
from typing import Any

from flexsid.cli.main import main
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store


def estimate(url: str) -> int:
    """Estimate maneuver 1 with retained modes."""
    structure = Structure(modes=(7, 9), fixed={})
    request = EstimationRun(
        maneuver_id=1, method=Method.EE, structure=structure, settings=RunSettings()
    )
    store = Store.open(url)
    run = execute_run(store, request, RUN, lambda progress: None)
    store.close()
    assert run.id is not None
    return run.id


def test_a_run_is_written_back_and_undone(flown_url: str, capsys: Any) -> None:
    def run(*arguments: str) -> Any:
        assert main(["write-back", *arguments, "--json", "--database", flown_url]) == 0
        return json.loads(capsys.readouterr().out)

    number = str(estimate(flown_url))
    proposal = run(number)
    (alpha,) = [one for one in proposal["parameters"] if one["name"] == "CZ_alpha"]
    assert alpha["after_std"] < 0.3 * abs(alpha["after"])
    assert run() == []
    written = run(number, "--reason", "both methods agree")
    assert written["prediction_id"] != written["former_prediction_id"]
    assert written["values"][written["names"].index("CZ_alpha")] == alpha["after"]
    assert [one["id"] for one in run()] == [written["id"]]
    undone = run("--undo", str(written["id"]))
    assert undone["undone_by"] == undone["author"] == written["author"] != ""
    assert main(["write-back", "--database", flown_url]) == 0
    printed = capsys.readouterr().out
    assert "both methods agree" in printed
    assert "undone by" in printed
    assert main(["write-back", number, "--database", flown_url]) == 0
    assert "give --reason to write it back" in capsys.readouterr().out
    assert main(["write-back", number, "--undo", "1", "--database", flown_url]) != 0
    assert "not both" in capsys.readouterr().err
