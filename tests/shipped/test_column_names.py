"""Names of columns, from an upload to the proposed channels."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest
from campaign import draw_flight
from drawn_columns import DrawnFile, write_drawn_file
from shipped import Client, serving

PROPOSED = {
    **{"delta_e": "elevator", "delta_a": "aileron", "delta_r_deg": "rudder"},
    **{"DEL_BFS": "bfs", "deltawf1l": "wf1l", "del_elev_r": "elevator_r", "del_flap": "flap"},
    # words of their own, of which no beginning is cut off
    **{name: name for name in ("delay", "delta_p", "delta_time", "delivered", "model")},
}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("names")
    with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
        yield server.connect()


def test_only_a_whole_prefix_is_removed_from_a_name(client: Client, tmp_path: Path) -> None:
    names = ["time_s", "q_degs", *PROPOSED]
    rows = [[row / 50, *((row * k) % 7 for k in range(len(names) - 1))] for row in range(100)]
    file = tmp_path / "flight.csv"
    file.write_text("\n".join([",".join(names), *(",".join(map(str, row)) for row in rows)]))
    proposal = client.upload(file)["proposal"]["text"]
    channels = {one["column"]: one for one in tomllib.loads(proposal)["channels"]}
    assert {name: channels[name]["name"] for name in PROPOSED} == PROPOSED
    inputs = {name for name in PROPOSED if channels[name]["role"] == "input"}
    assert inputs == {name for name, proposed in PROPOSED.items() if proposed.lower() != name}


LOGGED = {
    "p_rad_s": ("p", "rad/s"),
    "q_deg_s": ("q", "deg/s"),
    "u": ("u", "m/s"),
    "v": ("v", "m/s"),
    "w": ("w", "m/s"),
    "az_device_id": ("az_device_id", "1"),
    "airspeed_innov_test_ratio": ("airspeed_innov_test_ratio", "1"),
    "rates_setpoint.pitch": ("rates_setpoint_pitch", "1"),
    "theta_ref": ("theta_ref", "1"),
    "pitch_stick [deg]": ("pitch_stick", "deg"),
    "PIDP.P": ("PIDP_P", "1"),
    "ATT.DesRoll": ("ATT_DesRoll", "1"),
    "ARSP.H": ("ARSP_H", "1"),
    "alpha_dot": ("alpha_dot", "1"),
    "sensor.xyz.0": ("xyz.0", "1"),
    "Yaw Rate (rad/sec)": ("r", "rad/sec"),
    "Pitch Rate (turns/sec)": ("Pitch Rate (turns/sec)", "turns/sec"),  # which is asked
}
"""Columns of logs: the name that is proposed, and its unit."""


def test_what_a_log_computes_is_no_measurement(client: Client, tmp_path: Path) -> None:
    names = ["time_s", *LOGGED]
    rows = [[row / 50, *((row * k) % 7 for k in range(len(names) - 1))] for row in range(100)]
    file = tmp_path / "flight.csv"
    file.write_text("\n".join([",".join(names), *(",".join(map(str, row)) for row in rows)]))
    proposal = client.upload(file)["proposal"]["text"]
    channels = {one["column"]: one for one in tomllib.loads(proposal)["channels"]}
    proposed = {name: (channels[name]["name"], channels[name]["unit"]) for name in names[1:]}
    assert proposed == {name: LOGGED[name] for name in names[1:]}
    assert all("role" in channels[name]["guessed"] for name in names[1:] if "_id" in name)


UNITS = {"ue": 1e-6, "microstrain": 1e-6, "ustrain": 1e-6, "ft/s^2": 0.3048, "ft/s2": 0.3048}
"""Spellings of one unit, by its factor."""


@pytest.mark.parametrize("seeds", [(4,), pytest.param(range(20), marks=pytest.mark.long)])
def test_strange_names_are_recognised_by_words_and_motion(
    client: Client, seeds: Sequence[int], tmp_path: Path
) -> None:
    n_columns, wrong = 0, []
    for seed in seeds:
        flight = draw_flight(777, seed, rows=6000)
        rng = np.random.default_rng([seed, 7])
        folder = tmp_path / str(seed)
        folder.mkdir()
        drawn = write_drawn_file(rng, folder, flight.aircraft, flight.record)
        proposal = client.upload(drawn.path)["proposal"]["text"]
        found, silent = judge_proposal(drawn, proposal)
        assert not silent  # what is guessed is asked
        n_columns += len(drawn.truth)
        wrong += found
    assert len(wrong) <= 0.05 * n_columns, wrong


def judge_proposal(drawn: DrawnFile, proposal: str) -> tuple[list[str], list[str]]:
    """Return the columns that are wrong, and those of them that nobody is asked about."""
    channels = {one["column"]: one for one in tomllib.loads(proposal)["channels"]}
    wrong, silent = [], []
    for column, truth in drawn.truth.items():
        channel = channels[column]
        unit = channel["unit"]
        written = truth.unit.replace("^", "")
        is_unit = UNITS.get(unit, unit.replace("^", "")) == UNITS.get(written, written)
        is_role = channel["role"] == truth.role
        is_name = truth.name in (None, channel["name"])
        if is_unit and is_role and is_name:
            continue
        wrong.append(f"{column} is {truth}, proposed as {channel}")
        asked = set(channel.get("guessed", ()))
        is_renamed = channel["name"] != column.rpartition(".")[2]
        needed = {"unit": is_unit, "role": is_role and is_name, "name": is_name or not is_renamed}
        if {key for key, is_right in needed.items() if not is_right} - asked:
            silent.append(wrong[-1])
    return wrong, silent


def test_pulse_widths_are_no_deflections_without_a_calibration(
    client: Client, tmp_path: Path
) -> None:
    rows = [
        f"{k / 50},{1500 + 400 * np.sin(k / 9):.0f},{1400 + k % 90},{k % 7}" for k in range(200)
    ]
    file = tmp_path / "flight.csv"
    file.write_text("\n".join(["time_s,elevator,servo3,q_degs", *rows]))
    found = client.upload(file)
    proposal = found["proposal"]["text"]
    channels = {one["column"]: one for one in tomllib.loads(proposal)["channels"]}
    elevator, servo = channels["elevator"], channels["servo3"]
    assert (elevator["unit"], elevator["role"]) == ("us", "input")
    assert {"unit", "role"} <= set(elevator["guessed"])
    assert (servo["name"], servo["unit"], servo["role"]) == ("servo3", "us", "output")
    assert proposal.count("needs unit, role and calibration") == 2

    def check(mapping: str) -> dict:
        path = f"uploads/{found['upload']['id']}/check"
        return client.send("post", path, {"mapping": mapping})

    for unit in ("us", "deg"):
        part = '"elevator"\nunit = "us"'
        problem = check(proposal.replace(part, part.replace("us", unit)))["problem"]
        assert problem["code"] == "needs-calibration"
        assert "calibration = [[1000, -25]" in problem["message"]
    table = 'unit = "deg"\ncalibration = [[1000, 25], [1500, 5], [2000, -25]]'
    mapping = proposal.replace('name = "elevator"\nunit = "us"', f'name = "elevator"\n{table}')
    channel = next(one for one in check(mapping)["channels"] if one["name"] == "elevator")
    assert channel["largest"] == pytest.approx(21.0)
    assert channel["smallest"] == pytest.approx(-19.0)
    narrow = check(mapping.replace("[2000, -25]", "[1800, -25]"))["problem"]
    assert narrow["code"] == "outside-calibration"
    assert "its calibration has 1000 to 1800" in narrow["message"]
