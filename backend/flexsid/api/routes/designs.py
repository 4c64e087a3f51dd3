"""Excitation designs: make one, look at it, check it, take it to the aircraft."""

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
    RedesignRequest,
    RehearsalRequest,
    RescaleRequest,
)
from flexsid.api.received import receive
from flexsid.api.requests import Title
from flexsid.api.wire import Identity, Json
from flexsid.importers import confined
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
from flexsid.workflow.excitation.target_modes import target_modes

router = APIRouter(prefix="/designs", tags=["designs"])

_STRICT: Any = ConfigDict(extra="forbid")
_DIRECT_S = 20.0  # estimated processor time of a search that a request may wait for

Level = Annotated[int, Query(ge=0, le=2, description="Amplitude: 0 low, 1 medium, 2 high.")]
Limit = Annotated[float | None, Query(ge=1e-6, le=1e9, allow_inf_nan=False)]
# Larger ones are degrees given as radians: no surface turns by more than 60 deg, or 2900 deg/s.
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
    """Modes, correlation of the true deflections, parameters told by each input's lines."""

    modes: list[ExpectedMode]
    surfaces: list[str]
    correlation: list[list[float]]
    worth: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class RehearsalList:
    """Rehearsals of one design."""

    items: list[preflight_simulation.RehearsalResult]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignList:
    """Designs, oldest first."""

    items: list[ExcitationDesign]
    next: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CatalogueRow:
    """One row of Table 1; counts are per input, ``periods`` the duration in units of T."""

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
def create_design(store: TheStore, wanted: DesignRequest) -> Json:
    """Search the phases of a design and keep it; a few seconds."""
    wish = wanted.wish(store)
    excitation_designs.check_search(
        wish, _DIRECT_S, ", or begin it as a task (POST /designs/searches)"
    )
    kept = excitation_designs.create_design(store, wanted.name, wish, wanted.fta, wanted.note)
    return Json(kept, status.HTTP_201_CREATED, {"Location": f"/api/v1/designs/{kept.id}"})


@router.post("/searches", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED)
def search_design(context: TheContext, wanted: DesignRequest) -> Json:
    """Begin to search the phases of a design, as a task that can be followed and cancelled."""
    wish = wanted.wish(context.store)
    excitation_designs.check_search(wish)

    def work(report: Report) -> int | None:
        return excitation_designs.create_design(
            context.store, wanted.name, wish, wanted.fta, wanted.note, _teller(report)
        ).id

    begun = context.tasks.begin("design", wanted.name, work)
    return Json(begun, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{begun.id}"})


@router.post("/flown", response_model=DesignList, status_code=status.HTTP_201_CREATED)
def import_flown(
    store: TheStore,
    files: Annotated[list[UploadFile], File(description="Samples of exactly one period.")],
    name: Annotated[Title, Form()],
    rate_hz: Annotated[float, Form(gt=0.0, le=1e5, allow_inf_nan=False)],
    unit: Annotated[Literal["deg", "rad"], Form()] = "deg",
    apart: Annotated[bool, Form(description="Each file is a design of its own.")] = False,
) -> Json:
    """Recognise multisines that were flown and keep them as they were."""
    with TemporaryDirectory(prefix="flexsid-") as folder:
        sources = confined.read_all(*receive(Path(folder), files))
    found = imported_multisines.flown_inputs(sources, unit)
    kept = imported_multisines.keep_flown(store, found, name, rate_hz, apart=apart)
    return Json(DesignList(items=list(kept)), status.HTTP_201_CREATED)


@router.get("/catalogue", response_model=CatalogueList)
def list_catalogue() -> Json:
    """List the 24 designs of Table 1."""
    return Json({"items": excitation_designs.catalogue(), "next": None})


@router.get("/{design_id}", response_model=ExcitationDesign)
def get_design(store: TheStore, design_id: Identity) -> Json:
    """Return one design."""
    return Json(store.designs.get(design_id))


@router.delete("/{design_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_design(store: TheStore, design_id: Identity) -> Response:
    """Forget a design."""
    store.designs.delete(design_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


@router.get("/{design_id}/checks", response_model=DesignChecks)
def check_design(
    store: TheStore,
    design_id: Identity,
    natural_frequency: Annotated[float, Query(ge=0.01, le=1e5, description="Actuator's. [rad/s]")],
    damping: Annotated[float, Query(ge=0.001, le=10.0)] = 0.7,
    delay_s: Annotated[float, Query(ge=0.0, le=10.0)] = 0.0,
    position: Deflection = None,
    rate: Rate = None,
    acceleration: Limit = None,
    level: Level = 0,
) -> Json:
    """Check orthogonality, peaks, and what moves behind an actuator.

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
    return Json(excitation_designs.checks_of(store.designs.get(design_id), actuator, level))


@router.get("/{design_id}/target-modes", response_model=TargetModes)
def get_target_modes(
    store: TheStore,
    design_id: Identity,
    aircraft_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
) -> Json:
    """Compare the band of a design with the structural modes that it targets on an aircraft."""
    return Json(target_modes(store, store.designs.get(design_id), aircraft_id))


@router.get("/{design_id}/expected-errors", response_model=predicted_accuracy.ExpectedErrors)
def expect_errors(
    store: TheStore,
    design_id: Identity,
    run_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    level: Level = 0,
) -> Json:
    """Predict the standard errors of a run's derivatives, had this design been flown."""
    return Json(
        predicted_accuracy.expected_errors(store, store.designs.get(design_id), run_id, level)
    )


@router.get("/{design_id}/expected-response", response_model=ExpectedSummary)
def expect_response(
    store: TheStore,
    design_id: Identity,
    run_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    level: Level = 0,
) -> Json:
    """Tell how far modes stand out of the noise, and how surfaces would be correlated."""
    found = predicted_accuracy.expected_response(store, store.designs.get(design_id), run_id, level)
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
    """Compare a design with doublets, 3-2-1-1s and sweeps that keep its limits; seconds."""
    return Json(classic_inputs.compare_inputs(store, store.designs.get(design_id), run_id, level))


@router.get("/{design_id}/allocation", response_model=amplitude_optimisation.Allocation)
def allocate_amplitudes(
    store: TheStore,
    design_id: Identity,
    run_id: Annotated[int, Query(ge=1, le=LARGEST_ID)],
    deflection: Deflection = None,
    load_factor: Limit = None,
    level: Level = 0,
) -> Json:
    """Find amplitudes with the least worst relative standard error, and D-optimal ones.

    Limits: largest deflection of any surface [rad] and load factor [g], feedback
    included; the design's own where left out.
    """
    design = store.designs.get(design_id)
    return Json(
        amplitude_optimisation.allocate(store, design, run_id, level, deflection, load_factor)
    )


@router.post(
    "/{design_id}/rescaled",
    response_model=ExcitationDesign,
    status_code=status.HTTP_201_CREATED,
)
def rescale_design(store: TheStore, design_id: Identity, wanted: RescaleRequest) -> Json:
    """Keep a design with the same lines and phases and other amplitudes."""
    design = store.designs.get(design_id)
    kept = amplitude_optimisation.rescale_design(
        store, design, wanted.name, wanted.gains, wanted.note
    )
    return Json(kept, status.HTTP_201_CREATED, {"Location": f"/api/v1/designs/{kept.id}"})


@router.post(
    "/{design_id}/redesign", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED
)
def redesign(context: TheContext, design_id: Identity, wanted: RedesignRequest) -> Json:
    """Begin to search phases anew for the lines of a design, as one that was flown."""
    design = context.store.designs.get(design_id)
    excitation_designs.check_search(replace(design.wish, effort=wanted.effort))

    def work(report: Report) -> int | None:
        return imported_multisines.redesign(
            context.store, design, wanted.name, wanted.effort, _teller(report)
        ).id

    begun = context.tasks.begin("design", wanted.name, work)
    return Json(begun, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{begun.id}"})


@router.get("/{design_id}/rehearsals", response_model=RehearsalList)
def list_rehearsals(store: TheStore, design_id: Identity) -> Json:
    """List the rehearsals of a design, newest first, with what their runs estimated."""
    design = store.designs.get(design_id)
    return Json(RehearsalList(items=list(preflight_simulation.rehearsal_results(store, design))))


@router.post(
    "/{design_id}/rehearsals", response_model=TaskProgress, status_code=status.HTTP_202_ACCEPTED
)
def rehearse(context: TheContext, design_id: Identity, wanted: RehearsalRequest) -> Json:
    """Begin to fly a design in simulation; the maneuver is kept and its estimation queued."""
    design = context.store.designs.get(design_id)
    if wanted.controller_id is not None:
        context.store.controllers.get(wanted.controller_id)

    def work(report: Report) -> int | None:
        kept = preflight_simulation.rehearse_design(
            context.store, design, wanted.run_id, wanted.level, wanted.controller_id, report
        )
        context.dispatcher.wake()
        return kept.id

    begun = context.tasks.begin("rehearsal", design.name, work)
    return Json(begun, status.HTTP_202_ACCEPTED, {"Location": f"/api/v1/tasks/{begun.id}"})


def _teller(report: Report) -> Callable[[str, float, float], None]:
    def tell(name: str, best: float, fraction: float) -> None:
        report(fraction, f"{name} at a relative peak factor of {best:.4f}")

    return tell


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
    """Return one period at the flight computer's rate, or the recipe."""
    content = excitation_designs.export_design(store.designs.get(design_id), form, level)
    name = f"design-{design_id}.{form}"
    return Response(
        content,
        media_type=excitation_designs.MEDIA[form],
        headers={"Content-Disposition": f'attachment; filename="{name}"'},
    )
