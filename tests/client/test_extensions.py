"""Packages that extend flexsid: the template is built, installed and used; failures are named."""

from __future__ import annotations

import importlib
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from interpreter import make_interpreter
from ports import find_free_port
from scipy.signal import butter, lfilter, lsim

from flexsid.client import Workbench
from flexsid.errors import BadInput
from flexsid.extensions import ExtensionFailed
from flexsid.importers.formats.readers import load_formats, read_file
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.live import StreamChannel, StreamHeader
from flexsid.records.maneuver import Role
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import Mounting
from flexsid.sysid.model.sensor_models import find_sensor_model, load_sensor_models
from flexsid.workflow.fits.computation import find_estimator, load_estimators

TEMPLATE = Path(__file__).parents[2] / "examples" / "extension"
TRUE = {"CZ_alpha": -5.6, "CZ_q": -8.0, "CZ_de": -0.45, "Cm_alpha": -1.3, "Cm_q": -25.0,
        "Cm_de": -1.7}  # fmt: skip
MAPPING = """
[aircraft]
name = "Transport"
geometry = { area = { value = 39.0, unit = "m2" }, chord = { value = 1.98, unit = "m" }, \
span = { value = 19.8, unit = "m" } }
[aircraft.mass]
fuel = [0.5]
mass = { values = [4600.0], unit = "kg" }
pitch_inertia = { values = [32000.0], unit = "kg*m2" }
x_cg = { values = [0.0], unit = "m" }
[[aircraft.surfaces]]
name = "de"
[[aircraft.sensors]]
name = "alpha"
kind = "vane"
[[aircraft.sensors]]
name = "qdot"
kind = "pitch-acceleration"
[flight]
number = 1
[maneuver]
label = "3-2-1-1"
axis = "longitudinal"
[maneuver.condition]
airspeed = { value = 70.0, unit = "m/s" }
density = { value = 1.0, unit = "kg/m3" }
alpha = { value = 0.0, unit = "rad" }
[time]
column = "t"
[[channels]]
column = "de"
unit = "rad"
role = "input"
[[channels]]
column = "alpha"
unit = "rad"
role = "output"
[[channels]]
column = "qdot"
unit = "rad/s2"
role = "output"
"""


def fly() -> dict[str, np.ndarray]:
    """The short period of a rigid transport in a 3-2-1-1."""
    time = np.arange(0.0, 30.0, 0.02)
    steps = np.zeros(time.size)
    for start, stop, sign in ((2.0, 3.5, 1), (3.5, 4.5, -1), (4.5, 5.0, 1), (5.0, 5.5, -1)):
        steps[(time >= start) & (time < stop)] = 0.04 * sign
    numerator, denominator = butter(2, 3.0, fs=50.0)
    de = lfilter(numerator, denominator, steps)
    force, rate = 0.5 * 70.0**2 * 39.0, 1.98 / 140.0
    z, m = force / (4600.0 * 70.0), force * 1.98 / 32000.0
    A = np.array(
        [[z * TRUE["CZ_alpha"], z * TRUE["CZ_q"] * rate + 1.0],
         [m * TRUE["Cm_alpha"], m * TRUE["Cm_q"] * rate]]
    )  # fmt: skip
    B = np.array([[z * TRUE["CZ_de"]], [m * TRUE["Cm_de"]]])
    system = (A, B, np.stack([[1.0, 0.0], A[1]]), np.stack([[0.0], B[1]]))
    _, outputs, _ = lsim(system, de, time)
    return {"t": time, "de": de, "alpha": outputs[:, 0], "qdot": outputs[:, 1]}


@pytest.fixture
def server(database_url: str, tmp_path: Path) -> Iterator[str]:
    """A server into whose environment the template was installed."""
    target = tmp_path / "installed"
    options = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check")
    install = (sys.executable, "-m", "pip", "install", "--quiet", *options, "--target", target)
    subprocess.run([*install, str(TEMPLATE)], check=True)
    port = find_free_port()
    start = "import sys; from flexsid.cli.main import main; sys.exit(main(sys.argv[1:]))"
    process = subprocess.Popen(
        [make_interpreter(tmp_path, target), "-c", start, "serve", "--database", database_url],
        env={**os.environ, "FLEXSID_PORT": str(port)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert f":{port}" in process.stdout.readline()
    yield f"http://127.0.0.1:{port}"
    process.send_signal(signal.SIGTERM)
    process.wait()
    process.stdout.close()


def test_the_template_has_a_receiver(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(TEMPLATE)
    example = importlib.import_module("flexsid_example")
    channel = StreamChannel(name="q", unit="rad/s", role=Role.OUTPUT, rate_hz=100.0)
    header = StreamHeader(channels=(channel,), frame_s=0.05)
    options = example.NOISE.options(std=0.2)
    source = pickle.loads(pickle.dumps(example.NOISE.open(None, options, header)))
    frames = list(islice(source.receive(6), 2))
    assert [frame.number for frame in frames] == [7, 8]
    assert frames[1].time_s == pytest.approx(0.4)
    assert frames[0].samples[0].shape == (5, 1)


@pytest.mark.parametrize("backend", ["sqlite"])
def test_the_template_adds_a_sensor_and_a_file_format(server: str, tmp_path: Path) -> None:
    receivers = {one["name"]: one for one in Workbench(server).live.receivers()}
    assert receivers["noise"]["options"][0]["default"] == 0.01
    columns = fly()
    file, mapping = tmp_path / "flight.raw", tmp_path / "mapping.toml"
    content = np.stack(list(columns.values()), axis=1).astype("<f8").tobytes()
    file.write_bytes(b"RAW " + " ".join(columns).encode() + b"\n" + content)
    mapping.write_text(MAPPING)
    workbench = Workbench(server)
    maneuver = workbench.import_maneuver(file, mapping=mapping, confirmed=True)
    run = workbench.submit(maneuver, "EE", modes=[], band_hz=[0.05, 2.0])
    workbench.wait(run, show_progress=False)
    found = workbench.parameters(run)
    for name in ("CZ_alpha", "Cm_alpha", "Cm_q", "Cm_de"):  # what both outputs identify
        assert found.loc[name, "value"] == pytest.approx(TRUE[name], rel=0.03), name


@pytest.fixture
def install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str, str, str], None]]:
    """Return a function that installs a package with one entry point and a module."""

    def clear() -> None:
        importlib.invalidate_caches()
        load_sensor_models.cache_clear()
        load_formats.cache_clear()
        load_estimators.cache_clear()

    def add(group: str, value: str, module: str) -> None:
        (tmp_path / "vendor_module.py").write_text(module)
        metadata = tmp_path / "vendor-2.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: vendor\nVersion: 2.0\n")
        (metadata / "entry_points.txt").write_text(f"[{group}]\nadded = vendor_module:{value}\n")
        monkeypatch.syspath_prepend(tmp_path)
        clear()

    yield add
    sys.modules.pop("vendor_module", None)
    monkeypatch.undo()
    clear()


@pytest.fixture
def flown(flown_url: str) -> Iterator[Store]:
    with closing(Store.open(flown_url)) as store:
        yield store


SENSOR = """
from flexsid.sysid.model.sensor_models import SensorModel
import numpy as np
ADDED = SensorModel(kind={kind!r}, units=({unit!r},), noise_std=1.0, senses="rotation",
                    rows={{"longitudinal": {{"y": lambda at, condition: {row}}}}})
"""


@pytest.mark.parametrize(
    ("module", "problem"),
    [
        ("import absent", "package vendor 2.0, which extends flexsid, fails .*absent"),
        ("ADDED = 3", "package vendor 2.0 .*is a int, expected a SensorModel"),
        (SENSOR.format(kind="gyro", unit="rad/s", row=0), "vendor 2.0 adds .*'gyro'.*flexsid has"),
        (SENSOR.format(kind="probe", unit="furlong", row=0), "furlong"),
    ],
)
def test_a_package_that_fails_is_named(install, module: str, problem: str) -> None:
    install("flexsid.sensors", "ADDED", module)
    with pytest.raises((ExtensionFailed, BadInput), match=problem):
        load_sensor_models()


@pytest.mark.parametrize("row", ["np.zeros((4, 7))", "np.full((4, 2), np.nan)", "1 / 0"])
def test_an_invalid_row_names_its_package(install, row: str) -> None:
    install("flexsid.sensors", "ADDED", SENSOR.format(kind="probe", unit="rad", row=row))
    at = Mounting((0.0, 0.0, 0.0), np.zeros((3, 0)), np.zeros((3, 0)), np.zeros(0))
    condition = FlightCondition(
        airspeed=70.0, density=1.0, mass=1.0, pitch_inertia=1.0, area=1.0, chord=1.0
    )
    with pytest.raises(ExtensionFailed, match=r"package vendor 2\.0"):
        find_sensor_model("probe").build_row("y", LONGITUDINAL, at, condition)


def test_a_reader_that_fails_names_its_package(install, tmp_path: Path) -> None:
    module = (
        "from flexsid.importers.formats.readers import FileFormat\n"
        "ADDED = FileFormat(name='log', suffixes=('.log',), recognises=lambda head: True,\n"
        "                   read=lambda path: iter([1 / 0]))\n"
    )
    install("flexsid.importers", "ADDED", module)
    file = tmp_path / "flight.log"
    file.write_bytes(b"x")
    with pytest.raises(BadInput, match=r"flight\.log: .*in the package vendor 2\.0"):
        list(read_file(file, file.name))


@pytest.mark.parametrize("backend", ["sqlite"])
def test_an_estimator_of_a_package_computes_runs(install, flown: Store) -> None:
    module = (
        "from flexsid.workflow.fits.computation import Estimator, fit_regressions\n"
        "def fit(task, report):\n"
        "    if task.settings.max_iterations == 1: raise ValueError('no iteration left')\n"
        "    return fit_regressions(task, report)\n"
        "ADDED = Estimator(title='Least squares', fit=fit)\n"
    )
    install("flexsid.estimators", "ADDED", module)
    method = Method("added")
    found = []
    for one in (method, Method.EE):
        run = EstimationRun(
            maneuver_id=1,
            method=one,
            structure=Structure(modes=(7,), fixed={}),
            settings=RunSettings(),
        )
        found.append(execute_run(flown, run, RUN, lambda progress: None))
    assert flown.runs.get(found[0].id or 0).method == "added"
    values = [{p.name: p.value for p in run.result.parameters} for run in found if run.result]
    assert values[0] == values[1]
    assert find_estimator(method).package == "vendor 2.0"
    failed = execute_run(
        flown,
        replace(run, method=method, settings=RunSettings(max_iterations=1)),
        RUN,
        lambda progress: None,
    )
    assert failed.error is not None
    assert failed.error["code"] == "extension-failed"
    assert "package vendor 2.0" in failed.error["message"]
    with pytest.raises(ValueError, match="absent"):
        Method("absent")


def test_an_unknown_sensor_type_lists_those_that_exist() -> None:
    with pytest.raises(BadInput, match="no type of sensor 'probe'; types are accelerometer, gyro"):
        find_sensor_model("probe")
