"""Results, output and errors of the command line."""

from __future__ import annotations

import csv
import json
import os
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa
from irig106_recorder import PACKETS, write
from ports import find_free_port
from scipy.io import loadmat, netcdf_file
from waiting import PATIENCE_S, wait_until

from flexsid.api.request_examples import AIRCRAFT_DEFINITION
from flexsid.cli.main import main
from flexsid.errors import BadInput
from flexsid.records.decision import ModelProposal, StructureReference, Vote
from flexsid.storage.copies import backup as copies
from flexsid.storage.store import Store
from flexsid.storage.tables import arrays, decisions
from flexsid.workflow.review import decision_review

ESTIMATE = ["run", "--maneuver", "1", "--method", "EE", "--modes", "7,9"]


@pytest.fixture(autouse=True)
def own_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Set the variables that the command sets, so that they are restored."""
    for name in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.setenv(name, "1")
    monkeypatch.delenv("FLEXSID_DATABASE", raising=False)
    monkeypatch.chdir(tmp_path)


def refused(capsys: pytest.CaptureFixture[str], code: int, *arguments: str) -> str:
    assert main(arguments) == code
    printed = capsys.readouterr()
    assert printed.err.startswith("flexsid: ")
    assert printed.err.count("\n") == 1
    return printed.err


def test_a_run_is_executed_and_printed(flown_url: str, capsys) -> None:
    assert main([*ESTIMATE, "--wait", "--database", flown_url]) == 0
    printed = capsys.readouterr().out
    assert "run 2: EE of maneuver 1, converged" in printed
    assert "Cm_alpha" in printed
    assert "R²" in printed


def test_a_run_is_printed_as_json_or_queued_for_a_server(flown_url: str, capsys) -> None:
    assert main([*ESTIMATE, "--wait", "--json", "--database", flown_url]) == 0
    run = json.loads(capsys.readouterr().out)
    assert (run["state"], run["method"]) == ("succeeded", "EE")
    assert main([*ESTIMATE, "--database", flown_url]) == 0
    assert "run 2: EE of maneuver 1, converged" in capsys.readouterr().out, "the same run"
    assert main([*ESTIMATE[:-1], "7", "--database", flown_url]) == 0
    assert "run 3 is queued" in capsys.readouterr().out


def test_a_refused_estimation_stores_no_run(flown_url: str, capsys) -> None:
    to = ("--wait", "--database", flown_url)
    run = ("run", "--method", "EE", "--maneuver")
    assert "mode 99" in refused(capsys, 2, *run, "1", "--modes", "7,99", *to)
    # The other maneuvers are estimated.
    assert main([*run, "99,1", "--modes", "7", *to]) == 1
    printed = capsys.readouterr()
    assert printed.err == "flexsid: maneuver 99: there is no maneuver 99\n"
    assert "run 2: EE of maneuver 1" in printed.out


def test_invalid_arguments_are_reported_as_text_or_json(capsys) -> None:
    assert "choose from" in refused(capsys, 2, "run", "--maneuver", "1", "--method", "XX")
    assert "--help" in refused(capsys, 2, "run", "--method", "OE")
    assert main(["nonsense", "--json"]) == 2
    assert json.loads(capsys.readouterr().err)["code"] == "bad-arguments"


@pytest.mark.parametrize("arguments", [("--help",), ESTIMATE])
def test_a_closed_output_pipe_is_no_failure(flown_url: str, arguments: Sequence[str]) -> None:
    assert _run_into(_open_closed_pipe(), *arguments, url=flown_url) == (141, "")


def test_a_closed_pipe_of_output_and_errors_is_no_failure(flown_url: str) -> None:
    run = ("run", "--method", "EE", "--maneuver", "99,1")
    assert _run_into(_open_closed_pipe(), *run, url=flown_url, shares_output=True)[0] == 141


def test_an_error_is_reported_though_the_output_is_closed(flown_url: str) -> None:
    run = ("run", "--method", "EE", "--maneuver", "99,1")
    code, err = _run_into(_open_closed_pipe(), *run, url=flown_url)
    assert (code, err) == (141, "flexsid: maneuver 99: there is no maneuver 99\n")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs a device that is full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_output_that_cannot_be_written_is_reported(flown_url: str, unbuffered: str) -> None:
    full = os.open("/dev/full", os.O_WRONLY)
    code, err = _run_into(full, *ESTIMATE, url=flown_url, unbuffered=unbuffered)
    assert code == 1
    assert err == "flexsid: the output cannot be written: No space left on device\n"


def _open_closed_pipe() -> int:
    """Return an end to write to; the other is closed before a command is started."""
    reading, writing = os.pipe()
    os.close(reading)
    return writing


def _run_into(
    output: int, *arguments: str, url: str, shares_output: bool = False, unbuffered: str = ""
) -> tuple[int, str]:
    """Run the command with an open file as its output; return its exit code and its errors."""
    command = "import sys; from flexsid.cli.main import main; sys.exit(main(sys.argv[1:]))"
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "PYTHONUNBUFFERED": unbuffered,
        "FLEXSID_DATABASE": url,
    }
    try:
        ended = subprocess.run(
            [sys.executable, "-c", command, *arguments],
            env=environment,
            stdout=output,
            stderr=output if shares_output else subprocess.PIPE,
            text=True,
            timeout=PATIENCE_S,
            check=False,
        )
    finally:
        os.close(output)
    return ended.returncode, ended.stderr or ""


def test_a_run_uses_a_saved_or_the_approved_structure(flown_url: str, capsys) -> None:
    run = ("run", "--maneuver", "1", "--method", "EE", "--json", "--database", flown_url)
    assert main([*run, "--structure", "2:1"]) == 0
    named = json.loads(capsys.readouterr().out)
    assert (named["structure_id"], named["structure_version"]) == (2, 1)
    assert main([*run, "--structure", "2", "--modes", "7"]) == 2
    assert main([*run, "--structure", "99"]) == 1
    assert main([*run, "--modes", ""]) == 0
    assert json.loads(capsys.readouterr().out)["structure"]["modes"] == []
    assert main(list(run)) == 0
    assert json.loads(capsys.readouterr().out)["structure"]["modes"] == [7, 9]  # of the band
    store = Store.open(flown_url)
    proposal = ModelProposal(
        title="all",
        structure=StructureReference(id=1, version=1),
        limits={},
        reasoning="enough",
    )
    decision = decision_review.propose(store, proposal, "Ann")
    decision_review.cast_vote(store, decision.id or 0, 1, Vote.APPROVE, "yes", "Bo")
    store.close()
    assert main(list(run)) == 0
    approved = json.loads(capsys.readouterr().out)
    assert (approved["structure_id"], approved["structure"]["modes"]) == (1, [7])


def test_a_run_is_exported(flown_url: str, capsys, tmp_path: Path) -> None:
    for name in ("run.json", "run.csv", "model.mat"):
        output = str(tmp_path / name)
        assert main(["export", "1", "--output", output, "--database", flown_url]) == 0
    whole = json.loads((tmp_path / "run.json").read_text())
    names = [parameter["name"] for parameter in whole["run"]["result"]["parameters"]]
    assert len(whole["covariance"]) == len(names)
    assert whole["lines"][0]["measured_real"]
    with (tmp_path / "run.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == names
    assert float(rows[0]["std_error"]) > 0
    model = loadmat(tmp_path / "model.mat", simplify_cells=True)
    assert model["A"].shape == (len(model["states"]),) * 2


def test_the_file_suffix_selects_the_format_of_a_design(capsys, tmp_path: Path) -> None:
    order = ["design", "--fta", "500", "--effort", "quick", "--output"]
    assert main([*order, str(tmp_path / "fta.csv")]) == 0
    assert "bfs        relative peak factor 1." in capsys.readouterr().out
    with (tmp_path / "fta.csv").open() as file:
        rows = (line for line in file if not line.startswith("#"))
        assert len(list(csv.DictReader(rows))) == 2400
    assert "expected one of .csv" in refused(capsys, 2, *order, "fta.xls")
    assert "no row 7" in refused(capsys, 2, "design", "--fta", "7", "--output", "a.csv")


def test_flutter_is_predicted_from_runs(flown_url: str, capsys) -> None:
    asked = ["flutter", "1", "--next", "45", "--database", flown_url]
    assert main(asked) == 0
    assert capsys.readouterr().out.startswith("Next point at 45.0 m/s")
    assert main([*asked, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["next_m_s"] == 45.0
    assert "RUNS is 'x'" in refused(capsys, 2, "flutter", "x", "--database", flown_url)


def test_runs_are_validated(flown_url: str, capsys) -> None:
    to = ["--database", flown_url]
    assert main(["validate", "1", "--maneuvers", "1", *to]) == 0
    assert "EE 1, flown" in capsys.readouterr().out
    assert main(["validate", "1", "--hold-out", "frequencies", "--json", *to]) == 0
    assert json.loads(capsys.readouterr().out)["r_squared"] > 0.9
    refusal = refused(capsys, 1, "validate", "1", "--hold-out", "periods", *to)
    assert "expected at least 3" in refusal
    assert "expected 2 to 20" in refused(
        capsys, 2, "validate", "1", "--hold-out", "folds", "--folds", "1", *to
    )


def test_a_transfer_function_is_fitted(flown_url: str, capsys) -> None:
    orders = ["--zeros", "5", "--poles", "6"]
    command = ["transfer-function", "--maneuver", "1", "--input", "wf4s", "--output", "q", *orders]
    assert main([*command, "--database", flown_url]) == 0
    printed = capsys.readouterr().out
    assert "delay [s]" in printed
    assert printed.count("±") > 6
    store = Store.open(flown_url)
    assert store.jobs.find(kind="transfer-function")[0].title == "q over wf4s, flown"
    store.close()


def test_modes_of_outputs_are_printed(flown_url: str, capsys) -> None:
    command = ["output-only", "--maneuver", "1", "--band", "3,12", "--database", flown_url]
    assert main(command) == 0
    assert "damping" in capsys.readouterr().out
    assert "fewer than" in refused(capsys, 1, *command, "--start", "0", "--stop", "1")
    assert "no channel 'none'" in refused(capsys, 2, *command, "--outputs", "none")


def test_files_are_imported(database_url: str, capsys, tmp_path: Path) -> None:
    mapping = tmp_path / "m.toml"
    mapping.write_text(
        """
        [aircraft]
        builtin = "FLEX-28"
        [flight]
        number = 7
        [maneuver]
        label = "multisine"
        [maneuver.condition]
        airspeed = { value = 20.0, unit = "m/s" }
        density = { value = 1.2, unit = "kg/m3" }
        fuel_fraction = { value = 0.5 }
        [time]
        column = "t_s"
        [[channels]]
        column = "bfs"
        unit = "deg"
        role = "input"
        [[channels]]
        column = "q"
        unit = "deg/s"
        role = "output"
        """
    )
    recording = tmp_path / "m.csv"
    recording.write_text(
        "t_s,bfs,q\n" + "".join(f"{k / 50:.2f},{k % 3},{k % 5}\n" for k in range(20))
    )
    command = ["import", str(recording), "--mapping", str(mapping), "--database", database_url]
    assert main(command) == 0
    assert "maneuver 1: multisine, flight 7 of FLEX-28" in capsys.readouterr().out

    mapping.write_text(mapping.read_text().replace('label = "multisine"', ""))
    (tmp_path / "n.csv").write_text(recording.read_text() + "late\n")
    (tmp_path / "o.csv").write_text(recording.read_text() + "0.40,1,1\n")
    files = [str(tmp_path / name) for name in ("m.csv", "n.csv", "o.csv")]
    options = ["--mapping", str(mapping), "--database", database_url]
    assert main(["import", *files, "--each", *options]) == 1
    printed = capsys.readouterr()
    assert "m.csv: maneuver 2, m" in printed.out
    assert "o.csv: maneuver 3, o" in printed.out
    assert "n.csv: row 22 has 1 cells" in printed.err
    assert "1 of 3 files were refused" in printed.err
    assert "imported" in refused(capsys, 1, *command)
    recording.write_text("t_s,bfs,q\n0.00,x,1\n")
    assert "m.csv" in refused(capsys, 2, *command)


def test_what_an_import_does_not_read_is_printed(database_url: str, capsys, tmp_path: Path) -> None:
    mapping = tmp_path / "m.toml"
    mapping.write_text(
        """
        [aircraft]
        builtin = "FLEX-28"
        [flight]
        number = 7
        [time]
        uneven = "interpolate"
        [[channels]]
        column = "Q"
        name = "q"
        unit = "deg/s"
        role = "output"
        """
    )
    recording = write(tmp_path / "a.ch10", PACKETS["packed"])
    command = ["import", str(recording), "--mapping", str(mapping), "--database", database_url]
    assert main(command) == 0
    assert "not read: SUB: a subframe" in capsys.readouterr().out
    text = mapping.read_text()
    mapping.write_text(text.replace("number = 7", "number = 8"))
    assert main([*command, "--each"]) == 0
    assert "not read: SUB: a subframe" in capsys.readouterr().out
    mapping.write_text(text.replace("number = 7", "number = 9"))
    assert main([*command, "--each", "--json"]) == 0
    assert "SUB: a subframe" in json.loads(capsys.readouterr().out)["not_read"]


def test_samples_are_exported_for_other_programs(flown_url: str, capsys, tmp_path: Path) -> None:
    command = ["samples", "1", "--database", flown_url, "--output"]
    for name in ("all.nc", "all.mat", "all.json"):
        assert main([*command, str(tmp_path / name)]) == 0
    channels = {one["name"]: one for one in json.loads((tmp_path / "all.json").read_text())}
    q = np.array(channels["q"]["values"])
    simulink = loadmat(tmp_path / "all.mat", simplify_cells=True)["q"]
    assert (simulink["unit"], simulink["signals"]["dimensions"]) == ("rad/s", 1)
    np.testing.assert_array_equal(simulink["signals"]["values"], q)
    variables: dict[str, Any] = netcdf_file(tmp_path / "all.nc", mmap=False).variables
    assert (variables["q"].units, variables["q"].dimensions) == (b"rad/s", ("time_s",))
    np.testing.assert_array_equal(variables["q"][:], q)
    np.testing.assert_array_equal(variables["time_s"][:], channels["q"]["time_s"])
    some = tmp_path / "some.csv"
    assert main([*command, str(some), "--channels", "q,wf4s"]) == 0
    head, first, *_ = some.read_text().splitlines()
    assert head == "time_s,q [rad/s],wf4s [rad]"
    assert float(first.split(",")[1]) == q[0]
    capsys.readouterr()
    assert ".nc" in refused(capsys, 2, *command, "a.xls")
    assert "no channel 'flux'" in refused(capsys, 2, *command, str(some), "--channels", "flux")


def test_errors_are_reported_on_one_line(flown_url: str, capsys) -> None:
    to = ["--database", flown_url]
    maneuver = ["run", "--method", "EE", "--maneuver"]
    assert "no maneuver 99" in refused(capsys, 1, *maneuver, "99", *to)
    assert "mode 99" in refused(capsys, 2, *maneuver, "1", "--modes", "99", *to)
    assert "--modes" in refused(capsys, 2, *maneuver, "1", "--modes", "seven", *to)
    assert "--band" in refused(capsys, 2, *maneuver, "1", "--band", "1", *to)
    assert "no run 99" in refused(capsys, 1, "export", "99", "--output", "a.json", *to)
    assert ".csv" in refused(capsys, 2, "export", "1", "--output", "a.xls", *to)
    assert "written" in refused(capsys, 1, "export", "1", "--output", "no/folder/a.json", *to)
    quick = ("design", "--fta", "500", "--effort", "quick")
    assert "written" in refused(capsys, 1, *quick, "--output", "no/folder/a.csv")
    assert "0.1 to 1000" in refused(capsys, 2, "flutter", "1", "--next", "-4", *to)
    assert "nowhere.csv" in refused(capsys, 2, "import", "nowhere.csv", *to)
    assert "address" in refused(capsys, 2, "migrate", "--database", "nonsense")


def test_the_environment_names_database_and_port(monkeypatch, capsys, tmp_path: Path) -> None:
    assert main(["migrate"]) == 0
    assert (tmp_path / "var" / "flexsid.db").is_file()
    monkeypatch.setenv("FLEXSID_DATABASE", f"sqlite:///{tmp_path}/other.db")
    assert main(["migrate"]) == 0
    assert (tmp_path / "other.db").is_file()
    assert "the database is at schema 0" in capsys.readouterr().out
    monkeypatch.setenv("FLEXSID_PORT", "eighty")
    assert "FLEXSID_PORT" in refused(capsys, 2, "migrate")


def test_a_failed_run_reports_the_reason(flown_url: str, capsys, monkeypatch) -> None:
    monkeypatch.setattr("flexsid.workflow.runs.estimation.store_result", lambda *_: 1 / 0)  # pyrefly: ignore[division-by-zero]
    error = refused(capsys, 1, *ESTIMATE, "--wait", "--database", flown_url)
    assert "run 2 failed" in error


def test_the_server_executes_runs_and_stops_at_once(flown_url: str) -> None:
    port = find_free_port()
    server = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import sys; from flexsid.cli.main import main; sys.exit(main(sys.argv[1:]))",
            *("serve", "--database", flown_url),
        ],
        env={**os.environ, "FLEXSID_PORT": str(port)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert server.stdout is not None
    assert f"http://127.0.0.1:{port}" in server.stdout.readline()
    # A run queued by another process is executed too.
    assert main([*ESTIMATE[:-1], "7", "--database", flown_url]) == 0
    store = Store.open(flown_url)
    wait_until(lambda: store.runs.get(2).state.value == "succeeded", "the run")
    store.close()
    health = f"http://127.0.0.1:{port}/api/v1/health"
    with urllib.request.urlopen(health) as response:
        assert json.load(response)["status"] == "ok"
    server.send_signal(signal.SIGTERM)
    assert server.wait(timeout=PATIENCE_S) in (0, -signal.SIGTERM)
    server.stdout.close()


def test_a_port_in_use_is_reported(flown_url: str, capsys, monkeypatch, tmp_path: Path) -> None:
    with closing(socket.socket()) as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        monkeypatch.setenv("FLEXSID_PORT", str(taken.getsockname()[1]))
        assert "FLEXSID_PORT" in refused(capsys, 1, "serve", "--database", flown_url)
        refused(capsys, 1, "demo", "--database", f"sqlite:///{tmp_path}/new.db")
    assert not (tmp_path / "new.db").exists(), "simulated although the port is in use"


def test_search_prints_terms_with_statistics_and_candidates(
    flown_url: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("FLEXSID_DATABASE", flown_url)
    assert main(["search", "1", "--modes", "7,9", "--resamplings", "2"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("search 1: EE over flown supports 44 of 44 terms")
    assert "CQ7_etadot7" in printed
    assert "candidates, by prediction" in printed
    assert (
        main(["search", "1", "--modes", "7", "--method", "OE", "--resamplings", "0", "--json"]) == 0
    )
    found = json.loads(capsys.readouterr().out)
    assert found["state"] == "succeeded"
    assert found["result"]["groups"][0]["name"] == "OE"
    assert "f_out" in refused(capsys, 2, "search", "1", "--f-in", "4", "--f-out", "5")


def test_several_maneuvers_are_estimated_in_order(flown_url: str, capsys) -> None:
    order = ["run", "--maneuver", "1,1", "--method", "EE", "--modes", "7", "--wait"]
    assert main([*order, "--database", flown_url]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(":")[0] for line in lines] == ["run 2", "run 3"]
    assert main([*order, "--json", "--database", flown_url]) == 0
    runs = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [run["state"] for run in runs] == ["succeeded", "succeeded"]
    assert "--maneuver" in refused(
        capsys, 2, "run", "--maneuver", "", "--method", "EE", "--database", flown_url
    )


def test_every_command_prints_json(flown_url: str, capsys, tmp_path: Path) -> None:
    to = ["--json", "--database", flown_url]
    commands = {
        "export": ["export", "1", "--output", str(tmp_path / "run.csv")],
        "report": ["report", "run", "1", "--output", str(tmp_path / "run.html")],
        "design": ["design", "--fta", "500", "--effort", "quick"],
        "migrate": ["migrate"],
        "dashboard": ["dashboard", "1"],
    }
    commands["design"] += ["--output", str(tmp_path / "design.csv")]
    for name, order in commands.items():
        assert main([*order, *to]) == 0, name
        assert isinstance(json.loads(capsys.readouterr().out), dict), name
    assert main(["export", "99", "--output", "a.json", *to]) == 1
    problem = json.loads(capsys.readouterr().err.splitlines()[-1])
    assert problem["code"] == "unknown-record"
    assert "no run 99" in problem["detail"]


def test_accounts_are_changed_with_an_event_of_the_audit_log(tmp_path: Path, capsys) -> None:
    """Also without FLEXSID_MODE; from the first account on, every command is in the log."""
    database = f"sqlite:///{tmp_path / 'team.db'}"
    kite = tmp_path / "kite.toml"
    kite.write_text(AIRCRAFT_DEFINITION, encoding="utf-8")
    for command in (["users", "add", "Ann"], ["users", "reset", "Ann"], ["aircraft", str(kite)]):
        assert main([*command, "--database", database]) == 0
    log = tmp_path / "log.jsonl"
    assert main(["audit", "--output", str(log), "--database", database]) == 0
    events = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    assert [event["changes"][0]["table"] for event in events] == [
        "accounts",
        "accounts",
        "aircraft",
    ]
    assert all(event["author"].endswith("(command line)") for event in events)


def test_a_certificate_of_a_cluster_is_private_and_is_not_replaced(tmp_path: Path, capsys) -> None:
    file = tmp_path / "cluster.yaml"
    assert main(["cluster-certificate", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["valid_until"] > "2027"
    assert file.stat().st_mode & 0o777 == 0o600
    written = file.read_text()
    assert "exists" in refused(capsys, 2, "cluster-certificate", str(file))
    assert file.read_text() == written
    missing = str(tmp_path / "missing" / "cluster.yaml")
    assert "No such file" in refused(capsys, 2, "cluster-certificate", missing)


def test_a_missing_database_is_not_created_by_reading(tmp_path: Path, capsys) -> None:
    file = tmp_path / "folder" / "typo.db"
    for command in (ESTIMATE, ["flutter", "1"], ["report", "run", "1", "--output", "run.html"]):
        error = refused(capsys, 2, *command, "--database", f"sqlite:///{file}")
        assert "there is no database" in error
    assert not file.parent.exists()


def test_serving_a_file_that_is_no_database_is_refused(
    tmp_path: Path, capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FLEXSID_PORT", str(find_free_port()))
    file = tmp_path / "notes.txt"
    file.write_text("these are my notes\n" * 100)
    error = refused(capsys, 1, "serve", "--database", f"sqlite:///{file}")
    assert "the database does not respond" in error
    assert file.read_text().startswith("these are my notes")


def test_an_intact_database_is_reported_as_intact(flown_url: str, capsys) -> None:
    assert main(["check", "--database", flown_url, "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["sound"] is True
    assert [one["code"] for one in result["warnings"] if one["is_damage"]] == []


def test_each_damage_is_reported_with_advice(flown_url: str, capsys) -> None:
    store = Store.open(flown_url)
    (channel,) = store.channels.find(maneuver_id=1, name="q")
    decision = decision_review.propose(
        store,
        ModelProposal(
            title="two modes",
            structure=StructureReference(id=1, version=1),
            limits={},
            reasoning="fits",
            run_ids=(1,),
        ),
        "Ann",
    )
    decision_review.cast_vote(store, decision.id or 0, 1, Vote.APPROVE, "", "Bob")
    with store.database.transaction() as connection:
        run = 'UPDATE runs SET settings = \'{"start": "best", "max_iterations": 3}\''
        connection.exec_driver_sql(f"{run}, deleted_at = created_at")
        changed = bytes(8 * channel.n_samples)
        this = sa.update(arrays).where(arrays.c.hash == channel.array)
        connection.execute(this.values(data=changed))
        connection.execute(sa.update(decisions).values(votes={"Eve": "approve"}))
    store.close()
    assert main(["check", "--database", flown_url, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)["warnings"]
    assert {(one["code"], one["record"]) for one in found if one["is_damage"]} == {
        ("damaged-data", "channel 'q' of maneuver 1"),
        ("result-altered", "run 1"),
        ("broken-chain", "decision 1"),
    }
    assert main(["check", "--database", flown_url]) == 1
    assert "Import the file again" in capsys.readouterr().out
    if flown_url.startswith("sqlite"):
        assert "flexsid check" in refused(capsys, 1, "backup", "copy", "--database", flown_url)
        assert not Path("copy").exists()


def test_backups_at_intervals_retain_the_newest(
    database_url: str, store: Store, tmp_path: Path, capsys, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "backups"
    command = ["backup", str(folder), "--retained", "2", "--every", "24"]
    options = ["--database", database_url]
    assert "is no folder" in refused(capsys, 2, *command, *options)
    folder.mkdir()
    assert "--retained" in refused(capsys, 2, "backup", str(folder), "--every", "24", *options)
    assert "at least 1" in refused(capsys, 2, "backup", str(folder), "--retained", "0", *options)
    pauses: list[float] = []

    def pause(seconds: float) -> None:
        pauses.append(seconds)
        for age, file in enumerate(copies.list_scheduled(folder)):
            file.rename(folder / f"{copies.SCHEDULED}2020010{age}-000000.db")
        if len(pauses) == 4:
            raise KeyboardInterrupt
        failing = len(pauses) == 2
        monkeypatch.setattr(copies, "try_restore", refuse if failing else lambda source: None)

    def refuse(source: Path) -> None:
        raise BadInput("damaged")

    monkeypatch.setattr("flexsid.cli.administration.time.sleep", pause)
    assert main([*command, *options]) == 130
    assert pauses == [86400.0, 86400.0, 3600.0, 86400.0]
    assert len(list(folder.iterdir())) == 2
    printed = capsys.readouterr()
    assert printed.out.count("restored as a test; the newest 2 are retained") == 3
    assert "damaged" in printed.err


def test_incremental_backups_are_made_in_a_folder(
    database_url: str, store: Store, tmp_path: Path, capsys
) -> None:
    command = ["backup", str(tmp_path), "--incremental", "--database", database_url]
    assert "--retained" in refused(capsys, 2, *command)
    assert main([*command, "--retained", "1", "--json"]) == 0
    made = Path(json.loads(capsys.readouterr().out)["file"])
    assert {made.name, "samples.db"} <= {one.name for one in tmp_path.iterdir()}
    assert main(["restore", str(made), "--database", database_url]) == 0


def test_a_record_that_changed_since_a_run_is_reported(flown_url: str, capsys) -> None:
    store = Store.open(flown_url)
    aircraft = store.aircraft.get(1)
    store.aircraft.replace(replace(aircraft, name="FLEX-29"))
    store.close()
    assert main(["check", "--database", flown_url, "--json"]) == 0, "it may be a correction"
    (found,) = json.loads(capsys.readouterr().out)["warnings"]
    assert (found["code"], found["record"]) == ("inputs-changed", "aircraft 1")
    assert "1 runs were estimated with (the first: run 1)" in found["text"]


def test_a_deleted_run_of_a_baseline_is_detected(flown_url: str, capsys) -> None:
    store = Store.open(flown_url)
    decision = decision_review.propose(
        store,
        ModelProposal(
            title="two modes",
            structure=StructureReference(id=1, version=1),
            limits={},
            reasoning="fits",
            run_ids=(1,),
        ),
        "Ann",
    )
    decision_review.cast_vote(store, decision.id or 0, 1, Vote.APPROVE, "", "Bob")
    with store.database.transaction() as connection:  # as an earlier release allowed
        connection.exec_driver_sql("UPDATE runs SET deleted_at = created_at")
    store.close()
    assert main(["check", "--database", flown_url]) == 1
    assert "Run 1, evidence of decision 1, was deleted" in capsys.readouterr().out
