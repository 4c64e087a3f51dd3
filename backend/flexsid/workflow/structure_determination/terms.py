"""Statistics of the candidate terms: value, F, selection frequency and collinearity."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.records.finite import finite_or_none
from flexsid.records.search import SearchStep, SearchTerm, TermDependency, TermGroup
from flexsid.sysid.spectra.collinearity import find_near_dependencies
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.selection import Selection, SelectionStep


def build_term_group(
    name: str, selection: Selection, evidences: Sequence[Evidence], stability: np.ndarray
) -> TermGroup:
    """Build the statistics of a selection; ``stability`` is the selection frequency by term."""
    total = np.sum([one.information for one in evidences], axis=0)
    size = np.sqrt(np.maximum(np.diag(total), np.finfo(float).tiny))
    unit = total / np.outer(size, size)
    inflation = np.diag(np.linalg.pinv(unit, rcond=1e-12, hermitian=True))
    inside = np.array([term.selected for term in selection.terms])
    names = [term.name for term in selection.terms]
    selected = [term.name for term in selection.terms if term.selected]
    among = find_near_dependencies(total[np.ix_(inside, inside)], selected) if inside.any() else ()
    before = find_near_dependencies(total, names)
    criteria = selection.criteria
    return TermGroup(
        name=name,
        path=tuple(_build_step(step) for step in selection.path),
        terms=tuple(
            SearchTerm(
                name=term.name,
                selected=term.selected,
                value=term.value if np.isfinite(term.std_error) else None,
                std_error=finite_or_none(term.std_error),
                f=term.f,
                support=term.share,
                stability=finite_or_none(share),
                inflation=float(grown) if 0.0 < grown < 1e8 else None,
            )
            for term, share, grown in zip(selection.terms, stability, inflation, strict=True)
        ),
        dependencies=tuple(
            TermDependency(condition_index=one.index, shares=one.shares)
            for one in (*among, *(b for b in before if b not in among))
        ),
        r_squared=finite_or_none(criteria.r_squared),
        pse=finite_or_none(criteria.pse),
        bic=finite_or_none(criteria.bic),
    )


def _build_step(step: SelectionStep) -> SearchStep:
    return SearchStep(
        action=step.action,
        term=step.term,
        f=step.f,
        n_terms=step.criteria.n_terms,
        r_squared=finite_or_none(step.criteria.r_squared),
        pse=finite_or_none(step.criteria.pse),
        bic=finite_or_none(step.criteria.bic),
    )
