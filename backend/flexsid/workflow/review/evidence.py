"""Evidence of decisions: hashes of data and software."""

from __future__ import annotations

import hashlib
from functools import cache
from itertools import chain
from pathlib import Path

import flexsid
from flexsid.errors import UnknownRecord
from flexsid.records.decision import ModelProposal
from flexsid.storage.event_chain import hash_value
from flexsid.storage.store import Store
from flexsid.workflow.fits.software_versions import read_versions
from flexsid.workflow.model_structures.model_structures import get_version
from flexsid.workflow.model_structures.run_results import hash_run

GONE = "gone"
"""Value in place of the hash for deleted records."""


def hash_evidence(store: Store, proposal: ModelProposal) -> dict[str, str]:
    """Hash the evidence of a proposal: models, runs, maneuvers, predictions, figures."""
    found: dict[str, str] = {}
    for reference in (proposal.structure, proposal.changes):
        if reference is not None:
            name = f"structure {reference.id} version {reference.version}"
            stored = get_version(store, reference.id, reference.version)
            found[name] = hash_value([stored.name, stored.structure])
    if proposal.global_model_id is not None:
        version = store.global_model_versions.get(proposal.global_model_id)
        found[f"global model {version.id}"] = hash_value(version)
    maneuvers: dict[int, None] = {}
    for run_id in proposal.all_run_ids:
        try:
            run = store.runs.get(run_id)
        except UnknownRecord:
            run = None
        if run is None or run.deleted_at is not None:
            found[f"run {run_id}"] = GONE
            continue
        found[f"run {run_id}"] = hash_run(run)
        maneuvers |= dict.fromkeys((run.maneuver_id, *run.settings.additional_maneuver_ids))
    for maneuver_id in maneuvers:
        found[f"maneuver {maneuver_id}"] = _maneuver_hash(store, maneuver_id)
    predictions = chain.from_iterable(one.prediction_ids for one in proposal.comparisons)
    for prediction_id in dict.fromkeys(predictions):
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
