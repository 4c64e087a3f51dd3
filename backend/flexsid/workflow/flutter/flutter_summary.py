"""Flutter summaries of structural programs, with the speeds at which roots become unstable."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.aircraft import Aircraft
from flexsid.records.modal_data import FlutterPoint, FlutterSummary, Instability
from flexsid.storage.store import Store

NEUTRAL = 1e-4
"""Structural damping g: below it a root is neutral, as an undamped mode in vacuo."""

RIGID_BODY_OMEGA = 2.0 * np.pi * 0.05
"""rad/s: a root closer to the origin is a rigid-body motion or round-off."""

_RISING = 1e-3
"""1/s: a root that grows more slowly (doubling in 700 s) is neutral."""

_JUMP = 0.25
"""Largest relative change in frequency of one root between rows."""

_DENSITY_SWEEPS = ("PKNL", "PKNLS")
_WITHOUT_ONSET = ("K",)
_BEFORE = (
    "Stored by an earlier version, which did not separate subcases, Mach numbers and densities: "
    "import the file again."
)


@dataclass(frozen=True, slots=True, eq=False)
class _Root:
    """One root of one analysis, in the order of its sweep."""

    number: int
    airspeed: np.ndarray
    damping: np.ndarray
    omega: np.ndarray
    growth: np.ndarray
    density: np.ndarray
    mach: np.ndarray


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
    notes = [f"Velocities are in {speed_unit}."]
    parts: list[dict[str, np.ndarray]] = []
    total = 0
    for source in files:
        arrays = _read_arrays(source, speed)
        for number in np.unique(arrays["analysis"]):
            title, method = _describe(source, int(number), len(files) > 1)
            rows = arrays["analysis"] == number
            found, remarks = find_instabilities(
                {k: v[rows] for k, v in arrays.items()}, title, method
            )
            points += found
            notes += [f"{title[:1].upper()}{title[1:]}: {text}" for text in remarks]
        arrays["analysis"] = arrays["analysis"] + total
        total = int(arrays["analysis"].max()) + 1
        parts.append(arrays)
        notes += [f"{source.name}: {text}." for text in source.arrays.get("refused", ())]
    joined = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    record = FlutterSummary(
        aircraft_id=aircraft.id,
        name=name,
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
    if "analysis" in summary.arrays:
        return summary
    return replace(summary, notes=(*summary.notes, _BEFORE))


def find_instabilities(
    arrays: dict[str, np.ndarray], title: str, method: str
) -> tuple[list[FlutterPoint], list[str]]:
    """Find the speeds at which roots of one analysis become unstable; return points and notes.

    Parameters
    ----------
    arrays
        As stored in a FlutterSummary, of one analysis.
    title, method
        Description of the analysis, and its solution method.

    Notes
    -----
    Damping is interpolated by a straight line between the rows on either side of zero. Rows are
    taken by rising airspeed; in sweeps of matched points (PKNL) in the order printed, reversed
    where dynamic pressure falls, as their airspeeds need not rise.
    """
    if method in _WITHOUT_ONSET:
        return [], [f"no speed is read, since method {method} does not follow its roots."]
    points: list[FlutterPoint] = []
    neutral: list[int] = []
    notes: list[str] = []
    for number in np.unique(arrays["root"]):
        root = _select_root(arrays, int(number), method)
        size = np.hypot(root.growth, root.omega)
        if (np.abs(root.damping) < NEUTRAL).all() or (size < RIGID_BODY_OMEGA).all():
            rising = float(root.growth.max())
            if rising < _RISING or (root.damping < NEUTRAL).all():
                neutral.append(root.number)
            else:
                notes.append(
                    f"root {root.number} grows slowly, doubling in {np.log(2.0) / rising:.3g} s "
                    "or longer (within 0.05 Hz of the origin, a motion of the free body): no "
                    "speed is read from it."
                )
            continue
        state = np.where((np.abs(root.damping) < NEUTRAL) | (size < RIGID_BODY_OMEGA), 0, 1)
        state = state * np.sign(root.damping).astype(int)
        before = 0
        for row in range(state.size):
            if state[row] > 0 and before <= 0:
                points.append(_interpolate_onset(root, row, before, title, notes))
            before = int(state[row]) or before
    if neutral:
        listed = ", ".join(map(str, neutral))
        notes.append(f"roots {listed} stay neutral or slow: no speed is read from them.")
    return points, notes


def _interpolate_onset(
    root: _Root, row: int, before: int, title: str, notes: list[str]
) -> FlutterPoint:
    """Interpolate the speed at which a root becomes unstable between rows."""
    first, share = row, 0.0
    if before < 0:  # seen stable: the last row without growth lies on the other side of zero
        first = int(np.flatnonzero(root.damping[:row] <= 0)[-1])
        share = float(root.damping[first] / (root.damping[first] - root.damping[first + 1]))
    after = first + 1 if before < 0 else row

    def at(values: np.ndarray) -> float:
        return float(values[first] + share * (values[after] - values[first]))

    kind = Instability.DIVERGENCE if root.omega[after] < RIGID_BODY_OMEGA else Instability.FLUTTER
    omega = at(root.omega)
    if kind is Instability.DIVERGENCE:
        omega = 0.0
    elif root.omega[first] < RIGID_BODY_OMEGA:
        omega = float(root.omega[after])
    larger = float(max(root.omega[first], root.omega[after]))
    if abs(float(root.omega[after] - root.omega[first])) > max(_JUMP * larger, RIGID_BODY_OMEGA):
        notes.append(
            f"root {root.number} changes from {root.omega[first] / (2.0 * np.pi):.3g} to "
            f"{root.omega[after] / (2.0 * np.pi):.3g} Hz between {root.airspeed[first]:.4g} and "
            f"{root.airspeed[after]:.4g} m/s, where it becomes unstable: roots may be exchanged "
            "there; check with a finer sweep."
        )
    density, mach = at(root.density), at(root.mach)
    return FlutterPoint(
        root=root.number,
        airspeed_m_s=at(root.airspeed),
        omega_rad_s=omega,
        kind=kind,
        is_bound=before >= 0,
        analysis=title,
        mach=mach if np.isfinite(mach) else None,
        density_ratio=density if np.isfinite(density) else None,
    )


def _select_root(arrays: dict[str, np.ndarray], number: int, method: str) -> _Root:
    rows = np.flatnonzero(arrays["root"] == number)
    speed = arrays["airspeed"][rows]
    if method in _DENSITY_SWEEPS:
        pressure = arrays["density"][rows] * speed**2
        order = rows if pressure[-1] >= pressure[0] else rows[::-1]
    elif method == "KE":
        order = rows if speed[-1] >= speed[0] else rows[::-1]
    else:
        order = rows[np.argsort(speed, kind="stable")]
    return _Root(
        number,
        *(arrays[name][order] for name in ("airspeed", "damping", "omega", "growth")),
        *(arrays[name][order] for name in ("density", "mach")),
    )


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


def _describe(source: SourceFile, number: int, with_file: bool) -> tuple[str, str]:
    """Describe an analysis; return the text and its method."""
    found = source.arrays
    rows = np.asarray(found["flutter/analysis"]) == number
    subcase = int(np.asarray(found["flutter/subcase"])[number])
    symmetry, method = (str(found[f"flutter/{name}"][number]) for name in ("symmetry", "method"))
    parts = [source.name] if with_file else []
    parts += [f"subcase {subcase}"] if subcase else []
    parts += [symmetry] if symmetry else []
    for name, text in (("mach", "Mach"), ("density", "density ratio")):
        values = np.unique(np.asarray(found[f"flutter/{name}"], dtype=float)[rows])
        if np.isfinite(values).all():
            low, high = float(values[0]), float(values[-1])
            parts.append(f"{text} {low:.4g}" + (f" to {high:.4g}" if high > low else ""))
    return ", ".join([*parts, method or "method not stated"]), method
