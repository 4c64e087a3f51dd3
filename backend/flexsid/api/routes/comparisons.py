"""Comparisons: derivatives of runs and predictions side by side."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from flexsid.api.context import TheStore
from flexsid.api.wire import Json, split_ids
from flexsid.records.comparison import Comparison
from flexsid.workflow.comparison import compare

router = APIRouter(prefix="/comparisons", tags=["comparisons"])


@router.get("", response_model=Comparison)
def get_comparison(
    store: TheStore,
    run_ids: Annotated[str, Query(description="Ids of runs, separated by commas.")],
    prediction_ids: Annotated[
        str | None, Query(description="Ids of predictions, separated by commas.")
    ] = None,
) -> Json:
    """Compare derivatives of runs and predictions."""
    return Json(
        compare(store, split_ids(run_ids, "run_ids"), split_ids(prediction_ids, "prediction_ids"))
    )
