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
