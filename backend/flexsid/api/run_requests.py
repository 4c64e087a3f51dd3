"""Request models of runs, batches and model structures."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from flexsid.api.requests import (
    LARGEST_NUMBER,
    Author,
    Delay,
    Id,
    Name,
    Names,
    Number,
    Request,
    Text,
    Title,
    Version,
)
from flexsid.records.model_structure import HeldBy, Structure
from flexsid.records.run import (
    Aerodynamics,
    EstimationRun,
    Method,
    OutOfBandModes,
    RunSettings,
    Start,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.axes import ModelAxis
from flexsid.workflow.runs.run_templates import apply_run_template

ModeNumber = Annotated[int, Field(strict=True, ge=1, le=9999)]
Prior = tuple[Number, Annotated[float, Field(strict=True, gt=0.0, le=LARGEST_NUMBER)]]
Frequency = Annotated[float, Field(strict=True, ge=0.0, le=1e4)]


class FixedToRequest(Request):
    """Run or prediction whose value a derivative is fixed to."""

    source: HeldBy
    id: Id


class StructureRequest(Request):
    """A model structure; see ``Structure``."""

    modes: Annotated[tuple[ModeNumber, ...], Field(max_length=20)] = ()
    inputs: Names = ()
    outputs: Names = ()
    free: Names | None = None
    fixed: Annotated[dict[Name, Number] | None, Field(max_length=500)] = None
    free_delays: Annotated[bool, Field(strict=True)] = False
    extra_parameters: Names = ()
    axis: ModelAxis = "longitudinal"
    absent: Names = ()
    fixed_to: Annotated[dict[Name, FixedToRequest] | None, Field(max_length=500)] = None
    delays: Annotated[dict[Name, Delay] | None, Field(max_length=500)] = None
    instruments: Annotated[dict[Name, Name | None] | None, Field(max_length=500)] = None

    def to_record(self) -> Structure:
        """Return the structure to be stored."""
        return self.make_record(Structure, fixed=self.fixed or {})


class SettingsRequest(Request):
    """Settings of the estimation, apart from the model structure."""

    start: Start = Start.BEST
    band_hz: tuple[Frequency, Frequency] | None = None
    max_iterations: Annotated[int, Field(strict=True, ge=1, le=1000)] = 100
    noise: Literal["diagonal", "full"] = "diagonal"
    priors: Annotated[dict[Name, Prior] | None, Field(max_length=500)] = None
    prior_spread: Annotated[float, Field(strict=True, gt=0.0, le=100.0)] | None = None
    start_run_id: Id | None = None
    out_of_band_modes: OutOfBandModes = OutOfBandModes.RETAINED
    aerodynamics: Aerodynamics = Aerodynamics.QUASI_STEADY
    additional_maneuver_ids: Annotated[tuple[Id, ...], Field(max_length=100)] = ()


class LimitsRequest(Request):
    """Time and memory limits of a run; it is stopped beyond them."""

    time_s: Annotated[float | None, Field(strict=True, gt=0.0, le=86_400.0)] = None
    memory_mb: Annotated[int | None, Field(strict=True, ge=64, le=1_000_000)] = None


Priority = Annotated[int, Field(strict=True, ge=-100, le=100)]


class RunOptions(Request):
    """Settings, modal tables, prediction and limits of runs; omitted ids are the latest.

    With ``run_template_id``, settings that are omitted are those of the template.
    """

    settings: SettingsRequest | None = None
    modal_table_id: Id | None = None
    damping_table_id: Id | None = None
    prediction_id: Id | None = None
    run_template_id: Id | None = None
    priority: Priority = 0
    limits: LimitsRequest | None = None

    def make_run(self, **more: Any) -> EstimationRun:
        """Return a run to be queued, with its resolved structure."""
        settings = (self.settings or SettingsRequest()).make_record(RunSettings)
        return self.make_record(EstimationRun, settings=settings, **more)

    def apply_template(self, store: Store, run: EstimationRun) -> EstimationRun:
        """Return a run with the settings of the template, if one is named."""
        if self.run_template_id is None:
            return run
        given = frozenset(() if self.settings is None else self.settings.model_fields_set)
        return apply_run_template(store, run, self.run_template_id, given)


class RunRequest(RunOptions):
    """Estimate a model of one maneuver by one method.

    Omitted ids default to the aircraft's latest tables and the prediction that covers most of the
    derivatives. The structure is given in full, or by ``structure_id`` (in
    ``structure_version``, the newest if omitted).
    """

    maneuver_id: Id
    method: Method
    structure: StructureRequest | None = None
    structure_id: Id | None = None
    structure_version: Version | None = None
    author: Author = ""


class RunTemplateRequest(Request):
    """A run whose method and settings are saved under a name."""

    run_id: Id
    name: Title
    note: Text = ""


class RunTemplateEditRequest(Request):
    """A run whose method and settings follow ``revision`` of a template."""

    run_id: Id
    revision: Version
    note: Text = ""


class BatchStructure(Request):
    """A model structure of a batch: in full, or by id, in its newest version if none is given."""

    structure: StructureRequest | None = None
    structure_id: Id | None = None
    structure_version: Version | None = None


class BatchRequest(RunOptions):
    """Estimate many maneuvers by each of the methods, with each of the structures.

    With ``from_equation_error``, OE and FRE runs wait for the EE run of the same maneuver and
    structure, and use its estimates as starting values.
    """

    name: Title
    maneuver_ids: Annotated[tuple[Id, ...], Field(min_length=1, max_length=20_000)]
    methods: Annotated[tuple[Method, ...], Field(min_length=1, max_length=3)]
    structures: Annotated[tuple[BatchStructure, ...], Field(max_length=100)] = ()
    from_equation_error: Annotated[bool, Field(strict=True)] = False

    def make_template(
        self, structure: Structure, structure_id: int | None, version: int | None, analyst: str
    ) -> EstimationRun:
        """Return the common part of the runs with one structure."""
        return self.make_run(
            maneuver_id=self.maneuver_ids[0],
            method=self.methods[0],
            structure=structure,
            structure_id=structure_id,
            structure_version=version,
            author=analyst,
        )


class ModelStructureRequest(Request):
    """A model structure to store under a name."""

    aircraft_id: Id
    name: Title
    structure: StructureRequest
    note: Text = ""


class StructureEditRequest(Request):
    """A new version of a model structure.

    ``version`` is the version that was edited; the header ``If-Match`` can give it instead.
    """

    name: Title
    structure: StructureRequest
    note: Text = ""
    version: Version | None = None
