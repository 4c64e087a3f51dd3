"""The Python client with a running workbench."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import Any

import control
import numpy as np
import pytest
from beam_model import make_beam, write_matrix_entries, write_results
from plotly.graph_objects import Figure
from scipy.io import loadmat
from waiting import PATIENCE_S

from flexsid.cli.live import parse_options
from flexsid.cli.main import main
from flexsid.client import RequestRefused, RunFailed, Unreachable, Workbench
from flexsid.client import workbench as client
from flexsid.client.connection import ProgressLine
from flexsid.errors import BadInput, FlexsidError

MAPPING = """
[aircraft]
name = "FLEX-28"
[flight]
number = 7
[maneuver]
label = "sent"
[maneuver.condition]
airspeed = { value = 40, unit = "m/s" }
altitude = { value = 1500, unit = "m" }
fuel_fraction = { value = 50, unit = "%" }
[time]
column = "t"
[[channels]]
column = "wf4"
name = "wf4s"
unit = "deg"
role = "input"
[[channels]]
column = "q"
name = "q"
unit = "deg/s"
role = "output"
"""


def test_runs_are_validated(workbench: Workbench) -> None:
    # pyrefly: ignore[unsupported-operation]
    assert workbench.cross_predict([1]).loc[1, 1] > 0.9
    assert workbench.cross_validate(1, partition="frequencies")["refits"][0]["n_held_out"] > 50


def test_lists_are_tables(workbench: Workbench) -> None:
    maneuvers: Any = workbench.maneuvers()
    assert maneuvers.index.name == "id"
    assert maneuvers.loc[1, "label"] == "flown"
    assert maneuvers.loc[1, "dynamic_pressure_pa"] > 0
    assert str(maneuvers["created_at"].dtype).startswith("datetime64")
    assert workbench.aircraft().loc[1, "name"] == "FLEX-28"
    assert len(workbench.flights(aircraft_id=1)) == 1
    assert len(workbench.predictions()) > 0
    assert set(workbench.modal_tables()["kind"]) >= {"FEM"}
    assert len(workbench.maneuvers(search="nothing is called so")) == 0


def test_lists_come_page_by_page(workbench: Workbench, monkeypatch) -> None:
    first = workbench.submit(1, "EE", [7])
    second = workbench.submit(1, "EE", [9])
    workbench.wait(first, second, timeout_s=PATIENCE_S)
    whole = workbench.get
    monkeypatch.setattr(workbench, "get", lambda path, **query: whole(path, **{"limit": 1} | query))
    monkeypatch.setattr("flexsid.client.workbench._PAGE", 1)
    assert {1, first, second} <= set(workbench.runs().index)
    assert list(workbench.runs(limit=2, maneuver_id=1).index) == [second, first]


def test_waiting_for_a_missing_run_is_refused(workbench: Workbench) -> None:
    with pytest.raises(RequestRefused, match="99"):
        workbench.wait(1, 99, timeout_s=PATIENCE_S)


def test_a_run_is_submitted_waited_for_and_read(workbench: Workbench) -> None:
    run = workbench.submit(1, "EE", modes=[7, 9], band_hz=[0.5, 12.0], author="notebook")
    workbench.wait(run, timeout_s=PATIENCE_S)
    result = workbench.run(run)
    assert (result["state"], result["author"]) == ("succeeded", "notebook")
    assert result["settings"]["band_hz"] == [0.5, 12.0]
    parameters: Any = workbench.parameters(run)
    assert parameters.loc["Cm_alpha", "std_error"] > 0
    covariance: Any = workbench.covariance(run)
    assert list(covariance.index) == list(parameters.index) == list(covariance.columns)
    sigma = np.sqrt(covariance.loc["Cm_alpha", "Cm_alpha"])
    # The covariance holds the modal table and the condition, whose airspeed has a spread.
    [one] = [one for one in result["parameters"] if one["name"] == "Cm_alpha"]
    parts = np.linalg.norm([sigma, one["modal_std"] or 0.0, one["condition_std"] or 0.0])
    assert parts == pytest.approx(parameters.loc["Cm_alpha", "std_error"])


def test_settings_of_a_run_are_saved_and_used_as_a_template(workbench: Workbench) -> None:
    template = workbench.save_run_template(1, "our standard EE", "all flights")
    assert workbench.revise_run_template(template, 1, "with note") == 2
    listed = workbench.run_templates(aircraft_id=1)
    assert listed[["name", "revision", "note"]].values.tolist() == [
        ["our standard EE", 2, "with note"]
    ]
    run = workbench.submit(1, "EE", max_iterations=9, run_template_id=template)
    assert workbench.run(run)["template"]["changed_settings"] == ["max_iterations"]


def test_runs_and_predictions_are_compared(workbench: Workbench) -> None:
    other = workbench.submit(1, "EE", [7])
    workbench.wait(other, timeout_s=PATIENCE_S)
    table: Any = workbench.comparison([1, other], [1])
    (estimate, *_) = table.columns.get_level_values(0)
    parameters = workbench.parameters(1)
    assert table.loc["Cm_alpha", (estimate, "value")] == parameters.loc["Cm_alpha", "value"]
    difference: Any = table["max_difference_sigma", ""]
    assert float(difference["Cm_alpha"]) >= 0
    assert difference.isna()["Cm_eta9"]  # estimated by one run only


def test_identified_derivatives_are_a_table(workbench: Workbench) -> None:
    table: Any = workbench.identified_derivatives(1)
    assert table.loc["Cm_alpha", "n_estimated"] == 1
    assert workbench.get("aircraft/1/dashboard")["n_runs"]["EE"] >= 1


def test_transfer_functions_have_the_poles_of_the_model(workbench: Workbench) -> None:
    found = workbench.transfer_function(1, "wf4s", "q", zeros=5, poles=6)
    assert found["mismatch_cost"] < 10.0
    short_period = found["poles"][0]
    known = {pole["name"]: pole for pole in workbench.run(1)["poles"]}["SP"]
    expected = abs(complex(known["real"], known["imag"]))
    assert short_period["frequency_rad_s"] == pytest.approx(expected, rel=0.03)
    orders = {"zeros": 3, "poles": 4, "low_hz": 0.2, "high_hz": 6.0}
    bare, augmented = (
        workbench.transfer_function(1, name, "q", **orders) for name in ("wf4s", "wf4s_command")
    )
    assert augmented["delay_s"] > bare["delay_s"] + 0.005, "of the servo"
    low_order = workbench.transfer_function(1, "bfs", "q")
    assert low_order["band_hz"][1] < 3.8, "below the first elastic mode"
    assert low_order["is_close"]
    assert low_order["gain_unit"] == "(rad/s)/(rad s)"


def test_modes_come_from_outputs_alone(workbench: Workbench) -> None:
    found = workbench.identify_output_only(1, low_hz=3.0, high_hz=12.0)
    assert found["modes"]
    for mode in found["modes"]:
        assert 3.0 < mode["frequency_hz"] < 12.0
        assert 0.0 < mode["damping_std"] < mode["damping"]
    assert "known excitation" in found["warnings"][0]


def test_models_are_python_control_objects(workbench: Workbench, tmp_path) -> None:
    model = workbench.model(1)
    assert isinstance(model, control.StateSpace)
    assert model.state_labels[:4] == ["alpha", "q", "theta", "eta7"]
    exported = workbench.get("runs/1/model")
    assert exported["units"]["alpha"] == "rad"
    assert exported["units"]["q"] == "rad/s"
    workbench.save_model(1, tmp_path / "model.mat")
    read = loadmat(tmp_path / "model.mat", simplify_cells=True)
    np.testing.assert_array_equal(read["A"], model.A)
    np.testing.assert_array_equal(read["D"], model.D)
    assert list(read["outputs"]) == list(model.output_labels)
    assert read["delays_s"].shape == (len(model.output_labels),)
    workbench.save_model(1, tmp_path / "model.json")
    assert json.loads((tmp_path / "model.json").read_text())["A"] == exported["A"]
    with pytest.raises(BadInput, match=r"expected \.mat, \.json or \.fmu"):
        workbench.save_model(1, tmp_path / "model.xls")


def test_the_model_has_the_poles_of_the_run(workbench: Workbench) -> None:
    reported = [complex(pole["real"], pole["imag"]) for pole in workbench.run(1)["poles"]]
    poles = workbench.model(1).poles()
    for pole in reported:
        assert np.abs(poles - pole).min() < 1e-6 * max(1.0, abs(pole))


def test_figures_are_plotly_figures_and_their_numbers_tables(workbench: Workbench) -> None:
    figure = workbench.figure("fit", run_id=1)
    assert isinstance(figure, Figure)
    assert figure.to_dict()["data"]
    numbers: Any = workbench.numbers("time-history", maneuver_id=1, channels=["bfs", "wf1s"])
    assert set(numbers.columns) >= {"curve", "x", "y"}
    assert numbers["curve"].nunique() == 2


def test_a_refusal_states_its_reason(workbench: Workbench) -> None:
    with pytest.raises(RequestRefused, match="no run 999") as refused:
        workbench.run(999)
    assert (refused.value.status, refused.value.code) == (404, "unknown-record")
    with pytest.raises(RequestRefused, match="mode 99"):
        workbench.submit(1, "EE", modes=[99])
    with pytest.raises(RequestRefused, match="no_such_choice"):
        workbench.submit(1, "EE", modes=[7], no_such_choice=1)


def test_an_address_without_workbench_is_reported(monkeypatch) -> None:
    with pytest.raises(Unreachable, match="flexsid serve"):
        Workbench("http://127.0.0.1:9", timeout_s=5).aircraft()


def test_waiting_for_a_cancelled_run_raises(workbench: Workbench) -> None:
    run = workbench.submit(1, "OE", modes=[7, 9], max_iterations=1000)
    workbench.cancel(run)
    with pytest.raises(RunFailed, match=f"run {run} cancelled"):
        workbench.wait(run, timeout_s=PATIENCE_S)


def test_tables_without_pandas_name_the_missing_package(workbench: Workbench, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(FlexsidError, match=r"pip install flexsid\[client\]"):
        workbench.aircraft()
    assert workbench.items("aircraft")[0]["name"] == "FLEX-28"


def test_progress_is_one_line_on_a_terminal() -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    begun = {"id": 4, "state": "running", "progress": None, "finished_at": None}
    half = {**begun, "progress": {"fraction": 0.5, "message": "iteration 3"}}
    done = {**begun, "state": "succeeded", "finished_at": "2026-01-01T00:00:00Z"}
    shown, silent = Terminal(), io.StringIO()
    line = ProgressLine(True, shown)
    for run in (begun, half, done):
        line.show([run])
    ProgressLine(True, silent).show([half])
    ProgressLine(False, shown).show([half])
    assert " 50% run 4 running iteration 3" in shown.getvalue()
    assert shown.getvalue().count("\r") == 3
    line.show([half, done])
    assert " 75% 1 of 2 runs" in shown.getvalue()
    assert silent.getvalue() == ""


def test_every_option_of_the_interface_can_be_given(workbench: Workbench) -> None:
    schemas = workbench.get("openapi.json")["components"]["schemas"]
    structure = set(schemas["StructureRequest"]["properties"])
    request = set(schemas["RunRequest"]["properties"])
    assert structure - {"modes"} == client._STRUCTURE
    assert request - {"maneuver_id", "method", "structure", "settings"} == client._REQUEST


def test_a_run_uses_a_saved_structure(workbench: Workbench) -> None:
    run = workbench.submit(1, "EE", structure_id=2, structure_version=1)
    workbench.wait(run, timeout_s=PATIENCE_S)
    assert workbench.run(run)["structure_id"] == 2
    rigid = workbench.submit(1, "EE", modes=[])
    assert workbench.run(rigid)["structure"]["modes"] == []


def test_the_analyst_is_stored_with_a_run(live_url: str) -> None:
    ann = Workbench(live_url, analyst="Zoë")
    assert ann.run(ann.submit(1, "EE", modes=[7], band_hz=[0.3, 10.0]))["author"] == "Zoë"


def test_files_are_imported(workbench: Workbench, tmp_path: Path) -> None:
    time_s = np.arange(400) / 50.0
    table = np.column_stack([time_s, np.sin(time_s), np.cos(time_s)])
    record, mapping = tmp_path / "récord.csv", tmp_path / "mapping.toml"
    np.savetxt(record, table, delimiter=",", header="t,wf4,q", comments="")
    mapping.write_text(MAPPING)
    maneuver = workbench.import_maneuver(record, mapping=mapping)
    stored = workbench.get(f"maneuvers/{maneuver}")
    assert [channel["name"] for channel in stored["channels"]] == ["wf4s", "q"]
    mapping.write_text(MAPPING.replace('"q"', '"r"'))
    with pytest.raises(RequestRefused, match=r"récord\.csv"):
        workbench.import_maneuver(record, mapping=mapping)


def test_a_record_on_the_runway_is_imported(workbench: Workbench, tmp_path: Path) -> None:
    record, mapping = tmp_path / "runway.csv", tmp_path / "mapping.toml"
    samples = np.random.default_rng(1).normal(size=(400, 2))
    table = np.column_stack([np.arange(400) / 50.0, samples])
    np.savetxt(record, table, delimiter=",", header="t,wf4,q", comments="")
    parked = MAPPING.replace('label = "sent"', 'label = "before"\naxis = "ground"')
    mapping.write_text(parked)
    with pytest.raises(RequestRefused, match="airspeed 0, not 40"):
        workbench.import_maneuver(record, mapping=mapping)
    mapping.write_text(parked.replace("value = 40", "value = 0"))
    maneuver = workbench.import_maneuver(record, mapping=mapping)
    stored = workbench.get(f"maneuvers/{maneuver}")
    assert (stored["axis"], stored["condition"]["airspeed_m_s"], stored["airspeed_ratio"]) == (
        *("ground", 0.0),
        None,
    )
    assert maneuver not in workbench.maneuvers().index
    assert maneuver in workbench.maneuvers(ground=True).index


def test_reports_are_written(workbench: Workbench, tmp_path: Path) -> None:
    workbench.save_report(tmp_path / "run.html", "run", 1)
    assert "Equation error, run 1" in (tmp_path / "run.html").read_text(encoding="utf-8")
    workbench.save_report(tmp_path / "two.html", "comparison", run_ids=[1], prediction_ids=[1])
    with pytest.raises(BadInput, match=r"\.html or \.pdf"):
        workbench.save_report(tmp_path / "run.txt", "run", 1)


def test_modal_data_are_imported_compared_and_saved(workbench: Workbench, tmp_path: Path) -> None:
    beam = make_beam()
    files = [tmp_path / name for name in ("deck.bdf", "modes.f06")]
    for file, content in zip(files, write_results(beam.structure), strict=True):
        file.write_bytes(content)
    options = {"length_unit": "m", "mass_unit": "kg", "generalized_mass": "unit"}
    modal = workbench.modal_data
    assert modal.inspect(*files)["n_nodes"] == 13
    number, other = (
        modal.add(*files, aircraft_id=1, name=kind, kind=kind, **options) for kind in ("FEM", "GVT")
    )
    assert list(modal.modes(number)["frequency_hz"]) == pytest.approx(
        beam.structure.omega / 2 / np.pi, rel=1e-6
    )
    assert list(modal.correlation(number, other)["mac"]) == pytest.approx(np.ones(4))
    mass = tmp_path / "mass.pch"
    mass.write_text(write_matrix_entries("MAAX", beam.mass, beam.dofs))
    values = modal.orthogonality(mass, modal_table_id=number, mass="MAAX", length_unit="m")
    assert values.to_numpy() == pytest.approx(np.eye(4), abs=2e-5)
    assert modal.update(number, "updated", test_ids=[other]) > other
    for name in ("modes.mat", "modes.op4", "modes.zip"):
        modal.save(number, tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    modal.save(number, tmp_path / "mode.svg", number=1, moving=True)
    assert "<animate" in (tmp_path / "mode.svg").read_text()


def test_responses_are_estimated_from_time_data(workbench: Workbench, tmp_path: Path) -> None:
    force = np.random.default_rng(1).normal(size=2000)
    file = tmp_path / "run.csv"
    columns = np.column_stack([np.arange(2000) / 100.0, force, 2.0 * force])
    head = "time [s],force 61+z [N],61+z [m/s2]"
    np.savetxt(file, columns, delimiter=",", header=head, comments="")
    modal = workbench.modal_data
    number = modal.estimate_responses(file, averages=20, aircraft_id=1, name="GVT", estimator="Hv")
    found = modal.response(number, "61+z", "61+z")
    assert found["real"].to_numpy() == pytest.approx(np.full(len(found), 2.0))
    assert found["multiple_coherence"].to_numpy().min() == pytest.approx(1.0)


def test_streams_are_started_by_script_and_command(
    workbench: Workbench, live_url: str, capsys: pytest.CaptureFixture[str]
) -> None:
    names = {one["name"]: one for one in workbench.live.receivers()}
    assert {"replay", "push", "udp", "tcp", "nats", "mqtt", "mavlink"} <= names.keys()
    assert names["nats"]["missing_extra"] is None
    with pytest.raises(RequestRefused, match="name credentials by the option 'credentials'"):
        workbench.live.start(1, "t", "nats", {"server": "nats://a:b@c", "subject": "s"})
    address = ["live", "--url", live_url, "--json"]
    started = [*address, "start", "--run", str(1), "--receiver", "push"]
    assert main(started) == 0
    number = json.loads(capsys.readouterr().out)["id"]
    detail = workbench.live.stream(number)
    assert detail["stream"]["receiver"] == {"name": "push", "options": {}}
    packet = b"FXS1" + bytes(detail["packet_bytes"] - 4)
    assert workbench.live.push(number, packet) == 1
    assert number in workbench.live.streams().index
    assert main([*address, "stop", str(number)]) == 0
    assert json.loads(capsys.readouterr().out)["status"] == "stopped"
    assert workbench.live.history(number) == []
    assert main([*address, "start", "--receiver", "push"]) == 2
    assert "--run" in capsys.readouterr().err


def test_options_of_a_receiver_are_parsed() -> None:
    texts = ["port=14550", "address=0.0.0.0", "channels.q=ATTITUDE.pitchspeed", "speed=1.5"]
    assert parse_options(texts) == {
        "port": 14550,
        "address": "0.0.0.0",
        "channels": {"q": "ATTITUDE.pitchspeed"},
        "speed": 1.5,
    }
    for text in ("port", "=5", "channels.=x"):
        with pytest.raises(BadInput, match="expected NAME=VALUE"):
            parse_options([text])


def test_samples_are_those_that_runs_use(workbench: Workbench) -> None:
    samples = workbench.samples(1, ["q", "wf4s"], start_s=1.0, stop_s=2.0)
    assert samples.attrs["units"] == {"q": "rad/s", "wf4s": "rad"}
    assert (samples.index.name, samples.index[0]) == ("time_s", 1.0)
    drawn = workbench.numbers("time-history", maneuver_id=1, channels=["q"])
    recorded = workbench.samples(1, ["q"])["q"]
    assert recorded.loc[samples.index].equals(samples["q"])
    assert abs(drawn["y"]).max() == pytest.approx(np.rad2deg(recorded.abs().max()), rel=1e-3)
    rows = workbench.get_bytes("maneuvers/1/samples", channels="q,wf4s", format="csv").splitlines()
    assert rows[0] == b"time_s,q [rad/s],wf4s [rad]"
    assert len(rows) == recorded.size + 1
    for form, magic in (("nc", b"CDF"), ("mat", b"MATLAB 5.0")):
        file = workbench.get_bytes("maneuvers/1/samples", channels="q", format=form)
        assert file.startswith(magic)
    with pytest.raises(RequestRefused, match="no channel 'flux'; it has"):
        workbench.samples(1, ["flux"])
    with pytest.raises(RequestRefused, match="both start_s and stop_s"):
        workbench.samples(1, ["q"], start_s=1.0)
