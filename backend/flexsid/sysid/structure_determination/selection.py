"""Selection of terms one by one, with the criteria after every step, and its stability."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from flexsid.errors import BadInput
from flexsid.sysid.estimation.experiment import Parameters
from flexsid.sysid.structure_determination.evidence import Evidence, pool_evidence

# --- Selection: terms selected one by one, with the criteria after every step, and its stability

_MOST_DROPS = 2  # of one term, so that a search ends


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """Thresholds of the partial F and of the predicted squared error.

    ``f_in`` and ``f_out`` bound the partial F to enter and to stay (4 is 95 %, 20 is
    conservative: four and a half standard errors); ``pse_noise`` is the penalty of a term
    in the predicted squared error, in noise variances.
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


DEFAULT_THRESHOLDS = Thresholds()
"""Thresholds by default."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ValidationFit:
    """Prediction of data by a model that was not fitted to them.

    ``cost`` is their negative log likelihood, with the noise of the prediction errors;
    ``r_squared`` the share of the outputs' power that is predicted, outputs equally
    weighted. Both are None where the prediction is not finite.
    """

    name: str
    cost: float | None
    r_squared: float | None


@dataclass(frozen=True, slots=True)
class Criteria:
    """Criteria of a set of terms.

    ``r_squared`` of the weighted data points; ``pse`` the predicted squared error in noise
    variances; ``bic`` Schwarz's criterion, twice the description length (MDL).
    """

    n_terms: int
    r_squared: float
    pse: float
    bic: float


@dataclass(frozen=True, slots=True)
class SelectionStep:
    """One step of a path: ``enter`` or ``drop`` a term, its partial F, and the criteria then."""

    action: str
    term: str
    f: float
    criteria: Criteria


@dataclass(frozen=True, slots=True)
class Term:
    """One candidate at the end of a search.

    ``value`` is its value, or its value if entered next, both None if it is linearly dependent;
    ``support`` the fraction of the single maneuvers that support it.
    """

    name: str
    selected: bool
    value: float | None
    std_error: float | None
    f: float
    support: float


@dataclass(frozen=True, slots=True)
class Selection:
    """Selected terms of one coefficient, and the path of the search."""

    path: tuple[SelectionStep, ...]
    terms: tuple[Term, ...]
    criteria: Criteria

    @property
    def selected(self) -> tuple[str, ...]:
        """Names of the selected terms, in the order of the candidates."""
        return tuple(term.name for term in self.terms if term.selected)


def compute_criteria(
    evidences: Sequence[Evidence],
    selected: Bool[np.ndarray, " p"],
    rest: Float[np.ndarray, " n_maneuvers"],
    thresholds: Thresholds,
) -> Criteria:
    """Compute the criteria of a set of terms from its residuals.

    Notes
    -----
    PSE = MSFE + (pse_noise sigma^2) n / N with sigma^2 the residuals' variance with all
    candidates (Morelli); BIC = N ln(MSFE) + n ln N. Every maneuver has its own values.
    """
    n_terms = int(np.count_nonzero(selected))
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
class SelectionState:
    """Selected terms, and the steps of the path to them."""

    selected: Bool[np.ndarray, " p"]
    path: tuple[SelectionStep, ...] = ()


def select_terms(
    evidences: Sequence[Evidence],
    start: SelectionState,
    thresholds: Thresholds,
    *,
    forced: Bool[np.ndarray, " p"] | None = None,
    enter: bool = True,
) -> SelectionState:
    """Select terms: drop the weakest unsupported one, else enter the strongest supported one.

    The steps are appended to the path of ``start``; ``forced`` terms are never dropped, and
    none enters without ``enter``. ``evidences`` are of the same candidates, one per maneuver.

    Notes
    -----
    A term that was dropped twice does not enter again, so that the search ends.
    """
    names = evidences[0].names
    free = np.ones(len(names), dtype=bool) if forced is None else ~forced
    selected, path = start.selected | ~free, list(start.path)
    dropped = np.zeros(len(names), dtype=int)
    now = pool_evidence(evidences, selected)
    while True:
        unsupported = selected & free & ~now.find_supported(thresholds.f_out)
        eligible = ~selected & (dropped < _MOST_DROPS) & now.find_supported(thresholds.f_in)
        if unsupported.any():
            moved, action = int(np.argmin(np.where(unsupported, now.f, np.inf))), "drop"
            dropped[moved] += 1
        elif enter and eligible.any():
            moved, action = int(np.argmax(np.where(eligible, now.gain, -1.0))), "enter"
        else:
            return SelectionState(selected, tuple(path))
        f = float(now.f[moved])
        selected = selected.copy()
        selected[moved] = action == "enter"
        now = pool_evidence(evidences, selected)
        criteria = compute_criteria(evidences, selected, now.rest, thresholds)
        path.append(SelectionStep(action, names[moved], f, criteria))


def summarise_selection(
    evidences: Sequence[Evidence], end: SelectionState, thresholds: Thresholds
) -> Selection:
    """Summarise every term at the end of a search.

    Notes
    -----
    Dropped terms are not zero but too small to be supported, and bias the selected ones. Their
    standard errors include the square of the bias that is estimated without bias from the change
    d of a value from that with all terms: d^2 - var(d), if positive, with var(d) the difference of
    the variances. Source: Claeskens and Hjort, The focused information criterion, Journal of the
    American Statistical Association 98 (2003), doi:10.1198/016214503000000819.
    """
    now = pool_evidence(evidences, end.selected)
    every = pool_evidence(evidences, np.ones_like(end.selected))
    change = now.values - every.values
    of_change = np.maximum(every.std_errors**2 - now.std_errors**2, 0.0)
    bias = np.where(end.selected, np.maximum(change**2 - of_change, 0.0), 0.0)
    support = np.mean(now.each_f > thresholds.f_in, axis=0)
    widened = np.sqrt(now.std_errors**2 + bias)
    values, std_errors = now.values.astype(object), widened.astype(object)
    values[~np.isfinite(widened)] = std_errors[~np.isfinite(widened)] = None
    columns = (end.selected, values, std_errors, now.f, support)
    rows = zip(evidences[0].names, *(column.tolist() for column in columns), strict=True)
    criteria = compute_criteria(evidences, end.selected, now.rest, thresholds)
    return Selection(end.path, tuple(Term(*row) for row in rows), criteria)


def compute_selection_frequency(
    evidences: Sequence[Evidence],
    search: Callable[[Sequence[Evidence]], Selection],
    n_resamplings: int,
) -> Float[np.ndarray, " p"]:
    """Compute the share of bootstrap samples in which every candidate is selected.

    ``evidences`` are of the same candidates, one per maneuver; ``search`` is repeated for
    every sample. NaN without samples.

    Notes
    -----
    Combs of neighbouring frequencies are drawn with replacement (bootstrap), separately
    in every maneuver, which preserves the correlation between neighbours.
    """
    rng = np.random.default_rng(0)
    sizes = [len(one.parts) for one in evidences]
    hits = np.zeros(len(evidences[0].names))
    for _ in range(n_resamplings):
        drawn = []
        for one, n_parts in zip(evidences, sizes, strict=True):
            counts = np.bincount(rng.integers(n_parts, size=n_parts), minlength=n_parts)
            drawn.append(one.resample(counts.astype(float)))
        hits += [term.selected for term in search(drawn).terms]
    return hits / n_resamplings if n_resamplings else np.full(hits.size, np.nan)


# --- Models with some of the candidate terms ------------------------------------------------------


def select_candidates(
    candidates: Parameters,
    selected: Bool[np.ndarray, " n_theta"],
    theta: Float[np.ndarray, " n_theta"],
) -> Parameters:
    """Select the parameters of a model with some of the candidates, started at theta."""
    n = candidates.rows.size
    table = candidates.table(np.where(selected, theta, 0.0))
    inside = np.flatnonzero(selected)
    return replace(
        candidates,
        names=tuple(candidates.names[i] for i in inside),
        start=theta[inside],
        base=table,
        rows=candidates.rows[selected[:n]],
        columns=candidates.columns[selected[:n]],
        extras=tuple(e for e, k in zip(candidates.extras, selected[n:], strict=True) if k),
    )


def expand_values(
    candidates: Parameters, values: Mapping[str, float]
) -> Float[np.ndarray, " n_theta"]:
    """Return the values of all candidates, zero for those that are not in a model."""
    return np.array([values.get(name, 0.0) for name in candidates.names])
