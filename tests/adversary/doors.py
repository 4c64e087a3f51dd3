"""Ways into the product, each with its defaults, through the port of the started command."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from shipped import Client

METHODS = ("OE", "FRE", "EE")


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


def run_methods(client: Client, faults: Faults, maneuver: int) -> dict[str, dict[str, Any]]:
    """Request a run by each method with nothing but its maneuver."""
    bodies = {method: {"maneuver_id": maneuver, "method": method} for method in METHODS}
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


def predict_flutter(client: Client, faults: Faults, run: int) -> dict[str, Any] | None:
    """Predict flutter from one run."""
    path = f"flutter/results?run_ids={run}"
    job = faults.check(client, "post", path)
    if job is None:
        return None
    ended = wait_for_end(client, f"jobs/{job['id']}")
    if ended["state"] != "succeeded":
        faults.found.append(f"{path}: {ended['error']}")
        return None
    return faults.check(client, "get", f"flutter?run_ids={run}")
