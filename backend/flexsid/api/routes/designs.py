"""Excitation designs: design, checks, predicted accuracy, pre-flight simulation, export."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal

from fastapi import APIRouter, File, Form, Query, Response, UploadFile, status
from pydantic import ConfigDict

from flexsid.api.context import TheContext, TheStore
from flexsid.api.design_requests import (
    DesignRequest,
    PreflightSimulationRequest,
    RedesignRequest,
    RescaleRequest,
)
from flexsid.api.requests import Title
from flexsid.api.serialization import Identity, Json
from flexsid.api.uploads import save_files
from flexsid.importers import sandbox
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.views import ExpectedMode, TargetModes
from flexsid.storage.repository import LARGEST_ID
from flexsid.sysid.excitation.checks import ActuatorLimits, DesignChecks
from flexsid.workflow.background_tasks import Report, TaskProgress
from flexsid.workflow.excitation import (
    amplitude_optimisation,
    classic_inputs,
    excitation_designs,
    imported_multisines,
    predicted_accuracy,
    preflight_simulation,
)
from flexsid.workflow.excitation.target_modes import compare_target_modes

router = APIRouter(prefix="/designs", tags=["designs"])

_STRICT: Any = ConfigDict(extra="forbid")
_DIRECT_S = 20.0  # longest estimated processor time of a phase search within a request

Level = Annotated[int, Query(ge=0, le=2, description="Amplitude: 0 low, 1 medium, 2 high.")]
Limit = Annotated[float | None, Query(ge=1e-6, le=1e9, allow_inf_nan=False)]
# Larger values are degrees given as radians: limits of 60 deg and 2900 deg/s.
Deflection = Annotated[
    float | None,
    Query(ge=1e-6, le=1.05, allow_inf_nan=False, description="[rad], at most 1.05 (60 deg)."),
]
Rate = Annotated[
    float | None,
    Query(ge=1e-6, le=50.0, allow_inf_nan=False, description="[rad/s], at most 50 (2900 deg/s)."),
]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedSummary:
    """Expected signal of the modes, correlation of the surface deflections, information by input.

    ``worth`` is the information of the harmonics of each input, as a number of parameters.
    """

    modes: list[ExpectedMode]
    surfaces: list[str]
    correlation: list[list[float]]
    worth: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class PreflightSimulationList:
    """Pre-flight simulations of one design."""

    items: list[preflight_simulation.SimulationResult]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignList:
    """Designs, oldest first."""

    items: list[ExcitationDesign]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CatalogueRow:
    """One row of Table 1; numbers of harmonics by input, ``periods``: duration in units of T."""

    number: int
    numbers: tuple[int, int, int]
    axis: str
    periods: int
    surfaces: int
    throttles: int
    harmonics_per_input: int
    throttle_harmonics: int
    targets: str
    inputs: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class CatalogueList:
    """Table 1."""

    items: list[CatalogueRow]
    next: str | None = None


@router.get("", response_model=DesignList)
def list_designs(store: TheStore) -> Json:
    """List excitation designs."""
    return Json(DesignList(items=store.designs.find()))


@router.post("", response_model=ExcitationDesign, status_code=status.HTTP_201_CREATED)
def create_design(store: TheStore, body: DesignRequest) -> Json:
    """Create a design and optimise its phases; takes a few seconds."""
    specification = body.to_specification(store)
    excitation_designs.check_search(
        specification, _DIRECT_S, ", or start it as a task (POST /designs/searches)"
    )
    stored = excitation_designs.create_design(store, body.name, specification, body.fta, body.note)
    return Json(stored, status.HTTP_201_CREATED, {"Location": f"/api/v1/designs/{stored.id}"})


@router.post("/searches", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED)
def start_design(context: TheContext, body: DesignRequest) -> Json:
    """Create a design and optimise its phases, as a task."""
    specification = body.to_specification(context.store)
    excitation_designs.check_search(specification)

    def work(report: Report) -> int | None:
        return excitation_designs.create_design(
            context.store,
            body.name,
            specification,
            body.fta,
            body.note,
            _report_phase_search(report),
        ).id

    task = context.tasks.begin("design", body.name, work)
    return Json(task, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{task.id}"})


@router.post("/flown", response_model=DesignList, status_code=status.HTTP_201_CREATED)
def import_multisines(
    store: TheStore,
    files: Annotated[list[UploadFile], File(description="Samples of exactly one period.")],
    name: Annotated[Title, Form()],
    rate_hz: Annotated[float, Form(gt=0.0, le=1e5, allow_inf_nan=False)],
    unit: Annotated[Literal["deg", "rad"], Form()] = "deg",
    separate: Annotated[bool, Form(description="Each file is a separate design.")] = False,
) -> Json:
    """Import flown multisines: harmonics, amplitudes and phases are identified from the samples."""
    with TemporaryDirectory(prefix="flexsid-") as folder:
        sources = sandbox.read_all(*save_files(Path(folder), files))
    found = imported_multisines.recognise_inputs(sources, unit)
    stored = imported_multisines.save_designs(store, found, name, rate_hz, separate=separate)
    return Json(DesignList(items=list(stored)), status.HTTP_201_CREATED)


@router.get("/catalogue", response_model=CatalogueList)
def list_catalogue() -> Json:
    """List the 24 designs of Table 1."""
    return Json({"items": excitation_designs.list_flight_test_aids(), "next": None})


@router.get("/{design_id}", response_model=ExcitationDesign)
def get_design(store: TheStore, design_id: Identity) -> Json:
    """Return one design."""
    return Json(store.designs.get(design_id))


@router.delete("/{design_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_design(store: TheStore, design_id: Identity) -> Response:
    """Delete a design."""
    store.designs.delete(design_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


@router.get("/{design_id}/checks", response_model=DesignChecks)
def check_design(
    store: TheStore,
    design_id: Identity,
    natural_frequency: Annotated[
        float, Query(ge=0.01, le=1e5, description="Natural frequency of the actuator. [rad/s]")
    ],
    damping: Annotated[float, Query(ge=0.001, le=10.0)] = 0.7,
    delay_s: Annotated[float, Query(ge=0.0, le=10.0)] = 0.0,
    position: Deflection = None,
    rate: Rate = None,
    acceleration: Limit = None,
    level: Level = 0,
) -> Json:
    """Check the orthogonality of the inputs, their peaks, and the response of an actuator.

    Limits: position [rad], rate [rad/s], acceleration [rad/s2].
    """
    actuator = ActuatorLimits(
        natural_frequency=natural_frequency,
        damping=damping,
        delay_s=delay_s,
        position=position,
        rate=rate,
        acceleration=acceleration,
    )
    return Json(excitation_designs.check_multisine(store.designs.get(design_id), actuator, level))


@router.get("/{design_id}/target-modes", response_model=TargetModes)
def get_target_modes(
    store: TheStore,
    design_id: Identity,
    aircraft_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
) -> Json:
    """Compare the band of a design with its target modes on an aircraft."""
    return Json(compare_target_modes(store, store.designs.get(design_id), aircraft_id))


@router.get("/{design_id}/expected-errors", response_model=predicted_accuracy.ExpectedErrors)
def predict_errors(
    store: TheStore,
    design_id: Identity,
    run_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    level: Level = 0,
) -> Json:
    """Predict the standard errors of the derivatives of a run for this excitation (Cramér-Rao)."""
    return Json(
        predicted_accuracy.predict_errors(store, store.designs.get(design_id), run_id, level)
    )


@router.get("/{design_id}/expected-response", response_model=ExpectedSummary)
def predict_response(
    store: TheStore,
    design_id: Identity,
    run_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    level: Level = 0,
) -> Json:
    """Predict the signal-to-noise ratio of the modes and the correlation of the surfaces."""
    found = predicted_accuracy.predict_response(store, store.designs.get(design_id), run_id, level)
    return Json(
        ExpectedSummary(
            modes=list(found.modes),
            surfaces=list(found.surfaces),
            correlation=found.correlation.tolist(),
            worth={name: float(worth.sum()) for name, worth in found.worth.items()},
        )
    )


@router.get("/{design_id}/classic-inputs", response_model=classic_inputs.InputComparison)
def compare_classic_inputs(
    store: TheStore,
    design_id: Identity,
    run_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    level: Level = 0,
) -> Json:
    """Compare a design with doublets, 3-2-1-1s and sweeps of equal limits; takes seconds."""
    return Json(classic_inputs.compare_inputs(store, store.designs.get(design_id), run_id, level))


@router.get("/{design_id}/amplitudes", response_model=amplitude_optimisation.OptimisedAmplitudes)
def optimise_amplitudes(
    store: TheStore,
    design_id: Identity,
    run_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    deflection: Deflection = None,
    load_factor: Limit = None,
    level: Level = 0,
) -> Json:
    """Optimise amplitudes: minimax relative standard error, and D-optimal.

    Limits: largest deflection of any surface [rad] and load factor [g], feedback included;
    if omitted, those of the design.
    """
    design = store.designs.get(design_id)
    return Json(
        amplitude_optimisation.optimise_amplitudes(
            store, design, run_id, level, deflection, load_factor
        )
    )


@router.post(
    "/{design_id}/rescaled",
    response_model=ExcitationDesign,
    status_code=status.HTTP_201_CREATED,
)
def rescale_design(store: TheStore, design_id: Identity, body: RescaleRequest) -> Json:
    """Store a design with the same harmonics and phases, and scaled amplitudes."""
    design = store.designs.get(design_id)
    stored = amplitude_optimisation.rescale_design(store, design, body.name, body.gains, body.note)
    return Json(stored, status.HTTP_201_CREATED, {"Location": f"/api/v1/designs/{stored.id}"})


@router.post(
    "/{design_id}/redesign", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED
)
def redesign_phases(context: TheContext, design_id: Identity, body: RedesignRequest) -> Json:
    """Optimise new phases for the harmonics of a design, such as an imported one, as a task."""
    design = context.store.designs.get(design_id)
    excitation_designs.check_search(replace(design.specification, effort=body.effort))

    def work(report: Report) -> int | None:
        return imported_multisines.search_phases(
            context.store, design, body.name, body.effort, _report_phase_search(report)
        ).id

    task = context.tasks.begin("design", body.name, work)
    return Json(task, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{task.id}"})


@router.get("/{design_id}/preflight-simulations", response_model=PreflightSimulationList)
def list_preflight_simulations(store: TheStore, design_id: Identity) -> Json:
    """List the pre-flight simulations of a design, newest first, with their estimates."""
    design = store.designs.get(design_id)
    return Json(
        PreflightSimulationList(items=list(preflight_simulation.list_simulations(store, design)))
    )


@router.post(
    "/{design_id}/preflight-simulations",
    response_model=TaskProgress,
    status_code=status.HTTP_202_ACCEPTED,
)
def simulate_design(
    context: TheContext, design_id: Identity, body: PreflightSimulationRequest
) -> Json:
    """Simulate the flight of a design, as a task; stores the maneuver and queues its estimation."""
    design = context.store.designs.get(design_id)
    if body.controller_id is not None:
        context.store.controllers.get(body.controller_id)

    def work(report: Report) -> int | None:
        stored = preflight_simulation.simulate_design(
            context.store, design, body.run_id, body.level, body.controller_id, report
        )
        context.dispatcher.wake()
        return stored.id

    task = context.tasks.begin("preflight-simulation", design.name, work)
    return Json(task, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{task.id}"})


def _report_phase_search(report: Report) -> Callable[[str, float, float], None]:
    def report_best(name: str, best: float, fraction: float) -> None:
        report(fraction, f"{name} at a relative peak factor of {best:.4f}")

    return report_best


_FILE = {
    media: {"schema": {"type": "object" if media == "application/json" else "string"}}
    for media in excitation_designs.MEDIA.values()
}


@router.get("/{design_id}/export", response_class=Response, responses={200: {"content": _FILE}})
def export_design(
    store: TheStore,
    design_id: Identity,
    form: Literal["csv", "mat", "h", "json"] = "csv",
    level: Level = 0,
) -> Response:
    """Return one period at the rate of the flight computer, or the definition as JSON."""
    content = excitation_designs.export_design(store.designs.get(design_id), form, level)
    name = f"design-{design_id}.{form}"
    return Response(
        content,
        media_type=excitation_designs.MEDIA[form],
        headers={"Content-Disposition": f'attachment; filename="{name}"'},
    )
