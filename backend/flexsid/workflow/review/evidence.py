"""Evidence of decisions: hashes of data and software, and model structure searches."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import chain
from pathlib import Path

import flexsid
from flexsid.errors import UnknownRecord
from flexsid.records.decision import ModelProposal, Structure
from flexsid.records.run import AdequacyState
from flexsid.records.search import SearchCandidate, SearchResult, StructureSearch
from flexsid.storage.audit_recording import hash_value
from flexsid.storage.store import Store
from flexsid.sysid.adequacy.validation import LEAST_DIFFERENCE
from flexsid.workflow.fits.estimation_task import read_versions
from flexsid.workflow.model_structures.model_structures import get_version, hash_run

# --- Evidence of decisions: hashes of data and software -------------------------------------------

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


# --- Evidence of model structure searches on a proposed model structure ---------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchEvidence:
    """A search with the proposed model structure among its candidates.

    ``adequacy`` is that of its model with all terms, with the ``reason``; ``is_proposed`` is
    whether the search proposes the structure. ``likelihood_difference`` is the log likelihood of
    held-out data by the structure less that by all terms; None where one of them is unknown.
    """

    search_id: int
    method: str
    maneuver_labels: tuple[str, ...]
    adequacy: AdequacyState
    reason: str
    is_proposed: bool
    n_terms: int
    n_candidate_terms: int
    likelihood_difference: float | None


def collect_search_evidence(
    store: Store, aircraft_id: int, structure: Structure
) -> tuple[SearchEvidence, ...]:
    """Collect the searches of an aircraft that have a model structure among their candidates."""
    found = []
    for search in store.searches.find(aircraft_id=aircraft_id):
        if search.result is None:
            continue
        own = _find_candidate(search.result, structure)
        if own is not None:
            found.append(_describe(store, search, search.result, own))
    return tuple(found)


def _find_candidate(result: SearchResult, structure: Structure) -> SearchCandidate | None:
    wanted = _sort_terms(structure)
    return next((one for one in result.candidates if _sort_terms(one.structure) == wanted), None)


def _sort_terms(structure: Structure) -> Structure:
    free = None if structure.free is None else tuple(sorted(structure.free))
    return replace(structure, free=free, absent=tuple(sorted(structure.absent)))


def _describe(
    store: Store, search: StructureSearch, result: SearchResult, own: SearchCandidate
) -> SearchEvidence:
    assert search.id is not None
    full = max(result.candidates, key=lambda one: one.n_terms)
    of_own, of_full = own.predictive_cost, full.predictive_cost
    return SearchEvidence(
        search_id=search.id,
        method=search.method.value,
        maneuver_labels=tuple(store.maneuvers.get(m).label for m in search.maneuver_ids),
        adequacy=full.adequacy,
        reason=full.adequacy_reason,
        is_proposed=own.proposed,
        n_terms=own.n_terms,
        n_candidate_terms=full.n_terms,
        likelihood_difference=None if of_own is None or of_full is None else of_full - of_own,
    )


def warn_of_searches(searches: Sequence[SearchEvidence]) -> list[str]:
    """Warn of searches that speak against the proposed model structure."""
    warnings = []
    for one in searches:
        named = f"Search {one.search_id}"
        difference = one.likelihood_difference
        if one.adequacy is AdequacyState.SUSPECT:
            warnings.append(f"{named}: a test rejects the model with all terms. {one.reason}")
        elif not one.is_proposed:
            warnings.append(f"{named} does not propose this model structure.")
        if difference is not None and difference < -LEAST_DIFFERENCE:
            warnings.append(
                f"{named}: the log likelihood of held-out data is lower by {-difference:.3g} than "
                "with all terms."
            )
    return warnings
