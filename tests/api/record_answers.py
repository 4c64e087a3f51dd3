"""Record what the routes answer, as the examples that the description of the interface shows.

``python -m tests.api.record_answers DATABASE`` asks every route of a copy of the demonstration
campaign its own example and keeps the answers, shortened, in ``flexsid/api/answers.json``; what
needs a file that does not come with the project stays as it was. ``test_examples.py`` tells when
they no longer are what the routes promise.
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
from flexsid.api.description import ANSWERS
from flexsid.cli.serve import bring_along
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
_FLOWN = "\n".join(["bfs", *(f"{np.sin(0.1 * np.pi * k):.4f}" for k in range(200))])
_FORMS: dict[str, tuple[dict[str, str], list[Any]]] = {
    "upload_maneuver": (
        {},
        [("files", ("recording.csv", RECORDING)), ("mapping", ("mapping.toml", MAPPING))],
    ),
    "upload_files": ({}, [("files", ("recording.csv", RECORDING))]),
    "import_flown": (
        {"name": "As flown", "rate_hz": "50", "unit": "deg"},
        [("files", ("commands.csv", _FLOWN))],
    ),
    "upload_controller": (
        {"aircraft_id": "1", "name": "Damper of the recorder"},
        [("file", ("damper.json", DAMPER))],
    ),
}


def main(database: str) -> None:
    """Ask everything once, what ends something last."""
    kept = json.loads(ANSWERS.read_text(encoding="utf-8")) if ANSWERS.is_file() else {}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "asked.db"
        shutil.copy(database, file)
        settings = Settings(database=f"sqlite:///{file}")
        app = create_app(settings, bring_along=bring_along)
        with TestClient(app, base_url="http://127.0.0.1:8000") as client:
            answers = _Asking(client).ask(app.openapi())
    answers = dict(sorted({**kept, **answers}.items()))
    ANSWERS.write_text(json.dumps(answers, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{len(answers)} answers, {ANSWERS.stat().st_size / 1000:.0f} kB")


class _Asking:
    """Asks routes, with files and records of its own where an example needs them."""

    def __init__(self, client: TestClient) -> None:
        self.client = client
        self.task = ""
        for method in ("OE", "EE"):
            body = {"maneuver_id": 1, "method": method, "structure": {"modes": [7, 9]}}
            self._settle(self._made("runs", body))
        modes = client.get(f"{API}/modal-tables/1/file?form=uff&fuel=0.5").content
        hertz = np.linspace(2.0, 12.0, 400)
        ringing = 1.0 / (30.0**2 - (2 * np.pi * hertz) ** 2 + 20j * np.pi * hertz)
        measured = "".join(function(node, 61, hertz, node * ringing) for node in (61, 64)).encode()
        mass = io.BytesIO()
        np.savez(mass, mass=np.eye(399))
        self.uploads = {
            "look_at_upload": self._uploaded("modes.uff", modes),
            "import_structure": self._uploaded("modes.uff", modes),
            "import_responses": self._uploaded("gvt.uff", measured),
            "check_orthogonality": self._uploaded("mass.npz", mass.getvalue()),
        }
        self.recording = self._uploaded("recording.csv", RECORDING.encode())
        self.bodies: dict[str, Any] = {
            "import_structure": {"aircraft_id": 1, "name": "FEM 5.1"},
            "check_upload": {"mapping": MAPPING},
            "preview_upload": {"mapping": MAPPING, "channels": ["q"]},
            "import_upload": {"mapping": MAPPING},
            "vote_on_decision": {"revision": 2, "vote": "approve", "text": "agreed"},
            "withdraw_decision": {"revision": 1, "text": "the record was cut wrongly"},
        }

    def ask(self, described: dict[str, Any]) -> dict[str, Any]:
        operations = [
            (method, path, operation)
            for path, methods in described["paths"].items()
            for method, operation in methods.items()
            if operation["operationId"] != _ENDLESS
            and (method != "delete" or "200" in operation["responses"])
        ]
        operations.sort(key=_rank)
        answers = {}
        for method, path, operation in operations:
            name = operation["operationId"]
            answer = self._answer(method, path, operation)
            if answer.headers.get("content-type", "").startswith("application/json"):
                told = answer.json()
                if not (isinstance(told, dict) and told.get("items") == []):
                    answers[name] = shortened(told)
            elif answer.status_code >= 300:
                print(f"{name}: {method} {path}: {answer.status_code} {answer.text[:200]}")
            if name == "request_search":
                self._settle(answer.headers["location"])
            if name == "redesign":
                self.task = answer.json()["id"]
        return answers

    def _answer(self, method: str, path: str, operation: dict[str, Any]) -> Any:
        name = operation["operationId"]
        said: dict[str, dict[str, Any]] = {"path": {}, "query": {}, "header": dict(NAMED)}
        for part in operation.get("parameters", ()):
            if part["required"]:
                said[part["in"]][part["name"]] = part["example"]
        if "upload_id" in said["path"]:
            said["path"]["upload_id"] = self.uploads.get(name, self.recording)
        if name in _FORMS:
            form, files = _FORMS[name]
            sent = {"data": form, "files": files}
        else:
            content = operation.get("requestBody", {}).get("content", {})
            example = content.get("application/json", {}).get("example")
            sent = {"json": self.bodies.get(name, example)}
        if name in ("retry_job", "cancel_job"):
            said["path"]["job_id"] = self._left(cancelled=name == "retry_job")
        if "task_id" in said["path"]:
            said["path"]["task_id"] = self.task
        if name == "cancel_search":
            body = {"maneuver_ids": [2], "method": "OE", "structure": {"modes": [7, 9, 11]}}
            said["path"]["search_id"] = self._made("searches", body).rpartition("/")[2]
        if name == "export_design":
            said["query"]["form"] = "json"
        if name == "vote_on_decision":
            said["header"]["X-Flexsid-Analyst"] = "Bo"
        if name == "withdraw_decision":
            said["path"]["decision_id"] = self._proposed()
        address = path.format(**said["path"])
        return self.client.request(
            method, address, params=said["query"], headers=said["header"], **sent
        )

    def _made(self, path: str, body: Any) -> str:
        answer = self.client.post(f"{API}/{path}", json=body, headers=NAMED)
        assert answer.status_code < 300, answer.text
        return answer.headers["location"]

    def _settle(self, address: str) -> None:
        for _ in range(600):
            if self.client.get(address).json().get("state") not in ("queued", "running"):
                return
            time.sleep(0.1)
        sys.exit(f"{address} does not end")

    def _uploaded(self, name: str, content: bytes) -> str:
        answer = self.client.post(f"{API}/uploads", files=[("files", (name, content))])
        assert answer.status_code == 201, answer.text
        return answer.json()["upload"]["id"]

    def _left(self, *, cancelled: bool) -> int:
        body = {"maneuver_id": 2, "method": "OE", "structure": {"modes": [7, 9, 11, 12]}}
        if cancelled:
            body["structure"] = {"modes": [7, 9, 11, 15]}
        where = self._made("runs", body)
        number = int(where.rpartition("/")[2])
        if cancelled:
            self.client.post(f"{API}/jobs/{number}/cancel")
            self._settle(where)
        return number

    def _proposed(self) -> int:
        proposal = {"title": "Another", "structure": {"id": 2, "version": 1}, "reasoning": "x"}
        return int(self._made("decisions", proposal).rpartition("/")[2])


def _rank(operation: tuple[str, str, dict[str, Any]]) -> int:
    """What is looked at has been made before; what changes what others need comes last."""
    method, path, _ = operation
    if path.endswith(("cancel", "withdrawal", "retry")):
        return 3
    if "/uploads/" in path or (method == "post" and path.endswith(("/modes", "/corrections"))):
        return 4
    return {"post": 0, "put": 1, "get": 2, "delete": 3}[method]


def shortened(value: Any) -> Any:
    """The beginning of long lists and texts."""
    if isinstance(value, list):
        several = _ITEMS if any(isinstance(item, (dict, list)) for item in value) else _NUMBERS
        return [shortened(item) for item in value[:several]]
    if isinstance(value, dict):
        return {name: shortened(item) for name, item in value.items()}
    if isinstance(value, str) and len(value) > _LETTERS:
        return value[:_LETTERS]
    return value


if __name__ == "__main__":
    main(sys.argv[1])
