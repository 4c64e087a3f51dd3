"""JSBSim flies the exported rigid aircraft, and its poles are those of the identified models."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import jsbsim
import numpy as np
import pytest

from flexsid.demo import transport
from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.sysid.exchange.jsbsim import write_jsbsim
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import compute_standard_altitude, compute_standard_density
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.reduction import residualize
from flexsid.workflow.aircraft.aircraft_models import build_model, define_outputs
from flexsid.workflow.runs.exports import load_identified_model, write_jsbsim_aircraft

_STEP_S = 0.0005  # forces of JSBSim are a step late: an error of pole times step
_FLOWN_S = 20.0
_INPUT_RAD = 0.002
_STATES = {
    "longitudinal": ("velocities/u-aero-fps", "velocities/w-aero-fps", "velocities/q-rad_sec",
                     "attitude/theta-rad"),
    "lateral": ("velocities/v-aero-fps", "velocities/p-rad_sec", "velocities/r-rad_sec",
                "attitude/phi-rad"),
}  # fmt: skip


def fly(content: bytes, folder: Path, surfaces: Sequence[str]) -> dict[str, np.ndarray]:
    """Fly square waves of different frequencies, and fit a linear system to each axis."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        archive.extractall(folder)
        (model,) = {Path(name).parent.name for name in archive.namelist()}
    simulator = jsbsim.FGFDMExec(str(folder))
    simulator.set_debug_level(0)
    assert simulator.load_model(model)
    assert simulator.load_ic("trim.xml", True)
    simulator.set_dt(_STEP_S)
    assert simulator.run_ic()
    names = [name for axis in _STATES.values() for name in axis]
    frequencies = 0.23 + 0.13 * np.arange(len(surfaces))
    inputs, states = [], []
    for time in np.arange(0.0, _FLOWN_S, _STEP_S):
        inputs.append(_INPUT_RAD * np.sign(np.sin(2.0 * np.pi * frequencies * time)))
        for surface, value in zip(surfaces, inputs[-1], strict=True):
            simulator[f"fcs/{surface}-rad"] = float(value)
        assert simulator.run()
        states.append([simulator[name] for name in names])
    x, u = np.array(states), np.array(inputs)
    assert np.isfinite(x).all()
    return {
        axis: _fit_poles(x[:, [names.index(name) for name in own]], u)
        for axis, own in _STATES.items()
    }


def _fit_poles(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    columns = np.hstack([x[:-1], u[1:], np.ones((len(x) - 1, 1))])
    steps = np.linalg.lstsq(columns, x[1:], rcond=None)[0].T[:, : x.shape[1]]
    return np.log(np.linalg.eigvals(steps).astype(complex)) / _STEP_S


def check_poles(model: AeroelasticModel, table: DerivativeTable, flown: np.ndarray) -> None:
    """Compare all but the slow poles, which the speed changes and a round earth moves."""
    poles = np.linalg.eigvals(model.state_space(table).A)
    fast = poles[np.abs(poles) > 0.1]
    assert fast.size > 0
    for pole in fast:
        assert np.min(np.abs(flown - pole)) < 0.01 * abs(pole), pole


def test_both_axes_fly_with_their_poles(tmp_path: Path):
    aircraft = transport.describe_transport()
    condition = replace(transport._CONDITION, thrust_n=4000.0)
    models, tables = [], []
    for body, inputs in (
        (LONGITUDINAL, ("elevator",)),
        (LATERAL, ("aileron_a", "rudder")),
    ):
        outputs = define_outputs(aircraft, ["theta" if body is LONGITUDINAL else "phi"])
        models.append(build_model(aircraft, condition, transport._RIGID, inputs, outputs, body))
        true = transport.TRUE[body.axis]
        tables.append(DerivativeTable.from_names((), inputs, true, body))
    at = models[0].condition
    altitude = compute_standard_altitude(at.density)
    content = write_jsbsim("Transport <1>", at, altitude, tables, "A & B")
    flown = fly(content, tmp_path, ["elevator", "aileron_a", "rudder"])
    for model, table in zip(models, tables, strict=True):
        check_poles(model, table, flown[model.body.axis])


@pytest.mark.parametrize("backend", ["sqlite"])
def test_runs_of_two_maneuvers_give_both_axes(store: Store, tmp_path: Path):
    transport.add_transport(store)
    runs = []
    for maneuver in store.maneuvers.find()[:2]:  # one of each axis
        run = EstimationRun(
            maneuver_id=maneuver.id or 0,
            method=Method.OE,
            structure=Structure(fixed={}, axis=maneuver.axis),
            settings=RunSettings(band_hz=(0.1, 2.0)),
        )
        execute_run(store, run, RUN, lambda progress: None)
        runs.append(store.runs.find()[-1])
    assert [run.structure.axis for run in runs] == ["longitudinal", "lateral"]
    first, second = (run.id or 0 for run in runs)
    models = [load_identified_model(store, run) for run in runs]
    surfaces = [name for found in models for name in found.model.inputs]
    for ids in ((first, second), (second, first)):
        folder = tmp_path / str(ids[0])
        flown = fly(write_jsbsim_aircraft(store, *ids), folder, surfaces)
        for found in models:
            check_poles(found.model, found.derivatives, flown[found.model.body.axis])


@pytest.mark.parametrize("backend", ["sqlite"])
def test_modes_of_a_run_are_residualised(flown_url: str, tmp_path: Path):
    store = Store.open(flown_url)
    found = load_identified_model(store, store.runs.get(1))
    model = found.model
    table = residualize(found.derivatives, model.modes, model.condition, ())
    rigid = model.with_modes(0)
    flown = fly(write_jsbsim_aircraft(store, 1), tmp_path, table.inputs)
    check_poles(rigid, table, flown["longitudinal"])
    with pytest.raises(BadInput, match="both of the longitudinal axis"):
        write_jsbsim_aircraft(store, 1, 1)
    store.close()


@pytest.mark.parametrize("altitude", [-900.0, 0.0, 3210.0, 10_900.0])
def test_altitude_and_density_of_the_standard_atmosphere_agree(altitude: float):
    assert compute_standard_altitude(compute_standard_density(altitude)) == pytest.approx(
        altitude, abs=1e-6
    )


def test_a_density_above_the_troposphere_is_refused():
    with pytest.raises(BadInput, match="outside the troposphere"):
        compute_standard_altitude(0.2)
