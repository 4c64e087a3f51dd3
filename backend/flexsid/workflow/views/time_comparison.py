"""One output over time: records of maneuvers with the simulated outputs of runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.views import CheckedTrace, ComparedRecord, SimulatedOutput, TimeComparison
from flexsid.storage.store import Store
from flexsid.workflow.views.time_check import check_in_time

MOST_SIMULATIONS = 12
"""Simulations of one figure, which take less than a second."""


def compare_in_time(
    store: Store,
    run_ids: Sequence[int],
    output: str | None = None,
    maneuver_ids: Sequence[int] = (),
    points: int = 2000,
) -> TimeComparison:
    """Simulate runs under recorded inputs, and compare one output with its record.

    Parameters
    ----------
    store
        The campaign.
    run_ids
        Succeeded runs with a complete model.
    output
        Output of all runs; by default the first of the first run.
    maneuver_ids
        Maneuvers under whose inputs every run is simulated; by default each run under those of
        its own maneuver.
    points
        Points of a curve on the screen.

    Returns
    -------
    TimeComparison
        One record per maneuver, in order of dynamic pressure and fuel, with the fit of every
        run in percent: 100 (1 - ||y - yhat|| / ||y - mean(y)||), y the record without trim.

    Raises
    ------
    BadInput
        Without runs, if a run does not have the output, a maneuver is of another aircraft, or
        more than ``MOST_SIMULATIONS`` are requested.
    """
    runs = {number: store.runs.get(number) for number in dict.fromkeys(run_ids)}
    pairs = [
        (maneuver_id, number)
        for number, run in runs.items()
        for maneuver_id in (dict.fromkeys(maneuver_ids) or (run.maneuver_id,))
    ]
    if not pairs:
        raise BadInput("run_ids names no run; give ids separated by commas", code="no-runs")
    if len(pairs) > MOST_SIMULATIONS:
        raise BadInput(
            f"{len(pairs)} simulations are requested; at most {MOST_SIMULATIONS} are compared in"
            " one figure: give fewer runs or maneuvers",
            code="too-many",
        )
    found: dict[int, list[tuple[int, CheckedTrace]]] = {}
    for maneuver_id, number in pairs:
        names = () if output is None else (output,)
        trace = check_in_time(store, number, names, maneuver_id).traces[0]
        output = trace.name
        found.setdefault(maneuver_id, []).append((number, trace))
    records: list[ComparedRecord] = []
    for maneuver_id, traces in found.items():
        maneuver = store.maneuvers.get(maneuver_id)
        _, first = traces[0]
        records.append(
            ComparedRecord(
                maneuver_id=maneuver_id,
                label=maneuver.label,
                airspeed_m_s=maneuver.condition.airspeed_m_s,
                dynamic_pressure_pa=maneuver.condition.dynamic_pressure_pa,
                fuel_fraction=maneuver.condition.fuel_fraction,
                time_s=first.time_s - first.time_s[0],
                measured=first.measured,
                simulated=tuple(
                    SimulatedOutput(
                        run_id=number,
                        method=runs[number].method,
                        values=trace.simulated,
                        fit_percent=compute_fit_percent(trace.measured, trace.simulated),
                    )
                    for number, trace in traces
                ),
            )
        )
    records.sort(key=lambda one: (one.dynamic_pressure_pa, one.fuel_fraction, one.maneuver_id))
    unit = found[pairs[0][0]][0][1].unit
    return TimeComparison(output=output or "", unit=unit, points=points, records=tuple(records))


def compute_fit_percent(measured: np.ndarray, simulated: np.ndarray) -> float | None:
    """Return the fit as of MATLAB's ``compare``: normalised rms error from 100, in percent.

    Parameters
    ----------
    measured, simulated
        Samples, (N,).

    Returns
    -------
    float or None
        100 for a perfect model, 0 for the mean of the record, negative for worse; None for a
        constant record.
    """
    spread = float(np.linalg.norm(measured - np.mean(measured)))
    if not spread > 0.0:
        return None
    return 100.0 * (1.0 - float(np.linalg.norm(measured - simulated)) / spread)
