"""Correlation matrix of the parameter estimates."""

from __future__ import annotations

import numpy as np

from flexsid.figures import style
from flexsid.figures.labels import parameter_label
from flexsid.figures.spec import Spec, empty, heatmap, scatter, title
from flexsid.records.views import ParameterCorrelation
from flexsid.sysid.estimation.agreement import find_correlated_pairs

LIMIT = 0.9  # |rho| above which two parameters are nearly collinear
_RINGED = 5  # largest pairs of a grouped matrix
_NAMED = 120  # largest number of parameters with hover names


def draw_parameter_correlation(
    value: ParameterCorrelation, selected: str | None = None, grouped: bool = False
) -> Spec:
    """Draw the correlation matrix of the estimates, with pairs above ``LIMIT`` marked.

    Row and column of the ``selected`` derivative are framed. ``grouped`` is the lower triangle
    alone, with the five largest pairs ringed and one tick per coefficient, for narrow places.
    """
    if not value.names:
        return empty("No free parameters")
    if grouped:
        return _draw_grouped(value, selected)
    labels = [parameter_label(name) for name in value.names]
    places = list(range(len(labels)))
    named = len(labels) <= _NAMED
    data = [
        heatmap(
            places,
            places,
            value.correlation,
            zmin=-1,
            zmax=1,
            colorscale="RdBu",
            colorbar=title("ρ [1]"),
            hovertemplate=("%{text}<br>" if named else "") + "ρ = %{z:.3f}<extra></extra>",
        )
    ]
    if named:
        data[0]["text"] = [[f"{a}, {b}" for b in labels] for a in labels]
    off_diagonal = np.where(np.eye(len(labels), dtype=bool), 0.0, value.correlation)
    pairs = np.argwhere(np.abs(np.nan_to_num(off_diagonal)) > LIMIT).tolist()
    if pairs:
        ring = {"color": style.MARK, "width": 2}
        data.append(
            scatter(
                [j for _, j in pairs],
                [i for i, _ in pairs],
                name=f"|ρ| > {LIMIT}",
                marker={"symbol": "x-thin", "size": 8, "line": ring},
                text=[
                    f"{labels[i]}, {labels[j]}<br>ρ = {value.correlation[i, j]:.3f}"
                    for i, j in pairs
                ],
                hovertemplate=f"%{{text}}<extra>|ρ| > {LIMIT}</extra>",
            )
        )
    ticks = {"tickmode": "array", "tickvals": places, "ticktext": labels, "automargin": True}
    layout = {
        "xaxis": {**ticks, "tickangle": -90, "constrain": "domain"},
        "yaxis": {**ticks, "autorange": "reversed", "scaleanchor": "x", "constrain": "domain"},
        "showlegend": False,
        "shapes": _frame(value.names, selected),
        "meta": {"rows": max(2.0, len(labels) / 8)},
    }
    return {"data": data, "layout": layout}


def _frame(names: tuple[str, ...], selected: str | None) -> list[Spec]:
    """Return frames around the row and the column of a derivative."""
    if selected not in names:
        return []
    at, last = names.index(selected), len(names) - 0.5
    line = {"color": style.OCHRE, "width": 2}
    spans = ((-0.5, last, at - 0.5, at + 0.5), (at - 0.5, at + 0.5, -0.5, last))
    return [
        {"type": "rect", "x0": x0, "x1": x1, "y0": y0, "y1": y1, "line": line}
        for x0, x1, y0, y1 in spans
    ]


def _draw_grouped(value: ParameterCorrelation, selected: str | None) -> Spec:
    n = len(value.names)
    places = list(range(n))
    shown = np.where(np.tri(n, k=-1, dtype=bool), value.correlation, np.nan)
    pairs = find_correlated_pairs(value.correlation, _RINGED)
    labels = [parameter_label(name) for name in value.names]
    groups: dict[str, list[int]] = {}
    for at, name in enumerate(value.names):
        groups.setdefault(name.partition("_")[0], []).append(at)
    ticks = {
        "tickmode": "array",
        "tickvals": [sum(own) / len(own) for own in groups.values()],
        "ticktext": [parameter_label(name) for name in groups],
        "showgrid": False,
        "showspikes": False,
        "ticks": "",
    }
    edge = {"color": style.GRID, "width": 1}
    ends = [own[-1] + 0.5 for own in groups.values()][:-1]
    rules = [
        {"type": "line", **where, "line": edge}
        for end in ends
        for where in (
            {"x0": -0.5, "x1": end, "y0": end, "y1": end},
            {"x0": end, "x1": end, "y0": end, "y1": n - 0.5},
        )
    ]
    data = [
        heatmap(
            places, places, shown, zmin=-1, zmax=1, colorscale="RdBu", showscale=False,
            text=[[f"{a}, {b}" for b in labels] for a in labels],
            hovertemplate="%{text}<br>ρ = %{z:.3f}<extra></extra>",
        ),
        scatter(
            [i for i, *_ in pairs],
            [j for _, j, _ in pairs],
            marker={
                "symbol": "circle-open", "size": 15, "color": style.GREY, "line": {"width": 2},
            },
            hoverinfo="skip",
        ),
    ]  # fmt: skip
    layout = {
        "xaxis": {**ticks, "constrain": "domain", "range": [-0.5, n - 0.5]},
        "yaxis": {
            **ticks, "range": [n - 0.5, -0.5], "scaleanchor": "x", "constrain": "domain",
        },
        "showlegend": False,
        "shapes": [*rules, *_frame(value.names, selected)],
        "margin": {"l": 40, "r": 4, "t": 6, "b": 30},
        "meta": {"rows": 1.2},
    }  # fmt: skip
    return {"data": data, "layout": layout}
