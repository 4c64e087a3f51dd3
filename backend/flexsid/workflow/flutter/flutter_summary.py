"""Flutter summaries of structural programs, and their roots with the names of modes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from scipy.optimize import linear_sum_assignment

from flexsid import units
from flexsid.allowed import Allowed, Fuel, Id
from flexsid.errors import BadInput
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.flutter import (
    ComparedSweep,
    FlutterPoint,
    FlutterSummary,
    SummaryAnalysis,
    SummaryRoot,
    SummaryRoots,
)
from flexsid.storage.store import Store
from flexsid.sysid.model.condition import compute_standard_density
from flexsid.sysid.modes.shapes import may_be
from flexsid.sysid.modes.table import compute_fuel_weights, sum_weighted_rows
from flexsid.workflow.flutter.flutter_roots import (
    RIGID_BODY_OMEGA,
    SweptRoot,
    find_instabilities,
    select_roots,
)
from flexsid.workflow.flutter.predicted_flutter import PredictedFlutterQuery
from flexsid.workflow.modal_data.modal_tables import format_title, list_mode_names, open_modes

# --- Flutter summaries of structural programs, with the speeds at which roots become unstable -----

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


# --- Roots of a flutter summary with the names of modes, at any damping of the structure ----------

_NEAR = 0.05
"""Largest relative difference in frequency of a root at the begin of its sweep and its mode."""

_UNPAIRED = 1e3
"""Cost of a pair that differs more, above the sum of all costs of pairs that do not."""

_SYMMETRIES = {"XZ symmetric": True, "XZ antisymmetric": False}


@dataclass(frozen=True, slots=True, kw_only=True)
class SummaryQuery:
    """An analysis of a flutter summary, a damping g, and the modes that name its roots."""

    summary_id: Id
    analysis: Annotated[int, Allowed(ge=0, le=9999, text="Place among the analyses, from 0.")] = 0
    g: Annotated[
        float,
        Allowed(ge=0.0, le=1.0, text="Structural damping g at which instabilities are read."),
    ] = 0.0
    modal_table_id: Annotated[
        Id | None,
        Allowed(text="Modal table whose modes name the roots; without names by default."),
    ] = None
    fuel: Fuel = 0.5


def read_summary_roots(store: Store, query: SummaryQuery) -> SummaryRoots:
    """Read the roots of one analysis, and find its instabilities at a damping g.

    A root is named by the mode whose frequency is nearest to that at the begin of its sweep, if
    within 5 % and, where the analysis is of one symmetry, of that symmetry; each mode once.

    Raises
    ------
    BadInput
        If the summary was stored by a version that did not store its analyses, or has no such
        analysis, or the modal table is of another aircraft.
    """
    summary = store.flutter_summaries.get(query.summary_id)
    analysis = _select_analysis(summary, query.analysis)
    rows = store.arrays.get(summary.arrays["analysis"]) == query.analysis
    arrays = {
        name: store.arrays.get(summary.arrays[name])[rows]
        if name in summary.arrays
        else np.full(int(rows.sum()), np.nan)
        for name in ("root", "airspeed", "damping", "omega", "growth", "density", "mach")
    }
    roots = select_roots(arrays, analysis.method)
    points, notes = find_instabilities(arrays, analysis.title, analysis.method, query.g)
    names, note = _name_roots(store, query, summary, analysis, roots)
    return SummaryRoots(
        summary_id=query.summary_id,
        analysis=analysis,
        g=query.g,
        roots=tuple(
            SummaryRoot(
                number=root.number,
                name=names.get(root.number, ""),
                is_neutral=root.is_neutral,
                airspeed_m_s=tuple(root.airspeed.tolist()),
                damping_g=tuple(root.damping.tolist()),
                frequency_hz=tuple((root.omega / (2.0 * np.pi)).tolist()),
            )
            for root in roots
        ),
        points=tuple(sorted(points, key=lambda point: (point.is_bound, point.airspeed_m_s))),
        compared=_find_comparable(analysis, arrays["airspeed"], points),
        notes=(*note, *(text[:1].upper() + text[1:] for text in notes)),
    )


def query_beside_summary(
    prediction_id: int, fuel: float, compared: ComparedSweep
) -> PredictedFlutterQuery:
    """Return the query of a prediction at the air density and airspeeds of an analysis."""
    return PredictedFlutterQuery(
        prediction_id=prediction_id,
        fuel=fuel,
        density_kg_m3=compared.density_kg_m3,
        from_m_s=compared.from_m_s,
        to_m_s=compared.to_m_s,
    )


def _select_analysis(summary: FlutterSummary, number: int) -> SummaryAnalysis:
    if not summary.analyses:
        raise BadInput(
            f"flutter summary '{summary.name}' was stored by an earlier version without the "
            "headings of its analyses; import its file again",
            code="summary-outdated",
        )
    if number >= len(summary.analyses):
        raise BadInput(
            f"flutter summary '{summary.name}' has {len(summary.analyses)} analyses; expected "
            f"0 to {len(summary.analyses) - 1}, got {number}",
            code="unknown-analysis",
        )
    return summary.analyses[number]


def _name_roots(
    store: Store,
    query: SummaryQuery,
    summary: FlutterSummary,
    analysis: SummaryAnalysis,
    roots: list[SweptRoot],
) -> tuple[dict[int, str], tuple[str, ...]]:
    """Name roots by the nearest frequencies of a modal table at a fuel fraction."""
    if query.modal_table_id is None:
        return {}, ()
    table = store.modal_tables.get(query.modal_table_id)
    if table.aircraft_id != summary.aircraft_id:
        raise BadInput(
            f"modal table '{table.name}' is of another aircraft than the flutter summary",
            code="other-aircraft",
        )
    modes = open_modes(store, table)
    omega = sum_weighted_rows(compute_fuel_weights(modes.fuel, query.fuel), modes.omega)
    symmetric = _SYMMETRIES.get(analysis.symmetry)
    usable = [
        place
        for place, is_symmetric in enumerate(modes.table.symmetric)
        if omega[place] > RIGID_BODY_OMEGA
        and (symmetric is None or may_be(is_symmetric, symmetric))
    ]
    swept = [root for root in roots if root.omega[0] > RIGID_BODY_OMEGA]
    first = np.array([root.omega[0] for root in swept])
    difference = np.abs(np.log(first[:, None] / omega[usable][None, :]))
    cost = np.where(difference < _NEAR, difference, _UNPAIRED)
    called = list_mode_names(modes.table)
    names = {
        swept[row].number: called[usable[column]]
        for row, column in zip(*linear_sum_assignment(cost), strict=True)
        if cost[row, column] < _UNPAIRED
    }
    near = f"within {100.0 * _NEAR:.0f} % of its frequency at the begin of the sweep"
    source = f"{format_title(table)} at {100.0 * query.fuel:.0f} % fuel"
    note = (
        f"A root has the name of a mode of {source} {near}."
        if names
        else f"No root has a mode of {source} {near}."
    )
    return names, (note,)


def _find_comparable(
    analysis: SummaryAnalysis, airspeed: np.ndarray, points: list[FlutterPoint]
) -> ComparedSweep | None:
    """Return the air density and airspeeds of an analysis, with that of sea level as reference.

    In a sweep of matched points the density is that of its first instability.
    """
    if analysis.density_ratio is None:
        return None
    ratio, highest = analysis.density_ratio
    if highest > ratio:
        seen = [point for point in points if not point.is_bound and point.density_ratio]
        if not seen:
            return None
        ratio = min(seen, key=lambda point: point.airspeed_m_s).density_ratio or 0.0
    low, high = float(airspeed.min()), float(airspeed.max())
    if ratio <= 0.0 or not 0.0 < low < high:
        return None
    density = ratio * compute_standard_density(0.0)
    return ComparedSweep(density_kg_m3=density, from_m_s=low, to_m_s=high)
