"""The demonstration campaign, simulated once for all tests and cached until its code changes."""

from __future__ import annotations

import fcntl
import hashlib
from pathlib import Path

from flexsid.demo.campaign import add_campaign
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store

ROOT = Path(__file__).parents[2]


def campaign_file() -> Path:
    """Database with the whole campaign; copy it before changing anything."""
    cached = ROOT / ".cache" / "campaign" / f"{_hash_sources()}.db"
    cached.parent.mkdir(parents=True, exist_ok=True)
    with (cached.parent / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # other processes of the same tests wait for it
        if not cached.is_file():
            for outdated in cached.parent.glob("*.db*"):
                outdated.unlink()
            partial = cached.with_suffix(".db.part")
            upgrade(f"sqlite:///{partial}")
            store = Store.open(f"sqlite:///{partial}")
            add_campaign(store)
            store.close()
            partial.rename(cached)
    return cached


def _hash_sources() -> str:
    package = ROOT / "backend" / "flexsid"
    layers = ("demo", "sysid", "records", "storage", "workflow", "importers")
    sources = [path for layer in layers for path in sorted((package / layer).rglob("*.*"))]
    digest = hashlib.sha256()
    for path in [*sources, *sorted((ROOT / "migrations").rglob("*.py"))]:
        if path.suffix != ".pyc":
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
