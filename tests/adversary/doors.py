"""Ways into the product, each with its defaults, through the port of the started command."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from shipped import Client
from simulated_flight import Multisine

METHODS = ("OE", "FRE", "EE")
LIVE_SPEED = 20.0  # times real time


@dataclass(frozen=True)
class Faults:
    """Responses that no request should have."""

    found: list[str]

    def check(self, client: Client, method: str, path: str, body: Any = None, **sent: Any) -> Any:
        """Send a request; keep a refusal, and return the content or None."""
        response = client.request(method, path, body, **sent)
        if not response.is_success:
            self.found.append(f"{method} {path}: {response.status_code} {response.text[:300]}")
            return None
        return response.json() if response.content else None


def wait_for_end(client: Client, path: str) -> Any:
    """Wait until a job or a run has ended, however long it takes."""
    while (now := client.get(path))["state"] in ("queued", "running"):
        time.sleep(0.1)
    return now


def import_flight(client: Client, faults: Faults, files: list[Path], mapping: str) -> int | None:
    """Upload the files and import them; return the maneuver."""
    upload = client.upload(*files)["upload"]["id"]
    job = faults.check(client, "post", f"uploads/{upload}/import", {"mapping": mapping})
    if job is None:
        return None
    ended = wait_for_end(client, f"jobs/{job['id']}")
    if ended["state"] != "succeeded":
        faults.found.append(f"import: {ended['error']}")
        return None
    return ended["result"]["maneuver_id"]


def run_methods(
    client: Client, faults: Faults, maneuver: int, methods: Sequence[str] = METHODS
) -> dict[str, dict[str, Any]]:
    """Request a run by each method with nothing but its maneuver."""
    bodies = {method: {"maneuver_id": maneuver, "method": method} for method in methods}
    asked = {m: faults.check(client, "post", "runs", body) for m, body in bodies.items()}
    return {m: wait_for_end(client, f"runs/{run['id']}") for m, run in asked.items() if run}


def search_structure(
    client: Client, faults: Faults, maneuver: int, method: str
) -> dict[str, Any] | None:
    """Search the structure that is proposed for the maneuver, as the page does."""
    proposal = faults.check(client, "get", f"maneuvers/{maneuver}/run-proposal")
    if proposal is None:
        return None
    body = {"maneuver_ids": [maneuver], "method": method, "structure": proposal["structure"]}
    search = faults.check(client, "post", "searches", body)
    return wait_for_end(client, f"searches/{search['id']}") if search else None


def predict_flutter(client: Client, faults: Faults, *runs: int) -> dict[str, Any] | None:
    """Predict flutter from runs."""
    return _analyse(client, faults, "flutter", runs)


def fit_global_model(client: Client, faults: Faults, runs: Sequence[int]) -> dict[str, Any] | None:
    """Fit a global model to runs."""
    return _analyse(client, faults, "global-models", runs)


def _analyse(
    client: Client, faults: Faults, noun: str, runs: Sequence[int]
) -> dict[str, Any] | None:
    query = f"run_ids={','.join(map(str, runs))}"
    job = faults.check(client, "post", f"{noun}/results?{query}")
    if job is None or not _succeeds(client, faults, job, noun):
        return None
    return faults.check(client, "get", f"{noun}?{query}")


def _succeeds(client: Client, faults: Faults, job: dict[str, Any], what: str) -> bool:
    ended = wait_for_end(client, f"jobs/{job['id']}")
    if ended["state"] != "succeeded":
        faults.found.append(f"{what}: {ended['error']}")
    return ended["state"] == "succeeded"


def follow_live(client: Client, faults: Faults, maneuver: int, run: int) -> list[dict[str, Any]]:
    """Replay a maneuver as a stream with the model of a run; return its estimates in order."""
    receiver = {"name": "replay", "options": {"maneuver_id": maneuver, "speed": LIVE_SPEED}}
    body = {"run_id": run, "title": "adversary", "receiver": receiver}
    stream = faults.check(client, "post", "live/streams", body)
    if stream is None:
        return []
    path = f"live/streams/{stream['id']}"
    while client.get(path)["stream"]["status"] == "running":
        time.sleep(0.1)
    states = client.get(f"{path}/history")["states"]
    return [one["state"]["estimate"] for one in states if one["state"]["estimate"]]


def simulate_design(
    client: Client, faults: Faults, multisine: Multisine, inputs: Sequence[str], run: int
) -> dict[str, Any] | None:
    """Design the harmonics that were flown again, and simulate their flight with a run's model."""
    peaks = np.abs(multisine.commands).max(axis=0)
    top_hz = multisine.list_harmonics(len(inputs) - 1)[-1] / multisine.period
    largest = float(peaks.max())
    body = {
        "name": f"design for run {run}",
        "duration_s": multisine.period,
        "rate_hz": float(np.ceil(10 * top_hz)),
        "peaks": [largest / 2, largest, 2 * largest],
        "effort": "quick",
        "inputs": [
            {
                "name": name,
                "harmonics": multisine.list_harmonics(k),
                "relative_peak": float(peaks[k]) / largest,
            }
            for k, name in enumerate(inputs)
        ],
    }
    design = faults.check(client, "post", "designs", body)
    if design is None:
        return None
    path = f"designs/{design['id']}/preflight-simulations"
    job = faults.check(client, "post", path, {"run_id": run})
    if job is None or not _succeeds(client, faults, job, path):
        return None
    while (found := client.get(path)["items"][0])["state"] in ("queued", "running"):
        time.sleep(0.1)
    return found
