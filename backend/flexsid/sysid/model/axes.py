"""The axes that a model can describe, by name."""

from __future__ import annotations

from typing import Literal

from flexsid.sysid.model.airspeed import AIRSPEED
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody

RIGID_BODIES: dict[str, RigidBody] = {body.axis: body for body in (LONGITUDINAL, LATERAL, AIRSPEED)}

ModelAxis = Literal["longitudinal", "lateral", "longitudinal-airspeed"]
"""Axis of a model; a combined maneuver has a longitudinal and a lateral one."""
