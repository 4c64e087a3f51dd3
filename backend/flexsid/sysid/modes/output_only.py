"""Modes of a structure from outputs alone, excited by turbulence or ground, with their errors."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float
from scipy.special import chdtri

from flexsid.errors import BadInput
from flexsid.sysid.modes.modal_model import propagate_covariance
from flexsid.sysid.modes.output_spectrum import (
    OutputBand,
    SpectrumFit,
    average_band,
    compute_cost,
    compute_spectrum,
    compute_strengths,
    fit_spectrum,
    is_structural,
    propose_mode,
    remove_mode,
    start_model,
)

# --- Tones ----------------------------------------------------------------------------------------

_FALSE_TONE = 1e-6  # probability that chance in one record is a tone
_TONE_REACH = 3  # frequencies on each side that a tone changes
_TONE_WINDOW = 24  # frequencies on each side, of the level about it
_TONE_SEGMENTS = 8
_TONE_SCATTER = 0.25  # variance of the power over segments, of its mean squared; 1 for noise
_TONE_ORDER = 2  # of the polynomial that is the amplitude of a tone over the record
_MOST_TONES = 50

# --- Start values ---------------------------------------------------------------------------------

_BAND_RATIO = 1.6
_BAND_OVERLAP = 1.3
_MOST_COMPONENTS = 8
_BLOCK_ROWS = 16
_MOST_ORDER = 24
_SAME_FREQUENCY, _SAME_DAMPING, _SAME_SHAPE = 0.01, 0.3, 0.9
_LEAST_ORDERS = 0.35

# --- Bands ----------------------------------------------------------------------------------------

_REACH = 10.0  # decay rates on each side of a pole that the fitted band has
_LEAST_REACH = 40  # frequencies, at least
_CLOSE = 5.0  # decay rates: modes nearer to each other are fitted together
_GAP_RATIO = 1.2
_MOST_TOGETHER = 4
_FALSE_MODE = 1e-4
_SURE = 0.15  # relative standard deviation of a damping ratio below which a mode is certain
_LARGEST_SPREAD = 0.5  # relative: largest standard deviation of a damping ratio
_LEAST_WIDTH = 6.0  # decay rates: a band resolves no mode that is wider
_NEAR = 2.0  # decay rates on each side of a pole
_MOST_TAKEN = 0.5
_LEAST_POWER = 1e-6  # of the largest output
_HIGHEST = 0.95  # of the Nyquist frequency
_SCANNED = (0.005, 0.015, 0.04)
LEAST_CYCLES = 20.0  # of the lowest frequency in the record


@dataclass(frozen=True, slots=True, eq=False)
class OutputOnlyModes:
    """Modes identified from outputs.

    ``omega`` are natural frequencies [rad/s], ``damping`` damping ratios [1], ``std_omega`` and
    ``std_damping`` their standard deviations, ``shapes`` (n_modes, n_outputs) of largest component
    one, in the units of the outputs. ``tones`` are frequencies of steady tones, which are left out
    [rad/s]. ``measured`` and ``fitted`` are means over the outputs of the spectral density,
    relative to the variance of each [s], at ``frequencies`` [rad/s].
    """

    omega: Float[np.ndarray, " n_modes"]
    damping: Float[np.ndarray, " n_modes"]
    std_omega: Float[np.ndarray, " n_modes"]
    std_damping: Float[np.ndarray, " n_modes"]
    shapes: Complex[np.ndarray, "n_modes n_outputs"]
    tones: Float[np.ndarray, " n_tones"]
    frequencies: Float[np.ndarray, " n_bins"]
    measured: Float[np.ndarray, " n_bins"]
    fitted: Float[np.ndarray, " n_bins"]


@dataclass(frozen=True, slots=True, eq=False)
class _BandModes:
    """Modes of one band, per sample, and its densities."""

    poles: np.ndarray
    covariance: np.ndarray
    shapes: np.ndarray
    theta: np.ndarray
    measured: np.ndarray
    fitted: np.ndarray


def identify_output_only(
    outputs: Float[np.ndarray, "n_samples n_outputs"], dt: float, band: tuple[float, float]
) -> OutputOnlyModes:
    """Identify modes from outputs that unmeasured broadband forces excite, as turbulence does.

    Parameters
    ----------
    outputs
        Accelerations, rates or strains of one record, evenly sampled; any units.
    dt
        Sample interval. [s]
    band
        Limits of the natural frequencies. [rad/s]

    Returns
    -------
    OutputOnlyModes
        Modes in order of frequency.

    Raises
    ------
    BadInput
        If the record is too short for the band, no output moves, or there is no mode.

    Notes
    -----
    Start values are the poles that a covariance-driven subspace method finds stable over model
    orders (Peeters and De Roeck 1999, doi:10.1006/mssp.1999.1249), in bands of the spectrum. Modes
    that are close are fitted together by maximum likelihood, see ``fit_spectrum``, to the principal
    components of the outputs in their band, one more than modes. A mode is added where the
    periodograms exceed the model, and removed by the likelihood ratio with ``_FALSE_MODE`` or where
    its damping ratio is not determined. Covariances are those of the information, divided by the
    fraction of the degrees of freedom near the poles that the parameters leave.
    """
    n = outputs.shape[0]
    low, high = band[0] * dt, min(band[1] * dt, _HIGHEST * np.pi)
    if low * n < 2.0 * np.pi * LEAST_CYCLES or not low < high:
        raise BadInput(
            f"a record of {n * dt:.0f} s has fewer than {LEAST_CYCLES:g} cycles of "
            f"{band[0] / (2.0 * np.pi):.3g} Hz, or the band is empty; use a longer record or a "
            "higher band",
            code="record-too-short",
        )
    centred = outputs - np.mean(outputs, axis=0)
    size = np.std(centred, axis=0)
    moves = size > 0
    if not moves.any():
        raise BadInput("no output moves in this record; select other outputs", code="no-motion")
    transform, tones, is_tone = remove_tones(centred[:, moves] / size[moves], (low, high))
    theta = 2.0 * np.pi * np.arange(transform.shape[0]) / n
    poles, shapes = find_starts(transform, theta, (low, high))
    found = []
    for group, (first, last) in divide_into_bands(poles, (low, high), n):
        used = (theta >= first) & (theta <= last) & ~is_tone
        if np.count_nonzero(used) >= _LEAST_REACH:
            found.append(_fit_band(theta[used], transform[used], n, poles[group], shapes[group]))
    return _join_bands(found, tones, dt, size)


def _join_bands(
    found: list[_BandModes], tones: np.ndarray, dt: float, size: np.ndarray
) -> OutputOnlyModes:
    poles = np.concatenate([one.poles for one in found]) / dt
    if not poles.size:
        raise BadInput(
            "the outputs do not differ from noise by any mode in this band; use a longer record "
            "or a wider band",
            code="no-modes",
        )
    spread = [propagate_covariance(one.poles / dt, one.covariance / dt**2) for one in found]
    std_omega, std_damping = (np.concatenate(parts) for parts in zip(*spread, strict=True))
    shapes = np.zeros((poles.size, size.size), dtype=complex)
    shapes[:, size > 0] = np.concatenate([one.shapes for one in found]) * size[size > 0]
    largest = np.argmax(np.abs(shapes), axis=1)
    shapes /= shapes[np.arange(poles.size), largest][:, None]
    order = np.argsort(np.abs(poles))
    return OutputOnlyModes(
        omega=np.abs(poles)[order],
        damping=(-np.real(poles) / np.abs(poles))[order],
        std_omega=std_omega[order],
        std_damping=std_damping[order],
        shapes=shapes[order],
        tones=tones / dt,
        frequencies=np.concatenate([one.theta for one in found]) / dt,
        measured=2.0 * dt * np.concatenate([one.measured for one in found]),
        fitted=2.0 * dt * np.concatenate([one.fitted for one in found]),
    )


def remove_tones(
    outputs: Float[np.ndarray, "n_samples n_outputs"], band: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Transform of the record without tones, their frequencies, and where they were.

    Notes
    -----
    A tone stands out of the periodogram of a Hann window in few frequencies, and its amplitude is
    the same in all parts of the record, that of a mode in turbulence is not: the variance of its
    power is 0 and 1 of the mean squared (kurtosis 1.5 and 3 of the samples: Jacobsen, Andersen
    and Brincker 2007). It is subtracted with an amplitude that varies as a parabola.
    """
    n, _n_out = outputs.shape
    window = 1.0 - np.cos(2.0 * np.pi * np.arange(n) / n)
    time = np.arange(n)
    rest = outputs.copy()
    found: list[float] = []
    refused: list[int] = []
    level = None
    while len(found) < _MOST_TONES:
        power = np.abs(np.fft.rfft(rest * window[:, None], axis=0)) ** 2
        theta = 2.0 * np.pi * np.arange(power.shape[0]) / n
        level = _smooth_level(power) if level is None else level
        ratio = np.mean(power / np.maximum(level, 1e-300), axis=1)
        ratio[(theta < band[0]) | (theta > band[1])] = 0.0
        for line in [*refused, *(round(one * n / (2 * np.pi)) for one in found)]:
            ratio[max(0, line - _TONE_REACH) : line + _TONE_REACH + 1] = 0.0
        line = int(np.argmax(ratio))
        # Outputs that move together have no more freedom than one: the exponential distribution.
        if ratio[line] < -np.log(_FALSE_TONE / power.shape[0]):
            break
        frequency = _refine_tone(rest, window, line)
        carrier = np.exp(-1j * frequency * time)
        if not _is_steady(rest, carrier, power[line], level[line]):
            refused.append(line)
            if len(refused) > _MOST_TONES:
                break
            continue
        found.append(frequency)
        x = np.linspace(-1.0, 1.0, n)
        basis = np.concatenate(
            [
                np.stack([np.real(carrier), np.imag(carrier)], axis=1) * x[:, None] ** power_of
                for power_of in range(_TONE_ORDER + 1)
            ],
            axis=1,
        )
        rest -= basis @ np.linalg.lstsq(basis, rest, rcond=None)[0]
    transform = np.fft.rfft(rest, axis=0) / np.sqrt(n)
    is_tone = np.zeros(transform.shape[0], dtype=bool)
    for one in found:
        line = round(one * n / (2.0 * np.pi))
        is_tone[max(0, line - _TONE_REACH) : line + _TONE_REACH + 1] = True
    return transform, np.sort(np.array(found)), is_tone


def _smooth_level(power: np.ndarray) -> np.ndarray:
    """Median over frequencies about each, as mean of an exponential distribution."""
    padded = np.pad(power, ((_TONE_WINDOW, _TONE_WINDOW), (0, 0)), mode="reflect")
    views = np.lib.stride_tricks.sliding_window_view(padded, 2 * _TONE_WINDOW + 1, axis=0)
    return np.median(views, axis=-1) / np.log(2.0)


def _refine_tone(rest: np.ndarray, window: np.ndarray, line: int) -> float:
    """Frequency of the peak of the Hann spectrum by the ratio of its neighbours."""
    n = rest.shape[0]
    grid = 2.0 * np.pi * (line + np.linspace(-1.0, 1.0, 41)) / n
    kernel = np.exp(-1j * np.outer(grid, np.arange(n))) * window
    power = np.sum(np.abs(kernel @ rest) ** 2, axis=1)
    best = int(np.argmax(power))
    return float(grid[best])


def _is_steady(rest: np.ndarray, carrier: np.ndarray, power: np.ndarray, level: np.ndarray) -> bool:
    best = np.argsort(power / np.maximum(level, 1e-300))[-5:]
    length = rest.shape[0] // _TONE_SEGMENTS
    short = 1.0 - np.cos(2.0 * np.pi * np.arange(length) / length)
    used = rest[: length * _TONE_SEGMENTS, best] * carrier[: length * _TONE_SEGMENTS, None]
    parts = used.reshape(_TONE_SEGMENTS, length, -1)
    amplitude = np.einsum("t,stc->sc", short, parts)
    # One amplitude of all outputs: that of the first principal component.
    first = np.abs(np.linalg.svd(amplitude, full_matrices=False)[0][:, 0]) ** 2
    return bool(np.var(first) < _TONE_SCATTER * np.mean(first) ** 2)


def find_starts(
    transform: np.ndarray, theta: np.ndarray, band: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Poles per sample and shapes that a subspace method finds stable over model orders."""
    poles, shapes = [], []
    n_bands = max(1, int(np.ceil(np.log(band[1] / band[0]) / np.log(_BAND_RATIO))))
    edges = np.geomspace(band[0], band[1], n_bands + 1)
    for low, high in itertools.pairwise(edges):
        wide = (theta >= low / _BAND_OVERLAP) & (theta <= high * _BAND_OVERLAP) & (theta > 0)
        if np.count_nonzero(wide) < 4 * _BLOCK_ROWS:
            continue
        found, own = _find_stable(theta[wide], transform[wide])
        place = np.imag(found)
        keep = (place >= low) & (place < high)
        poles.append(found[keep])
        shapes.append(own[keep])
    if not poles:
        return np.zeros(0, complex), np.zeros((0, transform.shape[1]), complex)
    joined, joined_shapes = np.concatenate(poles), np.concatenate(shapes)
    order = np.argsort(np.imag(joined))
    return joined[order], joined_shapes[order]


def _find_stable(theta: np.ndarray, Y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Covariance-driven subspace identification of a band about its centre, over orders."""
    mean = np.real(np.median(np.abs(Y) ** 2, axis=0))
    scale = np.sqrt(np.maximum(mean, 1e-12 * mean.max()))
    Z = Y / scale
    V = _find_components(Z, _MOST_COMPONENTS)
    X = Z @ V
    K, r = X.shape
    step = (theta[-1] - theta[0]) / (K - 1) * K  # rad per sample of the whole band
    i = min(_BLOCK_ROWS, K // 8)
    lagged = np.fft.ifft(X[:, :, None] * X[:, None].conj(), axis=0)[1 : 2 * i]
    H = np.concatenate(
        [np.concatenate([lagged[a + b] for b in range(i)], axis=1) for a in range(i)], axis=0
    )
    squares, U = np.linalg.eigh(H @ H.conj().T)
    U, s = U[:, ::-1], np.sqrt(np.maximum(squares[::-1], 0.0))
    most = min(_MOST_ORDER, r * (i - 1))
    columns: list[list[tuple[complex, np.ndarray, int]]] = []
    before: list[tuple[complex, np.ndarray]] = []
    orders = range(2, most + 1)
    for order in orders:
        observability = U[:, :order] * np.sqrt(s[:order])
        A = np.linalg.lstsq(observability[:-r], observability[r:], rcond=None)[0]
        q, vectors = np.linalg.eig(A)
        angle = np.angle(q) % (2.0 * np.pi)
        poles = np.log(np.abs(q)) * step / (2.0 * np.pi) + 1j * (
            theta[0] + angle * step / (2.0 * np.pi)
        )
        seen = observability[:r] @ vectors
        now = [
            (complex(p), v)
            for p, v in zip(poles, seen.T, strict=True)
            if p.real < 0 and -p.real < 0.3 * abs(p)
        ]
        for p, v in now:
            if any(_is_same(p, v, *old) for old in before):
                for column in columns:
                    if _is_same(p, v, column[-1][0], column[-1][1]) and column[-1][2] < order:
                        column.append((p, v, order))
                        break
                else:
                    columns.append([(p, v, order)])
        before = now
    found, shapes = [], []
    for column in columns:
        if len(column) < _LEAST_ORDERS * len(orders):
            continue
        damping = [-p.real / abs(p) for p, _, _ in column]
        p, v, _ = column[int(np.argsort(damping)[len(damping) // 2])]
        found.append(p)
        shapes.append((v @ V.conj().T) * scale)
    return np.array(found, complex), np.array(shapes, complex).reshape(-1, Y.shape[1])


def _find_components(values: np.ndarray, most: int) -> np.ndarray:
    """Principal directions (n_outputs, n) of transforms, largest first."""
    return np.linalg.eigh(values.conj().T @ values)[1][:, ::-1][:, :most]


def _is_same(p: complex, v: np.ndarray, other: complex, w: np.ndarray) -> bool:
    near = abs(abs(p) - abs(other)) < _SAME_FREQUENCY * abs(p)
    alike = abs(p.real - other.real) < _SAME_DAMPING * abs(other.real)
    if not (near and alike):
        return False
    return float(abs(np.vdot(v, w)) ** 2) > _SAME_SHAPE * float(
        np.sum(np.abs(v) ** 2) * np.sum(np.abs(w) ** 2)
    )


def _divide(poles: np.ndarray, group: np.ndarray) -> list[np.ndarray]:
    """Divide modes at their widest gaps until all in a group are close, and few."""
    place, decay = np.imag(poles[group]), -np.real(poles[group])
    gap = np.diff(place) / (decay[:-1] + decay[1:])
    if group.size == 1 or (gap.max() < _CLOSE and group.size <= _MOST_TOGETHER):
        return [group]
    at = int(np.argmax(gap)) + 1
    return _divide(poles, group[:at]) + _divide(poles, group[at:])


def divide_into_bands(
    poles: np.ndarray, band: tuple[float, float], n_samples: int
) -> list[tuple[np.ndarray, tuple[float, float]]]:
    """Groups of modes that are close, each with the limits of its band, and the gaps between."""
    step = 2.0 * np.pi / n_samples
    groups = _divide(poles, np.arange(poles.size)) if poles.size else []
    found = []
    end = band[0]
    for place, group in enumerate(groups):
        own = poles[group]
        reach = np.maximum(-_REACH * np.real(own), _LEAST_REACH * step)
        low, high = np.min(np.imag(own) - reach), np.max(np.imag(own) + reach)
        if place:
            low = max(low, 0.5 * (np.imag(own[0]) + np.imag(poles[groups[place - 1][-1]])))
        if place + 1 < len(groups):
            high = min(high, 0.5 * (np.imag(own[-1]) + np.imag(poles[groups[place + 1][0]])))
        low, high = max(low, band[0]), min(high, band[1])
        found += _divide_gap(end, low, step)
        found.append((group, (low, high)))
        end = high
    return found + _divide_gap(end, band[1], step)


def _divide_gap(low: float, high: float, step: float) -> list[tuple[np.ndarray, tuple]]:
    """Bands without known modes between two frequencies."""
    if high - low < _LEAST_REACH * step or low <= 0:
        return []
    n = max(1, round(np.log(high / low) / np.log(_GAP_RATIO)))
    n = min(n, max(1, int((high - low) / (2 * _LEAST_REACH * step))))
    edges = np.geomspace(low, high, n + 1)
    none = np.zeros(0, dtype=int)
    return [(none, (a, b)) for a, b in itertools.pairwise(edges)]


def _fit_band(
    theta: np.ndarray, transform: np.ndarray, n_samples: int, poles: np.ndarray, shapes: np.ndarray
) -> _BandModes:
    """Fit the modes of one band; add those that it misses."""
    scale = np.sqrt(np.median(np.abs(transform) ** 2, axis=0))
    scale = np.maximum(scale, _LEAST_POWER * scale.max())
    relative = transform / scale
    best = None
    while best is None or best.poles.size < _MOST_TOGETHER:
        n_new = poles.size if best is None else poles.size + 1
        V = _find_components(relative, min(max(n_new + 1, 3), _MOST_COMPONENTS))
        X = relative @ V
        size = np.sqrt(np.median(np.abs(X) ** 2, axis=0))
        band = average_band(theta, X / size, n_samples, poles)
        fit = fit_spectrum(band, start_model(band, poles, (shapes / scale) @ V / size))
        fit = _remove_insignificant(band, fit)
        if best is not None or not poles.size:
            larger = _add_mode(band, fit)
            if larger is None:
                return best or _describe_band(
                    fit, band, transform, size[:, None] * V.conj().T, scale
                )
            fit = larger
        if best is not None and fit.model.poles.size <= best.poles.size:
            return best  # the fit to more components has lost a mode: it would come and go
        best = _describe_band(fit, band, transform, size[:, None] * V.conj().T, scale)
        poles, shapes = best.poles, best.shapes
    return best


def _add_mode(band: OutputBand, fit: SpectrumFit) -> SpectrumFit | None:
    try:
        proposed = propose_mode(band, fit.model, _SCANNED)
    except np.linalg.LinAlgError:
        return None
    if not np.isfinite(compute_cost(band, compute_spectrum(band, proposed))):
        return None
    larger = _remove_insignificant(band, fit_spectrum(band, proposed))
    return larger if larger.model.poles.size > fit.model.poles.size else None


def _describe_band(
    fit: SpectrumFit, band: OutputBand, transform: np.ndarray, back: np.ndarray, scale: np.ndarray
) -> _BandModes:
    """Return modes in the outputs, to which ``back`` leads from the components."""
    poles = fit.model.poles
    spectrum = compute_spectrum(band, fit.model)
    power = np.real(np.einsum("ao,bac,co->bo", back, spectrum, back.conj())) * scale**2
    # What is outside the components has no part of the modes: its mean level is noise.
    unit = back / np.linalg.norm(back, axis=1, keepdims=True)
    relative = transform / scale
    outside = relative - relative @ unit.conj().T @ unit
    level = np.mean(np.abs(outside * scale) ** 2)
    # Frequencies near the poles, of which the parameters of the modes take degrees of freedom.
    near = (np.abs(1j * band.lines[:, None] - poles) < _NEAR * -np.real(poles)).any(axis=1)
    n_out = back.shape[0]
    taken = 2 * poles.size * (1 + 2 * n_out) / max(2 * n_out * np.count_nonzero(near), 1)
    return _BandModes(
        poles=poles,
        covariance=fit.covariance / (1.0 - min(taken, _MOST_TAKEN)),
        shapes=(fit.model.shapes @ back) * scale,
        theta=band.average(band.lines),
        measured=band.average(np.mean(np.abs(transform) ** 2, axis=1)),
        fitted=np.mean(power, axis=1) + level,
    )


def _remove_insignificant(band: OutputBand, fit: SpectrumFit) -> SpectrumFit:
    n_out = band.power.shape[1]
    least = 0.5 * float(chdtri(4 * n_out, _FALSE_MODE / band.count.size))
    while fit.model.poles.size:
        poles = fit.model.poles
        with np.errstate(invalid="ignore"):
            _, spread = propagate_covariance(poles, fit.covariance)
        damping = -np.real(poles) / np.abs(poles)
        bad = (spread > _LARGEST_SPREAD * damping) | ~is_structural(poles)
        bad |= _LEAST_WIDTH * -np.real(poles) > band.lines[-1] - band.lines[0]
        bad |= (
            (np.imag(poles) < band.lines[0])
            | (np.imag(poles) > band.lines[-1])
            | ~np.isfinite(spread)
        )
        if bad.any():
            fit = fit_spectrum(
                band, remove_mode(band, fit.model, int(np.argmax(np.where(bad, spread, -1))))
            )
            continue
        if (spread < _SURE * damping).all():
            break
        weakest = int(np.argmin(compute_strengths(fit.model)))
        fewer = fit_spectrum(band, remove_mode(band, fit.model, weakest))
        if fewer.cost - fit.cost >= least:
            break
        fit = fewer
    return fit
