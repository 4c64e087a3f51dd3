"""Export of a run with its maneuver, aircraft, covariance and fitted spectra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Flight, Maneuver
from flexsid.records.run import EstimationRun, FitBlock
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.run_results import refuse_altered


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportedLines:
    """Fitted spectra of one block; rows by frequency, columns by output."""

    name: str
    outputs: tuple[str, ...]
    omega: list[float]  # [rad/s]
    measured_real: list[list[float]]
    measured_imag: list[list[float]]
    fitted_real: list[list[float]]
    fitted_imag: list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunExport:
    """A run with its aircraft, flight and maneuver, and the arrays of its result as numbers.

    ``covariance`` is ordered as the parameters; both are None and empty until
    the run has succeeded. ``signature`` is that of the site, written into the file.
    """

    aircraft: Aircraft
    flight: Flight
    maneuver: Maneuver
    run: EstimationRun
    covariance: list[list[float]] | None
    lines: list[ExportedLines]
    signature: str | None = None


def export_run(store: Store, run_id: int) -> RunExport:
    """Export a run with its maneuver, aircraft, covariance and fitted spectra."""
    run = store.runs.get(run_id)
    refuse_altered(run)
    maneuver = store.maneuvers.get(run.maneuver_id)
    result = run.result
    return RunExport(
        aircraft=store.aircraft.get(maneuver.aircraft_id),
        flight=store.flights.get(maneuver.flight_id),
        maneuver=maneuver,
        run=run,
        covariance=None if result is None else store.arrays.get(result.covariance).tolist(),
        lines=[] if result is None else [_export_block(store, block) for block in result.blocks],
    )


def _export_block(store: Store, block: FitBlock) -> ExportedLines:
    arrays = store.arrays.get_many(block.arrays.values())
    measured, fitted = arrays[block.arrays["measured"]], arrays[block.arrays["fitted"]]
    return ExportedLines(
        name=block.name,
        outputs=block.outputs,
        omega=arrays[block.arrays["omega"]].tolist(),
        measured_real=np.real(measured).tolist(),
        measured_imag=np.imag(measured).tolist(),
        fitted_real=np.real(fitted).tolist(),
        fitted_imag=np.imag(fitted).tolist(),
    )
