"""Comparison: derivatives of several runs and predictions side by side (Fig. 17)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """One column of a comparison; ``kind`` is OE, FRE, EE or prediction."""

    key: str
    label: str
    kind: str
    run_id: int | None = None
    prediction_id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceValue:
    """What one source says about a derivative; ``std_error`` is None where it gives none."""

    key: str
    value: float
    std_error: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One derivative; ``values`` follow the order of the sources, None where one has no say.

    ``max_difference_sigma`` is the largest |a - b| / sqrt(sigma_a^2 + sigma_b^2) over
    pairs of sources with a standard error; ``consistent`` says that it is at most 2.
    """

    name: str
    label: str
    values: tuple[SourceValue | None, ...]
    consistent: bool | None = None
    max_difference_sigma: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Rows per derivative, columns per source."""

    maneuver_ids: tuple[int, ...]
    sources: tuple[Source, ...]
    rows: tuple[Row, ...]
