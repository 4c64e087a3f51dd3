"""Import of files in one call, for tests."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from flexsid.records.maneuver import Maneuver
from flexsid.storage.store import Store
from flexsid.workflow.importing.flight_import import Imported, read_upload, store_upload


def import_files(
    store: Store,
    files: Sequence[Path],
    mapping: Path | str | None = None,
    aircraft_id: int | None = None,
    *,
    confirmed: bool = False,
) -> Imported:
    """Read files and store their contents."""
    return store_upload(store, read_upload(files, mapping), aircraft_id, confirmed=confirmed)


def import_maneuver(store: Store, files: Sequence[Path], mapping: Path | str) -> Maneuver:
    """Import files that hold a maneuver."""
    maneuver = import_files(store, files, mapping).maneuver
    assert maneuver is not None
    return maneuver
