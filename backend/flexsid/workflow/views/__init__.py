"""Read from the store what figures draw: finished numbers, nothing drawn."""

from flexsid.workflow.views.campaign import envelope
from flexsid.workflow.views.run import (
    derivatives,
    fit,
    iterations,
    parameter_correlation,
    poles,
    residual,
)

__all__ = [
    "derivatives",
    "envelope",
    "fit",
    "iterations",
    "parameter_correlation",
    "poles",
    "residual",
]
