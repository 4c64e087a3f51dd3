"""Request models of computed predictions: planform, surfaces, Mach number, reduced frequencies."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from flexsid.api.models.requests import Number, Request, Text, Title
from flexsid.request_models import body_of
from flexsid.workflow.modal_data.computed_predictions import (
    PlanformPanel,
    PlanformSurface,
    PredictionRequest,
)


@body_of(PlanformPanel)
class PanelRequest(Request):
    """A trapezium of the right half in structural axes (X aft, Y right, Z up). [m]

    ``left`` and ``right`` are the leading edges of its chords, left to right as seen from behind.
    """


@body_of(PlanformSurface)
class PlanformSurfaceRequest(Request):
    """A surface of the aircraft by Y of its ends [m] and its hinge as fraction of the chord."""


class SaveGlobalPredictionRequest(Request):
    """Name of the prediction, and the condition: a value of every variable in SI.

    It is tabulated over the flown fuel weights, where fuel is a variable, whose value is then not
    used. By default the mean condition of the runs.
    """

    source: Title
    condition: Annotated[tuple[Number, ...], Field(max_length=5)] = ()


class GlobalModelVersionRequest(Request):
    """Label and note of a new version of a global model."""

    label: Title
    note: Text = ""


@body_of(PredictionRequest)
class ComputePredictionRequest(Request):
    """A prediction to compute from panels, or from the CAERO1 entries of a Nastran deck.

    ``source`` names it. ``axis`` is that of the derivatives; modes are the lowest eight of its
    symmetry by default, and antisymmetric surfaces are positive with the right trailing edge down.
    ``reference_k`` is the reduced frequency of the tabulated derivatives: 0, or that of the mode
    that flutters.
    """

    def to_request(self) -> PredictionRequest:
        """Return the request of the job."""
        return self.make_record(PredictionRequest)
