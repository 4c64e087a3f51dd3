"""Request models of computed predictions: planform, surfaces, Mach number, reduced frequencies."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from flexsid.api.requests import LONGEST_TEXT, Id, Name, Number, Request, Text, Title
from flexsid.workflow.modal_data.computed_predictions import PredictionRequest

Length = Annotated[float, Field(strict=True, ge=0.0, le=1000.0, allow_inf_nan=False)]
Place = Annotated[float, Field(strict=True, ge=-1000.0, le=1000.0, allow_inf_nan=False)]
Division = Annotated[int, Field(strict=True, ge=1, le=200)]


class PanelRequest(Request):
    """A trapezium of the right half in structural axes (X aft, Y right, Z up). [m]

    ``left`` and ``right`` are the leading edges of its chords, left to right as seen from behind.
    """

    left: tuple[Place, Place, Place]
    left_chord: Length
    right: tuple[Place, Place, Place]
    right_chord: Length
    chordwise: Division = 8
    spanwise: Division = 10


class PlanformSurfaceRequest(Request):
    """A surface of the aircraft by Y of its ends [m] and its hinge as fraction of the chord."""

    name: Name
    span: tuple[Place, Place]
    hinge: Annotated[float, Field(strict=True, gt=0.0, lt=1.0)] = 0.75


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


class ComputePredictionRequest(Request):
    """A prediction to compute from panels, or from the CAERO1 entries of a Nastran deck.

    ``source`` names it. ``axis`` is that of the derivatives; modes are the lowest eight of its
    symmetry by default, and antisymmetric surfaces are positive with the right trailing edge down.
    ``reference_k`` is the reduced frequency of the tabulated derivatives: 0, or that of the mode
    that flutters.
    """

    aircraft_id: Id
    source: Title
    axis: Literal["longitudinal", "lateral"] = "longitudinal"
    panels: Annotated[tuple[PanelRequest, ...], Field(max_length=100)] = ()
    surfaces: Annotated[tuple[PlanformSurfaceRequest, ...], Field(max_length=40)] = ()
    deck: Annotated[str, Field(max_length=LONGEST_TEXT)] = ""
    deck_unit: Name = "m"
    modal_table_id: Id | None = None
    modes: Annotated[tuple[Id, ...], Field(max_length=30)] = ()
    mach: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 0.0
    reference_k: Annotated[Number, Field(ge=0.0, le=4.0)] = 0.0
    highest_k: Annotated[Number, Field(ge=0.1, le=4.0)] = 2.0

    def to_request(self) -> PredictionRequest:
        """Return the request of the job."""
        return self.make_record(PredictionRequest)
