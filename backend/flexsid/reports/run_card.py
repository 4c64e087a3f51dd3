"""Run card of a design: what the crew needs to fly it, on one page."""

from __future__ import annotations

import numpy as np

from flexsid.records.excitation import ExcitationDesign
from flexsid.reports.content import (
    Drawing,
    Facts,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    draw,
    moment,
)
from flexsid.storage.store import Store
from flexsid.sysid.excitation.export import build_self_test, list_units
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.workflow.excitation.excitation_designs import build_multisine
from flexsid.workflow.excitation.target_modes import find_band

_LEVELS = ("low", "medium", "high")
_HEIGHT_PX = 300  # of the figure, at most: the card is one page
_ROW_PX = 54  # of the figure per input
_STEPS = (
    "Compare the checksums with those of the flight computer; load this amplitude only.",
    "Trim, hands off, at the condition of the test point; hold for 2 s before the start.",
    "Start; no inputs of the pilot until the excitation has ended, then hold for 4 s.",
    "Stop at an oscillation that grows, at a limit of the aircraft, or on call.",
    "Next amplitude only after the surfaces have been compared with the commands.",
)


def run_card(store: Store, design_id: int, level: int) -> Report:
    """Build the run card of a design at one of its amplitudes.

    Raises
    ------
    UnknownRecord
        If there is no such design.
    """
    design = store.designs.get(design_id)
    multisine = build_multisine(design, level)
    specification = design.specification
    low, high = find_band(specification)
    facts = (
        ("Amplitude", f"{_LEVELS[level]} ({level + 1} of {len(_LEVELS)})"),
        ("Duration", f"{specification.duration_s:g} s, once"),
        ("Band", f"{low:.3g} to {high:.4g} Hz"),
        ("Rate", f"{specification.rate_hz:g} Hz"),
        *((("Flight test aid", str(design.fta + level)),) if design.fta is not None else ()),
        *((("Note", design.note),) if design.note else ()),
    )
    steps = tuple(Words(f"{k + 1}. {step}") for k, step in enumerate(_STEPS))
    return Report(
        title=f"Run card: {design.name}",
        subtitle=f"Design {design_id}, {_LEVELS[level]} amplitude",
        name=f"run-card-{design_id}-{_LEVELS[level]}",
        sections=(
            Section("Maneuver", (Facts(facts), _tabulate_inputs(design, multisine))),
            Section("Conduct", steps),
            Section("Commands", (_draw_commands(store, design_id, level, len(multisine.inputs)),)),
        ),
        provenance=(("Design", f"{design_id}, of {moment(design.created_at)}"),),
        single_page=True,
    )


def _draw_commands(store: Store, design_id: int, level: int, n_inputs: int) -> Part:
    """Draw the commands so high that the card is one page."""
    caption = "Commands over one period; units as in the table"
    found = draw(caption, store, "design-history", design_id=design_id, level=level)
    if not isinstance(found, Drawing):
        return found
    layout = {**found.spec["layout"], "height": min(_HEIGHT_PX, (n_inputs + 1) * _ROW_PX)}
    for name in [key for key in layout if key.startswith("yaxis")]:
        title = layout[name].get("title", {})
        # Rows are lower than a name with its unit is long.
        short = {**title, "text": title.get("text", "").partition(" [")[0]}
        layout[name] = {**layout[name], "title": short}
    return Drawing({**found.spec, "layout": layout}, caption)


def _tabulate_inputs(design: ExcitationDesign, multisine: Multisine) -> ReportTable:
    samples = multisine.sample_period(design.specification.rate_hz)
    rates = np.abs(np.diff(samples, axis=0)).max(axis=0) * design.specification.rate_hz
    rows = []
    for column, (name, unit, checksum) in enumerate(
        zip(
            multisine.inputs,
            list_units(multisine.inputs),
            build_self_test(samples).crc32,
            strict=True,
        )
    ):
        scale = np.rad2deg(1.0) if unit == "rad" else 100.0
        peak, rate = scale * np.abs(samples[:, column]).max(), scale * rates[column]
        shown = "deg" if unit == "rad" else "%"
        rows.append(
            (
                name,
                f"{peak:.2f} {shown}",
                f"{rate:.1f} {shown}/s",
                str(multisine.tones[name].harmonics.size),
                f"{design.peak_factors[name]:.3f}",
                f"{checksum:08x}",
            )
        )
    return ReportTable(
        ("input", "peak", "largest rate", "harmonics", "relative peak factor", "CRC-32"),
        tuple(rows),
        "Commands, and checksums of their tables as little-endian floats of 32 bits",
    )
