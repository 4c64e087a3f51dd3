"""Evidence: what a decision rests on, named by hash, data and software alike."""

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
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.runs.computation import versions

GONE = "gone"
"""Stands where the hash would, for what has been deleted since."""


def data_of(store: Store, proposal: StructureProposal) -> dict[str, str]:
    """Hash everything that a proposal rests on: structures, runs, maneuvers, figures."""
    runs = dict.fromkeys(proposal.run_ids)
    predictions: dict[int, None] = {}
    for comparison in proposal.comparisons:
        runs |= dict.fromkeys(comparison.run_ids)
        predictions |= dict.fromkeys(comparison.prediction_ids)
    found: dict[str, str] = {}
    for reference in (proposal.structure, proposal.changes):
        if reference is not None:
            name = f"structure {reference.id} version {reference.version}"
            kept = get_version(store, reference.id, reference.version)
            found[name] = hash_of([kept.name, kept.structure])
    maneuvers: dict[int, None] = {}
    for run_id in runs:
        try:
            run = store.runs.get(run_id)
        except UnknownRecord:
            run = None
        if run is None or run.deleted_at is not None:
            found[f"run {run_id}"] = GONE
            continue
        found[f"run {run_id}"] = hash_of(
            [run.method, run.maneuver_id, run.structure, run.settings, run.result, run.versions]
        )
        maneuvers |= dict.fromkeys((run.maneuver_id, *run.settings.together_with))
    for maneuver_id in maneuvers:
        found[f"maneuver {maneuver_id}"] = _maneuver_hash(store, maneuver_id)
    for prediction_id in predictions:
        found[f"prediction {prediction_id}"] = hash_of(store.predictions.get(prediction_id))
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
    return hash_of([maneuver.condition, maneuver.excitation, channels, corrections])


def software() -> dict[str, str]:
    """Versions of what computes, and a hash of our own source."""
    return versions() | {"source": _source_hash()}


@cache
def _source_hash() -> str:
    folder = Path(flexsid.__file__).parent
    digest = hashlib.sha256()
    for file in sorted(folder.rglob("*.py")):
        digest.update(f"{file.relative_to(folder).as_posix()}\n".encode())
        digest.update(file.read_bytes())
    return digest.hexdigest()


def seal(event: DecisionEvent) -> DecisionEvent:
    """Put the text of an event and its hash into it."""
    sealed = _canonical(_content(event))
    return replace(event, sealed=sealed, hash=_sha256(sealed))


def chain_is_whole(events: Sequence[DecisionEvent]) -> bool:
    """Whether every event is as it was written and none is missing."""
    previous = ""
    for number, event in enumerate(events, start=1):
        linked = (event.number, event.previous_hash) == (number, previous)
        if not linked or event.hash != _sha256(event.sealed):
            return False
        # A later release may give records more fields than were sealed.
        if not _says(_content(event), json.loads(event.sealed)):
            return False
        previous = event.hash
    return True


def hash_of(value: Any) -> str:
    """SHA-256 of a value as JSON: sorted keys, no blanks, nothing that is empty.

    What is empty is left out because a later release may add fields, which are empty
    in everything kept before.
    """
    return _sha256(_canonical(_without_empty(_plain(value))))


def _content(event: DecisionEvent) -> Any:
    content = _plain(event)
    for name in ("id", "hash", "sealed"):
        del content[name]
    return content


def _says(found: Any, sealed: Any) -> bool:
    if isinstance(sealed, dict) and isinstance(found, dict):
        return all(key in found and _says(found[key], value) for key, value in sealed.items())
    if isinstance(sealed, list) and isinstance(found, list):
        return len(found) == len(sealed) and all(map(_says, found, sealed))
    return found == sealed


def _without_empty(value: Any) -> Any:
    if isinstance(value, dict):
        kept = {key: _without_empty(item) for key, item in value.items()}
        return {key: item for key, item in kept.items() if not _is_empty(item)}
    if isinstance(value, list):
        return [_without_empty(item) for item in value]
    return value


def _is_empty(value: Any) -> bool:
    # A zero is a number that somebody meant.
    return value is None or value is False or (isinstance(value, str | list | dict) and not value)


def _plain(value: Any) -> Any:
    return orjson.loads(orjson.dumps(value, option=orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z))


def _canonical(content: Any) -> str:
    return json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
