"""Flight envelope: airspeed against fuel fraction, one marker per maneuver."""

from __future__ import annotations

from itertools import groupby

from flexsid.figures import style
from flexsid.figures.quantities import of_unit, text
from flexsid.figures.spec import Spec, empty, line_at, plane, scatter, text_at, title
from flexsid.nomenclature import describe
from flexsid.records.views import Envelope, EnvelopeMark


def draw_envelope(value: Envelope) -> Spec:
    """Draw the flown conditions over fuel fraction.

    The axis is V/V_f where every maneuver has it, with the predicted flutter boundary at 1;
    else true airspeed.
    """
    if not value.marks:
        return empty("No matching maneuvers")
    as_ratio = all(mark.airspeed_ratio is not None for mark in value.marks)
    by_fta = sorted(
        value.marks, key=lambda mark: (-1 if mark.fta is None else mark.fta, mark.maneuver_id)
    )
    speed = describe("airspeed")
    data = []
    for fta, group in groupby(by_fta, key=lambda mark: mark.fta):
        marks = tuple(group)
        colour, symbol = style.of_fta(fta)
        data.append(
            scatter(
                [mark.fuel_fraction for mark in marks],
                [
                    mark.airspeed_ratio if as_ratio else speed.display_factor * mark.airspeed_m_s
                    for mark in marks
                ],
                name="no FTA" if fta is None else f"FTA {fta}",
                marker={"color": colour, "symbol": symbol, "size": 10},
                customdata=[mark.maneuver_id for mark in marks],
                text=[_describe(mark) for mark in marks],
                hovertemplate="%{text}<extra></extra>",
            )
        )
    layout = plane(
        {**title("Fuel fraction [1]"), "range": [-0.05, 1.05]},
        title("V/V<sub>f</sub> [1]" if as_ratio else f"True airspeed {speed.axis_title}"),
        1,
    )
    if as_ratio:
        font = {"color": style.FLAG}
        layout["shapes"] = [line_at(1, "y")]
        layout["annotations"] = [
            text_at(1, 1, "predicted flutter", "right", "bottom", font, yref="y")
        ]
    return {"data": data, "layout": layout}


def _describe(mark: EnvelopeMark) -> str:
    ratio = "" if mark.airspeed_ratio is None else f"V/V<sub>f</sub> {mark.airspeed_ratio:.2f}, "
    speed, pressure = of_unit("V", "m/s"), of_unit("dynamic pressure", "Pa")
    return (
        f"<b>{text(mark.label)}</b><br>{ratio}{speed.format(mark.airspeed_m_s)}<br>"
        f"{pressure.format(mark.dynamic_pressure_pa)}<br>"
        f"fuel fraction {mark.fuel_fraction:.2f}"
    )
