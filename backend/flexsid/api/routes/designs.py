"""Excitation designs: design, checks, predicted accuracy, pre-flight simulation, export."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Literal

from fastapi import Depends, File, Form, Query, Response, UploadFile, status

from flexsid.api.authorization import TheAnalyst
from flexsid.api.context import TheContext, TheStore, save_files
from flexsid.api.models.design_requests import (
    DesignRequest,
    PreflightSimulationRequest,
    RedesignRequest,
    RescaleRequest,
)
from flexsid.api.models.requests import Title
from flexsid.api.models.responses import extend_record, response_of
from flexsid.api.parameters import query_as
from flexsid.api.responses import submit_job
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json
from flexsid.importers import sandbox
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import (
    DESIGN,
    PREDICTED_ACCURACY,
    SIMULATION,
)
from flexsid.records.excitation import DEFAULT_LEVEL, ExcitationDesign
from flexsid.records.views import ExpectedMode, TargetModes
from flexsid.storage.jobs.job_list import JobItem
from flexsid.storage.lists.list_query import Page
from flexsid.sysid.excitation.catalogue import CATALOGUE, FlightTestAid
from flexsid.sysid.excitation.checks import ActuatorLimits, DesignChecks
from flexsid.workflow.excitation import (
    amplitude_optimisation,
    excitation_designs,
    preflight_simulation,
)
from flexsid.workflow.excitation.excitation_designs import (
    DesignOrder,
    recognise_inputs,
    redesign,
    save_designs,
)
from flexsid.workflow.excitation.predicted_accuracy import DesignQuery, ExpectedErrors
from flexsid.workflow.excitation.target_modes import (
    RowTargets,
    TargetQuery,
    compare_target_modes,
    list_row_targets,
)

# --- Excitation designs: design, checks, predicted accuracy, pre-flight simulation, export --------

designs_router = make_router("/designs", tag="designs")

_DIRECT_S = 0.2  # longest estimated processor time of a phase search within a request

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


TheTargetQuery = Annotated[TargetQuery, Depends(query_as(TargetQuery))]


@response_of(FlightTestAid)
class CatalogueRow:
    """One row of Table 1; numbers of harmonics by input, ``periods``: duration in units of T."""

    numbers: tuple[int, int, int]
    inputs: list[str]


@designs_router.get("", response_model=Page[ExcitationDesign])
def list_designs(store: TheStore) -> Json:
    """List excitation designs."""
    return Json(Page(items=store.designs.find()))


@designs_router.post("", response_model=ExcitationDesign, status_code=status.HTTP_201_CREATED)
def create_design(store: TheStore, body: DesignRequest) -> Json:
    """Create a design and optimise its phases, where that takes no longer than 0.2 s."""
    specification = body.to_specification(store)
    excitation_designs.check_search(
        specification, _DIRECT_S, ", or start it as a job (POST /designs/searches)"
    )
    order = DesignOrder(name=body.name, specification=specification, fta=body.fta, note=body.note)
    stored = store.designs.add(excitation_designs.compute_design(order, lambda progress: None))
    return Json(stored, status.HTTP_201_CREATED, {"Location": f"/api/v1/designs/{stored.id}"})


@designs_router.post("/searches", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED)
def start_design(context: TheContext, body: DesignRequest, analyst: TheAnalyst) -> Json:
    """Create a design and optimise its phases, as a job."""
    specification = body.to_specification(context.store)
    excitation_designs.check_search(specification)
    order = DesignOrder(name=body.name, specification=specification, fta=body.fta, note=body.note)
    return submit_job(context, DESIGN, order, analyst, body.name)


@designs_router.post(
    "/import", response_model=Page[ExcitationDesign], status_code=status.HTTP_201_CREATED
)
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
        sources = sandbox.read_all(*save_files(Path(folder), files), store.quotas.expansion)
    found = recognise_inputs(sources, unit)
    stored = save_designs(store, found, name, rate_hz, separate=separate)
    return Json(Page(items=list(stored)), status.HTTP_201_CREATED)


@designs_router.get("/catalogue", response_model=Page[CatalogueRow])
def list_catalogue() -> Json:
    """List the 24 designs of Table 1."""
    rows = [
        extend_record(CatalogueRow, aid, inputs=[*sum(aid.input_names(), ())])
        for aid in CATALOGUE.values()
    ]
    return Json(Page(items=rows))


@designs_router.get("/catalogue/targets", response_model=Page[RowTargets])
def list_catalogue_targets(
    store: TheStore,
    query: TheTargetQuery,
    period_s: Annotated[float, Query(gt=0.1, le=1000.0, description="T of Table 1. [s]")] = 24.0,
    first_harmonic: Annotated[int, Query(ge=1, le=1000)] = 1,
) -> Json:
    """List band, resolution and harmonics about the target modes of all rows on an aircraft."""
    return Json(Page(items=list(list_row_targets(store, query, period_s, first_harmonic))))


@designs_router.get("/{design_id}", response_model=ExcitationDesign)
def get_design(store: TheStore, design_id: Identity) -> Json:
    """Return one design."""
    return Json(store.designs.get(design_id))


@designs_router.delete("/{design_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_design(store: TheStore, design_id: Identity) -> Response:
    """Delete a design."""
    store.designs.delete(design_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


@designs_router.get("/{design_id}/checks", response_model=DesignChecks)
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
    level: Level = DEFAULT_LEVEL,
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


@designs_router.get("/{design_id}/target-modes", response_model=TargetModes)
def get_target_modes(store: TheStore, design_id: Identity, query: TheTargetQuery) -> Json:
    """Compare the harmonics of a design with its target modes on an aircraft."""
    return Json(compare_target_modes(store, store.designs.get(design_id), query))


@designs_router.post(
    "/{design_id}/rescaled",
    response_model=ExcitationDesign,
    status_code=status.HTTP_201_CREATED,
)
def rescale_design(store: TheStore, design_id: Identity, body: RescaleRequest) -> Json:
    """Store a design with the same harmonics and phases, and scaled amplitudes."""
    design = store.designs.get(design_id)
    stored = amplitude_optimisation.rescale_design(store, design, body.name, body.gains, body.note)
    return Json(stored, status.HTTP_201_CREATED, {"Location": f"/api/v1/designs/{stored.id}"})


@designs_router.post(
    "/{design_id}/redesign", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED
)
def redesign_phases(
    context: TheContext, design_id: Identity, body: RedesignRequest, analyst: TheAnalyst
) -> Json:
    """Optimise new phases for the harmonics of a design, such as an imported one, as a job."""
    design = context.store.designs.get(design_id)
    order = redesign(design, body.name, body.effort)
    excitation_designs.check_search(order.specification)
    return submit_job(context, DESIGN, order, analyst, body.name)


@designs_router.get(
    "/{design_id}/preflight-simulations", response_model=Page[preflight_simulation.SimulationResult]
)
def list_preflight_simulations(store: TheStore, design_id: Identity) -> Json:
    """List the pre-flight simulations of a design, newest first, with their estimates."""
    design = store.designs.get(design_id)
    return Json(Page(items=list(preflight_simulation.list_simulations(store, design))))


@designs_router.post(
    "/{design_id}/preflight-simulations",
    response_model=JobItem,
    status_code=status.HTTP_202_ACCEPTED,
)
def simulate_design(
    context: TheContext,
    design_id: Identity,
    body: PreflightSimulationRequest,
    analyst: TheAnalyst,
) -> Json:
    """Simulate the flight of a design, as a job; stores the maneuver and queues its estimation."""
    design = context.store.designs.get(design_id)
    request = body.to_simulation(design_id)
    if request.controller_id is not None:
        context.store.controllers.get(request.controller_id)
    return submit_job(context, SIMULATION, request, analyst, design.name)


_FILE = {
    media: {"schema": {"type": "object" if media == "application/json" else "string"}}
    for media in excitation_designs.MEDIA.values()
}


@designs_router.get(
    "/{design_id}/export", response_class=Response, responses={200: {"content": _FILE}}
)
def export_design(
    store: TheStore,
    design_id: Identity,
    form: Literal["csv", "mat", "h", "json"] = "csv",
    level: Level = DEFAULT_LEVEL,
) -> Response:
    """Return one period at the rate of the flight computer, or the definition as JSON."""
    content = excitation_designs.export_design(store.designs.get(design_id), form, level)
    name = f"design-{design_id}.{form}"
    return Response(
        content,
        media_type=excitation_designs.MEDIA[form],
        headers={"Content-Disposition": f'attachment; filename="{name}"'},
    )


# --- Predictions for an excitation design: accuracy, comparison with classic inputs, amplitudes

design_predictions_router = make_router("/designs/{design_id}", tag="designs")


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedSummary:
    """Expected signal of the modes, correlation of the surface deflections, information by input.

    ``information`` is the information of the harmonics of each input, as a number of parameters.
    """

    modes: list[ExpectedMode]
    surfaces: list[str]
    correlation: list[list[float]]
    information: dict[str, float]


TheDesignQuery = Annotated[DesignQuery, Depends(query_as(DesignQuery, "design_id"))]


@design_predictions_router.get("/expected-errors", response_model=ExpectedErrors)
def get_expected_errors(store: TheStore, query: TheDesignQuery) -> Json:
    """Return the stored standard errors of the derivatives of a run for this excitation."""
    return Json(get_result(store, PREDICTED_ACCURACY, query).errors)


@design_predictions_router.get("/expected-response", response_model=ExpectedSummary)
def get_expected_response(store: TheStore, query: TheDesignQuery) -> Json:
    """Return the stored signal-to-noise ratio of the modes and correlation of the surfaces."""
    found = get_result(store, PREDICTED_ACCURACY, query).response
    return Json(
        ExpectedSummary(
            modes=list(found.modes),
            surfaces=list(found.surfaces),
            correlation=found.correlation.tolist(),
            information={name: float(one.sum()) for name, one in found.information.items()},
        )
    )
