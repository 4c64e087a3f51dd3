"""A model of one's own: the file of the how-to, by every entry point, on records of other code."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from own_model_flight import ROLL, simulate_roll, write_own_record
from shipped import Client, ask_command, make_environment, run_command, serving

HOW_TO = Path(__file__).parents[2] / "docs" / "how-to" / "own-model.md"
FILE = re.findall(r"^```python\n(.*?)^```$", HOW_TO.read_text(), re.MULTILINE | re.DOTALL)[0]
CLIENT = """
import json, sys
from flexsid.client import Workbench
workbench = Workbench(sys.argv[1])
fit = workbench.fit_grey_box(1, sys.argv[2])
system = workbench.grey_box(fit["id"])
print(json.dumps([fit, system.A.tolist(), system.input_labels, system.output_labels]))
"""


@dataclass(frozen=True, slots=True)
class Flown:
    """A server with one record of the roll mode."""

    url: str
    client: Client
    folder: Path
    database: str


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Flown]:
    folder = tmp_path_factory.mktemp("own-model")
    database = f"sqlite:///{folder / 'flexsid.db'}"
    record, mapping = write_own_record(folder, simulate_roll(seed=3))
    ask_command(folder, database, "import", str(record), "--mapping", str(mapping))
    (folder / "roll.py").write_text(FILE)
    with serving(folder, database) as server:
        yield Flown(server.url, server.connect(), folder, database)


def fit(client: Client, source: str, **more: Any) -> dict[str, Any]:
    """Request a fit and return its job when it has ended."""
    body = {"maneuver_id": 1, "model": "roll.py", "source": source, **more}
    job = client.send("post", "grey-box-fits", body)
    return job if job["state"] == "succeeded" else client.wait_for_end(f"jobs/{job['id']}")


def test_every_entry_point_has_the_same_fit(flown: Flown) -> None:
    job = fit(flown.client, FILE)
    assert job["state"] == "succeeded", job
    assert "source" not in job["request"]
    found = flown.client.get(f"grey-box-fits/{job['id']}")
    assert found["source"] == FILE
    assert found["derivatives"] == "complex step"
    assert found["adequacy"] == "consistent"
    for one in found["parameters"]:
        assert abs(one["value"] - ROLL[one["name"]]) < 4.0 * one["std"] < 0.3 * abs(one["value"])
    slow = found["poles"][0]
    assert abs(slow["frequency_rad_s"] + ROLL["L_p"]) < 4.0 * slow["frequency_std_rad_s"]
    assert found["responses"][0]["r_squared"] > 0.9
    (listed,) = flown.client.get("grey-box-fits?maneuver_id=1")["items"]
    assert (listed["id"], listed["bic"]) == (job["id"], found["bic"])

    command = ("grey-box", "--maneuver", "1", "--model", "roll.py")
    printed = run_command(flown.folder, flown.database, *command)
    assert printed.returncode == 0, printed.stderr
    assert re.search(r"L_p +-3\.\d+ ± 0\.0\d+ +1/s\n", printed.stdout), printed.stdout
    assert ask_command(flown.folder, flown.database, *command) == found

    client = subprocess.run(
        [sys.executable, "-c", CLIENT, flown.url, str(flown.folder / "roll.py")],
        env=make_environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    of_client, A, inputs, outputs = json.loads(client.stdout)
    assert of_client == {"id": job["id"], **found}
    assert (A, inputs, outputs) == (found["A"], ["aileron"], ["p"])


def test_a_model_without_the_actuator_is_rejected(flown: Flown) -> None:
    source = FILE.replace(
        'A = [[p["L_p"], p["L_da"]], [0.0, -p["servo"]]]', 'A = [[p["L_p"]]]'
    ).replace('A, [[0.0], [p["servo"]]], [[1.0, 0.0]]', 'A, [[p["L_da"]]], [[1.0]]')
    source = source.replace(', ("servo", 12.0, "rad/s")', "")
    smaller = flown.client.get(f"grey-box-fits/{fit(flown.client, source)['id']}")
    assert smaller["adequacy"] == "suspect"
    assert "p from" in smaller["sentence"]
    whole = flown.client.get(f"grey-box-fits/{fit(flown.client, FILE)['id']}")
    assert whole["bic"] < smaller["bic"] - 10.0
    assert len(smaller["parameters"]) == 2


def test_a_function_that_is_not_analytic_is_differentiated(flown: Flown) -> None:
    job = fit(flown.client, FILE.replace('-p["servo"]', '-abs(p["servo"])'))
    found = flown.client.get(f"grey-box-fits/{job['id']}")
    assert found["derivatives"] == "central differences"
    exact = flown.client.get(f"grey-box-fits/{fit(flown.client, FILE)['id']}")
    for one, other in zip(found["parameters"], exact["parameters"], strict=True):
        assert one["value"] == pytest.approx(other["value"], rel=1e-4)
        assert one["std"] == pytest.approx(other["std"], rel=1e-3)


@pytest.mark.parametrize(
    ("old", "new", "code", "message"),
    [
        ('p["L_da"]', 'p["L_r"]', "model-failed", "roll.py, line 5: KeyError: 'L_r'"),
        ("MODEL =", "raise SystemExit(3)\nMODEL =", "model-failed", "line 9: SystemExit"),
        ("MODEL = GreyBox(", "MODEL = dict(", "bad-model-file", "0 GreyBox values"),
        ("[[0.0]]\n", "[[0.0, 1.0]]\n", "bad-model", "D of 'Roll mode with actuator' is 1 x 2"),
        ('outputs={"p"', 'outputs={"r"', "unknown-channel", "no channel 'r'"),
        ('{"p": "rad/s"}', '{"p": "m"}', "wrong-dimension", "'p' is recorded in rad/s"),
        ('[p["servo"]]]', '[p["servo"] / p["L_da"]]]', "not-identifiable", "'L_da' has no effect"),
    ],
)
def test_errors_of_the_file_name_line_and_cause(
    flown: Flown, old: str, new: str, code: str, message: str
) -> None:
    assert old in FILE
    job = fit(flown.client, FILE.replace(old, new, 1))
    assert job["error"]["code"] == code, job["error"]
    assert message in job["error"]["message"]
    assert "Traceback" not in job["error"]["message"]


@pytest.mark.parametrize(
    ("body", "status", "code"),
    [
        ({"source": "def ("}, 422, "bad-model-file"),
        ({"source": ""}, 422, "unknown-model"),
        ({"maneuver_id": 99}, 404, "unknown-record"),
        ({"low_hz": 3.0, "high_hz": 1.0}, 422, "bad-band"),
        ({"method": "EE"}, 422, "invalid-request"),
    ],
)
def test_requests_that_cannot_be_computed_are_refused(
    flown: Flown, body: dict[str, Any], status: int, code: str
) -> None:
    whole = {"maneuver_id": 1, "model": "roll.py", "source": FILE, **body}
    refused = flown.client.request("post", "grey-box-fits", whole)
    assert (refused.status_code, refused.json()["code"]) == (status, code)
