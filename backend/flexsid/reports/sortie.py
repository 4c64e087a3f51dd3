"""Reports of a flight: the card of a design before it, and the sortie after it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexsid.display_units import display_unit
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.live import (
    LiveEstimate,
    LiveTestPoint,
    RecordedState,
    StreamStatus,
)
from flexsid.reports.content import (
    Drawing,
    Facts,
    Part,
    Report,
    ReportTable,
    Section,
    Words,
    converted,
    draw,
    estimate,
    heading,
    moment,
    shown,
)
from flexsid.storage.store import Store
from flexsid.sysid.excitation.designer import build_self_test, list_units
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.workflow.excitation.excitation_designs import build_multisine
from flexsid.workflow.excitation.target_modes import find_band
from flexsid.workflow.live.live_estimator import FlownStream, read_sortie

# --- Report of a sortie: test points of a stream, what was known when, alarms, lost data ----------

_STEP_S = 5.0  # between rows of what was known [s]
_ADVICE = (
    "Estimates in flight are advice. The runs of the stored maneuvers, with all tests of the model,"
    " are the result."
)


def sortie_report(store: Store, stream_id: int) -> Report:
    """Report a stream with its test points.

    Raises
    ------
    UnknownRecord
        If there is no stream of this id.
    """
    sortie = read_sortie(store, stream_id)
    stream = sortie.stream
    run = store.runs.get(stream.run_id)
    return Report(
        title=stream.title,
        subtitle=f"Sortie of {store.aircraft.get(stream.aircraft_id).name}, stream {stream_id}",
        name=f"flexsid-sortie-{stream_id}",
        sections=(
            Section("Summary", tuple(_summarise(sortie))),
            Section("Test points", tuple(_report_test_points(store, sortie))),
            Section(
                "What was known when",
                (
                    draw(
                        "Flutter speed and damping ratios as estimated in flight, ±2 standard"
                        " errors",
                        *(store, "live-history"),
                        stream_id=stream_id,
                    ),
                    _tabulate_estimates(sortie),
                ),
            ),
            Section("Alarms", (_tabulate_alarms(sortie),)),
            Section("Data", (_tabulate_defects(sortie),)),
        ),
        provenance=(
            ("Stream", f"{stream_id}, {moment(stream.created_at)}, {stream.author or 'unnamed'}"),
            ("Run of the model", f"{run.id}, {run.method.value}"),
            ("States", str(len(sortie.states))),
        ),
    )


def _summarise(sortie: FlownStream) -> Iterator[Part]:
    stream = sortie.stream
    if stream.status is StreamStatus.FAILED:
        yield Words(f"The stream failed: {stream.message}", warns=True)
    open_alarms = len(sortie.alarms) - len(_find_acknowledged(sortie))
    if open_alarms:
        yield Words(f"{open_alarms} of {len(sortie.alarms)} alarms not acknowledged.", warns=True)
    if any(not _get_measured(one) for one in sortie.estimates):
        yield Words(
            "The flight condition was not measured; that of the run of the stream is assumed.",
            warns=True,
        )
    yield Words(_ADVICE)
    last = sortie.states[-1].state if sortie.states else None
    yield Facts(
        (
            ("Receiver", stream.receiver.name),
            ("Started", moment(stream.created_at)),
            ("Stopped", moment(stream.stopped_at)),
            ("Test points", str(len(sortie.test_points))),
            ("Next test point", shown(stream.next_airspeed_m_s, "m/s")),
            ("Alarms", str(len(sortie.alarms))),
            ("Lost frames", "–" if last is None else str(last.lost_frames)),
            ("Late frames", "–" if last is None else str(last.late_frames)),
        )
    )


def _report_test_points(store: Store, sortie: FlownStream) -> Iterator[Part]:
    if not sortie.test_points:
        yield Words("No maneuver was flown.")
        return
    rows = []
    for point in sortie.test_points:
        last = _find_last_estimate(sortie, point)
        label = "–" if point.maneuver_id is None else store.maneuvers.get(point.maneuver_id).label
        rows.append(
            (
                label,
                point.status.value + (f" by {point.author}" if point.author else ""),
                f"{point.start_s:.1f} … {point.stop_s:.1f}",
                *_describe_estimate(last),
                "–" if point.run_id is None else str(point.run_id),
            )
        )
    yield ReportTable(
        ("maneuver", "status", "time [s]", *_head_estimates(), "run"),
        tuple(rows),
        "Test points with the last estimate of each, ± 2 standard errors",
        numbers_from=2,
    )
    for point in sortie.test_points:
        if point.message:
            yield Words(f"{point.start_s:.1f} s: {point.message}", warns=True)


def _head_estimates() -> tuple[str, ...]:
    speeds = heading("V", "m/s"), heading("V_f", "m/s")
    return (*speeds, "least damped", "damping ratio", "P(unstable) [%]")


def _describe_estimate(found: LiveEstimate | None) -> tuple[str, ...]:
    """Format airspeed, flutter speed and the least damped mode of an estimate."""
    if found is None:
        return ("–",) * len(_head_estimates())
    speeds = (
        converted(found.condition.airspeed_m_s if found.condition else None, "m/s", 3),
        _format_interval(found.flutter_m_s, found.flutter_std_m_s, display_unit("m/s")[1]),
    )
    mode = min(found.modes, key=lambda mode: mode.damping, default=None)
    if mode is None:
        return (*speeds, "–", "–", "–")
    return (
        *speeds,
        mode.name,
        _format_interval(mode.damping, mode.damping_std),
        "–"
        if mode.instability_probability is None
        else f"{100.0 * mode.instability_probability:.1f}",
    )


def _format_interval(value: float | None, std: float | None, factor: float = 1.0) -> str:
    if value is None:
        return "none"
    written, error = estimate(factor * value, None if std is None else 2.0 * factor * std)
    return f"{written} ± {error}"


def _find_last_estimate(sortie: FlownStream, point: LiveTestPoint) -> LiveEstimate | None:
    """Return the last estimate of a maneuver, which may end after the excitation."""
    following = [p.start_s for p in sortie.test_points if p.start_s > point.start_s]
    end_s = min(following, default=float("inf"))
    own = [one.state.estimate for one in sortie.estimates if point.start_s < one.time_s <= end_s]
    return own[-1] if own else None


def _tabulate_estimates(sortie: FlownStream) -> Part:
    """Tabulate what was known every five seconds of each maneuver."""
    rows, last_s = [], -_STEP_S
    for one in sortie.estimates:
        if 0.0 <= one.time_s - last_s < _STEP_S:
            continue
        last_s = one.time_s
        rows.append(
            (
                f"{one.time_s:.1f}",
                f"{one.state.maneuver_s:.1f}",
                *_describe_estimate(one.state.estimate),
                f"{one.delay_s:.2f}",
            )
        )
    return ReportTable(
        ("time [s]", "of maneuver [s]", *_head_estimates(), "delay [s]"),
        tuple(rows),
        f"Estimates every {_STEP_S:g} s; the delay is that from the last sample to the estimate",
        numbers_from=0,
    )


def _get_measured(one: RecordedState) -> bool:
    found = one.state.estimate
    return found is not None and found.condition is not None and found.condition.is_measured


def _find_acknowledged(sortie: FlownStream) -> dict[tuple[str, str, float], str]:
    """Return by whom each alarm was acknowledged."""
    return {
        (one.kind.value, one.subject, one.time_s): f"{one.author}: {one.note}".rstrip(": ")
        for one in sortie.acknowledgements
    }


def _tabulate_alarms(sortie: FlownStream) -> Part:
    if not sortie.alarms:
        return Words("No alarm was raised.")
    known = _find_acknowledged(sortie)
    return ReportTable(
        ("time [s]", "alarm", "of", "evidence", "acknowledged by"),
        tuple(
            (
                f"{alarm.time_s:.2f}",
                alarm.kind.value,
                alarm.subject,
                alarm.evidence,
                known.get((alarm.kind.value, alarm.subject, alarm.time_s), "not acknowledged"),
            )
            for alarm in sortie.alarms
        ),
        "Alarms in the order of time",
        numbers_from=5,
    )


def _tabulate_defects(sortie: FlownStream) -> Part:
    """Tabulate the largest defects of every channel in any maneuver."""
    worst: dict[str, tuple[float, int, bool]] = {}
    for one in sortie.states:
        for health in one.state.health:
            missing_s, spikes, excluded = worst.get(health.name, (0.0, 0, False))
            worst[health.name] = (
                max(missing_s, health.missing_s),
                max(spikes, health.spikes),
                excluded or health.is_excluded,
            )
    if not worst:
        return Words("No channel had gaps, spikes or frozen samples in a maneuver.")
    return ReportTable(
        ("channel", "without samples [s]", "spikes", "excluded"),
        tuple(
            (name, f"{missing_s:.2f}", str(spikes), "yes" if excluded else "no")
            for name, (missing_s, spikes, excluded) in sorted(worst.items())
        ),
        "Channels with defects: most in one maneuver",
    )


# --- Run card of a design: what the crew needs to fly it, on one page -----------------------------

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
    layout: dict[str, Any] = {
        **found.spec["layout"],
        "height": min(_HEIGHT_PX, (n_inputs + 1) * _ROW_PX),
    }
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
