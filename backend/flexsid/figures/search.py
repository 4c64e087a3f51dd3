"""Model structure determination: stepwise path, and selection frequency of each term."""

from __future__ import annotations

from flexsid.figures import style
from flexsid.figures.labels import parameter_label
from flexsid.figures.spec import Spec, column, empty, scatter, stack, title
from flexsid.records.search import SearchTerm, TermGroup


def draw_search_path(group: TermGroup) -> Spec:
    """Draw R2, predicted squared error and BIC by step, with entered and removed terms."""
    steps = group.path
    if not steps:
        return empty("No steps: the initial terms were retained")
    enters = [step.action == "enter" for step in steps]
    labels = [
        f"{'+' if entered else '−'} {parameter_label(step.term)}"
        for step, entered in zip(steps, enters, strict=True)
    ]
    numbers = list(range(1, len(steps) + 1))
    curves = (
        ("R² [1]", [step.r_squared for step in steps], style.BLUE),
        ("PSE [noise variances]", [step.pse for step in steps], style.VERMILION),
        ("BIC [1]", [step.bic for step in steps], style.GREEN),
    )
    symbols = ["circle" if entered else "x" for entered in enters]
    data = [
        scatter(
            numbers,
            column(values, exact=True),
            "lines+markers",
            row=row,
            line={"color": color, "width": 1.6},
            marker={"color": color, "size": 8, "symbol": symbols},
            customdata=[[text, step.f] for text, step in zip(labels, steps, strict=True)],
            hovertemplate="step %{x}: %{customdata[0]}<br>F %{customdata[1]:.4g}"
            "<br>%{y:.6g}<extra></extra>",
        )
        for row, (_, values, color) in enumerate(curves, start=1)
    ]
    x_axis = {**title("Step"), **_tick(numbers, labels)}
    layout = stack(x_axis, [title(label) for label, _, _ in curves], showlegend=False)
    return {"data": data, "layout": layout}


def draw_search_stability(group: TermGroup) -> Spec:
    """Draw the selection frequency of each term in bootstrap samples and in maneuvers."""
    terms = group.terms
    if all(term.stability is None for term in terms):
        return empty("No bootstrap of harmonics in this search")
    names = [term.name for term in terms]
    data = [
        _draw_bars("Selected", [term for term in terms if term.selected], style.BLUE),
        _draw_bars("Not selected", [term for term in terms if not term.selected], style.GREY),
        scatter(
            names,
            [100.0 * term.support for term in terms],
            name="Selected in single maneuvers",
            marker={"color": style.VERMILION, "symbol": "diamond", "size": 7},
            hovertemplate="%{x}: %{y:.0f} % of the maneuvers<extra></extra>",
        ),
    ]
    labels = [parameter_label(name) for name in names]
    layout = {
        "barmode": "overlay",
        "xaxis": {"categoryorder": "array", "categoryarray": names, **_tick(names, labels)},
        "yaxis": {**title("Selected in bootstrap samples [%]"), "range": [0, 105]},
        "legend": {"orientation": "h"},
        "meta": {"rows": 1},
    }
    return {"data": data, "layout": layout}


def _tick(values: list[int] | list[str], labels: list[str]) -> Spec:
    return {
        "tickmode": "array", "tickvals": values, "ticktext": labels, "tickangle": -60,
        "automargin": True,
    }  # fmt: skip


def _draw_bars(name: str, terms: list[SearchTerm], color: str) -> Spec:
    return {
        "type": "bar",
        "name": name,
        "x": [term.name for term in terms],
        "y": [None if t.stability is None else 100.0 * t.stability for t in terms],
        "marker": {"color": color},
        "customdata": [[term.f] for term in terms],
        "hovertemplate": "%{x}: %{y:.0f} % of samples<br>F %{customdata[0]:.4g}<extra></extra>",
    }
