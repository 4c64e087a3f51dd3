"""Figures of the sheet of a condition: normalised derivatives, and tests of a run."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor, log10

from flexsid.display_units import display_unit
from flexsid.figures import style
from flexsid.figures.spec import N_SIGMA, Spec, empty, scatter
from flexsid.figures.style import parameter_label
from flexsid.nomenclature import describe
from flexsid.records.condition_sheet import ConditionSheet, SheetRow, SheetSource, SourceRole
from flexsid.records.run import AdequacyTest, ModelAdequacy
from flexsid.sysid.adequacy.model_tests import FALSE_ALARM_RATE

REACH = 5.0
"""σ shown on either side of the reference; what lies beyond is an arrow with its percentage."""

_ROW_PX = 19
_TOP_PX, _BOTTOM_PX = 34, 44
_WIDE = 20.0  # 2σ in % of the value above which it is flagged
_UNKNOWN = 100.0  # and above which the derivative is not identifiable here
_SELECTED = "rgba(255, 193, 7, 0.33)"
_WITHIN = "rgba(134, 142, 150, 0.16)"
_SHARED = "rgba(134, 142, 150, 0.45)"

# Shares of the width: name, value, error, unit, percent, then the deviations.
_NAME, _VALUE, _ERROR, _UNIT, _PERCENT = 0.0, 0.205, 0.215, 0.31, 0.40
_LEFT = 0.43


def draw_condition_derivatives(value: ConditionSheet, selected: str | None = None) -> Spec:
    """Draw one row per derivative: value, ±2σ, and the deviations of all sources in σ.

    The grey column is ±2σ for all rows. Hatched rows have errors that all runs share.
    """
    if not value.rows:
        return empty("No run of this condition has succeeded")
    groups = _group_rows(value.rows)
    places: dict[str, int] = {}
    headings: list[tuple[int, str]] = []
    line = 0
    for coefficient, names in groups:
        headings.append((line, coefficient))
        line += 1
        for name in names:
            places[name] = line
            line += 1
    looks = _select_looks(value.sources)
    rows = {row.name: row for row in value.rows}
    data = [
        _draw_source(index, source, looks[source.key], value.rows, places)
        for index, source in enumerate(value.sources)
    ]
    data += _draw_pick_targets(value.rows, places)
    shapes, notes = _draw_table(rows, places, selected)
    notes += [_write(at, _NAME, f"<b>{_coefficient_label(name)}</b>") for at, name in headings]
    shapes += [_rule(at) for at, _ in headings]
    head = -1.0
    notes += [
        _write(head, _VALUE, "Value", "right", quiet=True),
        _write(head, _ERROR, "±2σ", quiet=True),
        _write(head, _PERCENT, "2σ in %", "right", quiet=True),
    ]
    arrows = _draw_arrows(value.sources, looks, value.rows, places)
    layout: Spec = {
        "xaxis": {
            "domain": [_LEFT, 1.0],
            "range": [-REACH - 2.2, REACH + 2.2],
            "tickvals": [-4, -2, 0, 2, 4],
            "ticktext": ["−4σ", "−2σ", "0", "+2σ", "+4σ"],
            "title": {"text": f"Deviation from {value.sources[0].label} in σ"},
            "zeroline": False,
            "showspikes": False,
            "fixedrange": True,
        },
        "yaxis": {
            "range": [line - 0.4, -1.6],
            "visible": False,
            "fixedrange": True,
            "automargin": False,
        },
        "shapes": shapes,
        "annotations": [*notes, *arrows],
        "showlegend": True,
        "legend": {"x": _LEFT, "y": 1.0, "yanchor": "bottom", "orientation": "h"},
        "hovermode": "closest",
        "margin": {"l": 4, "r": 6, "t": _TOP_PX, "b": _BOTTOM_PX},
        "meta": {
            "height": _TOP_PX + _BOTTOM_PX + _ROW_PX * (line + 1.2),
            "least_width": 720,
        },
    }
    return {"data": data, "layout": layout}


def _group_rows(rows: Sequence[SheetRow]) -> list[tuple[str, list[str]]]:
    groups: dict[str, list[str]] = {}
    for row in rows:
        groups.setdefault(row.name.partition("_")[0], []).append(row.name)
    return list(groups.items())


def _coefficient_label(name: str) -> str:
    found = describe(name)
    return found.html if found.meaning == "" else f"{found.html}</b> {found.meaning}<b>"


def _select_looks(sources: Sequence[SheetSource]) -> dict[str, tuple[str, str]]:
    """Select colour and symbol by source: methods filled, repeats open, truth a hollow bar."""
    looks: dict[str, tuple[str, str]] = {}
    n_repeats = n_predictions = 0
    for source in sources:
        if source.role is SourceRole.TRUTH:
            looks[source.key] = style.GREY, "line-ns-open"
        elif source.role is SourceRole.PREDICTION:
            looks[source.key] = style.PREDICTIONS[n_predictions % len(style.PREDICTIONS)]
            n_predictions += 1
        elif source.role is SourceRole.REPEAT:
            n_repeats += 1
            looks[source.key] = style.of_method(source.method or "", n_repeats)
        else:
            looks[source.key] = style.of_method(source.method or "")
    return looks


def _draw_source(
    index: int,
    source: SheetSource,
    look: tuple[str, str],
    rows: Sequence[SheetRow],
    places: dict[str, int],
) -> Spec:
    colour, symbol = look
    shown = [
        (number, row, found, found.deviation_sigma)
        for number, row in enumerate(rows)
        if (found := row.values[index]) is not None
        and found.deviation_sigma is not None
        and abs(found.deviation_sigma) <= REACH
    ]
    # heights within a row mean nothing, they only part the symbols
    offset = {SourceRole.METHOD: 0.16, SourceRole.TRUTH: 0.0}.get(source.role, 0.0)
    offset *= 1 if index % 2 else -1
    outside = [source.role is SourceRole.REPEAT and abs(sigma) > N_SIGMA for *_, sigma in shown]
    return scatter(
        [sigma for *_, sigma in shown],
        [places[row.name] + offset for _, row, *_ in shown],
        "markers+text",
        name=source.label,
        text=[
            f"<b>{sigma:+.1f}σ</b>" if far else ""
            for far, (*_, sigma) in zip(outside, shown, strict=True)
        ],
        textposition=["middle right" if sigma > 0 else "middle left" for *_, sigma in shown],
        textfont={"color": colour, "size": 11},
        marker={
            "color": colour,
            "symbol": symbol,
            "size": 11 if source.role is SourceRole.TRUTH else 7,
            "line": {"width": 1.6, "color": colour},
        },
        customdata=[[number, row.name] for number, row, *_ in shown],
        hovertext=[
            f"{parameter_label(row.name)} {found.value:.5g}, {sigma:+.1f}σ"
            + ("" if found.deviation_percent is None else f", {found.deviation_percent:+.1f} %")
            for _, row, found, sigma in shown
        ],
        hovertemplate=f"%{{hovertext}}<extra>{source.label}</extra>",
    )


def _draw_pick_targets(rows: Sequence[SheetRow], places: dict[str, int]) -> list[Spec]:
    """Return marks that are not seen, by which a press anywhere in a row selects it."""
    steps = [0.5 * k for k in range(-14, 15)]
    x = [at for _ in rows for at in steps]
    return [
        scatter(
            x,
            [places[row.name] for row in rows for _ in steps],
            marker={"size": 14, "opacity": 0.0},
            customdata=[[number, row.name] for number, row in enumerate(rows) for _ in steps],
            hoverinfo="none",
            showlegend=False,
        )
    ]


def _draw_arrows(
    sources: Sequence[SheetSource],
    looks: dict[str, tuple[str, str]],
    rows: Sequence[SheetRow],
    places: dict[str, int],
) -> list[Spec]:
    """Return an arrow with the difference in % where a source lies beyond the strip."""
    notes: list[Spec] = []
    for row in rows:
        used: set[bool] = set()
        for source, found in zip(sources, row.values, strict=True):
            sigma = None if found is None else found.deviation_sigma
            if found is None or sigma is None or abs(sigma) <= REACH:
                continue
            right = sigma > 0
            if right in used:
                continue
            used.add(right)
            share = found.deviation_percent
            size = f"{sigma:+.0f}σ" if share is None else f"{share:+.0f} %"
            text = f"{size} →" if right else f"← {size}"
            notes.append(
                {
                    "xref": "x",
                    "yref": "y",
                    "x": REACH + 2.1 if right else -REACH - 2.1,
                    "y": places[row.name],
                    "text": text.replace("-", "−"),
                    "showarrow": False,
                    "xanchor": "right" if right else "left",
                    "font": {"size": 11, "color": looks[source.key][0]},
                }
            )
    return notes


def _draw_table(
    rows: dict[str, SheetRow], places: dict[str, int], selected: str | None
) -> tuple[list[Spec], list[Spec]]:
    """Return the columns of the table, the band of ±2σ, and marks of shared errors."""
    last = max(places.values())
    shapes: list[Spec] = [
        {
            **_box(-N_SIGMA, N_SIGMA, -0.5, last + 0.5),
            "fillcolor": _WITHIN,
        },
        {
            "type": "line", "xref": "x", "yref": "y", "x0": 0, "x1": 0, "y0": -0.5,
            "y1": last + 0.5, "layer": "below", "line": {"color": style.GREY, "width": 1},
        },
    ]  # fmt: skip
    notes: list[Spec] = []
    for name, at in places.items():
        row = rows[name]
        if name == selected:
            shapes.append(
                {
                    "type": "rect", "xref": "paper", "yref": "y", "x0": 0, "x1": 1,
                    "y0": at - 0.5, "y1": at + 0.5, "layer": "below", "line": {"width": 0},
                    "fillcolor": _SELECTED,
                }
            )  # fmt: skip
        if not row.is_testable:
            shapes.append(
                {
                    **_box(-N_SIGMA, N_SIGMA, at - 0.34, at + 0.34),
                    "fillcolor": _SHARED,
                    "layer": "below",
                }
            )
            if row.std_error is not None:
                notes.append(
                    {
                        **_write(at, 0.0, "σ shared by all runs", quiet=True),
                        "xref": "x",
                        "x": N_SIGMA + 0.15,
                        "font": {"size": 10, "color": style.GREY},
                    }
                )
        notes += _write_numbers(row, at, bold=name == selected)
    return shapes, notes


def _write_numbers(row: SheetRow, at: int, *, bold: bool) -> list[Spec]:
    label = f"  {parameter_label(row.name)}"
    notes = [_write(at, _NAME + 0.008, f"<b>{label}</b>" if bold else label)]
    unit, factor = display_unit(row.unit)
    if row.std_error is None:
        return [*notes, _write(at, _VALUE, _minus(f"{factor * row.value:.4g}"), "right")]
    error = factor * N_SIGMA * row.std_error
    value, spread = format_with_error(factor * row.value, error)
    notes += [
        _write(at, _VALUE, value, "right"),
        _write(at, _ERROR, f"± {spread}"),
        _write(at, _UNIT, "" if unit == "1" else unit.removeprefix("1"), quiet=True),
    ]
    if row.value:
        share = 100.0 * N_SIGMA * row.std_error / abs(row.value)
        digits = f"{share:.1f}" if share < 9.95 else f"{share:.0f}"
        text = "not identifiable" if share > _UNKNOWN else digits
        flagged = f'<b><span style="color:{style.FLAG}">{text}</span></b>'
        notes.append(_write(at, _PERCENT, flagged if share > _WIDE else text, "right"))
    return notes


def format_with_error(value: float, error: float) -> tuple[str, str]:
    """Write a value to the place of the second significant digit of its error, and the error."""
    decimals = max(0, 1 - floor(log10(error))) if error > 0 else 4
    return _minus(f"{value:.{decimals}f}"), f"{error:.{decimals}f}"


def _minus(text: str) -> str:
    return text.replace("-", "−")


def _write(at: float, x: float, text: str, anchor: str = "left", *, quiet: bool = False) -> Spec:
    note: Spec = {
        "xref": "paper", "yref": "y", "x": x, "y": at, "text": text, "showarrow": False,
        "xanchor": anchor, "yanchor": "middle", "font": {"size": 12},
    }  # fmt: skip
    if quiet:
        note["opacity"] = 0.75
        note["font"] = {"size": 11}
    return note


def _box(x0: float, x1: float, y0: float, y1: float) -> Spec:
    return {
        "type": "rect", "xref": "x", "yref": "y", "x0": x0, "x1": x1, "y0": y0, "y1": y1,
        "layer": "below", "line": {"width": 0},
    }  # fmt: skip


def _rule(at: float) -> Spec:
    return {
        "type": "line", "xref": "paper", "yref": "y", "x0": 0, "x1": 1, "y0": at + 0.45,
        "y1": at + 0.45, "line": {"color": style.GRID, "width": 1}, "layer": "below",
    }  # fmt: skip


def draw_adequacy(value: ModelAdequacy, selected: str | None = None) -> Spec:
    """Draw every test of a run as a mark on an axis of p, by hypothesis; the worst is named."""
    if not value.tests:
        return empty("This run was not tested for remaining model error")
    groups: dict[str, list[AdequacyTest]] = {}
    for test in value.tests:
        groups.setdefault(test.hypothesis, []).append(test)
    order = sorted(groups, key=lambda name: -len(groups[name]))
    worst = min(value.tests, key=lambda test: test.p)
    # Holm multiplies the smallest p by the number of tests that can reject
    limit = (
        FALSE_ALARM_RATE * worst.p / worst.adjusted_p
        if worst.adjusted_p < 1.0
        else (FALSE_ALARM_RATE / len(value.tests))
    )
    floor_p = min(limit / 10.0, max(worst.p, 1e-12) / 3.0)
    data = []
    for place, name in enumerate(order):
        tests = groups[name]
        data.append(
            scatter(
                [max(test.p, floor_p) for test in tests],
                [place] * len(tests),
                marker={
                    "symbol": "line-ns-open",
                    "size": 13,
                    "color": [style.FLAG if test.rejects else style.GREY for test in tests],
                    "line": {"width": 1.4},
                },
                name=name,
                hovertext=[
                    f"{describe(test.subject).label}: p = {test.p:.2g}, adjusted"
                    f" {test.adjusted_p:.2g}. {test.meaning}"
                    for test in tests
                ],
                hovertemplate=f"%{{hovertext}}<extra>{name}</extra>",
            )
        )
    chosen = [test for test in value.tests if selected is not None and test.subject == selected]
    if chosen:
        data.append(
            scatter(
                [max(test.p, floor_p) for test in chosen],
                [order.index(test.hypothesis) for test in chosen],
                marker={
                    "symbol": "line-ns-open",
                    "size": 17,
                    "color": style.OCHRE,
                    "line": {"width": 3},
                },
                name=describe(selected or "").label,
                hoverinfo="skip",
            )
        )
    layout: Spec = {
        "xaxis": {
            "type": "log",
            "range": [0.1, log10(floor_p)],
            "title": {"text": "p of each test"},
            "dtick": 1,
            "showspikes": False,
        },
        "yaxis": {
            "tickvals": list(range(len(order))),
            "ticktext": [f"{name}  {len(groups[name])}" for name in order],
            "range": [len(order) - 0.4, -0.9],
            "showgrid": False,
        },
        "shapes": [
            {
                "type": "line", "xref": "x", "yref": "paper", "x0": limit, "x1": limit,
                "y0": 0, "y1": 1, "line": {"color": style.FLAG, "width": 1.5, "dash": "dash"},
            }
        ],
        "annotations": [
            {
                "xref": "x", "yref": "paper", "x": log10(limit), "y": 1, "showarrow": False,
                "text": "rejects →", "xanchor": "left", "yanchor": "bottom",
                "font": {"size": 11, "color": style.FLAG},
            },
            {
                "xref": "x", "yref": "y", "x": log10(max(worst.p, floor_p)),
                "y": order.index(worst.hypothesis), "showarrow": True, "arrowhead": 0,
                "ax": 0, "ay": -22, "font": {"size": 11},
                "text": f"smallest p: {describe(worst.subject).label}",
            },
        ],
        "showlegend": False,
        "hovermode": "closest",
        "meta": {"rows": max(1.0, 0.13 * len(order) + 0.15)},
    }  # fmt: skip
    return {"data": data, "layout": layout}
