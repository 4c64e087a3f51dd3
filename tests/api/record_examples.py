"""Record responses of all routes as the examples of the OpenAPI description.

``PYTHONPATH=tests/servers python -m tests.api.record_examples DATABASE`` sends the example request
of every route to a copy of the demonstration campaign and stores the shortened responses in
``flexsid/api/examples.json``; examples that need files outside the project are not renewed.
``test_examples.py`` checks them against the declared models.
"""

from __future__ import annotations

import io
import json
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from fastapi.testclient import TestClient
from tests.api.test_vibration_tests import function

from flexsid.api.app import create_app
from flexsid.api.description import EXAMPLES
from flexsid.cli.serve import add_builtin_aircraft
from flexsid.settings import Settings

API = "/api/v1"
NAMED = {"X-Flexsid-Analyst": "Ann%20Analyst"}
_ITEMS, _NUMBERS, _LETTERS = 2, 3, 160
_ENDLESS = "stream_events"
RECORDING = "\n".join(["t_s,bf,q", *(f"{k / 50:.2f},{k % 3},{-k % 5}" for k in range(20))])
MAPPING = """[aircraft]
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
column = "bf"
name = "bfs"
unit = "deg"
role = "input"
[[channels]]
column = "q"
unit = "deg/s"
role = "output"
"""
DAMPER = (
    '{"reads": ["q"], "drives": ["wf4s"],'
    ' "transfer": {"wf4s": {"q": {"num": [0.2], "den": [0.02, 1.0]}}}}'
)
_COMMANDS = "\n".join(["bfs", *(f"{np.sin(0.1 * np.pi * k):.4f}" for k in range(200))])
_FORMS: dict[str, tuple[dict[str, str], list[Any]]] = {
    "upload_maneuver": (
        {},
        [("files", ("recording.csv", RECORDING)), ("mapping", ("mapping.toml", MAPPING))],
    ),
    "upload_files": ({}, [("files", ("recording.csv", RECORDING))]),
    "import_multisines": (
        {"name": "OMS 1", "rate_hz": "50", "unit": "deg"},
        [("files", ("commands.csv", _COMMANDS))],
    ),
    "upload_controller": (
        {"aircraft_id": "1", "name": "Damper of the recorder"},
        [("file", ("damper.json", DAMPER))],
    ),
}


def main(database: str) -> None:
    """Send one request to every route, those that cancel or delete last."""
    recorded = json.loads(EXAMPLES.read_text(encoding="utf-8")) if EXAMPLES.is_file() else {}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "copy.db"
        shutil.copy(database, file)
        settings = Settings(database=f"sqlite:///{file}")
        app = create_app(settings, add_builtin_aircraft=add_builtin_aircraft)
        with TestClient(app, base_url="http://127.0.0.1:8000") as client:
            examples = _Recorder(client).record(app.openapi())
    examples = dict(sorted({**recorded, **examples}.items()))
    EXAMPLES.write_text(json.dumps(examples, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{len(examples)} examples, {EXAMPLES.stat().st_size / 1000:.0f} kB")


class _Recorder:
    """Sends example requests, with files and records created for them."""

    def __init__(self, client: TestClient) -> None:
        self.client = client
        for method in ("OE", "EE"):
            body = {"maneuver_id": 1, "method": method, "structure": {"modes": [7, 9]}}
            self._wait_until_ended(self._create("runs", body))
        modes = client.get(f"{API}/modal-tables/1/file?form=uff&fuel=0.5").content
        hertz = np.linspace(2.0, 12.0, 400)
        ringing = 1.0 / (30.0**2 - (2 * np.pi * hertz) ** 2 + 20j * np.pi * hertz)
        measured = "".join(function(node, 61, hertz, node * ringing) for node in (61, 64)).encode()
        mass = io.BytesIO()
        np.savez(mass, mass=np.eye(399))
        self.uploads = {
            "inspect_modal_files": self._upload("modes.uff", modes),
            "import_modal_data": self._upload("modes.uff", modes),
            "import_responses": self._upload("gvt.uff", measured),
            "estimate_responses": self._upload("run.csv", _write_vibration_record()),
            "request_orthogonality": self._upload("mass.npz", mass.getvalue()),
        }
        self.recording = self._upload("recording.csv", RECORDING.encode())
        self.bodies: dict[str, Any] = {
            "import_modal_data": {"aircraft_id": 1, "name": "FEM 5.1"},
            "check_upload": {"mapping": MAPPING},
            "preview_upload": {"mapping": MAPPING, "channels": ["q"]},
            "import_upload": {"mapping": MAPPING},
            "vote_on_decision": {"revision": 2, "vote": "approve", "text": "agreed"},
            "withdraw_decision": {"revision": 1, "text": "the record was cut wrongly"},
        }

    def record(self, described: dict[str, Any]) -> dict[str, Any]:
        operations = [
            (method, path, operation)
            for path, methods in described["paths"].items()
            for method, operation in methods.items()
            if operation["operationId"] != _ENDLESS
            and (method != "delete" or "200" in operation["responses"])
        ]
        operations.sort(key=_find_rank)
        examples = {}
        for method, path, operation in operations:
            name = operation["operationId"]
            response = self._request(method, path, operation)
            if response.headers.get("content-type", "").startswith("application/json"):
                body = response.json()
                if not (isinstance(body, dict) and body.get("items") == []):
                    examples[name] = shorten(body)
            elif response.status_code >= 300:
                print(f"{name}: {method} {path}: {response.status_code} {response.text[:200]}")
            if name in (
                "compute_prediction",
                "request_search",
                "request_flutter",
                "request_predicted_flutter",
                "request_closed_loop",
                "request_cross_predictions",
                "request_cross_validation",
                "request_modes",
                "request_reconstruction",
            ):
                self._wait_until_ended(response.headers["location"])
        return examples

    def _request(self, method: str, path: str, operation: dict[str, Any]) -> Any:
        name = operation["operationId"]
        values: dict[str, dict[str, Any]] = {"path": {}, "query": {}, "header": dict(NAMED)}
        for part in operation.get("parameters", ()):
            if part["required"]:
                values[part["in"]][part["name"]] = part["example"]
        if "upload_id" in values["path"]:
            values["path"]["upload_id"] = self.uploads.get(name, self.recording)
        if name in _FORMS:
            form, files = _FORMS[name]
            sent = {"data": form, "files": files}
        else:
            content = operation.get("requestBody", {}).get("content", {})
            example = content.get("application/json", {}).get("example")
            sent = {"json": self.bodies.get(name, example)}
        if name in ("retry_job", "cancel_job"):
            values["path"]["job_id"] = self._queue_run(cancelled=name == "retry_job")
        if name == "cancel_search":
            body = {"maneuver_ids": [2], "method": "OE", "structure": {"modes": [7, 9, 11]}}
            values["path"]["search_id"] = self._create("searches", body).rpartition("/")[2]
        if name == "draw_lattice":
            values["query"]["prediction_id"] = 3  # that of compute_prediction
        if name == "export_design":
            values["query"]["form"] = "json"
        if name == "vote_on_decision":
            values["header"]["X-Flexsid-Analyst"] = "Bo"
        if name == "withdraw_decision":
            values["path"]["decision_id"] = self._propose()
        address = path.format(**values["path"])
        return self.client.request(
            method, address, params=values["query"], headers=values["header"], **sent
        )

    def _create(self, path: str, body: Any) -> str:
        response = self.client.post(f"{API}/{path}", json=body, headers=NAMED)
        assert response.status_code < 300, response.text
        return response.headers["location"]

    def _wait_until_ended(self, address: str) -> None:
        for _ in range(600):
            if self.client.get(address).json().get("state") not in ("queued", "running"):
                return
            time.sleep(0.1)
        sys.exit(f"{address} does not end")

    def _upload(self, name: str, content: bytes) -> str:
        response = self.client.post(f"{API}/uploads", files=[("files", (name, content))])
        assert response.status_code == 201, response.text
        return response.json()["upload"]["id"]

    def _queue_run(self, *, cancelled: bool) -> int:
        body = {"maneuver_id": 2, "method": "OE", "structure": {"modes": [7, 9, 11, 12]}}
        if cancelled:
            body["structure"] = {"modes": [7, 9, 11, 15]}
        where = self._create("runs", body)
        number = int(where.rpartition("/")[2])
        if cancelled:
            self.client.post(f"{API}/jobs/{number}/cancel")
            self._wait_until_ended(where)
        return number

    def _propose(self) -> int:
        proposal = {"title": "Another", "structure": {"id": 2, "version": 1}, "reasoning": "x"}
        return int(self._create("decisions", proposal).rpartition("/")[2])


def _find_rank(operation: tuple[str, str, dict[str, Any]]) -> int:
    """Return the order: creation, results of what was created, reading, then changes."""
    method, path, _ = operation
    if path.endswith(("cancel", "withdrawal", "retry")):
        return 4
    if "/uploads/" in path or (method == "post" and path.endswith(("/modes", "/corrections"))):
        return 5
    if method == "post" and path.endswith("/results"):
        return 2
    return {"post": 0, "put": 1, "get": 3, "delete": 4}[method]


def _write_vibration_record() -> bytes:
    """A force and two accelerations over 40 s."""
    rng = np.random.default_rng(1)
    force = rng.normal(size=4000)
    columns = [np.arange(4000) / 100.0, force, 2.0 * force, rng.normal(size=4000) - force]
    head = "time [s],force 61+z [N],61+z [m/s2],64+z [m/s2]"
    rows = (",".join(f"{x:.6g}" for x in row) for row in zip(*columns, strict=True))
    return "\n".join([head, *rows]).encode()


def shorten(value: Any) -> Any:
    """Return the beginning of long lists and texts."""
    if isinstance(value, list):
        several = _ITEMS if any(isinstance(item, (dict, list)) for item in value) else _NUMBERS
        return [shorten(item) for item in value[:several]]
    if isinstance(value, dict):
        return {name: shorten(item) for name, item in value.items()}
    if isinstance(value, str) and len(value) > _LETTERS:
        return value[:_LETTERS]
    return value


if __name__ == "__main__":
    main(sys.argv[1])
