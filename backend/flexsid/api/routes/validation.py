"""Validation of identified models: cross-prediction of maneuvers, and cross-validation of runs."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, status

from flexsid.api.analyst import TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.serialization import Json, RequiredReference
from flexsid.api.submission import KnownJob, respond_with_job, submit_job
from flexsid.figure_table import CrossPredictionParameters, CrossValidationParameters
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import AERODYNAMICS, CROSS_PREDICTION, CROSS_VALIDATION
from flexsid.records.validation import (
    AerodynamicsComparison,
    CrossPredictionMatrix,
    CrossValidationSummary,
)
from flexsid.storage.job_list import JobItem
from flexsid.workflow.validation.aerodynamics_comparison import AerodynamicsQuery
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
from flexsid.workflow.validation.cross_validation import CrossValidationQuery

router = APIRouter(tags=["validation"])


async def _read_cross_prediction(
    parameters: Annotated[CrossPredictionParameters, Query()],
) -> CrossPredictionQuery:
    return CrossPredictionQuery(**dict(parameters))


async def _read_cross_validation(
    parameters: Annotated[CrossValidationParameters, Query()],
) -> CrossValidationQuery:
    return CrossValidationQuery(**dict(parameters))


ThePredictionQuery = Annotated[CrossPredictionQuery, Depends(_read_cross_prediction)]
TheValidationQuery = Annotated[CrossValidationQuery, Depends(_read_cross_validation)]


@router.post(
    "/cross-predictions/results", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED
)
def request_cross_predictions(
    context: TheContext, query: ThePredictionQuery, analyst: TheAnalyst
) -> Json:
    """Queue the predictions of maneuvers by runs, or return the job of an equal request."""
    n_runs = len(query.run_ids)
    title = f"{n_runs} run{'' if n_runs == 1 else 's'}"
    return submit_job(context, CROSS_PREDICTION, query, analyst, title)


@router.get("/cross-predictions/results", response_model=KnownJob)
def get_cross_predictions_job(store: TheStore, query: ThePredictionQuery) -> Json:
    """Return the newest job of an equal request; null if there is none."""
    return respond_with_job(store, CROSS_PREDICTION, query)


@router.get("/cross-predictions", response_model=CrossPredictionMatrix)
def get_cross_predictions(store: TheStore, query: ThePredictionQuery) -> Json:
    """Return the stored fit of the outputs of maneuvers, predicted by the models of runs."""
    return Json(get_result(store, CROSS_PREDICTION, query))


@router.post(
    "/cross-validations/results", response_model=JobItem, status_code=status.HTTP_202_ACCEPTED
)
def request_cross_validation(
    context: TheContext, query: TheValidationQuery, analyst: TheAnalyst
) -> Json:
    """Queue the refits of a run without held-out data, or return the job of an equal request."""
    return submit_job(context, CROSS_VALIDATION, query, analyst, f"run {query.run_id}")


@router.get("/cross-validations/results", response_model=KnownJob)
def get_cross_validation_job(store: TheStore, query: TheValidationQuery) -> Json:
    """Return the newest job of an equal request; null if there is none."""
    return respond_with_job(store, CROSS_VALIDATION, query)


@router.get("/cross-validations", response_model=CrossValidationSummary)
def get_cross_validation(store: TheStore, query: TheValidationQuery) -> Json:
    """Return the stored fit of held-out data of a run, predicted by refits to the others.

    The figures ``held-out`` and ``held-out-residual`` have the spectra.
    """
    return Json(get_result(store, CROSS_VALIDATION, query).summary)


@router.post(
    "/aerodynamics-comparisons/results",
    response_model=JobItem,
    status_code=status.HTTP_202_ACCEPTED,
)
def request_aerodynamics_comparison(
    context: TheContext, run_id: RequiredReference, analyst: TheAnalyst
) -> Json:
    """Queue fits of a run's data with quasi-steady and shaped derivatives, or return their job."""
    query = AerodynamicsQuery(run_id=run_id)
    return submit_job(context, AERODYNAMICS, query, analyst, f"run {run_id}")


@router.get("/aerodynamics-comparisons/results", response_model=KnownJob)
def get_aerodynamics_comparison_job(store: TheStore, run_id: RequiredReference) -> Json:
    """Return the newest job of an equal request; null if there is none."""
    return respond_with_job(store, AERODYNAMICS, AerodynamicsQuery(run_id=run_id))


@router.get("/aerodynamics-comparisons", response_model=AerodynamicsComparison)
def get_aerodynamics_comparison(store: TheStore, run_id: RequiredReference) -> Json:
    """Return the stored verdict between quasi-steady and shaped derivatives for a run."""
    return Json(get_result(store, AERODYNAMICS, AerodynamicsQuery(run_id=run_id)))
