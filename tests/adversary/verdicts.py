"""Judge what the doors returned against the truth that flew."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from drawn_aircraft import Aircraft, Model
from true_model import find_flutter, residualize

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
    errors = compute_errors(truth, found)
    state = run["adequacy"]["state"]
    converged = run["fit"]["outcome"] == "converged"
    outcome = state if converged else "not converged"
    return Verdict(method, outcome, errors, len(found) - len(errors))


def compute_errors(truth: dict[str, float], found: Iterable[dict[str, Any]]) -> tuple[Error, ...]:
    """Return the errors of the values that have a truth and a standard error."""
    return tuple(
        Error(
            one["name"],
            classify(one["name"]),
            (one["value"] - truth[one["name"]]) / one["std_error"],
        )
        for one in found
        if one["name"] in truth and one["value"] is not None and one["std_error"]
    )


@dataclass(frozen=True)
class FlutterVerdict:
    """A flutter prediction: whether its interval holds the truth, or that it has none."""

    method: str
    outcome: str  # holds, misses, none, none but true, speed but none true
    half_width: float = 0.0  # of the interval, over the flutter speed


def judge_flutter(aircraft: Aircraft, method: str, found: dict[str, Any]) -> FlutterVerdict:
    """Compare a prediction with the flutter speed of the whole truth at the same density."""
    flown = replace(aircraft, density=found["density_kg_m3"])
    truth = find_flutter(flown, aircraft.truth)
    low, high = found["low_m_s"], found["high_m_s"]
    if low is None or high is None:
        beyond = truth is None or truth > found["searched_to_m_s"]
        return FlutterVerdict(method, "none" if beyond else "none but true")
    if truth is None:
        return FlutterVerdict(method, "speed but none true")
    width = (high - low) / 2 / truth
    return FlutterVerdict(method, "holds" if low <= truth <= high else "misses", width)


@dataclass(frozen=True)
class SearchVerdict:
    """A search: terms that its path ends with, against the truth and the run of its method."""

    method: str
    outcome: str  # proposes, undecided or failed
    strong: int = 0  # terms of at least eight standard errors of the run
    missed: tuple[str, ...] = ()  # of these, dropped
    zeros: int = 0  # terms that are zero
    false: tuple[str, ...] = ()  # of these, selected
    errors: tuple[Error, ...] = ()  # of the values at the end of the path


STRONG = 8.0  # standard errors


def judge_search(
    aircraft: Aircraft, n_known: int, method: str, search: dict[str, Any], run: dict[str, Any]
) -> SearchVerdict:
    """Compare the end of the path with the terms of the truth."""
    if search["state"] != "succeeded":
        return SearchVerdict(method, "failed")
    result = search["result"]
    proposes = any(one["proposed"] for one in result["candidates"])
    truth = name_derivatives(residualize(aircraft, aircraft.truth, n_known))
    planted = {name for name, value in name_derivatives(aircraft.truth).items() if value == 0}
    sigma = {one["name"]: one["std_error"] for one in run["parameters"] if one["std_error"]}
    terms = [one for group in result["groups"] for one in group["terms"] if one["name"] in truth]
    selected = {one["name"] for one in terms if one["selected"]}
    size = {one["name"]: abs(truth[one["name"]]) / sigma.get(one["name"], np.inf) for one in terms}
    strong = {name for name, ratio in size.items() if ratio >= STRONG}
    # Modes that the table lacks give planted zeros a static part; where it is small they are zero.
    zeros = {name for name in size if name in planted and name in sigma and size[name] < 0.5}
    errors = compute_errors(truth, (one for one in terms if one["selected"]))
    return SearchVerdict(
        method, "proposes" if proposes else "undecided",
        len(strong), tuple(sorted(strong - selected)),
        len(zeros), tuple(sorted(zeros & selected)), errors,
    )  # fmt: skip


@dataclass(frozen=True)
class WidthVerdict:
    """Intervals of flutter of one run, of two runs and so on.

    ``growth`` is the largest factor by which one more run widened the interval, infinite where it
    then had none, or the prediction was refused.
    """

    growth: float
    last: FlutterVerdict


def judge_widths(
    aircraft: Aircraft, method: str, found: list[dict[str, Any] | None]
) -> WidthVerdict | None:
    """Compare the intervals of flutter of one run, two runs and so on; None without any."""
    stated = [one for one in found if one is not None]
    widths = [
        np.inf if one is None or one["low_m_s"] is None or one["high_m_s"] is None
        else one["high_m_s"] - one["low_m_s"]
        for one in found
    ]  # fmt: skip
    factors = [after / before for before, after in pairwise(widths) if np.isfinite(before)]
    if not factors:
        return None
    return WidthVerdict(max(factors), judge_flutter(aircraft, method, stated[-1]))


@dataclass(frozen=True)
class ValuesVerdict:
    """Values of the live estimate, of a global model, or of a simulated flight of a design.

    ``ratios`` are the expected standard errors of a design over those of its simulated flight.
    """

    door: str
    outcome: str
    errors: tuple[Error, ...] = ()
    ratios: tuple[float, ...] = ()


def judge_live(aircraft: Aircraft, n_known: int, estimates: list[dict[str, Any]]) -> ValuesVerdict:
    """Compare the last live estimate with the truth."""
    if not estimates:
        return ValuesVerdict("live", "no estimate")
    truth = name_derivatives(residualize(aircraft, aircraft.truth, n_known))
    last = estimates[-1]
    rows = zip(last["names"], last["values"], last["std_errors"], strict=True)
    errors = compute_errors(
        truth, ({"name": name, "value": value, "std_error": std} for name, value, std in rows)
    )
    return ValuesVerdict("live", "estimates" if errors else "no standard errors", errors)


def judge_global_model(
    aircraft: Aircraft, n_known: int, found: dict[str, Any] | None
) -> ValuesVerdict:
    """Compare a global model with the derivatives, which do not depend on the airspeed."""
    if found is None:
        return ValuesVerdict("global model", "refused")
    truth = name_derivatives(residualize(aircraft, aircraft.truth, n_known))
    errors = compute_errors(truth, found["derivatives"])
    return ValuesVerdict("global model", "estimates", errors)


def judge_simulation(found: dict[str, Any] | None) -> ValuesVerdict:
    """Compare a simulated flight with the model that flew, and the expected standard errors."""
    if found is None or found["state"] != "succeeded":
        return ValuesVerdict("simulated design", "refused" if found is None else found["state"])
    rows = [{**one, "value": one["estimate"]} for one in found["derivatives"]]
    errors = compute_errors({one["name"]: one["flown"] for one in rows}, rows)
    ratios = tuple(
        one["expected"] / one["std_error"] for one in rows if one["expected"] and one["std_error"]
    )
    return ValuesVerdict("simulated design", "estimates", errors, ratios)
