"""Validation: matrix of cross-predictions, and correlation functions of residuals."""

from __future__ import annotations

import numpy as np

from flexsid.figures import quantities, style
from flexsid.figures.spec import Spec, empty, heatmap, scatter, stack, title
from flexsid.records.validation import (
    CorrelationCurve,
    CrossPrediction,
    CrossPredictionMatrix,
    ResidualCorrelations,
)

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
        colorbar=title("Mean R² [1]"),
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
    layout = {
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
        [title(f"{_name(curve)} [1]") for curve in value.curves],
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
