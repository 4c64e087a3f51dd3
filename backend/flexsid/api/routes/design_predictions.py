"""Predictions for an excitation design: accuracy, comparison with classic inputs, amplitudes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Depends

from flexsid.api.context import TheStore
from flexsid.api.routes.designs import Deflection, Level, Limit
from flexsid.api.serialization import Identity, Json, RequiredReference
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import AMPLITUDES, INPUT_COMPARISON, PREDICTED_ACCURACY
from flexsid.records.views import ExpectedMode
from flexsid.storage.store import Store
from flexsid.workflow.excitation.amplitude_optimisation import AmplitudeQuery, OptimisedAmplitudes
from flexsid.workflow.excitation.classic_inputs import InputComparison
from flexsid.workflow.excitation.predicted_accuracy import DesignQuery, ExpectedErrors

router = APIRouter(prefix="/designs/{design_id}", tags=["designs"])


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedSummary:
    """Expected signal of the modes, correlation of the surface deflections, information by input.

    ``information`` is the information of the harmonics of each input, as a number of parameters.
    """

    modes: list[ExpectedMode]
    surfaces: list[str]
    correlation: list[list[float]]
    information: dict[str, float]


async def _read_query(
    design_id: Identity, run_id: RequiredReference, level: Level = 0
) -> DesignQuery:
    return DesignQuery(design_id=design_id, run_id=run_id, level=level)


async def _read_amplitude_query(
    design_id: Identity,
    run_id: RequiredReference,
    deflection: Deflection = None,
    load_factor: Limit = None,
    level: Level = 0,
) -> AmplitudeQuery:
    return AmplitudeQuery(
        design_id=design_id,
        run_id=run_id,
        level=level,
        deflection=deflection,
        load_factor=load_factor,
    )


TheDesignQuery = Annotated[DesignQuery, Depends(_read_query)]
TheAmplitudeQuery = Annotated[AmplitudeQuery, Depends(_read_amplitude_query)]


def _get_title(store: Store, query: DesignQuery) -> str:
    return store.designs.get(query.design_id).name


for _path, _kind, _name, _read in (
    ("/predicted-accuracy", PREDICTED_ACCURACY, "predicted_accuracy", _read_query),
    ("/classic-inputs", INPUT_COMPARISON, "input_comparison", _read_query),
    ("/amplitudes", AMPLITUDES, "amplitudes", _read_amplitude_query),
):
    add_job_routes(router, _path, _kind, _name, _read, _get_title)


@router.get("/expected-errors", response_model=ExpectedErrors)
def get_expected_errors(store: TheStore, query: TheDesignQuery) -> Json:
    """Return the stored standard errors of the derivatives of a run for this excitation."""
    return Json(get_result(store, PREDICTED_ACCURACY, query).errors)


@router.get("/expected-response", response_model=ExpectedSummary)
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


@router.get("/classic-inputs", response_model=InputComparison)
def get_input_comparison(store: TheStore, query: TheDesignQuery) -> Json:
    """Return the stored comparison with doublets, 3-2-1-1s and sweeps of equal limits."""
    return Json(get_result(store, INPUT_COMPARISON, query))


@router.get("/amplitudes", response_model=OptimisedAmplitudes)
def get_amplitudes(store: TheStore, query: TheAmplitudeQuery) -> Json:
    """Return the stored amplitudes of minimax relative standard error, and D-optimal ones.

    Limits: largest deflection of any surface [rad] and load factor [g], feedback included;
    if omitted, those of the design.
    """
    return Json(get_result(store, AMPLITUDES, query))
