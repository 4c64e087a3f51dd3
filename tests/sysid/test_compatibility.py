"""Faults of sensors by kinematics, on records of a truth that shares no code with the search."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import rigid_record
from kinematic_flight import (
    ACCELEROMETER,
    AREA,
    AXES,
    CHORD,
    DENSITY,
    NOISE,
    SENSORS,
    SPAN,
    VANE,
    PlantedFault,
    record_flight,
)

from flexsid.errors import NotIdentifiable
from flexsid.sysid.compatibility.fault_search import (
    Compatibility,
    check_compatibility,
    list_candidates,
)
from flexsid.sysid.compatibility.kinematics import CompatibilitySensor, FlightRecord
from flexsid.sysid.compatibility.likelihood import (
    FaultCandidate,
    SensorFaultKind,
    build_likelihood,
)
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.sensor_models import AIRSPEED_PROBE

DELAY, SCALE, ARM, AIRSPEED = SensorFaultKind
DEGREES = 180.0 / np.pi


def build_record(
    seed: int, axis: str, fault: PlantedFault | None = None, noise: float = 1.0
) -> FlightRecord:
    columns = record_flight(seed, axis, fault, noise=noise)
    airspeed = _build_sensor("airspeed", AIRSPEED_PROBE.kind, "x", columns)
    sensors = [_build_sensor(name, *SENSORS[name], columns) for name in AXES[axis]]
    condition = FlightCondition(
        airspeed=float(columns["airspeed"].mean()),
        density=DENSITY,
        mass=900.0,
        pitch_inertia=1500.0,
        area=AREA,
        chord=CHORD,
        span=SPAN,
        alpha=0.05,
    )
    if axis == "combined":  # with a forward accelerometer, which measures its derivative
        sensors.append(airspeed)
    return FlightRecord(tuple(sensors), condition, airspeed)


def _build_sensor(
    name: str, kind: str, axis: str, columns: dict[str, np.ndarray]
) -> CompatibilitySensor:
    place = {"vane": VANE, "accelerometer": ACCELEROMETER}.get(kind, (0.0, 0.0, 0.0))
    return CompatibilitySensor(name, kind, axis, place, columns["t"], columns[name], NOISE[name])


@cache
def check(seed: int, axis: str, fault: PlantedFault | None = None) -> Compatibility:
    return check_compatibility([build_record(seed, axis, fault)])


@pytest.mark.parametrize("axis", ["longitudinal", "lateral", "combined"])
def test_sensors_of_one_motion_have_no_fault(axis: str) -> None:
    found = check(1, axis)
    assert found.faults == ()
    assert all(found.checked.values())


@pytest.mark.parametrize(
    ("axis", "fault", "kind", "value"),
    [
        ("longitudinal", PlantedFault("alpha", delay_s=0.022), DELAY, 0.022),
        ("longitudinal", PlantedFault("alpha", delay_s=0.22), DELAY, 0.22),
        ("longitudinal", PlantedFault("alpha", scale=1.15), SCALE, 1.15),
        ("longitudinal", PlantedFault("az", scale=9.80665), SCALE, 9.80665),
        ("longitudinal", PlantedFault("theta", scale=1 / DEGREES), SCALE, 1 / DEGREES),
        ("longitudinal", PlantedFault("alpha", arm=2.0), ARM, 2.0),
        ("lateral", PlantedFault("r", scale=-1.0), SCALE, -1.0),
        ("lateral", PlantedFault("ay", arm=1.5), ARM, 1.5),
        ("combined", PlantedFault("airspeed", scale=0.857), AIRSPEED, 0.857),
    ],
    ids=lambda one: one.sensor if isinstance(one, PlantedFault) else str(one),
)
def test_a_planted_fault_is_the_only_one_found(
    axis: str, fault: PlantedFault, kind: SensorFaultKind, value: float
) -> None:
    (found,) = check(1, axis, fault).faults
    named = {
        (one.candidate.kind, one.candidate.channel): one for one in (found, *found.inseparable)
    }
    one = named[kind, fault.sensor]
    assert abs(one.value - value) < 2.5 * one.std
    assert one.std < 0.3 * abs(value)
    assert len(named) == 1 or kind is ARM  # the place of a vane, or of the accelerometer


def test_a_wrong_unit_is_named_in_a_short_record_of_small_redundancy() -> None:
    # The accelerometer has three degrees of freedom of its own: what chance adds to its residual
    # is no noise. The ratio of airspeeds that would explain the same is that of no unit.
    columns = rigid_record.simulate(
        12.0, lambda time: rigid_record.make_pulses(time, (0.3, 1), (0.3, -1))
    )
    columns["az"] *= 9.80665
    noise = {**rigid_record.NOISE, "az": 9.80665 * rigid_record.NOISE["az"]}
    sensors = tuple(
        CompatibilitySensor(
            *(name, *SENSORS[name], (0.0, 0.0, 0.0)), columns["t"], columns[name], noise[name]
        )
        for name in ("alpha", "q", "theta", "az")
    )
    condition = FlightCondition(
        airspeed=rigid_record.AIRSPEED,
        density=rigid_record.DENSITY,
        mass=rigid_record.MASS,
        pitch_inertia=rigid_record.INERTIA,
        area=rigid_record.AREA,
        chord=rigid_record.CHORD,
        span=rigid_record.SPAN,
    )
    (found,) = check_compatibility([FlightRecord(sensors, condition)]).faults
    assert found.candidate == FaultCandidate(SCALE, "az")
    assert found.inseparable == ()
    assert abs(found.value - 9.80665) < 2.5 * found.std


def test_maneuvers_are_compared_together() -> None:
    fault = PlantedFault("alpha", scale=1.05)
    records = [build_record(seed, "longitudinal", fault) for seed in (1, 2)]
    (alone,) = check_compatibility(records[:1]).faults
    (together,) = check_compatibility(records).faults
    assert together.candidate == alone.candidate
    assert together.gain > 1.4 * alone.gain
    assert abs(together.value - 1.05) < 2.5 * together.std


def test_kinematics_of_any_amplitude_are_exact() -> None:
    record = build_record(2, "combined", noise=0.0)
    likelihood = build_likelihood([record])
    n_values = likelihood.n_frequencies * len(likelihood.names)
    assert likelihood.compute_cost({}) < 0.05 * n_values  # 1 is the noise


def test_slopes_of_the_likelihood_are_those_of_differences() -> None:
    likelihood = build_likelihood([build_record(3, "combined")])
    candidates = list_candidates(likelihood.parts[0].record)
    assert {one.kind for one in candidates} == set(SensorFaultKind)
    values = {one: one.advance(one.neutral, 1e-3) for one in candidates}
    cost = likelihood.compute_cost(values)
    linear = likelihood.linearize(values, candidates)
    for one, (step, lower, _) in zip(candidates, linear, strict=True):
        slope = -2.0 * (cost - lower) / step
        ahead, behind = (
            likelihood.compute_cost({**values, one: one.advance(values[one], change)})
            for change in (1e-4, -1e-4)
        )
        assert slope == pytest.approx((ahead - behind) / 2e-4, rel=2e-2, abs=1.0), one


def test_standard_errors_are_those_of_repeated_records() -> None:
    likelihoods = [build_likelihood([build_record(seed, "longitudinal")]) for seed in range(6)]
    for one in (FaultCandidate(DELAY, "alpha"), FaultCandidate(SCALE, "az")):
        away = []
        for likelihood in likelihoods:
            values, _ = likelihood.fit({one: one.neutral}, (one,))
            change = np.log(values[one]) if one.is_ratio else values[one]
            away.append(change / likelihood.estimate_std(values)[one])
        assert 0.4 < np.sqrt(np.mean(np.square(away))) < 1.4


def test_the_window_has_its_derivative() -> None:
    record = build_record(1, "longitudinal")
    record = FlightRecord(record.sensors, record.condition, gaps=((6.0, 6.5),))
    difference = np.gradient(record.window, record.step_s)
    np.testing.assert_allclose(record.window_rate, difference, atol=0.3)
    assert not record.window[(record.time > 6.0) & (record.time < 6.5)].any()


def test_one_sensor_for_each_motion_cannot_be_compared() -> None:
    record = build_record(1, "longitudinal").select(frozenset({"alpha", "q"}))
    with pytest.raises(NotIdentifiable, match="2 sensors for 2 motions"):
        check_compatibility([record])


def test_noise_alone_is_no_fault() -> None:
    record = build_record(1, "longitudinal")
    rng = np.random.default_rng(1)
    quiet = tuple(
        CompatibilitySensor(
            *(one.name, one.kind, one.axis, one.position, one.time),
            one.noise_std * rng.normal(size=one.samples.size),
            one.noise_std,
        )
        for one in record.sensors
    )
    assert check_compatibility([FlightRecord(quiet, record.condition)]).faults == ()
