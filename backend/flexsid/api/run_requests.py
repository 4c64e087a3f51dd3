"""Request models of runs, batches and model structures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from flexsid.api.requests import (
    LARGEST_NUMBER,
    Author,
    Delay,
    Id,
    Name,
    Names,
    Number,
    Text,
    Title,
    Version,
)
from flexsid.records.model_structure import FixedTo, HeldBy, Structure
from flexsid.records.run import EstimationRun, Limits, Method, RunSettings, Start

_STRICT: Any = ConfigDict(extra="forbid")

ModeNumber = Annotated[int, Field(strict=True, ge=1, le=9999)]
Prior = tuple[Number, Annotated[float, Field(strict=True, gt=0.0, le=LARGEST_NUMBER)]]
Frequency = Annotated[float, Field(strict=True, ge=0.0, le=1e4)]


@dataclass(frozen=True, slots=True, kw_only=True)
class FixedToRequest:
    """Run or prediction whose value a derivative is fixed to."""

    source: HeldBy
    id: Id

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureRequest:
    """A model structure; see ``Structure``."""

    modes: Annotated[tuple[ModeNumber, ...], Field(max_length=20)] = ()
    inputs: Names = ()
    outputs: Names = ()
    free: Names | None = None
    fixed: Annotated[dict[Name, Number] | None, Field(max_length=500)] = None
    free_delays: Annotated[bool, Field(strict=True)] = False
    extra_parameters: Names = ()
    axis: Literal["longitudinal"] = "longitudinal"
    absent: Names = ()
    fixed_to: Annotated[dict[Name, FixedToRequest] | None, Field(max_length=500)] = None
    delays: Annotated[dict[Name, Delay] | None, Field(max_length=500)] = None
    instruments: Annotated[dict[Name, Name | None] | None, Field(max_length=500)] = None

    __pydantic_config__ = _STRICT

    def to_record(self) -> Structure:
        """Return the record to be stored."""
        return Structure(
            modes=self.modes,
            inputs=self.inputs,
            outputs=self.outputs,
            free=self.free,
            fixed=self.fixed or {},
            free_delays=self.free_delays,
            extra_parameters=self.extra_parameters,
            axis=self.axis,
            absent=self.absent,
            fixed_to={
                name: FixedTo(source=held.source, id=held.id)
                for name, held in (self.fixed_to or {}).items()
            },
            delays=self.delays or {},
            instruments=self.instruments or {},
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsRequest:
    """Settings of the estimation, apart from the model structure."""

    start: Start = Start.BEST
    band_hz: tuple[Frequency, Frequency] | None = None
    max_iterations: Annotated[int, Field(strict=True, ge=1, le=1000)] = 100
    noise: Literal["diagonal", "full"] = "diagonal"
    priors: Annotated[dict[Name, Prior] | None, Field(max_length=500)] = None
    prior_spread: Annotated[float, Field(strict=True, gt=0.0, le=100.0)] | None = None
    start_run_id: Id | None = None
    additional_maneuver_ids: Annotated[tuple[Id, ...], Field(max_length=100)] = ()

    __pydantic_config__ = _STRICT

    def to_record(self) -> RunSettings:
        """Return the record to be stored."""
        return RunSettings(
            start=self.start,
            band_hz=self.band_hz,
            max_iterations=self.max_iterations,
            noise=self.noise,
            priors=self.priors or {},
            prior_spread=self.prior_spread,
            start_run_id=self.start_run_id,
            additional_maneuver_ids=self.additional_maneuver_ids,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitsRequest:
    """Time and memory limits of a run; it is stopped beyond them."""

    time_s: Annotated[float | None, Field(strict=True, gt=0.0, le=86_400.0)] = None
    memory_mb: Annotated[int | None, Field(strict=True, ge=64, le=1_000_000)] = None

    __pydantic_config__ = _STRICT

    def to_record(self) -> Limits:
        """Return the record to be stored."""
        return Limits(time_s=self.time_s, memory_mb=self.memory_mb)


Priority = Annotated[int, Field(strict=True, ge=-100, le=100)]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRequest:
    """Estimate a model of one maneuver by one method.

    Omitted ids default to the aircraft's latest tables and the prediction that covers most of the
    derivatives. The structure is given in full, or by ``structure_id`` (in
    ``structure_version``, the newest if omitted).
    """

    maneuver_id: Id
    method: Method
    structure: StructureRequest | None = None
    settings: SettingsRequest | None = None
    modal_table_id: Id | None = None
    damping_table_id: Id | None = None
    prediction_id: Id | None = None
    structure_id: Id | None = None
    structure_version: Version | None = None
    author: Author = ""
    priority: Priority = 0
    limits: LimitsRequest | None = None

    __pydantic_config__ = _STRICT

    def to_record(self, structure: Structure, version: int | None, analyst: str) -> EstimationRun:
        """Return the run to be queued, with its resolved structure."""
        return EstimationRun(
            maneuver_id=self.maneuver_id,
            method=self.method,
            structure=structure,
            settings=(self.settings or SettingsRequest()).to_record(),
            modal_table_id=self.modal_table_id,
            damping_table_id=self.damping_table_id,
            prediction_id=self.prediction_id,
            structure_id=self.structure_id,
            structure_version=version,
            author=self.author or analyst,
            priority=self.priority,
            limits=None if self.limits is None else self.limits.to_record(),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchStructure:
    """A model structure of a batch: in full, or by id, in its newest version if none is given."""

    structure: StructureRequest | None = None
    structure_id: Id | None = None
    structure_version: Version | None = None

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class BatchRequest:
    """Estimate many maneuvers by each of the methods, with each of the structures.

    With ``from_equation_error``, OE and FRE runs wait for the EE run of the same maneuver and
    structure, and use its estimates as starting values.
    """

    name: Title
    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=20_000)]
    methods: Annotated[tuple[Method, ...], Field(min_length=1, max_length=3)]
    structures: Annotated[tuple[BatchStructure, ...], Field(max_length=100)] = ()
    settings: SettingsRequest | None = None
    modal_table_id: Id | None = None
    damping_table_id: Id | None = None
    prediction_id: Id | None = None
    from_equation_error: Annotated[bool, Field(strict=True)] = False
    priority: Priority = 0
    limits: LimitsRequest | None = None

    __pydantic_config__ = _STRICT

    def make_template(
        self, structure: Structure, structure_id: int | None, version: int | None, analyst: str
    ) -> EstimationRun:
        """Return the common part of the runs with one structure."""
        return EstimationRun(
            maneuver_id=self.maneuver_ids[0],
            method=self.methods[0],
            structure=structure,
            settings=(self.settings or SettingsRequest()).to_record(),
            modal_table_id=self.modal_table_id,
            damping_table_id=self.damping_table_id,
            prediction_id=self.prediction_id,
            structure_id=structure_id,
            structure_version=version,
            author=analyst,
            priority=self.priority,
            limits=None if self.limits is None else self.limits.to_record(),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelStructureRequest:
    """A model structure to store under a name."""

    aircraft_id: Id
    name: Title
    structure: StructureRequest
    note: Text = ""

    __pydantic_config__ = _STRICT


@dataclass(frozen=True, slots=True, kw_only=True)
class StructureEditRequest:
    """A new version of a model structure.

    ``version`` is the version that was edited; the header ``If-Match`` can give it instead.
    """

    name: Title
    structure: StructureRequest
    note: Text = ""
    version: Version | None = None

    __pydantic_config__ = _STRICT
