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
    trace = {
        "type": "scatter",
        "mode": "lines+markers",
        "x": [step.iteration for step in steps],
        "y": column([step.cost for step in steps], exact=True),
        "customdata": [[value.run_id, _finite(step.step)] for step in steps],
        "line": {"color": style.BLUE, "width": 1.8},
        "marker": {"color": style.BLUE, "size": 6},
        "hovertemplate": (
            "iteration %{x}<br>cost %{y:.6g}<br>step %{customdata[1]:.2e}<extra></extra>"
        ),
    }
    layout: Spec = {
        "xaxis": {**title("Iteration [1]"), "rangemode": "tozero", "dtick": 1 + len(steps) // 10},
        "yaxis": {**title("Cost J [1]"), "tickformat": ".8~g"},
        "showlegend": False,
        "meta": {"rows": 1},
    }
    return {"data": [trace], "layout": layout}


def _finite(number: float) -> float | None:
    return number if np.isfinite(number) else None
