"""Names of columns, from an upload to the proposed channels."""

from __future__ import annotations

import tomllib
from pathlib import Path

from shipped import serving

PROPOSED = {
    **{"delta_e": "elevator", "delta_a": "aileron", "delta_r_deg": "rudder"},
    **{"DEL_BFS": "bfs", "deltawf1l": "wf1l", "del_elev_r": "elevator_r", "del_flap": "flap"},
    # words of their own, of which no beginning is cut off
    **{name: name for name in ("delay", "delta_p", "delta_time", "delivered", "model")},
}


def test_only_a_whole_prefix_is_removed_from_a_name(tmp_path: Path) -> None:
    names = ["time_s", "q_degs", *PROPOSED]
    rows = [[row / 50, *((row * k) % 7 for k in range(len(names) - 1))] for row in range(100)]
    file = tmp_path / "flight.csv"
    file.write_text("\n".join([",".join(names), *(",".join(map(str, row)) for row in rows)]))
    with serving(tmp_path, f"sqlite:///{tmp_path / 'flexsid.db'}") as server:
        proposal = server.connect().upload(file)["proposal"]["text"]
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
}
"""Columns of logs: the name that is proposed, and its unit."""


def test_what_a_log_computes_is_no_measurement(tmp_path: Path) -> None:
    names = ["time_s", *LOGGED]
    rows = [[row / 50, *((row * k) % 7 for k in range(len(names) - 1))] for row in range(100)]
    file = tmp_path / "flight.csv"
    file.write_text("\n".join([",".join(names), *(",".join(map(str, row)) for row in rows)]))
    with serving(tmp_path, f"sqlite:///{tmp_path / 'flexsid.db'}") as server:
        proposal = server.connect().upload(file)["proposal"]["text"]
    channels = {one["column"]: one for one in tomllib.loads(proposal)["channels"]}
    proposed = {name: (channels[name]["name"], channels[name]["unit"]) for name in names[1:]}
    assert proposed == {name: LOGGED[name] for name in names[1:]}
    assert all("role" in channels[name]["guessed"] for name in names[1:] if "_id" in name)
