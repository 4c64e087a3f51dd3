"""Channels, or the regressors of equation error, against each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.records.views import PlotMatrix
from flexsid.storage.store import Store
from flexsid.sysid.estimation.equation_error import regressors
from flexsid.sysid.model.derivatives import variables
from flexsid.sysid.spectra.collinearity import collinearity
from flexsid.workflow.measurements.excitation_interval import excitation_interval
from flexsid.workflow.measurements.recording import maneuver_lines
from flexsid.workflow.measurements.transforms import spectra_of
from flexsid.workflow.runs.computation import motion_of
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.views.channels import input_names, on_one_clock, read_channels, sampling

Domain = Literal["time", "frequency"]


def plot_matrix(
    store: Store,
    maneuver_id: int,
    channels: Sequence[str] = (),
    domain: Domain = "time",
    modes: Sequence[int] = (),
) -> PlotMatrix:
    """Read channels against each other while the excitation ran; the inputs by default.

    Trim before and after would only add points at rest, which hide correlation. With
    ``modes`` the columns are the regressors of equation error with these modes, which
    exist at the lines only.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    if modes:
        return _of_regressors(store, maneuver, tuple(dict.fromkeys(modes)))
    chosen = tuple(dict.fromkeys(channels)) or input_names(store, maneuver)
    if domain == "frequency":
        return _of_spectra(store, maneuver, chosen)
    excitation = maneuver.excitation
    interval = None if excitation is None else excitation_interval(excitation)
    traces = read_channels(store, maneuver, chosen, interval)
    together = on_one_clock(traces) if traces else ()
    samples = (
        np.stack([trace.values for trace in together], axis=1) if together else np.zeros((0, 0))
    )
    names = tuple(trace.name for trace in together)
    return _judged(maneuver, names, tuple(trace.unit for trace in together), samples)


def _of_spectra(store: Store, maneuver: Maneuver, names: tuple[str, ...]) -> PlotMatrix:
    if maneuver.excitation is None:
        raise BadInput(
            "the excitation of this maneuver is not known, so its lines are not; compare the "
            "channels in the time domain",
            code="no-excitation",
        )
    rates = sampling(store, maneuver, names)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    below_hz = 0.4 * min(rate_hz for rate_hz, _ in rates.values())
    lines = maneuver_lines(maneuver, (0.0, below_hz))
    spectra = spectra_of(store, maneuver, aircraft, names, lines).values
    return _judged(maneuver, names, tuple(f"{rates[name][1]} s" for name in names), spectra)


def _of_regressors(store: Store, maneuver: Maneuver, modes: tuple[int, ...]) -> PlotMatrix:
    """Regressors from the motion that the sensors give, companion modes taken out."""
    assert maneuver.id is not None
    request = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.EE,
        structure=Structure(modes=modes, fixed={}),
        settings=RunSettings(),
    )
    data = prepare(store, request).maneuvers[0]
    columns = regressors(data.model, motion_of(data)[0], data.measured.inputs)
    names = variables(modes, data.model.inputs)
    return _judged(maneuver, names, tuple("s" for _ in names), columns)


def _judged(
    maneuver: Maneuver, names: tuple[str, ...], units: tuple[str, ...], columns: np.ndarray
) -> PlotMatrix:
    assert maneuver.id is not None
    found = collinearity(columns, remove_mean=not np.iscomplexobj(columns))
    return PlotMatrix(
        maneuver_id=maneuver.id,
        names=names,
        units=units,
        samples=columns,
        correlation=found.correlation,
        inflation=found.inflation,
        condition=found.condition,
    )
