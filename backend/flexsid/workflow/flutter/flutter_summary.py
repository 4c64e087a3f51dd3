"""Flutter summaries of structural programs, with the speeds at which roots become unstable."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.flutter_summary import FlutterPoint, FlutterSummary, SummaryAnalysis
from flexsid.storage.store import Store
from flexsid.workflow.flutter.root_onsets import find_instabilities

_DEFAULT_CONFIGURATION = "AEROSG2D"
"""Configuration that Nastran prints where none is named."""

_BEFORE = (
    "Stored by an earlier version, which did not store the headings of its analyses: import the "
    "file again for figures and for other damping."
)


def save_flutter_summary(
    store: Store, aircraft: Aircraft, sources: Sources, name: str, speed_unit: str
) -> FlutterSummary:
    """Store flutter summaries of files, with the speeds at which roots become unstable.

    Parameters
    ----------
    store, aircraft
        Database and aircraft.
    sources
        Files, at least one with a summary.
    name
        Name of the summary.
    speed_unit
        Unit of the velocities, which the printout does not state (VREF scales them).

    Raises
    ------
    BadInput
        If no file has a summary.
    """
    assert aircraft.id is not None
    files = [source for source in sources.items if "flutter/velocity" in source.arrays]
    if not files:
        raise BadInput("the files have no flutter summary", code="no-flutter-summary")
    speed = units.factor(speed_unit, "speed")
    points: list[FlutterPoint] = []
    analyses: list[SummaryAnalysis] = []
    notes = [f"Velocities are in {speed_unit}."]
    parts: list[dict[str, np.ndarray]] = []
    total = 0
    for source in files:
        arrays = _read_arrays(source, speed)
        # in printed order; a page without rows has no analysis
        numbers, arrays["analysis"] = np.unique(arrays["analysis"], return_inverse=True)
        for place, number in enumerate(numbers.tolist()):
            analysis = _describe(source, number, len(files) > 1)
            same = sum(one.title.startswith(analysis.title) for one in analyses)
            if same:  # the same heading again
                analysis = replace(analysis, title=f"{analysis.title} ({same + 1})")
            rows = arrays["analysis"] == place
            title = analysis.title
            found, remarks = find_instabilities(
                {k: v[rows] for k, v in arrays.items()}, title, analysis.method
            )
            analyses.append(analysis)
            points += found
            notes += [f"{title[:1].upper()}{title[1:]}: {text}" for text in remarks]
        arrays["analysis"] = (arrays["analysis"] + total).astype(np.int32)
        total += numbers.size
        parts.append(arrays)
        notes += [f"{source.name}: {text}." for text in source.arrays.get("refused", ())]
    joined = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    record = FlutterSummary(
        aircraft_id=aircraft.id,
        name=name,
        analyses=tuple(analyses),
        points=tuple(sorted(points, key=lambda point: (point.is_bound, point.airspeed_m_s))),
        arrays={
            key: store.arrays.put(values)
            for key, values in joined.items()
            if np.isfinite(values).any()
        },
        notes=tuple(notes),
        origin=", ".join(source.name for source in files),
    )
    return store.flutter_summaries.add(record)


def add_warning(summary: FlutterSummary) -> FlutterSummary:
    """Add the warning of an earlier version to its summary."""
    if summary.analyses:
        return summary
    return replace(summary, notes=(*summary.notes, _BEFORE))


def _read_arrays(source: SourceFile, speed: float) -> dict[str, np.ndarray]:
    found = {
        path.removeprefix("flutter/"): np.asarray(values)
        for path, values in source.arrays.items()
        if path.startswith("flutter/")
    }
    return {
        "analysis": found["analysis"].astype(np.int32),
        "root": found["point"].astype(np.int32),
        "airspeed": found["velocity"] * speed,
        "damping": found["damping"],
        "omega": 2.0 * np.pi * found["frequency"],
        "growth": found["real"],
        "density": found["density"],
        "mach": found["mach"],
    }


def _describe(source: SourceFile, number: int, with_file: bool) -> SummaryAnalysis:
    """Describe an analysis by the heading of its pages."""
    found = source.arrays
    rows = np.asarray(found["flutter/analysis"]) == number
    subcase = int(np.asarray(found["flutter/subcase"])[number])
    configuration, symmetry, method = (
        str(found[f"flutter/{name}"][number]) for name in ("configuration", "symmetry", "method")
    )
    parts = [source.name] if with_file else []
    parts += [f"subcase {subcase}"] if subcase else []
    parts += [configuration] if configuration not in ("", _DEFAULT_CONFIGURATION) else []
    parts += [symmetry] if symmetry else []
    ranges: dict[str, tuple[float, float] | None] = {}
    for name, text in (("mach", "Mach"), ("density", "density ratio")):
        values = np.asarray(found[f"flutter/{name}"], dtype=float)[rows]
        ranges[name] = None
        if np.isfinite(values).all():
            low, high = ranges[name] = float(values.min()), float(values.max())
            parts.append(f"{text} {low:.4g}" + (f" to {high:.4g}" if high > low else ""))
    return SummaryAnalysis(
        title=", ".join([*parts, method or "method not stated"]),
        file=source.name,
        subcase=subcase,
        configuration=configuration,
        symmetry=symmetry,
        method=method,
        mach=ranges["mach"],
        density_ratio=ranges["density"],
    )
