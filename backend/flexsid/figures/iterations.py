"""How the cost fell."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from flexsid.figures import style
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.run import Iteration
from flexsid.records.views import Convergence


def iterations(value: Convergence) -> Spec:
    """Draw cost against iteration, each fit to lines corrected anew as a curve of its own."""
    steps = value.iterations
    if not steps:
        return empty("This estimate needed no iterations")
    stages = [list(stage) for _, stage in groupby(steps, key=lambda step: step.stage)]
    traces = [
        _trace(value.run_id, stage, style.of_index(number)[0])
        for number, stage in enumerate(stages)
    ]
    several = len(stages) > 1
    above = "the least of its fit" if several else f"{_least(steps):.8g}"
    layout: Spec = {
        "xaxis": {**title("Iteration [1]"), "rangemode": "tozero", "dtick": 1 + len(steps) // 10},
        "yaxis": {**title(f"Cost J above {above} [1]"), "rangemode": "tozero"},
        "showlegend": several,
        "meta": {"rows": 1},
    }
    return {"data": traces, "layout": layout}


def _trace(run_id: int, steps: Sequence[Iteration], colour: str) -> Spec:
    """One fit; costs of fits to lines corrected anew are of other data."""
    # Costs of thousands fall by fractions: what is left above the least is what is seen.
    least = _least(steps)
    stage = steps[0].stage
    name = f"after correction {stage} for the ends of the record" if stage else "first fit"
    return {
        "type": "scatter",
        "mode": "lines+markers",
        "name": name,
        "x": [step.iteration for step in steps],
        "y": column([step.cost - least for step in steps], exact=True),
        "customdata": [[run_id, _finite(step.step), step.cost] for step in steps],
        "line": {"color": colour, "width": 1.8},
        "marker": {"color": colour, "size": 6},
        "hovertemplate": (
            "iteration %{x}<br>cost %{customdata[2]:.8g}<br>"
            f"step %{{customdata[1]:.2e}}<extra>{name if stage else ''}</extra>"
        ),
    }


def _least(steps: Sequence[Iteration]) -> float:
    return min((step.cost for step in steps if np.isfinite(step.cost)), default=0.0)


def _finite(number: float) -> float | None:
    return number if np.isfinite(number) else None
