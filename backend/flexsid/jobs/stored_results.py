"""Stored results of jobs that other records refer to."""

from __future__ import annotations

from flexsid.errors import FlexsidError
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import FLUTTER
from flexsid.records.flutter import Flutter
from flexsid.storage.store import Store
from flexsid.workflow.flutter.flutter_models import FlutterQuery


def find_stored_flutter(store: Store, run_ids: tuple[int, ...]) -> Flutter | None:
    """Return the stored flutter prediction of runs at its default condition; None without one."""
    try:
        return get_result(store, FLUTTER, FlutterQuery(run_ids=run_ids)).flutter
    except FlexsidError:  # not computed, not ready, failed, or runs that no prediction can use
        return None
