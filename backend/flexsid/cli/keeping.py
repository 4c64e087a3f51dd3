"""Back the database up, and bring it back."""

from __future__ import annotations

from pathlib import Path

from flexsid.settings import Settings
from flexsid.storage import backup as copies


def backup(settings: Settings, file: str) -> int:
    """Copy the database into a new file."""
    size = copies.backup(settings.database, Path(file))
    print(f"{file} holds the database, {size / 1e6:.1f} MB, checked")
    return 0


def restore(settings: Settings, file: str) -> int:
    """Put a backup in place of the database."""
    kept = copies.restore(settings.database, Path(file))
    print(f"the database holds {file} now")
    if kept is not None:
        print(f"what it held before is in {kept}")
    return 0
