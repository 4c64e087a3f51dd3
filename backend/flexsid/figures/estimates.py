"""Estimates and their models: convergence, residuals, correlation, search, validation."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import (
    Spec,
    axis,
    column,
    empty,
    heatmap,
    layout_key,
    scatter,
    stack,
    text_at,
    title,
)
from flexsid.figures.style import parameter_label
from flexsid.records.search import SearchTerm, TermGroup
from flexsid.records.validation import (
    CorrelationCurve,
    CrossPrediction,
    CrossPredictionMatrix,
    ResidualCorrelations,
)
from flexsid.records.views import Convergence, ParameterCorrelation, PlotMatrix, Residuals
from flexsid.sysid.estimation.agreement import find_correlated_pairs
from flexsid.sysid.estimation.estimate import IterationStep

# --- Convergence: cost by iteration ---------------------------------------------------------------


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
        "xaxis": {**title("Iteration"), "rangemode": "tozero", "dtick": tick},
        "yaxis": {**title(f"Cost J above {above}"), "rangemode": "tozero"},
        "showlegend": len(data) > 1,
        "meta": {"rows": 1},
    }
    return {"data": data, "layout": layout}


def _find_minimum(steps: Sequence[IterationStep]) -> float:
    return min((step.cost for step in steps if np.isfinite(step.cost)), default=0.0)


def _get_finite(number: float) -> float | None:
    return number if np.isfinite(number) else None


# --- Correlation matrix of the parameter estimates ------------------------------------------------

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
            colorbar=title("ρ"),
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


# --- Residuals by output and frequency, normalised by their rms -----------------------------------

_CEILING = 3.0  # exceeded with probability 1e-4 by circular Gaussian noise


def draw_residual(value: Residuals) -> Spec:
    """Draw |residual|/rms: noise is uniform, an unmodelled mode is a bright band."""
    if value.relative.size == 0:
        return empty("No fitted data")
    frequency = quantities.of_unit("Frequency", "Hz")
    labels = [quantities.of_channel(name).label for name in value.outputs]
    trace = heatmap(
        frequency.factor * value.frequency_hz,
        labels,
        value.relative.T,
        zmin=0,
        zmax=_CEILING,
        colorscale="Cividis",
        colorbar=title("|residual| / rms"),
        hovertemplate=f"%{{y}}<br>%{{x:.3f}} {frequency.unit}<br>%{{z:.2f}} rms<extra></extra>",
    )
    layout = {
        "xaxis": title(frequency.axis_title),
        "yaxis": {"autorange": "reversed", "type": "category", "automargin": True},
        "meta": {"rows": max(1.0, len(labels) / 5)},
    }
    return {"data": [trace], "layout": layout}


# --- Model structure determination: stepwise path, and selection frequency of each term -----------


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
        ("R²", [step.r_squared for step in steps], style.BLUE),
        ("PSE [noise variances]", [step.pse for step in steps], style.VERMILION),
        ("BIC", [step.bic for step in steps], style.GREEN),
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


# --- Validation: matrix of cross-predictions, and correlation functions of residuals --------------

_ROW_PX = 34
_HEAD_PX = 190
_WRITTEN = 25  # most maneuvers with numbers in the cells
_LONGEST = 36  # letters of a label


def draw_cross_predictions(value: CrossPredictionMatrix) -> Spec:
    """Draw R2 by model and maneuver; rings mark the maneuvers that a model was fitted to."""
    if not value.predictions:
        return empty("No runs selected")
    shape = (len(value.runs), len(value.maneuvers))
    r_squared = np.array(
        [np.nan if one.r_squared is None else one.r_squared for one in value.predictions]
    ).reshape(shape)
    models = [_shorten(one.label) for one in value.runs]
    places = list(range(shape[1]))
    trace = heatmap(
        places,
        models,
        r_squared,
        zmin=0,
        zmax=1,
        colorscale="Cividis",
        colorbar=title("Mean R²"),
        customdata=_reshape(list(range(len(value.predictions))), shape),
        text=_reshape([_describe(one) for one in value.predictions], shape),
        hovertemplate="%{text}<extra></extra>",
        xgap=1,
        ygap=1,
    )
    fitted = [k for k, one in enumerate(value.predictions) if one.is_fitted]
    rings = scatter(
        [k % shape[1] for k in fitted],
        [models[k // shape[1]] for k in fitted],
        name="fitted",
        hoverinfo="skip",
        marker={
            "symbol": "square-open",
            "size": 24,
            "color": style.FLAG,
            "line": {"width": 2, "color": style.FLAG},
        },
    )
    layout: Spec = {
        "xaxis": {
            **title("Maneuver"),
            "tickmode": "array",
            "tickvals": places,
            "ticktext": [_shorten(one.label) for one in value.maneuvers],
            "tickangle": -60,
            "automargin": True,
        },
        "yaxis": {
            **title("Model"),
            "autorange": "reversed",
            "type": "category",
            "automargin": True,
        },
        "showlegend": bool(fitted),
        "height": _HEAD_PX + _ROW_PX * shape[0],
        "meta": {"rows": 1},
    }
    if shape[1] <= _WRITTEN:
        layout["annotations"] = [
            {
                "x": k % shape[1], "y": models[k // shape[1]], "showarrow": False,
                "text": "–" if one.r_squared is None else f"{one.r_squared:.2f}",
                "font": {"size": 10, "color": _get_ink(one.r_squared)},
            }
            for k, one in enumerate(value.predictions)
        ]  # fmt: skip
    return {"data": [trace, rings] if fitted else [trace], "layout": layout}


def draw_residual_correlation(value: ResidualCorrelations) -> Spec:
    """Draw auto- and cross-correlation of residuals over the lag, with their bounds."""
    if not value.curves:
        return empty("No residuals")
    data: list[Spec] = []
    for row, curve in enumerate(value.curves, start=1):
        own = curve.output == curve.other
        colour = style.BLUE if own else style.GREEN
        name = "autocorrelation" if own else "cross-correlation"
        first = next(k for k, c in enumerate(value.curves) if (c.output == c.other) == own)
        for sign in (1.0, -1.0):
            data.append(
                scatter(
                    curve.lags_s,
                    sign * curve.bound,
                    "lines",
                    row=row,
                    name="95 % bound",
                    legendgroup="bound",
                    showlegend=row == 1 and sign > 0,
                    hoverinfo="skip",
                    line={"color": style.FLAG, "width": 1, "dash": "dash"},
                )
            )
        data.append(
            scatter(
                curve.lags_s,
                curve.values,
                "lines+markers",
                row=row,
                name=name,
                legendgroup=name,
                showlegend=row - 1 == first,
                customdata=[value.run_id],
                hovertemplate=f"%{{x:.3f}} s<br>%{{y:.3f}}<extra>{_name(curve)}</extra>",
                line={"color": colour, "width": 1.2},
                marker={"color": colour, "size": 4},
            )
        )
    note = (
        f"{100 * value.share_outside:.0f} % of the values are outside the bounds; 5 % are expected "
        "of white residuals that are independent of the inputs and of each other."
    )
    layout = stack(
        title("Lag [s]"),
        [title(f"{_name(curve)}") for curve in value.curves],
        showlegend=True,
        hovermode="closest",
    )
    layout["meta"] = {"rows": max(1.0, 0.55 * len(value.curves)), "note": note}
    return {"data": data, "layout": layout}


def _name(curve: CorrelationCurve) -> str:
    own = quantities.of_channel(curve.output).label
    return (
        own if curve.output == curve.other else f"{own}, {quantities.of_channel(curve.other).label}"
    )


def _describe(one: CrossPrediction) -> str:
    head = f"Run {one.run_id}, maneuver {one.maneuver_id}"
    if one.r_squared is None or one.theil is None:
        return f"{head}<br>{one.error}"
    worst = min(one.outputs, key=lambda output: output.r_squared)
    return (
        f"{head}<br>mean R² {one.r_squared:.3f}, Theil {one.theil:.3f}"
        f"<br>lowest R² {worst.r_squared:.3f} ({quantities.of_channel(worst.output).label})"
        f"<br>{one.n_frequencies} frequencies{', fitted' if one.is_fitted else ''}"
    )


def _reshape(values: list[int] | list[str], shape: tuple[int, int]) -> list[list[int | str]]:
    return [list(values[r * shape[1] : (r + 1) * shape[1]]) for r in range(shape[0])]


def _get_ink(r_squared: float | None) -> str:
    """Return black on the light end of the scale, else white; grey where there is no cell."""
    if r_squared is None:
        return style.GREY
    return "#000000" if r_squared > 0.5 else "#ffffff"


def _shorten(label: str) -> str:
    return label if len(label) <= _LONGEST else f"{label[: _LONGEST - 1]}…"


# --- Plot matrix of channels with correlation coefficients (Figs 9a and 18) -----------------------

"""Of |Re r|: above it equation and output error are ill-conditioned (ref. 14 of the paper)."""

_POINTS = 400  # in one cross plot
_ALL_POINTS = 8_000  # a browser draws so many within half a second
_GAP = 0.01
_FEW = 8  # largest number of channels with large font
_BARE = dict.fromkeys(("showticklabels", "zeroline", "showgrid", "showline"), False) | {"ticks": ""}


def draw_plot_matrix(value: PlotMatrix) -> Spec:
    """Draw names on the diagonal, cross plots above it, coefficients below.

    Spectra show real and imaginary parts together, and below the real part of their coefficient
    its magnitude and phase. Derivatives are real, so collinearity of regressors is in the real
    part, and only it is flagged: a motion and its rate are in quadrature, whatever the magnitude.
    """
    count = len(value.names)
    if count < 2:
        return empty("Select at least two channels")
    shown = [quantities.of_channel(*named) for named in zip(value.names, value.units, strict=True)]
    samples = value.samples
    samples_are_complex = np.iscomplexobj(samples)
    if samples_are_complex:
        samples = np.concatenate([np.real(samples), np.imag(samples)])
    samples = samples * np.array([quantity.factor for quantity in shown])
    cells = [(row, col) for row in range(count) for col in range(row + 1, count)]
    points = min(_POINTS, _ALL_POINTS // len(cells), len(samples))
    drawn = samples[np.linspace(0, len(samples) - 1, points).astype(int)]
    data = [
        scatter(
            drawn[:, col],
            drawn[:, row],
            name=f"{shown[row].label} over {shown[col].label}",
            xaxis=axis(col + 1, "x"),
            yaxis=axis(row + 1),
            marker={"color": style.BLUE, "size": 2.5, "opacity": 0.6},
            hovertemplate=f"{shown[col].label} %{{x:.3g}} {shown[col].unit}<br>"
            f"{shown[row].label} %{{y:.3g}} {shown[row].unit}<extra></extra>",
        )
        for row, col in cells
    ]
    font = {"size": 13 if count <= _FEW else 10}
    notes = [
        (k, k, f"<b>{q.label}</b>" + q.title.removeprefix(q.label), font)
        for k, q in enumerate(shown)
    ]
    notes += [(c, r, *_format_coefficient(value.correlation[c, r], font)) for r, c in cells]
    layout: Spec = {
        "showlegend": False,
        "hovermode": "closest",
        "shapes": [_draw_frames(cells, count)],
        "annotations": [
            text_at((c + 0.5) / count, 1.0 - (r + 0.5) / count, text, "center", "middle", own_font)
            for r, c, text, own_font in notes
        ]
        + [text_at(0.0, 0.0, _write_legend(samples_are_complex), "left", "top", {"size": 11})],
        "meta": {
            "rows": count,
            "names": list(value.names),
            "inflation": [] if value.inflation is None else column(value.inflation),
            "condition": value.condition if np.isfinite(value.condition) else None,
        },
    }
    for index in range(count):  # axes shared by the cross plots of a column and of a row
        left, right = _find_span(index, count)
        layout[layout_key(index + 1, "x")] = {**_BARE, "domain": [left, right]}
        layout[layout_key(index + 1)] = {**_BARE, "domain": [1.0 - right, 1.0 - left]}
    return {"data": data, "layout": layout}


def _write_legend(is_complex: bool) -> str:
    kind = "real part of the correlation (magnitude and phase)" if is_complex else "correlation"
    drawn = "real and imaginary parts" if is_complex else "samples"
    return f"Above the diagonal {drawn}; below {kind}, flagged beyond ±{LIMIT}."


def _find_span(index: int, count: int) -> tuple[float, float]:
    return index / count + _GAP / 2, (index + 1) / count - _GAP / 2


def _draw_frames(cells: list[tuple[int, int]], count: int) -> Spec:
    """Draw a box around every cross plot, all in one path."""
    boxes = []
    for row, col in cells:
        (left, right), (top, bottom) = _find_span(col, count), _find_span(row, count)
        low, high = 1.0 - bottom, 1.0 - top
        boxes.append(f"M{left},{low}L{right},{low}L{right},{high}L{left},{high}Z")
    return {
        "type": "path", "xref": "paper", "yref": "paper", "path": "".join(boxes),
        "line": {"color": style.GRID, "width": 1},
    }  # fmt: skip


def _format_coefficient(value: complex, font: Spec) -> tuple[str, Spec]:
    if not np.isfinite(value):  # a constant channel has no correlation
        return "–", font
    text, phasor = f"{np.real(value):z.2f}", ""
    if np.iscomplexobj(value):
        phasor = f"<br>({abs(value):.2f}∠{np.degrees(np.angle(value)):z.0f}°)"
    if abs(np.real(value)) <= LIMIT:
        return text + phasor, font
    return f"<b>{text} !</b>{phasor}", {**font, "color": style.FLAG}
