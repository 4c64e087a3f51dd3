"""What a maneuver looked like: its channels in time, against each other, and by frequency."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.views import ChannelHistories, PlotMatrix, Spectra
from flexsid.storage.store import Store
from flexsid.workflow.interval import excitation_interval
from flexsid.workflow.transforms import Lines, maneuver_lines, spectra_of
from flexsid.workflow.views.channels import input_names, on_one_clock, read_channels, sampling

POINTS = 1000  # about as many as a screen has columns
_MOST_POINTS = 20_000
_FIRST_LINE = 2.0  # cycles per record below which a line is mostly drift
_CLEAR_OF_NYQUIST = 0.4  # of the sampling rate, clear of the anti-alias filter's skirt


def time_history(
    store: Store,
    maneuver_id: int,
    channels: Sequence[str] = (),
    start_s: float | None = None,
    stop_s: float | None = None,
    points: int = POINTS,
) -> ChannelHistories:
    """Read channels over a window; the inputs over the whole record by default."""
    if not 10 <= points <= _MOST_POINTS:
        raise BadInput(
            f"{points} points per channel cannot be drawn; choose 10 to {_MOST_POINTS}",
            code="bad-points",
        )
    maneuver = store.maneuvers.get(maneuver_id)
    window = (
        -np.inf if start_s is None else start_s,
        np.inf if stop_s is None else stop_s,
    )
    if not window[0] < window[1]:
        raise BadInput(
            f"the window from {start_s} to {stop_s} s is empty; the start must come first",
            code="bad-window",
        )
    chosen = channels or input_names(store, maneuver)
    excitation = maneuver.excitation
    return ChannelHistories(
        maneuver_id=maneuver_id,
        traces=read_channels(store, maneuver, chosen, window),
        excitation_s=None if excitation is None else excitation_interval(excitation),
        points=points,
    )


def plot_matrix(store: Store, maneuver_id: int, channels: Sequence[str] = ()) -> PlotMatrix:
    """Read channels against each other while the excitation ran; the inputs by default.

    Trim before and after would only add points at rest, which hide correlation.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    chosen = channels or input_names(store, maneuver)
    excitation = maneuver.excitation
    interval = None if excitation is None else excitation_interval(excitation)
    traces = read_channels(store, maneuver, chosen, interval)
    together = on_one_clock(traces) if traces else ()
    samples = (
        np.stack([trace.values for trace in together], axis=1) if together else np.zeros((0, 0))
    )
    return PlotMatrix(
        maneuver_id=maneuver_id,
        names=tuple(trace.name for trace in together),
        units=tuple(trace.unit for trace in together),
        samples=samples,
        correlation=correlation(samples),
    )


def correlation(samples: np.ndarray) -> np.ndarray:
    """Pairwise correlation coefficients of columns; NaN for a column that never moves."""
    moved = samples - samples.mean(axis=0) if samples.size else samples
    product = moved.T @ moved
    scale = np.sqrt(np.outer(np.diag(product), np.diag(product)))
    return np.divide(product, scale, out=np.full(product.shape, np.nan), where=scale > 0)


def spectrum(store: Store, maneuver_id: int, channels: Sequence[str] = ()) -> Spectra:
    """Transform channels at the maneuver's lines; the inputs by default.

    A slow channel says nothing above its Nyquist frequency and has no number there.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    inputs = input_names(store, maneuver)
    rates = sampling(store, maneuver, channels or inputs)
    lines = _lines(maneuver, min((rate_hz for rate_hz, _ in rates.values()), default=0.0))
    magnitude = np.full((lines.omega.size, len(rates)), np.nan)
    for column, (name, (rate_hz, _)) in enumerate(rates.items()):
        seen = lines.omega <= np.pi * rate_hz
        below = Lines(lines.omega[seen], lines.owner[seen], lines.inputs)
        data = spectra_of(store, maneuver, aircraft, (name,), below)
        magnitude[seen, column] = np.abs(data.values[:, 0])
    return Spectra(
        maneuver_id=maneuver_id,
        inputs=inputs,
        frequency_hz=lines.omega / (2.0 * np.pi),
        owners=tuple(lines.inputs[owner] if owner >= 0 else "" for owner in lines.owner),
        names=tuple(rates),
        units=tuple(unit for _, unit in rates.values()),
        magnitude=magnitude,
    )


def _lines(maneuver: Maneuver, rate_hz: float) -> Lines:
    """The excited lines; without known excitation those that the record length gives."""
    if maneuver.excitation is not None:
        return maneuver_lines(maneuver)
    return maneuver_lines(
        maneuver, (_FIRST_LINE / maneuver.duration_s, _CLEAR_OF_NYQUIST * rate_hz)
    )
