"""Evidence of decisions: hashes of data and software."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import orjson

import flexsid
from flexsid.errors import UnknownRecord
from flexsid.records.decision import DecisionEvent, StructureProposal
from flexsid.records.sealed_names import with_sealed_names
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.runs.computation import read_versions

GONE = "gone"
"""Value in place of the hash for deleted records."""


def hash_evidence(store: Store, proposal: StructureProposal) -> dict[str, str]:
    """Hash the evidence of a proposal: model structures, runs, maneuvers, figures."""
    runs = dict.fromkeys(proposal.run_ids)
    predictions: dict[int, None] = {}
    for comparison in proposal.comparisons:
        runs |= dict.fromkeys(comparison.run_ids)
        predictions |= dict.fromkeys(comparison.prediction_ids)
    found: dict[str, str] = {}
    for reference in (proposal.structure, proposal.changes):
        if reference is not None:
            name = f"structure {reference.id} version {reference.version}"
            stored = get_version(store, reference.id, reference.version)
            found[name] = hash_value([stored.name, stored.structure])
    maneuvers: dict[int, None] = {}
    for run_id in runs:
        try:
            run = store.runs.get(run_id)
        except UnknownRecord:
            run = None
        if run is None or run.deleted_at is not None:
            found[f"run {run_id}"] = GONE
            continue
        found[f"run {run_id}"] = hash_value(
            [run.method, run.maneuver_id, run.structure, run.settings, run.result, run.versions]
        )
        maneuvers |= dict.fromkeys((run.maneuver_id, *run.settings.additional_maneuver_ids))
    for maneuver_id in maneuvers:
        found[f"maneuver {maneuver_id}"] = _maneuver_hash(store, maneuver_id)
    for prediction_id in predictions:
        found[f"prediction {prediction_id}"] = hash_value(store.predictions.get(prediction_id))
    for figure_id in proposal.figure_ids:
        found[f"figure {figure_id}"] = store.frozen_figures.get(figure_id).array
    return found


def _maneuver_hash(store: Store, maneuver_id: int) -> str:
    try:
        maneuver = store.maneuvers.get(maneuver_id)
    except UnknownRecord:
        return GONE
    if maneuver.deleted_at is not None:
        return GONE
    channels = [
        [channel.name, channel.unit, channel.role, channel.rate_hz, channel.start_s, channel.array]
        for channel in store.channels.find(maneuver_id=maneuver_id)
    ]
    corrections = [
        step.correction for step in store.conditioning.find(maneuver_id=maneuver_id, undone_at=None)
    ]
    return hash_value([maneuver.condition, maneuver.excitation, channels, corrections])


def list_software_versions() -> dict[str, str]:
    """List versions of the numerical software, and the hash of the flexsid source."""
    return read_versions() | {"source": _source_hash()}


@cache
def _source_hash() -> str:
    folder = Path(flexsid.__file__).parent
    digest = hashlib.sha256()
    for file in sorted(folder.rglob("*.py")):
        digest.update(f"{file.relative_to(folder).as_posix()}\n".encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()


def seal(event: DecisionEvent) -> DecisionEvent:
    """Add the canonical text of an event and its hash."""
    sealed = _to_canonical(_get_content(event))
    return replace(event, sealed=sealed, hash=_sha256(sealed))


def is_chain_intact(events: Sequence[DecisionEvent]) -> bool:
    """Return whether every event is unchanged and none is missing."""
    previous = ""
    for number, event in enumerate(events, start=1):
        linked = (event.number, event.previous_hash) == (number, previous)
        if not linked or event.hash != _sha256(event.sealed):
            return False
        # A later release may have records with more fields than were sealed.
        if not _matches(_get_content(event), json.loads(event.sealed)):
            return False
        previous = event.hash
    return True


def hash_value(value: Any) -> str:
    """Compute SHA-256 of a value as JSON with sorted keys, without blanks and empty values.

    Empty values are omitted because a later release may add fields, which are empty in records
    stored before.
    """
    return _sha256(_to_canonical(_remove_empty(_to_plain(value))))


def _get_content(event: DecisionEvent) -> Any:
    content = _to_plain(event)
    for name in ("id", "hash", "sealed"):
        del content[name]
    return content


def _matches(found: Any, sealed: Any) -> bool:
    if isinstance(sealed, dict) and isinstance(found, dict):
        return all(key in found and _matches(found[key], value) for key, value in sealed.items())
    if isinstance(sealed, list) and isinstance(found, list):
        return len(found) == len(sealed) and all(map(_matches, found, sealed))
    return found == sealed


def _remove_empty(value: Any) -> Any:
    if isinstance(value, dict):
        items = {key: _remove_empty(item) for key, item in value.items()}
        return {key: item for key, item in items.items() if not _is_empty(item)}
    if isinstance(value, list):
        return [_remove_empty(item) for item in value]
    return value


def _is_empty(value: Any) -> bool:
    # A zero is not empty.
    return value is None or value is False or (isinstance(value, str | list | dict) and not value)


def _to_plain(value: Any) -> Any:
    plain = orjson.loads(orjson.dumps(value, option=orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z))
    return with_sealed_names(plain)


def _to_canonical(content: Any) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
