"""Lateral maneuvers, surfaces, sensors and channels are refused by the longitudinal model."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flexsid.errors import BadInput
from flexsid.importers.clock import Clock
from flexsid.importers.maneuver import RawChannel
from flexsid.importers.source import SourceFile
from flexsid.records.aircraft import (
    Aircraft,
    Combination,
    Sensor,
    Surface,
    get_symmetry,
)
from flexsid.records.decision import Structure
from flexsid.records.maneuver import FlightChannel, Role
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ACCELEROMETER, ATTITUDE, GYRO, VANE
from flexsid.workflow.aircraft.axes import AxisNotSupported
from flexsid.workflow.importing.flight_import import check_axes
from flexsid.workflow.measurements.measured_axis import determine_axis
from flexsid.workflow.measurements.reconstruction import ReconstructionQuery, reconstruct
from flexsid.workflow.measurements.sensor_responses import gather_sensors
from flexsid.workflow.model_structures.model_structures import check_structure
from flexsid.workflow.runs.estimation import prepare

_MODE = Structure(modes=(7,), fixed={})


@pytest.fixture
def flown(flown_file: Any, tmp_path: Any) -> Iterator[Store]:
    file = tmp_path / "flown.db"
    file.write_bytes(flown_file.read_bytes())
    opened = Store.open(f"sqlite:///{file}")
    yield opened
    opened.close()


def _run(structure: Structure = _MODE, method: Method = Method.EE) -> EstimationRun:
    return EstimationRun(maneuver_id=1, method=method, structure=structure, settings=RunSettings())


def _with(flown: Store, change: Callable[[Aircraft], Aircraft]) -> None:
    flown.aircraft.replace(change(flown.aircraft.get(1)))


@pytest.mark.parametrize("method", list(Method))
def test_longitudinal_model_of_a_lateral_maneuver_is_refused(flown: Store, method: Method) -> None:
    flown.maneuvers.replace(replace(flown.maneuvers.get(1), axis="lateral"))
    with pytest.raises(AxisNotSupported, match="maneuver 1 'flown' is lateral") as refused:
        prepare(flown, _run(method=method))
    assert refused.value.code == "axis-not-supported"
    assert refused.value.context == {"maneuver_id": 1, "axis": "lateral"}
    with pytest.raises(BadInput, match="no recorded input"):  # its surfaces are symmetric
        reconstruct(flown, ReconstructionQuery(maneuver_id=1))


@pytest.mark.parametrize(
    ("kind", "axis", "message"),
    [
        (GYRO.kind, "x", "roll rate p, not pitch rate q"),
        (GYRO.kind, "z", "yaw rate r, not pitch rate q"),
        (VANE.kind, "z", "sideslip beta, not angle of attack alpha"),
        (ATTITUDE.kind, "x", "bank angle phi, not pitch angle theta"),
    ],
)
def test_sensor_of_another_axis_is_refused_as_output(
    flown: Store, kind: str, axis: str, message: str
) -> None:
    name = {GYRO.kind: "q", VANE.kind: "alpha", ATTITUDE.kind: "theta"}[kind]

    def turn(sensor: Sensor) -> Sensor:
        return replace(sensor, name="sensor_9", axis=axis) if sensor.name == name else sensor

    _with(flown, lambda one: replace(one, sensors=tuple(map(turn, one.sensors))))
    channel = next(c for c in flown.channels.find(maneuver_id=1) if c.name == name)
    flown.channels.replace(replace(channel, name="sensor_9"))
    with pytest.raises(AxisNotSupported, match=f"'sensor_9' .*{message}"):
        prepare(flown, _run(replace(_MODE, outputs=("sensor_9", "az_egi"))))
    assert "sensor_9" not in prepare(flown, _run()).model.outputs
    assert "longitudinal" in gather_sensors(flown, flown.maneuvers.get(1)).excluded["sensor_9"]


def test_a_sensor_whose_name_contradicts_its_record_is_refused(flown: Store) -> None:
    # An aircraft stored before names were checked: a roll gyro of axis y.
    _with(
        flown,
        lambda one: replace(
            one, sensors=tuple(replace(s, name="p") if s.name == "q" else s for s in one.sensors)
        ),
    )
    channel = next(c for c in flown.channels.find(maneuver_id=1) if c.name == "q")
    flown.channels.replace(replace(channel, name="p"))
    with pytest.raises(AxisNotSupported, match=r"'p' is recorded as a gyro of axis y.*indicates x"):
        prepare(flown, _run(replace(_MODE, outputs=("p", "az_egi"))))


def test_axes_and_sides_are_parsed_from_names() -> None:
    named = {"p": "x", "p_egi": "x", "Roll_Rate": "x", "q_nose": "y", "gyro_r": "z", "rate_3": None}
    assert {name: GYRO.find_axis(name) for name in named} == named
    assert (VANE.find_axis("beta_boom"), VANE.find_axis("vane_1")) == ("z", None)
    assert ACCELEROMETER.find_axis("ay_cf") == "y"


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (("wf1s", "wf1a", "wf1l", "bfr"), ("symmetric", "antisymmetric", "single", "single")),
        (("elevator", "aileron", "rudder"), ("symmetric", "antisymmetric", "antisymmetric")),
        (("flap_left", "elevator_l", "flap_1"), ("single", "single", "symmetric")),
        (("flapl", "flapr", "tail"), ("single", "single", "symmetric")),
        (("flaps", "flapa"), ("symmetric", "antisymmetric")),
    ],
)
def test_surfaces_are_read_by_name_unless_declared(
    aircraft: Aircraft, names: tuple[str, ...], expected: tuple[str, ...]
) -> None:
    own = replace(aircraft, surfaces=tuple(Surface(name=name) for name in names))
    assert tuple(get_symmetry(own, name) for name in names) == expected
    declared = replace(
        own, surfaces=tuple(replace(one, symmetry="symmetric") for one in own.surfaces)
    )
    assert {get_symmetry(declared, name) for name in names} == {"symmetric"}


def test_antisymmetric_surface_is_refused_as_input(flown: Store) -> None:
    _with(
        flown,
        lambda one: replace(
            one,
            surfaces=tuple(
                replace(s, symmetry="antisymmetric") if s.name == "wf4s" else s
                for s in one.surfaces
            ),
        ),
    )
    with pytest.raises(AxisNotSupported, match="'wf4s' of FLEX-28 is antisymmetric"):
        prepare(flown, _run(replace(_MODE, inputs=("bfs", "wf4s"))))
    # An omitted surface still moves the aircraft: only symmetric outputs are used.
    task = prepare(flown, _run())
    assert task.model.inputs == ("bfs", "wf1s", "wf2s", "wf3s")
    assert any("wf4s is excited too" in warning for warning in task.warnings)
    with pytest.raises(AxisNotSupported, match="'az_ofl' measures"):
        prepare(flown, _run(replace(_MODE, outputs=("q", "az_ofl"))))


def test_single_surfaces_are_fitted_with_symmetric_outputs_only(flown: Store) -> None:
    _with(
        flown,
        lambda one: replace(
            one, surfaces=tuple(replace(s, symmetry="single") for s in one.surfaces)
        ),
    )
    outputs = set(prepare(flown, _run()).model.outputs)
    assert {"alpha", "q", "theta", "az_egi", "az_ofs", "s_bend1s"} <= outputs
    assert not outputs & {"az_ofl", "s_bend1l", "ay_wll"}
    with pytest.raises(AxisNotSupported, match="'s_bend1r' measures"):
        prepare(flown, _run(replace(_MODE, outputs=("q", "s_bend1r"))))
    seen = gather_sensors(flown, flown.maneuvers.get(1))
    assert "az_ofl" in seen.excluded
    assert "az_egi" in seen.model.outputs


def test_the_antisymmetric_part_of_a_pair_is_refused(flown: Store) -> None:
    half = Combination(name="az_ofa", terms=(("az_ofl", -0.5), ("az_ofr", 0.5)))
    _with(flown, lambda one: replace(one, combinations=(*one.combinations, half)))
    with pytest.raises(AxisNotSupported, match="'az_ofa' is the antisymmetric part"):
        prepare(flown, _run(replace(_MODE, outputs=("q", "az_ofa"))))


def test_undeclared_roll_motion_is_refused(
    flown: Store,
) -> None:
    _add_roll_gyro(flown, 25.0)
    with pytest.raises(AxisNotSupported, match="p is 25 times as large as the pitch rate"):
        prepare(flown, _run())
    with pytest.raises(AxisNotSupported, match="p is 25 times"):
        gather_sensors(flown, flown.maneuvers.get(1))


def test_roll_rate_of_turbulence_is_accepted(flown: Store) -> None:
    _add_roll_gyro(flown, 1.5)
    assert "p" not in prepare(flown, _run()).model.outputs


def _add_roll_gyro(flown: Store, ratio: float) -> None:
    """Record a roll rate that is a multiple of the pitch rate."""
    q = next(s for s in flown.aircraft.get(1).sensors if s.name == "q")
    _with(flown, lambda one: replace(one, sensors=(*one.sensors, replace(q, name="p", axis="x"))))
    channel = next(c for c in flown.channels.find(maneuver_id=1) if c.name == "q")
    samples = ratio * np.asarray(flown.arrays.get(channel.array))
    array = flown.arrays.put(samples, channel.unit)
    flown.channels.add(replace(channel, id=None, name="p", array=array))


def test_a_channel_of_another_unit_or_sensor_is_refused(flown: Store) -> None:
    channel = next(c for c in flown.channels.find(maneuver_id=1) if c.name == "q")
    flown.channels.replace(replace(channel, unit="deg"))
    with pytest.raises(BadInput, match=r"'q' .* recorded in deg.*gyro") as refused:
        prepare(flown, _run())
    assert refused.value.code == "unit-of-another-kind"
    flown.channels.replace(replace(channel, sensor="theta"))
    with pytest.raises(AxisNotSupported, match="recorded by sensor 'theta', not by 'q'"):
        prepare(flown, _run())


def test_undeclared_axis_raises_a_query(aircraft: Aircraft) -> None:
    rate = np.sin(np.arange(99.0))

    def flown(*inputs: str, roll: float = 0.5) -> list[tuple[FlightChannel, np.ndarray]]:
        surfaces = [(_channel(name, "deg", Role.INPUT), rate) for name in inputs]
        rates = [("q", rate), ("p", roll * rate)]
        return [*surfaces, *((_channel(name, "deg/s", Role.OUTPUT), one) for name, one in rates)]

    lateral = flown("wf1a", "wf2a")
    with pytest.raises(BadInput, match=r"wf1a, wf2a\) are antisymmetric") as asked:
        determine_axis(None, aircraft, lateral)
    assert asked.value.code == "axis-needed"
    assert determine_axis("lateral", aircraft, lateral) == "lateral"
    assert determine_axis(None, aircraft, flown("wf1s")) == "longitudinal"
    turned = tuple(replace(sensor, axis="y") for sensor in aircraft.sensors)
    with pytest.raises(BadInput, match="p is 10 times"):
        determine_axis(None, replace(aircraft, sensors=turned), flown("wf1s", roll=10.0))


@pytest.mark.parametrize(("share", "is_lateral"), [(1.0, False), (0.8, False), (0.3, True)])
def test_sides_that_move_against_each_other_raise_a_query(
    aircraft: Aircraft, share: float, is_lateral: bool
) -> None:
    moved = np.sin(np.arange(99.0))
    sides = [("wf1l", moved), ("wf1r", (2.0 * share - 1.0) * moved)]
    channels = [(_channel(name, "deg", Role.INPUT), samples) for name, samples in sides]
    if is_lateral:
        with pytest.raises(BadInput, match=r"wf1l and wf1r move against.*combined") as asked:
            determine_axis(None, aircraft, channels)
        assert asked.value.code == "axis-needed"
    else:
        assert determine_axis(None, aircraft, channels) == "longitudinal"


def test_column_named_after_another_axis_raises_a_query(aircraft: Aircraft) -> None:
    clock = Clock(start_s=0.0, rate_hz=100.0, n_samples=9)
    pitch = next(s for s in aircraft.sensors if s.kind == GYRO.kind)
    own = replace(aircraft, sensors=(replace(pitch, name="q", axis="y"),))
    source = SourceFile(name="m.csv", sha256="", arrays={})
    column = RawChannel(
        name="q",
        unit="deg/s",
        role=Role.OUTPUT,
        samples=np.zeros(9),
        clock=clock,
        field="p",
        source=source,
    )
    with pytest.raises(BadInput, match="Column 'p' has the name of a gyro of axis x") as asked:
        check_axes(own, [column])
    assert asked.value.code == "unconfirmed-axis"
    check_axes(own, [replace(column, confirmed=("other-axis",)), replace(column, field="rate")])


def _channel(name: str, unit: str, role: Role) -> FlightChannel:
    return FlightChannel(
        flight_id=1,
        name=name,
        unit=unit,
        role=role,
        rate_hz=100.0,
        start_s=0.0,
        n_samples=99,
        array="",
    )


def test_model_structures_with_lateral_channels_are_refused(flown: Store) -> None:
    own = flown.aircraft.get(1)
    lateral = replace(own, surfaces=(*own.surfaces, Surface(name="wf1a")))
    with pytest.raises(AxisNotSupported, match="'wf1a'"):
        check_structure(flown, lateral, replace(_MODE, inputs=("wf1a",)))
