"""Validation of identified models: cross-prediction of maneuvers, and cross-validation of runs."""

from __future__ import annotations

from typing import Annotated

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import AERODYNAMICS, CROSS_PREDICTION, CROSS_VALIDATION, POSTERIOR
from flexsid.records.validation import (
    AerodynamicsComparison,
    CrossPredictionMatrix,
    CrossValidationSummary,
    PosteriorCheck,
)
from flexsid.text import count_noun
from flexsid.workflow.validation.aerodynamics_comparison import AerodynamicsQuery
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
from flexsid.workflow.validation.cross_validation import CrossValidationQuery
from flexsid.workflow.validation.posterior_check import PosteriorQuery

router = make_router(tag="validation")


ThePredictionQuery = Annotated[CrossPredictionQuery, Depends(query_as(CrossPredictionQuery))]
TheValidationQuery = Annotated[CrossValidationQuery, Depends(query_as(CrossValidationQuery))]
TheAerodynamicsQuery = Annotated[AerodynamicsQuery, Depends(query_as(AerodynamicsQuery))]
ThePosteriorQuery = Annotated[PosteriorQuery, Depends(query_as(PosteriorQuery))]

add_job_routes(
    *(router, "/cross-predictions", CROSS_PREDICTION, "cross_predictions"),
    lambda store, query: count_noun(len(query.run_ids), "run"),
)
for _path, _kind, _name in (
    ("/cross-validations", CROSS_VALIDATION, "cross_validation"),
    ("/aerodynamics-comparisons", AERODYNAMICS, "aerodynamics_comparison"),
    ("/posterior-checks", POSTERIOR, "posterior_check"),
):
    add_job_routes(router, _path, _kind, _name, lambda store, query: f"run {query.run_id}")


@router.get("/cross-predictions", response_model=CrossPredictionMatrix)
def get_cross_predictions(store: TheStore, query: ThePredictionQuery) -> Json:
    """Return the stored fit of the outputs of maneuvers, predicted by the models of runs."""
    return Json(get_result(store, CROSS_PREDICTION, query))


@router.get("/cross-validations", response_model=CrossValidationSummary)
def get_cross_validation(store: TheStore, query: TheValidationQuery) -> Json:
    """Return the stored fit of held-out data of a run, predicted by refits to the others.

    The figures ``held-out`` and ``held-out-residual`` have the spectra.
    """
    return Json(get_result(store, CROSS_VALIDATION, query).summary)


@router.get("/aerodynamics-comparisons", response_model=AerodynamicsComparison)
def get_aerodynamics_comparison(store: TheStore, query: TheAerodynamicsQuery) -> Json:
    """Return the stored verdict between quasi-steady and shaped derivatives for a run."""
    return Json(get_result(store, AERODYNAMICS, query))


@router.get("/posterior-checks", response_model=PosteriorCheck)
def get_posterior_check(store: TheStore, query: ThePosteriorQuery) -> Json:
    """Return the stored posterior of an output-error run, against its standard errors."""
    return Json(get_result(store, POSTERIOR, query))
