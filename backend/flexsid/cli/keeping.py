"""Back the database up, and bring it back."""

from __future__ import annotations

from pathlib import Path

from flexsid.cli.opening import opened
from flexsid.cli.saying import say
from flexsid.settings import Settings
from flexsid.storage import backup as copies
from flexsid.storage.migrate import upgrade
from flexsid.workflow.review.database_check import check_database


def migrate(settings: Settings, *, as_json: bool) -> int:
    """Bring the schema up to date and say where it is."""
    revision = upgrade(settings.database)
    say([f"the database is at schema {revision}"], {"schema": revision}, as_json=as_json)
    return 0


def check(settings: Settings, *, as_json: bool) -> int:
    """Look for damage; 1 where there is any."""
    with opened(settings) as store:
        found = check_database(store)
    damage = [one for one in found if one.is_damage]
    lines = [f"{'damage' if one.is_damage else 'note'}: {one.text}" for one in found]
    if not damage:
        lines.append("pages, references, samples, results and decisions are as they were stored")
    say(lines, {"sound": not damage, "findings": found}, as_json=as_json)
    return 1 if damage else 0


def backup(settings: Settings, file: str, *, as_json: bool) -> int:
    """Copy the database into a new file."""
    size = copies.backup(settings.database, Path(file))
    words = f"{file} holds the database, {size / 1e6:.1f} MB; pages, references and samples checked"
    say([words], {"file": file, "bytes": size}, as_json=as_json)
    return 0


def restore(settings: Settings, file: str, *, as_json: bool) -> int:
    """Put a backup in place of the database."""
    kept = copies.restore(settings.database, Path(file))
    lines = [f"the database holds {file} now"]
    if kept is not None:
        lines.append(f"what it held before is in {kept}")
    answer = {"file": file, "before": None if kept is None else str(kept)}
    say(lines, answer, as_json=as_json)
    return 0
