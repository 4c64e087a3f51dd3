"""Sections of reports on validation: stored results, since reports compute nothing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeVar

from flexsid.errors import BadInput, Conflict
from flexsid.jobs.kind import Kind, get_result
from flexsid.jobs.kinds import CROSS_PREDICTION, CROSS_VALIDATION
from flexsid.records.validation import CrossValidationSummary
from flexsid.reports.content import ReportTable, Section, Words, draw
from flexsid.storage.store import Store
from flexsid.workflow.validation.cross_prediction import CrossPredictionQuery
from flexsid.workflow.validation.cross_validation import CrossValidationQuery

Result = TypeVar("Result")


def report_cross_validation(store: Store, run_id: int) -> tuple[Section, ...]:
    """Report the stored five-fold cross-validation of a run; no section without one."""
    found = _find_result(store, CROSS_VALIDATION, CrossValidationQuery(run_id=run_id))
    if found is None:
        return ()
    residual = draw("Residuals at the data held out", store, "held-out-residual", run_id=run_id)
    section = Section(
        "Cross-validation", (Words(found.summary.sentence), _tabulate(found.summary), residual)
    )
    return (section,)


def report_cross_predictions(store: Store, run_ids: Sequence[int]) -> tuple[Section, ...]:
    """Report the stored matrix of runs and their maneuvers; no section without one."""
    runs = tuple(dict.fromkeys(run_ids))
    if _find_result(store, CROSS_PREDICTION, CrossPredictionQuery(run_ids=runs)) is None:
        return ()
    caption = "Mean R² of the outputs of each maneuver, predicted by each model"
    drawing = draw(caption, store, "cross-prediction", run_ids=runs)
    return (Section("Cross-prediction", (drawing,)),)


def _find_result(store: Store, kind: Kind[Any, Result], query: object) -> Result | None:
    try:
        return get_result(store, kind, query)
    except (BadInput, Conflict):  # runs that may be compared, but not predict each other
        return None


def _tabulate(found: CrossValidationSummary) -> ReportTable:
    return ReportTable(
        ("output", "maneuver", "R²", "of the run", "Theil", "of the run"),
        tuple(
            (
                one.output,
                str(one.maneuver_id),
                f"{one.r_squared:.3f}",
                f"{one.fitted_r_squared:.3f}",
                f"{one.theil:.3f}",
                f"{one.fitted_theil:.3f}",
            )
            for one in found.outputs
        ),
        "R² and Theil's inequality coefficient of the data held out, by refits and by the run",
        numbers_from=2,
    )
