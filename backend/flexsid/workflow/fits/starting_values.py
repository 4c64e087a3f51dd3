"""Starting values of the iterative fits: equation error, and delays from the sensors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput, NotIdentifiable
from flexsid.records.run import Progress, ReportProgress
from flexsid.sysid.estimation.delays import estimate_delays
from flexsid.sysid.estimation.limits import LONGEST_DELAY_S
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.workflow.fits.equation_error_fit import estimate_starting_values
from flexsid.workflow.fits.estimation_task import (
    EstimationTask,
    get_first_start,
    select_free_parameters,
)
from flexsid.workflow.fits.out_of_band_modes import regularise_start

EQUATION_ERROR = "equation error"


def collect_starting_points(task: EstimationTask, report: ReportProgress) -> dict[str, Parameters]:
    """Collect the start parameters by name.

    Raises
    ------
    BadInput
        If there are none.
    """
    tables = dict(task.starts)
    if task.try_equation_error:
        report(Progress(message="Estimating starting values by equation error"))
        parameters = select_free_parameters(task, get_first_start(task), ())
        try:
            values = estimate_starting_values(task, parameters)
            name, table = _regularise_start(task, parameters, values)
            tables = {name: table, **tables}
        except NotIdentifiable:
            if not tables:
                raise
    if not tables:
        raise BadInput(
            "no starting values: the aircraft has no prediction for these derivatives; import "
            "one, or start from equation error or another run",
            code="no-start",
        )
    candidates = {
        name: select_free_parameters(task, table, task.extras) for name, table in tables.items()
    }
    delayed = [k for k, e in enumerate(next(iter(candidates.values())).extras) if e.kind == "delay"]
    if delayed:
        report(Progress(message="Estimating delays from the redundancy of the sensors"))
        candidates = _insert_start_delays(task, candidates, delayed)
    return candidates


def _regularise_start(
    task: EstimationTask, parameters: Parameters, values: np.ndarray
) -> tuple[str, DerivativeTable]:
    """Return name and table of the start by equation error, out-of-band modes regularised."""
    if not task.out_of_band:
        return EQUATION_ERROR, parameters.table(values)
    names = ", ".join(task.mode_names[k] for k in task.out_of_band)
    source = "in vacuo" if task.predicted is None else "predicted"
    table = regularise_start(parameters, values, task.out_of_band, task.predicted)
    return f"{EQUATION_ERROR}, {names} as {source}", table


def _insert_start_delays(
    task: EstimationTask, candidates: dict[str, Parameters], delayed: list[int]
) -> dict[str, Parameters]:
    """Start the free delays at values estimated from the redundancy of the sensors."""
    first = task.maneuvers[0]
    spectra = first.measured
    unknown = {f"{name}, delays from zero": one for name, one in candidates.items()}
    try:
        delays = estimate_delays(first.model, spectra.inputs, spectra.outputs, spectra.instruments)
    except NotIdentifiable:
        return unknown
    if np.max(np.abs(delays)) > LONGEST_DELAY_S:
        return unknown  # too few sensors to resolve delays from motion
    result = {}
    for name, parameters in candidates.items():
        start = parameters.start.copy()
        for k in delayed:
            start[parameters.rows.size + k] = delays[parameters.extras[k].output]
        result[name] = replace(parameters, start=start)
    return result
