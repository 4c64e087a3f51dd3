"""Evidence of model structure searches on a proposed model structure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from flexsid.records.model_structure import Structure
from flexsid.records.run import AdequacyState
from flexsid.records.search import SearchCandidate, SearchResult, StructureSearch
from flexsid.storage.store import Store
from flexsid.sysid.estimation.held_out_likelihood import LEAST_DIFFERENCE


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
