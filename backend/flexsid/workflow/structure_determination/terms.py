"""What the data say of every term: its value, its support, what it cannot be told from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.records.finite import finite_or_none
from flexsid.records.search import SearchStep, SearchTerm, TermDependency, TermGroup
from flexsid.sysid.spectra.collinearity import near_dependencies
from flexsid.sysid.structure_determination.evidence import Evidence
from flexsid.sysid.structure_determination.selection import Selection, SelectionStep


def term_group(
    name: str, selection: Selection, evidences: Sequence[Evidence], often: np.ndarray
) -> TermGroup:
    """Tell of a choice among terms; ``often`` says how often each stays when lines are redrawn."""
    total = np.sum([one.information for one in evidences], axis=0)
    size = np.sqrt(np.maximum(np.diag(total), np.finfo(float).tiny))
    unit = total / np.outer(size, size)
    inflation = np.diag(np.linalg.pinv(unit, rcond=1e-12, hermitian=True))
    inside = np.array([term.chosen for term in selection.terms])
    names = [term.name for term in selection.terms]
    chosen = [term.name for term in selection.terms if term.chosen]
    among = near_dependencies(total[np.ix_(inside, inside)], chosen) if inside.any() else ()
    before = near_dependencies(total, names)
    criteria = selection.criteria
    return TermGroup(
        name=name,
        path=tuple(_step(step) for step in selection.path),
        terms=tuple(
            SearchTerm(
                name=term.name,
                chosen=term.chosen,
                value=term.value if np.isfinite(term.std_error) else None,
                std_error=finite_or_none(term.std_error),
                f=term.f,
                support=term.share,
                stability=finite_or_none(share),
                inflation=float(grown) if 0.0 < grown < 1e8 else None,
            )
            for term, share, grown in zip(selection.terms, often, inflation, strict=True)
        ),
        dependencies=tuple(
            TermDependency(condition_index=one.index, shares=one.shares)
            for one in (*among, *(b for b in before if b not in among))
        ),
        r_squared=finite_or_none(criteria.r_squared),
        pse=finite_or_none(criteria.pse),
        bic=finite_or_none(criteria.bic),
    )


def _step(step: SelectionStep) -> SearchStep:
    return SearchStep(
        action=step.action,
        term=step.term,
        f=step.f,
        n_terms=step.criteria.n_terms,
        r_squared=finite_or_none(step.criteria.r_squared),
        pse=finite_or_none(step.criteria.pse),
        bic=finite_or_none(step.criteria.bic),
    )
