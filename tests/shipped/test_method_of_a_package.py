"""A run by the estimator of an installed package, on every route and figure."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest
import shipped
from rigid_record import SHORT_PERIOD_HZ, simulate_doublet, write_record
from shipped import Client, ask_command
from vendor_package import install_package, serving_by
from waiting import wait_until

METHOD = "least-squares"
ENTRY = f"""
[project.entry-points."flexsid.estimators"]
{METHOD} = "vendor:ESTIMATOR"
[project.entry-points."flexsid.models"]
pitch = "vendor:PITCH"
"""
MODULE = """
from flexsid.workflow.fits.computation import Estimator, fit_regressions
ESTIMATOR = Estimator(title="Least squares", fit=fit_regressions)

from flexsid.sysid import GreyBox, GreyBoxParameter as Parameter
def pitch(p, condition):
    A = [[p["Z_a"], 1.0 + p["Z_q"]], [p["M_a"], p["M_q"]]]
    return A, [[p["Z_e"]], [p["M_e"]]], [[1, 0], [0, 1]], [[0], [0]]
STARTS = {"Z_a": -1.0, "Z_q": 0.0, "Z_e": 0.0, "M_a": -5.0, "M_q": -2.0, "M_e": -10.0}
PITCH = GreyBox(title="Short period", matrices=pitch, inputs={"elevator": "rad"},
                parameters=[Parameter(*one) for one in STARTS.items()],
                outputs={"alpha": "rad", "q": "rad/s"})
"""
GIVEN = {
    **{"name": "Cm_alpha", "output": "q", "input": "elevator", "channel": "q", "against": "fta"},
    **{"y": "Cm_alpha", "x": "airspeed_ratio", "derivative": "Cm_alpha", "axis": "longitudinal"},
}
"""Parameters of routes that are no id."""
SHOWN = (
    *("runs", "runs/1", "runs/1/export", "runs/1/model", "runs/facets", "jobs", "jobs/1"),
    *("maneuvers", "maneuvers/1", "aircraft/1/dashboard", "reports/run/1"),
    *(f"figures/{name}?run_id=1" for name in ("fit", "poles", "residual", "time-check")),
    *(f"{name}?run_ids=1" for name in ("comparisons", "reports/comparison", "figures/derivatives")),
    "figures/trend?run_ids=1&name=Cm_alpha",
)


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str, Path]:
    """Folder and database with two runs, and the command in the environment of the package."""
    folder = tmp_path_factory.mktemp("package")
    database = f"sqlite:///{folder / 'flexsid.db'}"
    columns = simulate_doublet()
    record, mapping = write_record(folder, columns)
    ask_command(folder, database, "import", str(record), "--mapping", str(mapping))
    program = install_package(folder, ENTRY, MODULE)
    with serving_by(program, folder, database) as client:
        for method in (METHOD, "EE"):
            body = {"maneuver_id": 1, "method": method, "structure": {"modes": []}}
            run = client.send("post", "runs", body)
            assert client.wait_for_end(f"runs/{run['id']}")["state"] == "succeeded"
    return folder, database, program


def list_addresses(client: Client) -> Iterator[str]:
    """List every address of the description that can be read, with the ids of the first records."""
    for path, methods in client.get("/api/v1/openapi.json")["paths"].items():
        if "get" not in methods or "event-stream" in str(methods["get"]["responses"]):
            continue
        asked = []
        for one in methods["get"].get("parameters", []):
            name, is_id = one["name"], one["name"].endswith(("_id", "_ids")) or one["name"] == "ids"
            value = GIVEN.get(name, "1")
            if one["in"] == "path":
                path = path.replace(f"{{{name}}}", value)
            elif one["in"] == "query" and (one.get("required") or (is_id and "run" in name)):
                asked.append(f"{name}={value}")
        yield path + ("?" + "&".join(asked) if asked else "")


def read_all(client: Client) -> dict[str, httpx2.Response]:
    """Read every address, once more when the results that it draws or lists are computed."""
    wait_until(lambda: client.request("get", "health/ready").is_success, "the dispatcher")
    addresses = list(list_addresses(client))
    responses = [client.request("get", address) for address in addresses]
    responses += [client.request("post", one) for one in addresses if "/results" in one]
    for state in ("queued", "running"):
        address = f"jobs?state={state}"
        wait_until(lambda address=address: not client.get(address)["items"], "the results")
    assert [one.text for one in responses if one.status_code >= 500] == []
    return {address: client.request("get", address) for address in addresses}


@pytest.mark.parametrize("installed", [True, pytest.param(False, marks=pytest.mark.long)])
def test_no_route_and_no_figure_fails(campaign: tuple[Path, str, Path], installed: bool) -> None:
    folder, database, program = campaign
    with serving_by(program if installed else shipped.PROGRAM, folder, database) as client:
        responses = read_all(client)
        shown = {path: client.request("get", path).status_code for path in SHOWN}
        body = {"maneuver_id": 1, "method": METHOD, "structure": {"modes": []}}
        repeated = client.request("post", "runs", body).status_code
    assert {path: one.text for path, one in responses.items() if one.status_code >= 500} == {}
    assert shown == dict.fromkeys(SHOWN, 200)
    assert repeated == (200 if installed else 422)


def test_a_model_of_a_package_is_fitted(campaign: tuple[Path, str, Path]) -> None:
    folder, database, program = campaign
    with serving_by(program, folder, database) as client:
        offered = client.get("grey-box-models")
        body = {"maneuver_id": 1, "model": "pitch"}
        job = client.send("post", "grey-box-fits", body)
        ended = client.wait_for_end(f"jobs/{job['id']}")
        assert ended["state"] == "succeeded", ended["error"]
        fit = client.get(f"grey-box-fits/{job['id']}")
    assert offered["installed"] == [{"name": "pitch", "package": "vendor 2.0"}]
    assert fit["source"] == "vendor 2.0"
    (pole,) = fit["poles"]
    frequency_hz = pole["frequency_rad_s"] / (2.0 * math.pi)
    assert frequency_hz == pytest.approx(SHORT_PERIOD_HZ, abs=0.02)
