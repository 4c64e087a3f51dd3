"""Views: data of figures, read from the database."""

from flexsid.workflow.views.campaign import envelope
from flexsid.workflow.views.channels import read_channels
from flexsid.workflow.views.loops import loops
from flexsid.workflow.views.maneuver import POINTS, signal_to_noise, spectrum, time_history
from flexsid.workflow.views.plot_matrix import Domain, plot_matrix
from flexsid.workflow.views.response import bode
from flexsid.workflow.views.run import (
    derivatives,
    fit,
    iterations,
    parameter_correlation,
    poles,
    residual,
)
from flexsid.workflow.views.time_check import time_check

__all__ = [
    "POINTS",
    "Domain",
    "bode",
    "derivatives",
    "envelope",
    "fit",
    "iterations",
    "loops",
    "parameter_correlation",
    "plot_matrix",
    "poles",
    "read_channels",
    "residual",
    "signal_to_noise",
    "spectrum",
    "time_check",
    "time_history",
]
