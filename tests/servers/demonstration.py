"""The demonstration campaign, flown once for all tests and kept until its makers change."""

from __future__ import annotations

import fcntl
import hashlib
from pathlib import Path

from flexsid.demo.campaign import fill
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store

ROOT = Path(__file__).parents[2]


def campaign_file() -> Path:
    """Database with the whole campaign; copy it before changing anything."""
    kept = ROOT / ".cache" / "campaign" / f"{_hash_of_makers()}.db"
    kept.parent.mkdir(parents=True, exist_ok=True)
    with (kept.parent / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # other processes of the same tests wait for it
        if not kept.is_file():
            for outdated in kept.parent.glob("*.db*"):
                outdated.unlink()
            made = kept.with_suffix(".db.part")
            upgrade(f"sqlite:///{made}")
            store = Store.open(f"sqlite:///{made}")
            fill(store)
            store.close()
            made.rename(kept)
    return kept


def _hash_of_makers() -> str:
    package = ROOT / "backend" / "flexsid"
    floors = ("demo", "sysid", "records", "storage", "workflow", "importers")
    sources = [path for floor in floors for path in sorted((package / floor).rglob("*.*"))]
    digest = hashlib.sha256()
    for path in [*sources, *sorted((ROOT / "migrations").rglob("*.py"))]:
        if path.suffix != ".pyc":
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
