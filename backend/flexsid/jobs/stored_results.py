"""Stored results of jobs that other records refer to."""

from __future__ import annotations

from functools import partial

from flexsid.errors import FlexsidError
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import CROSS_PREDICTION, FLUTTER
from flexsid.records.condition_sheet import ConditionSheet
from flexsid.records.flutter import Flutter
from flexsid.records.validation import CrossPredictionMatrix
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_models import FlutterQuery
from flexsid.workflow.review.condition_sheet import build_condition_sheet
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery


def find_stored_flutter(store: Store, run_ids: tuple[int, ...]) -> Flutter | None:
    """Return the stored flutter prediction of runs at its default condition; None without one."""
    try:
        return get_result(store, FLUTTER, FlutterQuery(run_ids=run_ids)).flutter
    except FlexsidError:  # not computed, not ready, failed, or runs that no prediction can use
        return None


def find_stored_predictions(
    store: Store, run_ids: tuple[int, ...], maneuver_ids: tuple[int, ...]
) -> CrossPredictionMatrix | None:
    """Return the stored prediction of maneuvers by the models of runs; None without one."""
    query = CrossPredictionQuery(run_ids=run_ids, maneuver_ids=maneuver_ids)
    try:
        return get_result(store, CROSS_PREDICTION, query)
    except FlexsidError:
        return None


def read_condition_sheet(store: Store, condition_id: int) -> ConditionSheet:
    """Return the sheet of the condition of a maneuver, from stored results."""
    return build_condition_sheet(
        store,
        condition_id,
        partial(find_stored_flutter, store),
        partial(find_stored_predictions, store),
    )
