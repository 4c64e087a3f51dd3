"""Model structure determination: stepwise path, and selection frequency of each term."""

from __future__ import annotations

from flexsid.figures import style
from flexsid.figures.labels import parameter_label
from flexsid.figures.spec import Spec, column, empty, layout_key, rows, title
from flexsid.records.search import SearchTerm, TermGroup


def search_path(group: TermGroup) -> Spec:
    """Draw R2, predicted squared error and BIC by step, with entered and removed terms."""
    steps = group.path
    if not steps:
        return empty("No steps: the initial terms were retained")
    labels = [
        f"{'+' if step.action == 'enter' else '−'} {parameter_label(step.term)}" for step in steps
    ]
    drawn = (
        ("R² [1]", [step.r_squared for step in steps], style.BLUE),
        ("PSE [noise variances]", [step.pse for step in steps], style.VERMILION),
        ("BIC [1]", [step.bic for step in steps], style.GREEN),
    )
    domains = rows([1.0] * len(drawn))
    layout: Spec = {"showlegend": False, "meta": {"rows": len(drawn)}}
    traces = []
    for number, (label, values, color) in enumerate(drawn, start=1):
        symbols = ["circle" if step.action == "enter" else "x" for step in steps]
        traces.append(
            {
                "type": "scatter",
                "mode": "lines+markers",
                "x": list(range(1, len(steps) + 1)),
                "y": column([_get_number(value) for value in values], exact=True),
                "yaxis": "y" if number == 1 else f"y{number}",
                "line": {"color": color, "width": 1.6},
                "marker": {"color": color, "size": 8, "symbol": symbols},
                "customdata": [[text, step.f] for text, step in zip(labels, steps, strict=True)],
                "hovertemplate": "step %{x}: %{customdata[0]}<br>F %{customdata[1]:.4g}"
                "<br>%{y:.6g}<extra></extra>",
            }
        )
        layout[layout_key(number)] = {**title(label), "domain": domains[number - 1]}
    layout["xaxis"] = {
        **title("Step"),
        "anchor": "y" if len(drawn) == 1 else f"y{len(drawn)}",
        "tickmode": "array",
        "tickvals": list(range(1, len(steps) + 1)),
        "ticktext": labels,
        "tickangle": -60,
        "automargin": True,
    }
    return {"data": traces, "layout": layout}


def search_stability(group: TermGroup) -> Spec:
    """Draw the selection frequency of each term in bootstrap draws and in maneuvers."""
    terms = group.terms
    if all(term.stability is None for term in terms):
        return empty("No bootstrap of harmonics in this search")
    traces = [
        _bars("Selected", [term for term in terms if term.selected], style.BLUE),
        _bars("Not selected", [term for term in terms if not term.selected], style.GREY),
        {
            "type": "scatter",
            "mode": "markers",
            "name": "Selected in single maneuvers",
            "x": [term.name for term in terms],
            "y": [100.0 * term.support for term in terms],
            "marker": {"color": style.VERMILION, "symbol": "diamond", "size": 7},
            "hovertemplate": "%{x}: %{y:.0f} % of the maneuvers<extra></extra>",
        },
    ]
    layout: Spec = {
        "barmode": "overlay",
        "xaxis": {
            "categoryorder": "array",
            "categoryarray": [term.name for term in terms],
            "tickmode": "array",
            "tickvals": [term.name for term in terms],
            "ticktext": [parameter_label(term.name) for term in terms],
            "tickangle": -60,
            "automargin": True,
        },
        "yaxis": {**title("Selected in bootstrap draws [%]"), "range": [0, 105]},
        "legend": {"orientation": "h"},
        "meta": {"rows": 1},
    }
    return {"data": traces, "layout": layout}


def _bars(name: str, terms: list[SearchTerm], color: str) -> Spec:
    return {
        "type": "bar",
        "name": name,
        "x": [term.name for term in terms],
        "y": [None if t.stability is None else 100.0 * t.stability for t in terms],
        "marker": {"color": color},
        "customdata": [[term.f] for term in terms],
        "hovertemplate": "%{x}: %{y:.0f} % of draws<br>F %{customdata[0]:.4g}<extra></extra>",
    }


def _get_number(value: float | None) -> float:
    return float("nan") if value is None else value
