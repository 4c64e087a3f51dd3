"""One table of a campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np
from campaign import Outcome
from doors import METHODS
from verdicts import Error, FlutterVerdict, SearchVerdict, Verdict

_NEAR = (0.8, 1.25)  # of an expected standard error over the one found
_GROWTH = 1.2  # of an interval of flutter by one more run
WITHIN = 2.0  # standard errors, which hold 95.4 % of normal errors
_OUTCOMES = ("consistent", "suspect", "not tested", "not converged", "failed")


def format_table(outcomes: Sequence[Outcome]) -> str:
    """Return the table as Markdown."""
    verdicts = [one for outcome in outcomes for one in outcome.verdicts]
    by_method = [[one for one in verdicts if one.method == method] for method in METHODS]
    lines = _row(f"{len(outcomes)} flights", *METHODS) + _row(*["---"] * (len(METHODS) + 1))
    for state in _OUTCOMES:
        lines += _row(f"{state} runs", *(_count(own, state) for own in by_method))
    without = [str(sum(one.without_error for one in own)) for own in by_method]
    lines += _row("derivatives without standard error", *without)
    for state in ("consistent", "suspect"):
        errors = [_errors(one for one in own if one.outcome == state) for own in by_method]
        lines += _row(f"within ±2σ, {state}", *map(_coverage, errors))
        lines += _row(f"σ over rms error, {state}", *map(_ratio, errors))
    lines += _format_flutter(outcomes) + _format_searches(outcomes) + _format_further(outcomes)
    errors = [_errors(own) for own in by_method]
    for kind in sorted({one.kind for own in errors for one in own}):
        own = [[one for one in some if one.kind == kind] for some in errors]
        lines += _row(f"within ±2σ, {kind}", *map(_coverage, own))
    for trait, own in _by_trait(outcomes):
        per_method = [_errors(v for v in own if v.method == method) for method in METHODS]
        lines += _row(f"within ±2σ, {trait}", *map(_coverage, per_method))
    return lines


def _format_flutter(outcomes: Sequence[Outcome]) -> str:
    own = [[v for o in outcomes for v in o.flutter if v.method == method] for method in METHODS]
    lines = ""
    for state in ("holds", "misses", "none", "none but true", "speed but none true"):
        lines += _row(f"flutter: {state}", *(_count(some, state) for some in own))
    widths = [[one.half_width for one in some if one.half_width] for some in own]
    return lines + _row(
        "flutter: median half width",
        *(f"{100 * np.median(some):.1f} %" if some else "" for some in widths),
    )


def _format_searches(outcomes: Sequence[Outcome]) -> str:
    own = [[v for o in outcomes for v in o.searches if v.method == method] for method in METHODS]
    lines = ""
    for state in ("proposes", "undecided", "failed"):
        lines += _row(f"search: {state}", *(_count(some, state) for some in own))
    shares = (
        ("terms of 8σ dropped", lambda one: len(one.missed), lambda one: one.strong),
        ("planted zeros kept", lambda one: len(one.false), lambda one: one.zeros),
    )
    for name, part, whole in shares:
        lines += _row(
            f"search: {name}", *(f"{sum(map(part, s))} of {sum(map(whole, s))}" for s in own)
        )
    errors = [[error for one in some for error in one.errors] for some in own]
    return lines + _row("search: values within ±2σ", *map(_coverage, errors))


def _format_further(outcomes: Sequence[Outcome]) -> str:
    """Format the doors that are gone through with runs by the first method."""
    lines, blank = "", [""] * (len(METHODS) - 1)
    values = [one for outcome in outcomes for one in outcome.values]
    for door in sorted({one.door for one in values}):
        own = [one for one in values if one.door == door]
        states = ", ".join(f"{n} {s}" for s, n in Counter(one.outcome for one in own).items())
        lines += _row(door, states, *blank)
        errors = [error for one in own for error in one.errors]
        lines += _row(f"{door}: values within ±2σ", _coverage(errors), *blank)
        ratios = np.array([ratio for one in own for ratio in one.ratios])
        if ratios.size:
            near = np.mean((ratios >= _NEAR[0]) & (ratios <= _NEAR[1]))
            text = f"{100 * near:.0f} % of {ratios.size}"
            lines += _row(f"{door}: expected over found σ within 0.8 to 1.25", text, *blank)
    widths = [one.widths for one in outcomes if one.widths is not None]
    if widths:
        growth = np.array([one.growth for one in widths])
        lost = np.sum(np.isinf(growth))
        text = f"{np.sum(growth > _GROWTH)} of {growth.size}, {lost} of them lost"
        lines += _row("flutter: interval more than 1.2 times wider by a run", text, *blank)
        holds = sum(one.last.outcome == "holds" for one in widths)
        lines += _row("flutter: interval of all runs holds", f"{holds} of {len(widths)}", *blank)
    return lines


def compute_coverage(verdicts: Iterable[Verdict]) -> float:
    """Return the share of errors within two standard errors."""
    errors = _errors(verdicts)
    return float(np.mean([abs(one.distance) <= WITHIN for one in errors])) if errors else np.nan


def _by_trait(outcomes: Sequence[Outcome]) -> list[tuple[str, list[Verdict]]]:
    found: dict[str, list[Verdict]] = {}
    for outcome in outcomes:
        for trait in outcome.flight.traits:
            found.setdefault(trait, []).extend(outcome.verdicts)
    return sorted(found.items())


def _errors(verdicts: Iterable[Verdict]) -> list[Error]:
    return [error for verdict in verdicts for error in verdict.errors]


def _count(verdicts: Sequence[Verdict | FlutterVerdict | SearchVerdict], state: str) -> str:
    return str(Counter(one.outcome for one in verdicts)[state])


def _coverage(errors: list[Error]) -> str:
    if not errors:
        return ""
    within = np.mean([abs(one.distance) <= WITHIN for one in errors])
    return f"{100 * within:.0f} % of {len(errors)}"


def _ratio(errors: list[Error]) -> str:
    if not errors:
        return ""
    return f"{1 / np.sqrt(np.mean([one.distance**2 for one in errors])):.2f}"


def _row(*cells: str) -> str:
    return "| " + " | ".join(cells) + " |\n"
