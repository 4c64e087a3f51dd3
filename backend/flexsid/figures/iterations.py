"""Convergence: cost by iteration."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from flexsid.figures import style
from flexsid.figures.spec import Spec, column, empty, scatter, title
from flexsid.records.views import Convergence
from flexsid.sysid.estimation.estimate import IterationStep


def draw_iterations(value: Convergence) -> Spec:
    """Draw cost against iteration, one curve per leakage correction.

    Costs after a leakage correction are of other data.
    """
    if not value.iterations:
        return empty("No iterations: the estimate is direct")
    data = []
    for stage, group in groupby(value.iterations, key=lambda step: step.stage):
        steps = list(group)
        colour, _ = style.of_index(len(data))
        # Costs of thousands change by fractions, so the difference to the minimum is drawn.
        minimum = _find_minimum(steps)
        name = f"after leakage correction {stage}" if stage else "first fit"
        data.append(
            scatter(
                [step.iteration for step in steps],
                column([step.cost - minimum for step in steps], exact=True),
                "lines+markers",
                name=name,
                customdata=[[value.run_id, _get_finite(step.step), step.cost] for step in steps],
                line={"color": colour, "width": 1.8},
                marker={"color": colour, "size": 6},
                hovertemplate="iteration %{x}<br>cost %{customdata[2]:.8g}<br>"
                f"step %{{customdata[1]:.2e}}<extra>{name if stage else ''}</extra>",
            )
        )
    minimum = f"{_find_minimum(value.iterations):.8g}"
    above = "minimum of each fit" if len(data) > 1 else minimum
    tick = 1 + len(value.iterations) // 10
    layout = {
        "xaxis": {**title("Iteration [1]"), "rangemode": "tozero", "dtick": tick},
        "yaxis": {**title(f"Cost J above {above} [1]"), "rangemode": "tozero"},
        "showlegend": len(data) > 1,
        "meta": {"rows": 1},
    }
    return {"data": data, "layout": layout}


def _find_minimum(steps: Sequence[IterationStep]) -> float:
    return min((step.cost for step in steps if np.isfinite(step.cost)), default=0.0)


def _get_finite(number: float) -> float | None:
    return number if np.isfinite(number) else None
