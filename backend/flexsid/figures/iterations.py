"""How the cost fell."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.spec import Spec, column, empty, title
from flexsid.records.views import Convergence


def iterations(value: Convergence) -> Spec:
    """Draw cost against iteration."""
    steps = value.iterations
    if not steps:
        return empty("This estimate needed no iterations")
    # Costs of thousands fall by fractions: what is left above the least is what is seen.
    least = min((step.cost for step in steps if np.isfinite(step.cost)), default=0.0)
    trace = {
        "type": "scatter",
        "mode": "lines+markers",
        "x": [step.iteration for step in steps],
        "y": column([step.cost - least for step in steps], exact=True),
        "customdata": [[value.run_id, _finite(step.step), step.cost] for step in steps],
        "line": {"color": style.BLUE, "width": 1.8},
        "marker": {"color": style.BLUE, "size": 6},
        "hovertemplate": (
            "iteration %{x}<br>cost %{customdata[2]:.8g}<br>"
            "step %{customdata[1]:.2e}<extra></extra>"
        ),
    }
    layout: Spec = {
        "xaxis": {**title("Iteration [1]"), "rangemode": "tozero", "dtick": 1 + len(steps) // 10},
        "yaxis": {**title(f"Cost J above {least:.8g} [1]"), "rangemode": "tozero"},
        "showlegend": False,
        "meta": {"rows": 1},
    }
    return {"data": [trace], "layout": layout}


def _finite(number: float) -> float | None:
    return number if np.isfinite(number) else None
