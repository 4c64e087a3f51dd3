"""Channels that views of a maneuver show first."""

from __future__ import annotations

from dataclasses import replace

import pytest

from flexsid.demo.independent_surfaces import describe_independent
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Excitation, Role
from flexsid.records.views import DefaultChannels
from flexsid.workflow.views.maneuver import select_default_channels

SINGLES = {
    surface.name: Role.INPUT
    for surface in describe_independent().surfaces
    if surface.symmetry == "single"
}


def _select(
    axis: str, aircraft: Aircraft | None = None, excitation: Excitation | None = None
) -> DefaultChannels:
    described = describe_independent() if aircraft is None else aircraft
    sensors = {sensor.name: Role.OUTPUT for sensor in described.sensors}
    return select_default_channels(described, axis, excitation, {**SINGLES, **sensors})


@pytest.mark.parametrize(
    ("axis", "outputs", "rates", "part"),
    [
        ("longitudinal", ("alpha", "q", "theta", "az_egi"), ("q",), "s"),
        ("lateral", ("beta", "p", "r", "phi"), ("p",), "a"),
    ],
)
def test_motion_of_the_axis_is_shown_first(
    axis: str, outputs: tuple[str, ...], rates: tuple[str, ...], part: str
):
    shown = _select(axis)
    assert shown.outputs[: len(outputs)] == outputs
    assert shown.rates == rates
    assert shown.inputs == tuple(f"{name}{part}" for name in ("bf", "wf1", "wf2", "wf3", "wf4"))
    other = "a" if part == "s" else "s"
    for pair in ("bf", "az_of"):
        own, foreign = (shown.combinations.index(f"{pair}{end}") for end in (part, other))
        assert own < foreign


def test_combined_maneuver_shows_both_axes_and_single_surfaces():
    shown = _select("combined")
    assert shown.outputs[:5] == ("alpha", "beta", "q", "p", "r")
    assert shown.rates == ("q", "p")
    assert shown.inputs == tuple(SINGLES)


def test_surfaces_excited_on_their_own_stay_apart():
    excitation = Excitation(period_s=24.0, harmonics={"wf1l": (5,)}, start_s=0.0)
    shown = _select("lateral", excitation=excitation)
    assert {"wf1l", "wf1r"} <= set(shown.inputs)
    assert "wf2a" in shown.inputs


def test_outputs_of_unknown_type_are_shown_without_any_other():
    described = describe_independent()
    foreign = tuple(replace(sensor, kind="of-a-removed-package") for sensor in described.sensors)
    shown = _select("lateral", replace(described, sensors=foreign))
    assert shown.outputs == tuple(sensor.name for sensor in described.sensors)
    assert shown.rates == shown.outputs[:1]
