"""Plot matrix of channels or equation-error regressors, with collinearity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.model_structure import Structure
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.records.views import PlotMatrix
from flexsid.storage.store import Store
from flexsid.sysid.estimation.equation_error import build_regressors
from flexsid.sysid.spectra.collinearity import assess_collinearity
from flexsid.workflow.aircraft.axes import find_body, list_moved_surfaces
from flexsid.workflow.fits.equation_error_fit import reconstruct_with_out_of_band_modes
from flexsid.workflow.measurements.maneuver_spectra import read_spectra
from flexsid.workflow.measurements.recording import select_frequencies
from flexsid.workflow.runs.default_band import set_default_band
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.views.channels import (
    find_sampling,
    list_input_names,
    read_traces,
    resample_to_slowest,
)
from flexsid.workflow.views.maneuver import CLEAR_OF_NYQUIST

Domain = Literal["time", "frequency"]


def compute_plot_matrix(
    store: Store,
    maneuver_id: int,
    channels: Sequence[str] = (),
    domain: Domain = "time",
    modes: Sequence[int] = (),
) -> PlotMatrix:
    """Read channels during the excitation and compute collinearity; inputs by default.

    Left and right surfaces that only move together, or against each other, are one input.
    Trim before and after would add points at rest, which hide correlation. With ``modes`` the
    columns are the equation-error regressors with these modes, at harmonics only.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    if modes:
        return _read_regressors(store, maneuver, tuple(dict.fromkeys(modes)))
    selected = tuple(dict.fromkeys(channels)) or list_moved_surfaces(
        store.aircraft.get(maneuver.aircraft_id),
        maneuver.axis,
        maneuver.excitation,
        list_input_names(store, maneuver),
    )
    if domain == "frequency":
        return _read_spectra(store, maneuver, selected)
    excitation = maneuver.excitation
    interval = None if excitation is None else excitation.interval_s
    traces = read_traces(store, maneuver, selected, interval)
    together = resample_to_slowest(traces) if traces else ()
    samples = (
        np.stack([trace.values for trace in together], axis=1) if together else np.zeros((0, 0))
    )
    names = tuple(trace.name for trace in together)
    return _build_matrix(maneuver, names, tuple(trace.unit for trace in together), samples)


def _read_spectra(store: Store, maneuver: Maneuver, names: tuple[str, ...]) -> PlotMatrix:
    if maneuver.excitation is None:
        raise BadInput(
            "the excitation of this maneuver is unknown, and with it its harmonics; compare "
            "channels in the time domain",
            code="no-excitation",
        )
    rates = find_sampling(store, maneuver, names)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    below_hz = CLEAR_OF_NYQUIST * min(rate_hz for rate_hz, _ in rates.values())
    frequencies = select_frequencies(maneuver, (0.0, below_hz))
    spectra = read_spectra(store, maneuver, aircraft, names, frequencies).values
    return _build_matrix(maneuver, names, tuple(f"{rates[name][1]} s" for name in names), spectra)


def _read_regressors(store: Store, maneuver: Maneuver, modes: tuple[int, ...]) -> PlotMatrix:
    """Compute regressors from reconstructed motion, without out-of-band modes."""
    assert maneuver.id is not None
    request = EstimationRun(
        maneuver_id=maneuver.id,
        method=Method.EE,
        structure=Structure(modes=modes, fixed={}, axis=find_body(maneuver.axis).axis),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
    )
    data = prepare(store, set_default_band(store, request)).maneuvers[0]
    columns = build_regressors(
        data.model, reconstruct_with_out_of_band_modes(data)[0], data.measured.inputs
    )
    names = data.model.variables
    return _build_matrix(maneuver, names, tuple("s" for _ in names), columns)


def _build_matrix(
    maneuver: Maneuver, names: tuple[str, ...], units: tuple[str, ...], columns: np.ndarray
) -> PlotMatrix:
    assert maneuver.id is not None
    found = assess_collinearity(columns, remove_mean=not np.iscomplexobj(columns))
    return PlotMatrix(
        maneuver_id=maneuver.id,
        names=names,
        units=units,
        samples=columns,
        correlation=found.correlation,
        inflation=found.inflation,
        condition=found.condition,
    )
