"""Selection: terms chosen one by one, with the criteria after every step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import BadInput
from flexsid.sysid.structure_determination.evidence import Evidence, support


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """What a term must show.

    ``f_in`` and ``f_out`` bound the partial F to enter and to stay (4 is 95 %, 20 is
    conservative: four and a half standard errors); ``pse_noise`` is how many noise variances
    the predicted squared error charges for a term.
    """

    f_in: float = 20.0
    f_out: float = 20.0
    pse_noise: float = 25.0

    def __post_init__(self) -> None:
        for name in ("f_in", "f_out", "pse_noise"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise BadInput(f"{name} is {value}; it must be a number above zero", field=name)
        if self.f_out > self.f_in:
            raise BadInput(
                f"f_out {self.f_out:g} is above f_in {self.f_in:g}: terms would enter and leave "
                "without end; choose f_out no larger",
                field="f_out",
            )


USUAL = Thresholds()
"""What a term must show when nothing else is asked."""


@dataclass(frozen=True, slots=True)
class Criteria:
    """How well a set of terms does.

    ``r_squared`` of the weighted lines; ``pse`` the predicted squared error in noise
    variances; ``bic`` Schwarz's criterion, twice the description length (MDL).
    """

    n_terms: int
    r_squared: float
    pse: float
    bic: float


@dataclass(frozen=True, slots=True)
class SelectionStep:
    """One step of a path: ``enter`` or ``drop`` a term, its partial F, and what follows."""

    action: str
    term: str
    f: float
    criteria: Criteria


@dataclass(frozen=True, slots=True)
class Term:
    """One candidate at the end of a search.

    ``value`` is what it has, or would take as the next to enter; ``share`` the part of the
    maneuvers that support it alone.
    """

    name: str
    chosen: bool
    value: float
    std_error: float
    f: float
    share: float


@dataclass(frozen=True, slots=True)
class Selection:
    """Which terms of one coefficient the data ask for, and how the search went."""

    method: str
    path: tuple[SelectionStep, ...]
    terms: tuple[Term, ...]
    criteria: Criteria

    @property
    def chosen(self) -> tuple[str, ...]:
        """Names of the chosen terms, in the order of the candidates."""
        return tuple(term.name for term in self.terms if term.chosen)


def criteria_of(
    evidences: Sequence[Evidence],
    chosen: Bool[np.ndarray, " p"],
    rest: Float[np.ndarray, " n_maneuvers"],
    thresholds: Thresholds,
) -> Criteria:
    """Judge a set of terms by what it leaves.

    Notes
    -----
    PSE = MSFE + (pse_noise sigma^2) n / N with sigma^2 the residuals' variance with all
    candidates (Morelli); BIC = N ln(MSFE) + n ln N. Every maneuver has its own values.
    """
    n_terms = int(np.count_nonzero(chosen))
    n_data = np.array([one.n_data for one in evidences])
    total = np.array([one.total for one in evidences])
    error = np.maximum(rest, 1e-12 * total) / n_data
    return Criteria(
        n_terms=n_terms,
        r_squared=float(1.0 - rest.sum() / total.sum()),
        pse=float((rest.sum() + thresholds.pse_noise * n_terms * n_data.size) / n_data.sum()),
        bic=float(n_data @ np.log(error) + n_terms * np.log(n_data).sum()),
    )


@dataclass(frozen=True, slots=True)
class Walk:
    """Where a walk over the terms stands, and the steps that led there."""

    chosen: Bool[np.ndarray, " p"]
    path: tuple[SelectionStep, ...] = ()


def walk(
    evidences: Sequence[Evidence],
    start: Walk,
    thresholds: Thresholds,
    *,
    forced: Bool[np.ndarray, " p"] | None = None,
    enter: bool = True,
) -> Walk:
    """Drop the weakest term that is not supported, else enter the strongest that is.

    Parameters
    ----------
    evidences
        Of the same candidates, one per maneuver.
    start
        The terms to start from; the steps go on behind its path.
    thresholds
        What a term must show.
    forced
        Terms that stay whatever they show.
    enter
        Whether terms may enter at all.

    Notes
    -----
    A term that was dropped twice does not come back, so that the walk ends.
    """
    names = evidences[0].names
    free = np.ones(len(names), dtype=bool) if forced is None else ~forced
    chosen, path = start.chosen | ~free, list(start.path)
    dropped = np.zeros(len(names), dtype=int)
    now = support(evidences, chosen)
    while True:
        loose = chosen & free & ~now.held_by(thresholds.f_out)
        ready = ~chosen & (dropped < 2) & now.held_by(thresholds.f_in)
        if loose.any():
            moved, action = int(np.argmin(np.where(loose, now.f, np.inf))), "drop"
            dropped[moved] += 1
        elif enter and ready.any():
            moved, action = int(np.argmax(np.where(ready, now.gain, -1.0))), "enter"
        else:
            return Walk(chosen, tuple(path))
        f = float(now.f[moved])
        chosen = chosen.copy()
        chosen[moved] = action == "enter"
        now = support(evidences, chosen)
        path.append(
            SelectionStep(
                action, names[moved], f, criteria_of(evidences, chosen, now.rest, thresholds)
            )
        )


def selection_at(
    method: str, evidences: Sequence[Evidence], end: Walk, thresholds: Thresholds
) -> Selection:
    """Tell every term's standing where a walk ended."""
    now = support(evidences, end.chosen)
    share = np.mean(now.each_f > thresholds.f_in, axis=0)
    terms = tuple(
        Term(*row)
        for row in zip(
            evidences[0].names,
            end.chosen.tolist(),
            now.values.tolist(),
            now.std_errors.tolist(),
            now.f.tolist(),
            share.tolist(),
            strict=True,
        )
    )
    criteria = criteria_of(evidences, end.chosen, now.rest, thresholds)
    return Selection(method, end.path, terms, criteria)
