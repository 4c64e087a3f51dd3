"""Convergence: cost by iteration."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from flexsid.figures import style
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.run import Iteration
from flexsid.records.views import Convergence


def iterations(value: Convergence) -> Spec:
    """Draw cost against iteration, one curve per leakage correction."""
    steps = value.iterations
    if not steps:
        return empty("No iterations: the estimate is direct")
    stages = [list(stage) for _, stage in groupby(steps, key=lambda step: step.stage)]
    traces = [
        _trace(value.run_id, stage, style.of_index(number)[0])
        for number, stage in enumerate(stages)
    ]
    several = len(stages) > 1
    above = "minimum of each fit" if several else f"{_find_minimum(steps):.8g}"
    layout: Spec = {
        "xaxis": {**title("Iteration [1]"), "rangemode": "tozero", "dtick": 1 + len(steps) // 10},
        "yaxis": {**title(f"Cost J above {above} [1]"), "rangemode": "tozero"},
        "showlegend": several,
        "meta": {"rows": 1},
    }
    return {"data": traces, "layout": layout}


def _trace(run_id: int, steps: Sequence[Iteration], colour: str) -> Spec:
    """Draw one fit; costs after a leakage correction are of other data."""
    # Costs of thousands change by fractions, so the difference to the minimum is drawn.
    minimum = _find_minimum(steps)
    stage = steps[0].stage
    name = f"after leakage correction {stage}" if stage else "first fit"
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": [step.iteration for step in steps],
        "y": column([step.cost - minimum for step in steps], exact=True),
        "customdata": [[run_id, _get_finite(step.step), step.cost] for step in steps],
        "line": {"color": colour, "width": 1.8},
        "marker": {"color": colour, "size": 6},
        "hovertemplate": (
            "iteration %{x}<br>cost %{customdata[2]:.8g}<br>"
            f"step %{{customdata[1]:.2e}}<extra>{name if stage else ''}</extra>"
        ),
    }


def _find_minimum(steps: Sequence[Iteration]) -> float:
    return min((step.cost for step in steps if np.isfinite(step.cost)), default=0.0)


def _get_finite(number: float) -> float | None:
    return number if np.isfinite(number) else None
