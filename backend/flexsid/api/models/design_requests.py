"""Request models of excitation designs and of computed predictions."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from flexsid.api.models.requests import Id, Name, Number, Request, Text, Title
from flexsid.errors import BadInput
from flexsid.request_models import body_of
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import Band, Target
from flexsid.sysid.excitation.designer import DesignSpecification, InputSpecification
from flexsid.sysid.simulation.airframe import SensorErrors
from flexsid.sysid.simulation.turbulence import DiscreteGust
from flexsid.workflow.excitation import excitation_designs
from flexsid.workflow.excitation.preflight_simulation import SimulationRequest, SurfaceLimits
from flexsid.workflow.excitation.target_modes import TargetQuery, find_row_targets
from flexsid.workflow.modal_data.computed_predictions import (
    PlanformPanel,
    PlanformSurface,
    PredictionRequest,
)

# --- Request models of excitation designs: by a row of Table 1, by harmonics or by bands ----------

Effort = Literal["quick", "thorough", "patient"]
Positive = Annotated[float, Field(strict=True, gt=0.0, le=1e5, allow_inf_nan=False)]
Harmonic = Annotated[int, Field(strict=True, ge=1, le=20_000)]


@body_of(InputSpecification)
class InputRequest(Request):
    """One input with its harmonics; relative ``power`` by harmonic, flat if omitted."""


class BandRequest(Request):
    """One input by its band: ``count`` harmonics, half of them near ``targets_hz`` if given.

    ``spectrum`` gives relative power at frequencies [Hz], interpolated log-log; flat if omitted.
    """

    name: Name
    low_hz: Positive
    high_hz: Positive
    count: Annotated[int, Field(strict=True, ge=1, le=500)]
    relative_peak: Positive = 1.0
    targets_hz: Annotated[tuple[Positive, ...], Field(max_length=20)] = ()
    spectrum: Annotated[tuple[tuple[Positive, Positive], ...], Field(max_length=50)] = ()


class DesignRequest(Request):
    """A row of Table 1 by ``fta``, or ``inputs`` by their harmonics, or ``bands``.

    ``peaks`` are the low, medium and high amplitudes of an input with relative peak 1 [rad], at
    most 60 deg. With ``aircraft_id`` the band of a row includes its target modes on that aircraft,
    in flight at ``airspeed_m_s``, or structural modes in vacuo without it. ``throttle_peak`` is the
    medium amplitude of the throttles of a row, a share of their full range; by default it is the
    number of the medium one of ``peaks``.
    """

    name: Title
    duration_s: Positive
    rate_hz: Positive
    peaks: tuple[Positive, Positive, Positive]
    fta: Annotated[int, Field(strict=True, ge=1, le=9999)] | None = None
    aircraft_id: Id | None = None
    airspeed_m_s: Annotated[float, Field(strict=True, gt=0.0, le=1000.0)] | None = None
    fuel_fraction: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] = 0.5
    altitude_m: Annotated[float, Field(strict=True, ge=-1000.0, le=11_000.0)] = 0.0
    first_harmonic: Harmonic = 1
    throttle_peak: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] | None = None
    inputs: Annotated[tuple[InputRequest, ...], Field(max_length=40)] = ()
    bands: Annotated[tuple[BandRequest, ...], Field(max_length=40)] = ()
    effort: Effort = "thorough"
    seed: Annotated[int, Field(strict=True, ge=0, le=2**31)] = 0
    note: Text = ""

    def to_specification(self, store: Store) -> DesignSpecification:
        """Return the specification of the design."""
        if (self.fta is not None) + bool(self.inputs) + bool(self.bands) != 1:
            raise BadInput("give either fta (a row of Table 1), or inputs, or bands")
        if self.aircraft_id is not None and self.fta is None:
            raise BadInput(
                "aircraft_id is valid with fta only; omit it with inputs or bands, which define"
                " their frequencies"
            )
        if self.throttle_peak is not None and self.fta is None:
            raise BadInput(
                "throttle_peak is valid with fta only; omit it with inputs or bands, whose"
                " throttles have a relative_peak"
            )
        if self.airspeed_m_s is not None and self.aircraft_id is None:
            raise BadInput("airspeed_m_s is valid with aircraft_id only; give both or neither")
        if self.fta is not None:
            return excitation_designs.specify_design(
                self.fta,
                self.duration_s,
                self.rate_hz,
                self.first_harmonic,
                self.peaks,
                self.effort,
                self.seed,
                self._find_targets(store, self.fta),
                self.throttle_peak,
            )
        if self.bands:
            bands = tuple(
                item.make_record(excitation_designs.BandSpecification, band=item.make_record(Band))
                for item in self.bands
            )
            return excitation_designs.specify_bands(
                bands, self.duration_s, self.rate_hz, self.peaks, self.effort, self.seed
            )
        return self.make_record(DesignSpecification)

    def _find_targets(self, store: Store, fta: int) -> tuple[Target, ...]:
        if self.aircraft_id is None:
            return ()
        query = TargetQuery(
            aircraft_id=self.aircraft_id,
            airspeed_m_s=self.airspeed_m_s,
            fuel_fraction=self.fuel_fraction,
            altitude_m=self.altitude_m,
        )
        return find_row_targets(store, fta, query)


class RescaleRequest(Request):
    """Factors on the amplitudes of inputs; omitted inputs are unchanged."""

    name: Title
    gains: Annotated[dict[Name, Positive], Field(min_length=1, max_length=40)]
    note: Text = ""


class RedesignRequest(Request):
    """New phases for the harmonics of a design."""

    name: Title
    effort: Effort = "thorough"


@body_of(SurfaceLimits)
class SurfaceLimitsRequest(Request):
    """Limits and freeplay of all surfaces; ``delay_s`` adds to that of the servos."""


@body_of(SensorErrors)
class SensorErrorsRequest(Request):
    """Errors of recorded channels in their SI unit; of all outputs without ``channels``."""


@body_of(DiscreteGust)
class DiscreteGustRequest(Request):
    """One-minus-cosine gust: peak speed, gradient distance, start in the record."""


@body_of(SimulationRequest, without=("design_id",))
class PreflightSimulationRequest(Request):
    """Run whose model is simulated, amplitude level, controller (none: open loop), imperfections.

    ``own_limits`` are those of single surfaces, by name, instead of ``limits``. Of several sensor
    errors with a channel the last applies to it.
    """

    def to_simulation(self, design_id: int) -> SimulationRequest:
        """Return the request of the simulation of a design."""
        return self.make_record(SimulationRequest, design_id=design_id)


# --- Request models of computed predictions: planform, surfaces, Mach number, reduced frequencies


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
