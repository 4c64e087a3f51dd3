"""Flight envelope: airspeed against fuel fraction, one marker per maneuver."""

from __future__ import annotations

from itertools import groupby

from flexsid.figures import style
from flexsid.figures.quantities import text
from flexsid.figures.spec import Spec, empty
from flexsid.records.views import Envelope, EnvelopeMark


def envelope(value: Envelope) -> Spec:
    """Draw the flown conditions over fuel fraction.

    The axis is V/V_f where every maneuver has it, with the predicted flutter boundary at 1;
    else true airspeed.
    """
    if not value.marks:
        return empty("No matching maneuvers")
    as_ratio = all(mark.airspeed_ratio is not None for mark in value.marks)
    marks = sorted(
        value.marks, key=lambda mark: (-1 if mark.fta is None else mark.fta, mark.maneuver_id)
    )
    layout: Spec = {
        "xaxis": {"title": {"text": "Fuel fraction [1]"}, "range": [-0.05, 1.05]},
        "yaxis": {
            "title": {"text": "V/V<sub>f</sub> [1]" if as_ratio else "True airspeed V [m/s]"}
        },
        "showlegend": True,
        "hovermode": "closest",
        "meta": {"rows": 1},
    }
    if as_ratio:
        layout["shapes"] = [_boundary()]
        layout["annotations"] = [_boundary_name()]
    traces = [
        _trace(fta, tuple(group), as_ratio)
        for fta, group in groupby(marks, key=lambda mark: mark.fta)
    ]
    return {"data": traces, "layout": layout}


def _trace(fta: int | None, marks: tuple[EnvelopeMark, ...], as_ratio: bool) -> Spec:
    colour, symbol = style.of_fta(fta)
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "no FTA" if fta is None else f"FTA {fta}",
        "x": [mark.fuel_fraction for mark in marks],
        "y": [mark.airspeed_ratio if as_ratio else mark.airspeed_m_s for mark in marks],
        "marker": {"color": colour, "symbol": symbol, "size": 10},
        "customdata": [mark.maneuver_id for mark in marks],
        "text": [_hover(mark) for mark in marks],
        "hovertemplate": "%{text}<extra></extra>",
    }


def _hover(mark: EnvelopeMark) -> str:
    ratio = "" if mark.airspeed_ratio is None else f"V/V<sub>f</sub> {mark.airspeed_ratio:.2f}, "
    return (
        f"<b>{text(mark.label)}</b><br>{ratio}V {mark.airspeed_m_s:.1f} m/s<br>"
        f"dynamic pressure {mark.dynamic_pressure_pa:.0f} Pa<br>"
        f"fuel fraction {mark.fuel_fraction:.2f}"
    )


def _boundary() -> Spec:
    return {
        "type": "line", "xref": "paper", "yref": "y", "x0": 0, "x1": 1, "y0": 1, "y1": 1,
        "line": {"color": style.FLAG, "width": 1.5, "dash": "dash"}, "layer": "below",
    }  # fmt: skip


def _boundary_name() -> Spec:
    return {
        "xref": "paper", "yref": "y", "x": 1, "y": 1, "xanchor": "right", "yanchor": "bottom",
        "text": "predicted flutter", "showarrow": False, "font": {"color": style.FLAG},
    }  # fmt: skip
