"""Flutter summaries of a Nastran printout (SOL 145), with the analysis of every row.

A printout may hold several analyses: of subcases, configurations, symmetries, Mach numbers and
densities. A root ("POINT") belongs to one analysis, so rows are separated by the heading of their
page.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from flexsid.importers.numbers import read_real
from flexsid.importers.source import Field

_VALUE = re.compile(r"[-+]?\d*\.\d+(?:[EeDd]?[-+]\d+)?|[-+]?\d+\.?|\*{3,}|NaN|[-+]?Inf\w*", re.I)
_NUMBER = r"([-+]?[\d.]+(?:[EeDd][-+]?\d+)?)"
_POINT = re.compile(r"POINT\s*=\s*(\d+)")
_MACH = re.compile(rf"MACH NUMBER\s*=\s*{_NUMBER}")
_DENSITY = re.compile(rf"DENSITY RATIO\s*=\s*{_NUMBER}")
_METHOD = re.compile(r"METHOD\s*=\s*([A-Z]+)")
_CONFIGURATION = re.compile(r"CONFIGURATION\s*=\s*(\S+)")
_SYMMETRY = re.compile(r"(X[YZ])-SYMMETRY\s*=\s*([A-Z]+)")
_COLUMNS = (
    ("1./KFREQ", "inverse"),
    ("KFREQ", "reduced_frequency"),
    ("DENSITY", "density"),
    ("MACH NO", "mach"),
    ("VELOCITY", "velocity"),
    ("DAMPING", "damping"),
    ("FREQUENCY", "frequency"),
)
_NEEDED = ("velocity", "damping", "frequency")


@dataclass(frozen=True, slots=True)
class _Page:
    """Analysis parameters from the heading of a page."""

    subcase: int
    configuration: str
    symmetry: str
    method: str
    mach: float
    density: float


@dataclass(slots=True)
class _FlutterAnalysis:
    """One analysis: its roots, and the rows of each."""

    page: _Page
    last: int = 0
    seen: dict[int, set[tuple[float, ...]]] = field(default_factory=dict)


@dataclass(slots=True)
class FlutterPages:
    """The flutter summaries of a printout, read line by line."""

    _analyses: list[_FlutterAnalysis] = field(default_factory=list)
    _rows: list[dict[str, float]] = field(default_factory=list)
    _current: int = -1
    _subcase: int = 0
    _symmetry: str = ""
    _configuration: str = ""
    _columns: list[str] = field(default_factory=list)

    def begin(self, subcase: int) -> None:
        """Begin a page."""
        self._subcase, self._symmetry, self._configuration = subcase, "", ""
        self._columns, self._current = [], -1

    def take(self, line: str) -> None:
        """Read the symmetry, the point, the heading or a row of a summary.

        Raises
        ------
        ValueError
            If the columns of a row differ from its heading, or a required number is missing.
        """
        if (configuration := _CONFIGURATION.search(line)) is not None:
            self._configuration = configuration[1]
        if symmetry := _SYMMETRY.findall(line):
            stated = [f"{plane} {how.lower()}" for plane, how in symmetry if how != "ASYMMETRIC"]
            self._symmetry = ", ".join(stated)
        elif (point := _POINT.search(line)) is not None:
            self._open(int(point[1]), line)
        elif "KFREQ" in line:
            at = {name: line.replace("1./KFREQ", " " * 8).find(key) for key, name in _COLUMNS[1:]}
            at["inverse"] = line.find("1./KFREQ")
            self._columns = sorted((n for n in at if at[n] >= 0), key=at.__getitem__)
            self._columns += ["real", "imaginary"]
        elif self._columns and self._current >= 0:
            self._row(line)

    def _open(self, point: int, line: str) -> None:
        method, mach, density = (found.search(line) for found in (_METHOD, _MACH, _DENSITY))
        page = _Page(
            subcase=self._subcase,
            configuration=self._configuration,
            symmetry=self._symmetry,
            method="" if method is None else method[1],
            mach=np.nan if mach is None else float(mach[1]),
            density=np.nan if density is None else read_real(density[1]),
        )
        same = [k for k, one in enumerate(self._analyses) if repr(one.page) == repr(page)]
        # A root repeated after another root belongs to a new analysis.
        if not same or (
            point in self._analyses[same[-1]].seen and self._analyses[same[-1]].last != point
        ):
            self._analyses.append(_FlutterAnalysis(page))
            same.append(len(self._analyses) - 1)
        self._current = same[-1]
        self._analyses[self._current].last = point
        self._analyses[self._current].seen.setdefault(point, set())

    def _row(self, line: str) -> None:
        parts = _VALUE.findall(line)
        if len(parts) < len(_NEEDED) or _VALUE.sub("", line).strip():
            return  # not a row: text, or empty
        if not all("." in part or not part[-1].isdigit() for part in parts):
            return  # whole numbers, of another table
        if len(parts) != len(self._columns):
            raise ValueError(f"{len(self._columns)} numbers are expected, {len(parts)} were found")
        numbers = [np.nan if part.startswith("*") else read_real(part) for part in parts]
        row = dict(zip(self._columns, numbers, strict=True))  # asterisks: wider than the column
        if not all(np.isfinite(row[name]) for name in _NEEDED):
            raise ValueError("velocity, damping or frequency is not a number")
        analysis = self._analyses[self._current]
        place = (row["velocity"], row.get("density", 0.0), row.get("mach", 0.0))
        if place in analysis.seen[analysis.last] and analysis.page.method not in ("K", "KE"):
            point = analysis.last  # the sweep restarts under the same heading
            analysis = _FlutterAnalysis(analysis.page, point, {point: set()})
            self._analyses.append(analysis)
            self._current = len(self._analyses) - 1
        analysis.seen[analysis.last].add(place)
        page = analysis.page
        row.setdefault("mach", page.mach)
        row.setdefault("density", page.density)
        self._rows.append({"analysis": self._current, "point": analysis.last, **row})

    @property
    def is_empty(self) -> bool:
        """Whether no summary was found."""
        return not self._rows

    def fields(self) -> Iterator[Field]:
        """Yield rows in printed order, and the heading of each analysis."""
        if not self._rows:
            return
        for name in (
            *("analysis", "point", "velocity", "damping", "frequency", "real", "imaginary"),
            *("density", "mach"),
        ):
            yield Field(f"flutter/{name}", np.array([row[name] for row in self._rows], dtype=float))
        pages = [analysis.page for analysis in self._analyses]
        yield Field("flutter/subcase", np.array([page.subcase for page in pages]))
        for name in ("configuration", "symmetry", "method"):
            text = np.array([getattr(page, name) for page in pages], dtype=np.str_)
            yield Field(f"flutter/{name}", text)
