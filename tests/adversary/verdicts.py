"""Judge what the doors returned against the truth that flew."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from drawn_aircraft import Aircraft, Model
from true_model import residualize

FORCES = ("CZ", "Cm")


@dataclass(frozen=True)
class Error:
    """An estimate with its distance from the truth, in standard errors."""

    name: str
    kind: str
    distance: float


@dataclass(frozen=True)
class Verdict:
    """One run: how it ended, what it says of itself, and its errors."""

    method: str
    outcome: str  # consistent, suspect, not converged, not tested or failed
    errors: tuple[Error, ...] = ()
    without_error: int = 0  # derivatives without a standard error


def name_derivatives(model: Model) -> dict[str, float]:
    """Return the derivatives by name."""
    return {
        f"{row}_{column}": float(model.table[k, m])
        for k, row in enumerate(model.rows)
        for m, column in enumerate(model.columns)
    }


def classify(name: str) -> str:
    """Return the class of a derivative: that of its coefficient and of its variable."""
    row, _, column = name.partition("_")
    coefficient = "force" if row in FORCES else "modal"
    for kind in ("etadot", "eta"):
        if column.startswith(kind):
            return f"{coefficient} {kind}"
    if column in ("alpha", "q"):
        return f"{coefficient} {column}"
    return f"{coefficient} surface"


def judge_run(aircraft: Aircraft, n_known: int, method: str, run: dict[str, Any]) -> Verdict:
    """Compare a run with the derivatives of the modes that the analysts know.

    The static response of modes that no table has is part of the truth that any estimate can
    have; so are the derivatives of modes that the run retains.
    """
    if run["state"] != "succeeded":
        return Verdict(method, "failed")
    truth = name_derivatives(residualize(aircraft, aircraft.truth, n_known))
    found = [one for one in run["parameters"] if one["name"] in truth]
    errors = tuple(
        Error(
            one["name"],
            classify(one["name"]),
            (one["value"] - truth[one["name"]]) / one["std_error"],
        )
        for one in found
        if one["std_error"]
    )
    state = run["adequacy"]["state"]
    converged = run["fit"]["outcome"] == "converged"
    outcome = state if converged else "not converged"
    return Verdict(method, outcome, errors, len(found) - len(errors))
