"""Request models of excitation designs: by a row of Table 1, by harmonics or by bands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from flexsid.api.requests import Name, Number, Text, Title
from flexsid.errors import BadInput
from flexsid.storage.repository import LARGEST_ID
from flexsid.storage.store import Store
from flexsid.sysid.excitation.designer import DesignSpecification, InputSpecification
from flexsid.sysid.excitation.harmonic_assignment import Band
from flexsid.workflow.excitation import excitation_designs
from flexsid.workflow.excitation.target_modes import find_reach

_STRICT: Any = ConfigDict(extra="forbid")

Effort = Literal["quick", "thorough", "patient"]
Positive = Annotated[float, Field(strict=True, gt=0.0, le=1e5, allow_inf_nan=False)]
Harmonic = Annotated[int, Field(strict=True, ge=1, le=20_000)]


@dataclass(frozen=True, slots=True, kw_only=True)
class InputRequest:
    """One input with its harmonics; relative ``power`` by harmonic, flat if omitted."""

    name: Name
    harmonics: Annotated[tuple[Harmonic, ...], Field(max_length=500)]
    relative_peak: Positive = 1.0
    power: Annotated[tuple[Number, ...], Field(max_length=500)] | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class BandRequest:
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

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignRequest:
    """A row of Table 1 by ``fta``, or ``inputs`` by their harmonics, or ``bands``.

    ``peaks`` are the low, medium and high amplitudes of an input with relative peak 1 [rad], at
    most 60 deg. With ``aircraft_id`` the band of a row includes its target modes on that aircraft.
    """

    name: Title
    duration_s: Positive
    rate_hz: Positive
    peaks: tuple[Positive, Positive, Positive]
    fta: Annotated[int, Field(strict=True, ge=1, le=9999)] | None = None
    aircraft_id: Annotated[int, Field(strict=True, ge=1, le=LARGEST_ID)] | None = None
    first_harmonic: Harmonic = 1
    inputs: Annotated[tuple[InputRequest, ...], Field(max_length=40)] = ()
    bands: Annotated[tuple[BandRequest, ...], Field(max_length=40)] = ()
    effort: Effort = "thorough"
    seed: Annotated[int, Field(strict=True, ge=0, le=2**31)] = 0
    note: Text = ""

    __pydantic_config__ = _STRICT

    def to_specification(self, store: Store) -> DesignSpecification:
        """Return the specification of the design."""
        if (self.fta is not None) + bool(self.inputs) + bool(self.bands) != 1:
            raise BadInput("give either fta (a row of Table 1), or inputs, or bands")
        if self.aircraft_id is not None and self.fta is None:
            raise BadInput(
                "aircraft_id is valid with fta only; omit it with inputs or bands, which define"
                " their frequencies"
            )
        if self.fta is not None:
            return excitation_designs.specify_design(
                self.fta,
                self.duration_s,
                self.rate_hz,
                self.first_harmonic,
                self.peaks,
                self.effort,
                self.seed,
                None if self.aircraft_id is None else find_reach(store, self.fta, self.aircraft_id),
            )
        if self.bands:
            return excitation_designs.specify_bands(
                tuple(
                    excitation_designs.BandSpecification(
                        name=item.name,
                        band=Band(
                            low_hz=item.low_hz,
                            high_hz=item.high_hz,
                            count=item.count,
                            targets_hz=item.targets_hz,
                        ),
                        relative_peak=item.relative_peak,
                        spectrum=item.spectrum,
                    )
                    for item in self.bands
                ),
                self.duration_s,
                self.rate_hz,
                self.peaks,
                self.effort,
                self.seed,
            )
        inputs = tuple(
            InputSpecification(
                name=item.name,
                harmonics=item.harmonics,
                relative_peak=item.relative_peak,
                power=item.power,
            )
            for item in self.inputs
        )
        return DesignSpecification(
            duration_s=self.duration_s,
            rate_hz=self.rate_hz,
            inputs=inputs,
            peaks=self.peaks,
            effort=self.effort,
            seed=self.seed,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RescaleRequest:
    """Factors on the amplitudes of inputs; omitted inputs are unchanged."""

    name: Title
    gains: Annotated[dict[Name, Positive], Field(min_length=1, max_length=40)]
    note: Text = ""

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class RedesignRequest:
    """New phases for the harmonics of a design."""

    name: Title
    effort: Effort = "thorough"

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class PreflightSimulationRequest:
    """Run whose model is simulated, amplitude level, and controller (none: open loop)."""

    run_id: Annotated[int, Field(strict=True, ge=1, le=LARGEST_ID)]
    level: Annotated[int, Field(strict=True, ge=0, le=2)] = 1
    controller_id: Annotated[int, Field(strict=True, ge=1, le=LARGEST_ID)] | None = None

    __pydantic_config__ = _STRICT
