"""Likelihood of sensor faults, with the motion and the biases of all sensors projected out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Complex, Float, Int

from flexsid.errors import NotIdentifiable
from flexsid.sysid.compatibility.kinematics import (
    ALTITUDE,
    FlightRecord,
    MeasurementErrors,
    form_equations,
)
from flexsid.sysid.model.sensor_models import VANE
from flexsid.sysid.preparation.redundancy import select_strong_frequencies
from flexsid.text import count_noun

_LARGEST_LOG = 10.0  # of the step of a ratio
_MODEL_ERROR = 0.01  # of the spectrum nearby: calibration and places are not known better
_NEAR = 7  # frequencies over which a spectrum is averaged
_SIGNAL_OVER_NOISE = 4.0  # times the power of the noise, 6 dB, in half of the sensors
_MIN_FREQUENCIES = 8
_LEAST_FREEDOM = 0.05  # of a sensor, below which its own noise is not known
_SHARED_NOISE = 9  # frequencies over which the noise of a vane is averaged: turbulence has a colour
_CHANCE = 2.0  # standard deviations of the power of a residual
_NOISE_STEPS = 8  # of the fixed-point iteration for the noise
_NEIGHBOURS = 4  # frequencies that share the residual of an omitted effect
_RANK = 1e-6  # of the largest singular value: motions that no sensor separates are one
_STEPS = 12
_HALVINGS = 6
_CONVERGED = 1e-3  # decrease of the cost that ends the steps


class SensorFaultKind(StrEnum):
    """Fault of a sensor."""

    DELAY = "delay"  # recorded later than true [s]
    SCALE = "scale"  # recorded over true
    ARM = "arm"  # true position ahead of the declared one along an axis [m]
    AIRSPEED = "airspeed"  # recorded over true


_DIFFERENCE = {
    SensorFaultKind.DELAY: 1e-5,
    SensorFaultKind.SCALE: 1e-5,
    SensorFaultKind.ARM: 1e-4,
    SensorFaultKind.AIRSPEED: 1e-5,
}
_LARGEST_STEP = {
    SensorFaultKind.DELAY: 0.05,
    SensorFaultKind.SCALE: 1.0,
    SensorFaultKind.ARM: 10.0,
    SensorFaultKind.AIRSPEED: 0.3,
}


@dataclass(frozen=True, slots=True, order=True)
class FaultCandidate:
    """A possible fault; ``axis`` is that of a lever arm."""

    kind: SensorFaultKind
    channel: str
    axis: str = ""

    @property
    def is_ratio(self) -> bool:
        """Whether its value is a ratio, with one where nothing is wrong."""
        return self.kind in (SensorFaultKind.SCALE, SensorFaultKind.AIRSPEED)

    @property
    def neutral(self) -> float:
        """Value where nothing is wrong."""
        return 1.0 if self.is_ratio else 0.0

    def advance(self, value: float, step: float) -> float:
        """Change a value; ratios by their logarithm."""
        if self.is_ratio:
            return float(value * np.exp(np.clip(step, -_LARGEST_LOG, _LARGEST_LOG)))
        return float(value + step)


Values = Mapping[FaultCandidate, float]


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """One record at the frequencies where it moves.

    ``sigma`` is the standard deviation of its spectra, ``least`` that by the samples alone,
    ``window`` the spectrum of its window.
    """

    record: FlightRecord
    some: Int[np.ndarray, " n_omega"]
    least: Float[np.ndarray, "n_omega n_y"]
    sigma: Float[np.ndarray, "n_omega n_y"]
    window: Complex[np.ndarray, " n_omega"]


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """Whitened residuals of one record, leverage of each sensor on the motion, and spectra."""

    residual: Complex[np.ndarray, "n_omega n_y"]
    leverage: Float[np.ndarray, "n_omega n_y"]
    spectra: Complex[np.ndarray, "n_omega n_y"]


@dataclass(frozen=True, slots=True, eq=False)
class FaultLikelihood:
    """Likelihood of faults that are common to one or many records."""

    names: tuple[str, ...]
    parts: tuple[_Part, ...]

    @property
    def noise(self) -> Float[np.ndarray, " n_y"]:
        """Root mean square noise of each sensor over that by its samples."""
        ratio = np.concatenate([one.sigma / one.least for one in self.parts])
        return np.sqrt(np.mean(ratio**2, axis=0))

    @property
    def band_hz(self) -> tuple[float, float]:
        """Lowest and highest frequency of any record. [Hz]"""
        omega = np.concatenate([one.record.omega[one.some] for one in self.parts])
        return float(omega.min() / (2.0 * np.pi)), float(omega.max() / (2.0 * np.pi))

    @property
    def n_frequencies(self) -> int:
        """Number of frequencies of all records."""
        return sum(one.some.size for one in self.parts)

    def project(self, values: Values) -> list[Projection]:
        """Project motion and biases out of the spectra of every record."""
        errors = _convert(values)
        return [_project(one, errors) for one in self.parts]

    def compute_residual(self, values: Values) -> Complex[np.ndarray, " n"]:
        """Whitened residuals of all records."""
        return np.concatenate([one.residual.ravel() for one in self.project(values)])

    def compute_cost(self, values: Values) -> float:
        """Half of -2 ln L."""
        return float(np.sum(np.abs(self.compute_residual(values)) ** 2))

    def fit(
        self, start: Values, free: Sequence[FaultCandidate]
    ) -> tuple[dict[FaultCandidate, float], float]:
        """Fit some of the values by Gauss-Newton steps; return all, and the cost."""
        values = dict(start)
        residual = self.compute_residual(values)
        cost = float(np.sum(np.abs(residual) ** 2))
        largest = np.array([_LARGEST_STEP[one.kind] for one in free])
        for _ in range(_STEPS):
            slope = self._differentiate(values, free, residual)
            normal, size = _normalize(slope)
            gradient = np.real(slope.conj().T @ residual) / size
            step = -np.linalg.lstsq(normal, gradient, rcond=1e-10)[0] / size
            step = np.clip(step, -largest, largest)
            for _ in range(_HALVINGS):
                moved = zip(free, step.tolist(), strict=True)
                trial = values | {one: one.advance(values[one], d) for one, d in moved}
                found = self.compute_residual(trial)
                lower = float(np.sum(np.abs(found) ** 2))
                if lower < cost:
                    break
                step = 0.5 * step
            else:
                break
            gained, values, residual, cost = cost - lower, trial, found, lower
            if gained < _CONVERGED:
                break
        return values, cost

    def linearize(
        self, values: Values, candidates: Sequence[FaultCandidate]
    ) -> list[tuple[float, float, float]]:
        """Change of each candidate alone to its optimum, the cost there, and its standard error.

        To first order about the given values, which stay as they are.
        """
        start = {one: one.neutral for one in candidates} | dict(values)
        projected = self.project(start)
        residual = np.concatenate([part.residual.ravel() for part in projected])
        cost = float(np.sum(np.abs(residual) ** 2))
        found = []
        for one in candidates:
            slope = self._differentiate(start, (one,), residual)
            normal = float(np.sum(np.abs(slope) ** 2))
            if not normal > 0.0:
                found.append((0.0, cost, float("inf")))
                continue
            gradient = float(np.real(np.vdot(slope[:, 0], residual)))
            (std,) = _estimate_std(slope, projected)
            found.append((-gradient / normal, cost - gradient**2 / normal, float(std)))
        return found

    def _differentiate(
        self,
        values: Values,
        free: Sequence[FaultCandidate],
        residual: Complex[np.ndarray, " n"],
    ) -> Complex[np.ndarray, "n n_free"]:
        columns = []
        for one in free:
            step = _DIFFERENCE[one.kind]
            ahead = self.compute_residual({**values, one: one.advance(values[one], step)})
            columns.append((ahead - residual) / step)
        return np.stack(columns, axis=1)

    def estimate_std(self, values: Values) -> dict[FaultCandidate, float]:
        """Standard errors of all values, of logarithms for ratios; infinite if not identifiable.

        Notes
        -----
        The larger of those of white residuals and of residuals that neighbouring frequencies share
        (Newey and West, Econometrica 55, 1987, doi:10.2307/1913610).
        """
        free = tuple(values)
        if not free:
            return {}
        projected = self.project(values)
        residual = np.concatenate([one.residual.ravel() for one in projected])
        slope = self._differentiate(values, free, residual)
        std = _estimate_std(slope, projected)
        return dict(zip(free, std.tolist(), strict=True))

    def adjust_noise(self, values: Values) -> FaultLikelihood:
        """Raise the noise of each sensor to its residual, that of vanes first.

        A vane also measures turbulence, whose spectrum has a colour; the noise of others is white.
        """
        errors = _convert(values)
        kinds = [one.kind for one in self.parts[0].record.sensors]
        is_vane = np.array([kind == VANE.kind for kind in kinds])
        parts = [replace(one, sigma=one.least) for one in self.parts]
        for some, shares_colour in ((is_vane, True), (~is_vane, False)):
            if not some.any():
                continue
            for _ in range(_NOISE_STEPS):
                found = [_project(one, errors) for one in parts]
                power = [np.abs(one.residual) ** 2 for one in found]
                freedom = [1.0 - one.leverage for one in found]
                if shares_colour:
                    ratios = [_average(p) for p in power], [_average(f) for f in freedom]
                else:
                    total = np.sum([p.sum(axis=0) for p in power], axis=0)
                    free = np.sum([f.sum(axis=0) for f in freedom], axis=0)
                    # Power that chance explains is no noise: few degrees of freedom would grow.
                    total = np.where(total > free + _CHANCE * np.sqrt(free), total, free)
                    ratios = (
                        [np.broadcast_to(total, p.shape) for p in power],
                        [np.broadcast_to(free, p.shape) for p in power],
                    )
                count = 1.0 if shares_colour else float(self.n_frequencies)
                parts = [
                    replace(
                        one,
                        sigma=np.where(
                            some,
                            np.maximum(
                                one.sigma * np.sqrt(p / np.maximum(f, _LEAST_FREEDOM * count)),
                                one.least,
                            ),
                            one.sigma,
                        ),
                    )
                    for one, p, f in zip(parts, *ratios, strict=True)
                ]
        return replace(self, parts=tuple(parts))

    def compute_coherence(self, values: Values) -> Float[np.ndarray, " n_y"]:
        """Coherence of each sensor with its prediction from all others; NaN without one."""
        own, cross, others = np.zeros((3, len(self.names)), dtype=complex)
        for part, found in zip(self.parts, self.project(values), strict=True):
            away = found.residual * part.sigma / np.maximum(1.0 - found.leverage, 1e-9)
            use = found.leverage < 0.99
            predicted = np.where(use, found.spectra - away, 0.0)
            z = np.where(use, found.spectra, 0.0)
            cross += np.sum(z.conj() * predicted, axis=0)
            own += np.sum(np.abs(z) ** 2, axis=0)
            others += np.sum(np.abs(predicted) ** 2, axis=0)
        size = np.real(own * others)
        return np.where(size > 0.0, np.abs(cross) ** 2 / np.where(size > 0.0, size, 1.0), np.nan)


def build_likelihood(records: Sequence[FlightRecord]) -> FaultLikelihood:
    """Build the likelihood of the sensors that all records share.

    Raises
    ------
    NotIdentifiable
        If no more sensors than motions were recorded, or a record is too short or hardly moves.
    """
    shared = frozenset.intersection(*(frozenset(s.name for s in one.sensors) for one in records))
    if not shared:
        raise NotIdentifiable("the maneuvers share no sensor", code="no-redundancy")
    parts = tuple(_select_frequencies(one.select(shared)) for one in records)
    first = parts[0]
    rows = (
        form_equations(first.record, MeasurementErrors(), first.some).rows / first.sigma[:, :, None]
    )
    n_y, n_r = rows.shape[1], int(np.abs(_find_basis(rows)).sum(axis=1).astype(bool).sum(1).max())
    if n_y <= n_r:
        raise NotIdentifiable(
            f"{count_noun(n_y, 'sensor')} for {count_noun(n_r, 'motion')}; their compatibility "
            "needs more sensors than motions",
            code="no-redundancy",
        )
    return FaultLikelihood(tuple(one.name for one in first.record.sensors), parts)


def _convert(values: Values) -> MeasurementErrors:
    by_kind: dict[SensorFaultKind, dict[str, float]] = {kind: {} for kind in SensorFaultKind}
    for one, value in values.items():
        by_kind[one.kind][one.channel] = value
    return MeasurementErrors(
        delays=by_kind[SensorFaultKind.DELAY],
        scales=by_kind[SensorFaultKind.SCALE],
        arms={(k.channel, k.axis): v for k, v in values.items() if k.kind is SensorFaultKind.ARM},
        airspeed=next(iter(by_kind[SensorFaultKind.AIRSPEED].values()), 1.0),
    )


def _select_frequencies(record: FlightRecord) -> _Part:
    """Select the frequencies up to which the sensors move, and the noise of their spectra."""
    if record.time.size < 8 * _MIN_FREQUENCIES or record.omega.size < _MIN_FREQUENCIES:
        raise NotIdentifiable(
            f"the sensors share {record.duration_s:.3g} s of the record, too little to compare "
            "them",
            code="too-short",
        )
    spectra = form_equations(record, MeasurementErrors(), np.arange(record.omega.size)).spectra
    power = np.sum(record.window**2) * record.step_s
    white = np.array([one.noise_std * np.sqrt(power / one.rate_hz) for one in record.sensors])
    is_altitude = np.array([one.kind == ALTITUDE for one in record.sensors])
    sigma = white * np.where(is_altitude, record.omega[:, None], 1.0)
    level = np.sqrt(_average(np.abs(spectra) ** 2, _NEAR))
    above = np.mean(level**2 > _SIGNAL_OVER_NOISE * sigma**2, axis=1) >= 0.5
    begin = int(np.argmax(above))
    quiet = np.flatnonzero(~above[begin:])
    top = record.omega.size if quiet.size == 0 else begin + int(quiet[0])
    if not above.any() or top < _MIN_FREQUENCIES:
        raise NotIdentifiable(
            "the sensors of this record hardly move above their noise", code="no-signal"
        )
    some = select_strong_frequencies(spectra[:top])
    least = np.hypot(sigma, _MODEL_ERROR * level)[some]
    window = record.transform(record.window[:, None])[some, 0]
    return _Part(record, some, least, least, window)


def _project(part: _Part, errors: MeasurementErrors) -> Projection:
    equations = form_equations(part.record, errors, part.some)
    rows = equations.rows / part.sigma[:, :, None]
    q = _find_basis(rows)
    q_h = q.conj().transpose(0, 2, 1)
    e = equations.spectra / part.sigma
    residual = e - np.matmul(q, np.matmul(q_h, e[:, :, None]))[:, :, 0]
    # A constant bias of a sensor has the spectrum of the window.
    columns = (np.eye(e.shape[1]) - np.matmul(q, q_h)) * (part.window[:, None] / part.sigma)[
        :, None, :
    ]
    flat = columns.reshape(-1, columns.shape[2])
    gram = np.real(flat.conj().T @ flat)
    gram[np.diag_indices_from(gram)] += 1e-9 * max(float(np.trace(gram)), 1e-300)
    bias = np.linalg.solve(gram, np.real(flat.conj().T @ residual.ravel()))
    residual = residual - (flat @ bias).reshape(residual.shape)
    return Projection(residual, np.sum(np.abs(q) ** 2, axis=2), equations.spectra)


def _estimate_std(
    slope: Complex[np.ndarray, "n n_free"], projected: Sequence[Projection]
) -> Float[np.ndarray, " n_free"]:
    """Standard errors by slopes and residuals; infinite where not identifiable."""
    residual = np.concatenate([one.residual.ravel() for one in projected])
    normal, size = _normalize(slope)
    inverse = np.linalg.pinv(normal, rcond=1e-10, hermitian=True)
    score = np.real(slope.conj() * residual[:, None]) / size
    scatter, first = np.zeros_like(normal), 0
    for one in projected:
        n_omega, n_y = one.residual.shape
        own = score[first : first + n_omega * n_y].reshape(n_omega, n_y, -1).sum(axis=1)
        first += n_omega * n_y
        scatter += own.T @ own
        for lag in range(1, min(_NEIGHBOURS, n_omega - 1) + 1):
            both = (1.0 - lag / (_NEIGHBOURS + 1.0)) * (own[lag:].T @ own[:-lag])
            scatter += both + both.T
    white, shared = 0.5 * np.diag(inverse), np.diag(inverse @ scatter @ inverse)
    std = np.sqrt(np.maximum(white, shared)) / size
    removed = np.diag(inverse) < 0.5  # of unit diagonal: left out by the pseudo-inverse
    return np.where(removed, np.inf, std)


def _find_basis(rows: np.ndarray) -> np.ndarray:
    """Orthonormal columns that span the motions at each frequency, zero where they do not."""
    size = np.linalg.norm(rows, axis=1)
    unit = rows / np.where(size > 0.0, size, 1.0)[:, None, :]
    q, r = np.linalg.qr(unit)
    if np.abs(np.diagonal(r, axis1=1, axis2=2)).min() > _RANK:
        return q
    q, level, _ = np.linalg.svd(unit, full_matrices=False)
    return q * (level > _RANK * level[:, :1])[:, None, :]


def _normalize(slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Normal matrix of unit diagonal, and the norms of the columns."""
    normal = np.real(slope.conj().T @ slope)
    size = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    return normal / np.outer(size, size), size


def _average(values: np.ndarray, width: int = _SHARED_NOISE) -> np.ndarray:
    """Average columns over neighbouring frequencies."""
    kernel = np.ones(width)
    count = np.convolve(np.ones(len(values)), kernel, mode="same")
    return np.stack([np.convolve(v, kernel, mode="same") / count for v in values.T], axis=1)
