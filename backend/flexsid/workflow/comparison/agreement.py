"""Agreement of estimates: about their mean, pairwise, and differences in setup."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from enum import Enum
from itertools import combinations
from math import hypot
from typing import Any

import numpy as np
from scipy import stats

from flexsid.records.comparison import AgreementCount, ComparedSource, Pair, Row, Setup, SourceValue
from flexsid.records.run import EstimationRun
from flexsid.sysid.estimation.trend import fit_trend

CONSISTENT_SIGMA = 2.0
"""Two estimates agree when they differ by at most this many combined standard errors."""


def is_consistent(difference_sigma: float | None) -> bool | None:
    """Return whether a difference in combined standard errors is agreement; None if unknown."""
    return None if difference_sigma is None else difference_sigma <= CONSISTENT_SIGMA


def find_largest_difference(
    couples: Iterable[tuple[SourceValue | None, SourceValue | None]],
) -> float | None:
    """Find the largest difference of any couple in combined standard errors; None without."""
    differences = (normalise_difference(a, b) for a, b in couples)
    return max((abs(one) for one in differences if one is not None), default=None)


def count_run_agreement(rows: Sequence[Row]) -> AgreementCount:
    """Count the derivatives on which all runs agree."""
    return _count(None, [row.consistent for row in rows])


def count_prediction_agreement(
    sources: Sequence[ComparedSource], rows: Sequence[Row]
) -> tuple[AgreementCount, ...]:
    """Count, for every prediction, the derivatives in which it agrees with all runs."""
    values = {
        source.key: [row.values[place] for row in rows]
        for place, source in enumerate(sources)
        if source.is_prediction
    }
    return tuple(
        _count(key, [None if value is None else value.consistent for value in column])
        for key, column in values.items()
    )


def _count(source: str | None, agreements: Sequence[bool | None]) -> AgreementCount:
    judged = [one for one in agreements if one is not None]
    return AgreementCount(source=source, n_judged=len(judged), n_consistent=sum(judged))


def average_estimates(values: Sequence[SourceValue | None]) -> dict[str, float | None]:
    """Compute the weighted mean of estimates and the chi-square of their scatter."""
    judged = [(v.value, v.std_error) for v in values if v is not None and v.std_error]
    if len(judged) < 2:
        return {}
    found, errors = (np.array(part, dtype=float) for part in zip(*judged, strict=True))
    mean = fit_trend(np.zeros(found.size), found, errors, 0)
    return {
        "mean": float(mean.coefficients[0]),
        "mean_std_error": float(np.sqrt(mean.covariance[0, 0])),
        "chi_square": mean.chi_square,
        "probability": mean.probability,
    }


def compare_pairs(sources: Sequence[ComparedSource], rows: Sequence[Row]) -> tuple[Pair, ...]:
    """Compare every pair of sources by all derivatives with standard errors.

    Notes
    -----
    Normalised differences are taken as independent of each other. Estimates of one
    run are correlated, so the probability is a guide, not a test.
    """
    found: list[Pair] = []
    for (i, first), (j, second) in combinations(enumerate(sources), 2):
        differences = {
            row.name: difference
            for row in rows
            if (difference := normalise_difference(row.values[i], row.values[j])) is not None
        }
        if not differences:
            continue
        squares = float(sum(value**2 for value in differences.values()))
        worst = max(differences, key=lambda name: abs(differences[name]))
        found.append(
            Pair(
                first=first.key,
                second=second.key,
                n=len(differences),
                rms_sigma=float(np.sqrt(squares / len(differences))),
                chi_square=squares,
                probability=float(stats.chi2.sf(squares, len(differences))),
                worst=worst,
                worst_sigma=differences[worst],
            )
        )
    return tuple(found)


def normalise_difference(a: SourceValue | None, b: SourceValue | None) -> float | None:
    """Divide a difference by its standard error, assuming independence."""
    if a is None or b is None or a.std_error is None or b.std_error is None:
        return None
    error = hypot(a.std_error, b.std_error)
    return (a.value - b.value) / error if error > 0 else None


def compare_setups(
    sources: Sequence[ComparedSource], runs: Mapping[int, EstimationRun]
) -> tuple[Setup, ...]:
    """List the settings in which the compared runs differ."""
    columns = [
        None
        if source.run_id is None or source.is_prediction
        else _list_settings(runs[source.run_id])
        for source in sources
    ]
    names = dict.fromkeys(name for column in columns if column is not None for name in column)
    rows: list[Setup] = []
    for name in names:
        values = tuple(None if column is None else column.get(name, "") for column in columns)
        if len({value for value in values if value is not None}) > 1:
            rows.append(Setup(name=name, values=values))
    return tuple(rows)


def _list_settings(run: EstimationRun) -> dict[str, str]:
    fields: dict[str, Any] = {
        "maneuver": run.maneuver_id,
        "method": run.method,
        **asdict(run.structure),
        **asdict(run.settings),
        "modal_table": run.modal_table_id,
        "damping_table": run.damping_table_id,
        "prediction": run.prediction_id,
        **{f"version of {name}": version for name, version in (run.versions or {}).items()},
    }
    return {name.replace("_", " "): _format(value) for name, value in fields.items()}


def _format(value: object) -> str:
    if value is None or value in ((), [], {}):
        return "–"
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, dict):
        return ", ".join(f"{name} {_format(one)}" for name, one in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(_format, value))
    return f"{value:.6g}" if isinstance(value, float) else str(value)
