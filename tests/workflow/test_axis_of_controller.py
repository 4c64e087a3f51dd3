"""What a controller of both axes does to the motion of one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexsid.demo.independent_surfaces import describe_controller, describe_independent
from flexsid.errors import BadInput
from flexsid.records.flutter import ControlLaw, Controller
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.workflow.flutter.controllers import interpolate_controller, select_axis_of_controller

AIRCRAFT = describe_independent()
STEMS = ("bf", "wf1", "wf2", "wf3", "wf4")
AIRSPEED = 40.0


def build_static(mixed: bool) -> Controller:
    """A law without states from pitch and roll rate to two sides, directly or by a mixer."""
    gains = ((0.2, -0.1), (0.2, 0.1))  # of q and p, left and right
    law = ControlLaw(airspeed_m_s=AIRSPEED, A=(), B=(), C=((), ()), D=gains)
    controller = Controller(
        aircraft_id=1, name="static", reads=("q", "p"), drives=("wf4l", "wf4r"), laws=(law,)
    )
    if not mixed:
        return controller
    law = replace(law, D=((0.2, 0.0), (0.0, 0.1)))
    mixer = ((1.0, -1.0), (1.0, 1.0))
    return replace(controller, laws=(law,), commands=("pitch", "roll"), mixer=mixer)


@pytest.mark.parametrize(
    "controller", [describe_controller(1), build_static(False), build_static(True)]
)
@pytest.mark.parametrize(
    ("body", "part", "motions"),
    [(LONGITUDINAL, "s", ("q", "theta")), (LATERAL, "a", ("p", "phi", "r"))],
)
def test_sides_move_as_their_parts(
    controller: Controller, body: RigidBody, part: str, motions: tuple[str, ...]
):
    inputs = tuple(f"{stem}{part}" for stem in STEMS)
    own = select_axis_of_controller(controller, AIRCRAFT, inputs, body)
    assert set(own.reads) == set(motions) & set(controller.reads)
    assert set(own.drives) <= set(inputs)
    whole, half = (interpolate_controller(one, AIRSPEED) for one in (controller, own))
    frequency = 7j

    def respond(law, signals: dict[str, float]) -> dict[str, complex]:
        y = np.array([signals.get(name, 0.0) for name in law.inputs])
        states = np.linalg.solve(frequency * np.eye(len(law.A)) - law.A, law.B @ y)
        return dict(zip(law.outputs, law.C @ states + law.D @ y, strict=True))

    rng = np.random.default_rng(3)
    signals = dict(zip(motions, rng.normal(size=len(motions)), strict=True))
    sides, parts = respond(whole, signals), respond(half, signals)
    sign = -1.0 if part == "a" else 1.0
    for name, value in parts.items():
        left, right = (sides[f"{name[:-1]}{side}"] for side in "lr")
        assert right == pytest.approx(sign * left)  # no motion of the other axis
        assert value == pytest.approx(right)


def test_a_controller_of_the_other_axis_is_refused():
    law = ControlLaw(airspeed_m_s=AIRSPEED, A=(), B=(), C=((), ()), D=((0.1,), (0.1,)))
    pitch = Controller(
        aircraft_id=1, name="pitch", reads=("q",), drives=("wf4l", "wf4r"), laws=(law,)
    )
    roll = replace(pitch, name="roll", reads=("p",))
    inputs = {part: tuple(f"{stem}{part}" for stem in STEMS) for part in "sa"}
    for controller, part, body in (
        (pitch, "a", LATERAL),
        (roll, "s", LONGITUDINAL),
        (replace(roll, name="symmetric roll"), "a", LATERAL),  # equal gains of both sides cancel
    ):
        with pytest.raises(BadInput, match=f"'{controller.name}' does not act on {body.axis}"):
            select_axis_of_controller(controller, AIRCRAFT, inputs[part], body)


def test_a_controller_of_one_axis_stays_as_it_is():
    inputs = tuple(f"{stem}s" for stem in STEMS)
    law = ControlLaw(airspeed_m_s=AIRSPEED, A=(), B=(), C=((),), D=((0.1,),))
    controller = Controller(
        aircraft_id=1, name="pitch", reads=("q",), drives=("wf4s",), laws=(law,)
    )
    assert select_axis_of_controller(controller, AIRCRAFT, inputs, LONGITUDINAL) is controller
