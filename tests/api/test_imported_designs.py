"""Import of flown multisines, and optimisation of new phases."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from waiting import ended

from flexsid.cli.main import main

URL = "/api/v1/designs"
FLOWN = Path(__file__).parents[2].parent / "shared/data/maewing1/flight/flown_multisines"
HARMONICS = {"a": range(3, 40, 2), "b": range(4, 41, 2)}


def samples(names: tuple[str, ...] = ("a", "b")) -> np.ndarray:
    rng = np.random.default_rng(2)
    cycles = np.arange(400) / 400
    return np.stack(
        [
            sum(np.sin(2.0 * np.pi * k * cycles + rng.uniform(0.0, 6.0)) for k in HARMONICS[name])
            for name in names
        ],
        axis=1,
    )


def sent(client: TestClient, text: str, **fields: Any):
    form = {"name": "flown", "rate_hz": "50", "unit": "deg"} | fields
    return client.post(f"{URL}/import", files=[("files", ("table.csv", text))], data=form)


def table(values: np.ndarray) -> str:
    rows = [",".join(f"{x:.6f}" for x in row) for row in values]
    return "\n".join(["wf1s,wf4s", *rows]) + "\n"


def test_columns_are_imported_as_inputs_and_phases_are_improved(empty: TestClient):
    flown = sent(empty, table(samples()))
    assert flown.status_code == 201, flown.text
    (design,) = flown.json()["items"]
    assert design["specification"]["duration_s"] == 8.0
    first, second = design["specification"]["inputs"]
    assert (first["name"], first["harmonics"]) == ("wf1s", list(HARMONICS["a"]))
    assert second["harmonics"] == list(HARMONICS["b"])
    rows = empty.get(f"{URL}/{design['id']}/export?form=csv").text.splitlines()
    rows = [row for row in rows if not row.startswith("#")]
    again = np.array([row.split(",") for row in rows[1:]], dtype=float)[:, 1:]
    flown_peak = np.deg2rad(np.abs(samples()).max(axis=0))
    np.testing.assert_allclose(np.abs(again).max(axis=0), flown_peak, rtol=0.02)

    order = {"name": "anew", "effort": "quick"}
    begun = empty.post(f"{URL}/{design['id']}/redesign", json=order)
    done = ended(empty, begun.headers["location"])
    better = empty.get(f"{URL}/{done['result']['design_id']}").json()
    assert better["specification"]["inputs"] == design["specification"]["inputs"]
    for name, factor in better["peak_factors"].items():
        assert factor < design["peak_factors"][name] - 0.05


def test_column_without_multisine_is_refused(empty: TestClient):
    noise = samples()
    noise[:, 1] = np.random.default_rng(0).normal(size=400)
    refused = sent(empty, table(noise))
    assert refused.status_code == 422
    assert refused.json()["code"] == "no-multisine"
    assert "wf4s" in refused.json()["detail"]
    shared = sent(empty, table(samples(("a", "a"))))
    assert shared.json()["code"] == "shared-harmonic"


@pytest.mark.skipif(not FLOWN.is_dir(), reason="the flown multisines of mAEWing1 are not here")
def test_the_multisines_of_maewing1_are_recognised(
    empty: TestClient, database_url: str, capsys: pytest.CaptureFixture[str]
):
    files = sorted(FLOWN.glob("*.csv"))
    form = {"name": "Geri", "rate_hz": "150", "separate": "true"}
    parts = [("files", (file.name, file.read_bytes())) for file in files]
    stored = empty.post(f"{URL}/import", files=parts, data=form)
    assert stored.status_code == 201, stored.text
    assert [one["name"] for one in stored.json()["items"]] == [file.stem for file in files]
    for one in stored.json()["items"]:
        (only,) = one["peak_factors"].values()
        assert 1.0 < only < 2.0
    pair = [str(FLOWN / f"playback_OMS2_{k}.csv") for k in (1, 2)]
    assert (
        main(
            [
                "import-multisine",
                *pair,
                "--rate",
                "150",
                "--name",
                "OMS2",
                "--database",
                database_url,
            ]
        )
        == 0
    )
    printed = capsys.readouterr().out
    assert "OMS2" in printed
    assert printed.count("relative peak factor") == 2
