"""The mathematics of flexsid: arrays and frozen values, free of web, database and plots.

The main names can be imported from here, e.g. ``from flexsid.sysid import maximize``; a
module is loaded on first use of its name.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from flexsid.sysid.estimation.equation_error import equation_error
    from flexsid.sysid.estimation.estimate import Estimate
    from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
    from flexsid.sysid.estimation.likelihood import FitSettings, maximize
    from flexsid.sysid.estimation.output_error import output_error
    from flexsid.sysid.estimation.parameters import select_parameters
    from flexsid.sysid.excitation.multisine import assign_harmonics, design_multisine
    from flexsid.sysid.model.aeroelastic import AeroelasticModel, StateSpace
    from flexsid.sysid.model.airspeed import AIRSPEED
    from flexsid.sysid.model.condition import FlightCondition
    from flexsid.sysid.model.derivatives import DerivativeTable
    from flexsid.sysid.model.instruments import Instrument
    from flexsid.sysid.model.lateral import LATERAL
    from flexsid.sysid.model.longitudinal import (
        LONGITUDINAL,
        accelerometer_row,
        attitude_row,
        gyro_row,
        vane_row,
    )
    from flexsid.sysid.model.sensors import stack_rows, strain_row
    from flexsid.sysid.model.time_response import time_response
    from flexsid.sysid.modes.shapes import StructuralModes
    from flexsid.sysid.signals import FrequencyData, FrequencyResponse, TimeHistory
    from flexsid.sysid.spectra.fourier import finite_fourier_transform
    from flexsid.sysid.spectra.response import estimate_bare_airframe_responses
    from flexsid.sysid.stability.root_tracking import track_roots
    from flexsid.sysid.stability.state_family import Aeroelastic

_PLACES = {
    "equation_error": "estimation.equation_error",
    "Estimate": "estimation.estimate",
    "frequency_response_error": "estimation.frequency_response_error",
    "FitSettings": "estimation.likelihood",
    "maximize": "estimation.likelihood",
    "output_error": "estimation.output_error",
    "select_parameters": "estimation.parameters",
    "assign_harmonics": "excitation.multisine",
    "design_multisine": "excitation.multisine",
    "AeroelasticModel": "model.aeroelastic",
    "StateSpace": "model.aeroelastic",
    "FlightCondition": "model.condition",
    "DerivativeTable": "model.derivatives",
    "Instrument": "model.instruments",
    "accelerometer_row": "model.longitudinal",
    "attitude_row": "model.longitudinal",
    "gyro_row": "model.longitudinal",
    "vane_row": "model.longitudinal",
    "LONGITUDINAL": "model.longitudinal",
    "LATERAL": "model.lateral",
    "AIRSPEED": "model.airspeed",
    "stack_rows": "model.sensors",
    "strain_row": "model.sensors",
    "time_response": "model.time_response",
    "StructuralModes": "modes.shapes",
    "FrequencyData": "signals",
    "FrequencyResponse": "signals",
    "TimeHistory": "signals",
    "finite_fourier_transform": "spectra.fourier",
    "estimate_bare_airframe_responses": "spectra.response",
    "track_roots": "stability.root_tracking",
    "Aeroelastic": "stability.state_family",
}

__all__ = [
    "AIRSPEED",
    "LATERAL",
    "LONGITUDINAL",
    "Aeroelastic",
    "AeroelasticModel",
    "DerivativeTable",
    "Estimate",
    "FitSettings",
    "FlightCondition",
    "FrequencyData",
    "FrequencyResponse",
    "Instrument",
    "StateSpace",
    "StructuralModes",
    "TimeHistory",
    "accelerometer_row",
    "assign_harmonics",
    "attitude_row",
    "design_multisine",
    "equation_error",
    "estimate_bare_airframe_responses",
    "finite_fourier_transform",
    "frequency_response_error",
    "gyro_row",
    "maximize",
    "output_error",
    "select_parameters",
    "stack_rows",
    "strain_row",
    "time_response",
    "track_roots",
    "vane_row",
]


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"flexsid.sysid has no '{name}'")
    return getattr(import_module(f"flexsid.sysid.{_PLACES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
