"""Limits of a design in flight: peaks, amplitudes by airspeed, and classic inputs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.maneuver import Condition
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.excitation.checks import KINDS, design_classic_input, pulse_lengths
from flexsid.sysid.excitation.fisher_information import (
    LOAD_FACTOR,
    FisherInformation,
    compute_waves,
    predict_cramer_rao_bounds_from_history,
)
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.signals import TimeHistory
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.workflow.excitation.excitation_designs import build_multisine
from flexsid.workflow.excitation.predicted_accuracy import (
    DesignQuery,
    PredictionModel,
    load_prediction_model,
)
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.exports import build_identified_model

# --- Comparison of a design with classic inputs within the same limits ----------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class ComparedInput:
    """One kind of excitation: largest deflection [rad], load factor [g], energy [rad2 s].

    ``pulse_s`` is the pulse length with the largest information; ``std_errors`` are empty where
    derivatives are not identifiable, and ``lacking`` is the reason.
    """

    kind: str
    pulse_s: float | None
    deflection: float
    load_factor: float
    energy: float
    std_errors: tuple[float, ...]
    lacking: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputComparison:
    """Multisine first, then classic inputs; standard errors in the order of ``names``."""

    names: tuple[str, ...]
    values: tuple[float, ...]
    inputs: tuple[ComparedInput, ...]
    next: str | None = None


def compare_inputs(store: Store, query: DesignQuery, report: ReportProgress) -> InputComparison:
    """Predict standard errors under doublets, 3-2-1-1s and sweeps within the design's limits.

    Surfaces move in turn, in the design's duration and band, at the largest amplitude at which
    neither the peak deflection nor the load factor of the design is exceeded. Of six pulse
    lengths the one with the smallest confidence ellipsoid is taken.
    """
    at, design = load_prediction_model(store, query.run_id), store.designs.get(query.design_id)
    information = at.predict(design, query.level)
    multisine = at.select_axis(build_multisine(design, query.level))
    rate = design.specification.rate_hz
    command = multisine.sample(np.arange(round(multisine.period_s * rate)) / rate)
    count = len(at.derivatives)
    rows = [_summarise("multisine", None, information, command, rate, count)]
    peaks = dict(zip(multisine.inputs, np.abs(command).max(axis=0).tolist(), strict=True))
    for k, kind in enumerate(KINDS):
        report(Progress(fraction=(k + 1) / (len(KINDS) + 1), message=f"Predicting {kind}"))
        rows.append(_find_best(at, design, multisine, kind, peaks, information, count))
    return InputComparison(
        names=information.names[:count],
        values=tuple(map(float, information.theta[:count])),
        inputs=tuple(rows),
    )


def _find_best(
    at: PredictionModel,
    design: ExcitationDesign,
    multisine: Multisine,
    kind: str,
    peaks: dict[str, float],
    against: FisherInformation,
    count: int,
) -> ComparedInput:
    best: tuple[float, ComparedInput] | None = None
    lacking = ""
    for pulse_s, history in _generate_candidates(at, design, multisine, kind, peaks):
        try:
            scaled, information = _scale_to_limits(at, multisine.band_hz, history, against)
            reported = np.ix_(information.reported, information.reported)
            size = np.linalg.slogdet(information.covariance()[reported])[1]
        except NotIdentifiable as error:
            lacking = error.message
            continue
        row = _summarise(kind, pulse_s, information, scaled.values, scaled.rate_hz, count)
        if best is None or size < best[0]:
            best = size, row
    if best is not None:
        return best[1]
    return ComparedInput(
        kind=kind, pulse_s=None, deflection=0.0, load_factor=0.0, energy=0.0,
        std_errors=(), lacking=lacking,
    )  # fmt: skip


def _generate_candidates(
    at: PredictionModel,
    design: ExcitationDesign,
    multisine: Multisine,
    kind: str,
    peaks: dict[str, float],
) -> Iterator[tuple[float | None, TimeHistory]]:
    duration_s, rate_hz = design.specification.duration_s, design.specification.rate_hz
    record_s = duration_s + at.noise_model.margin_s
    band = multisine.band_hz
    if kind == "sweep":
        yield None, design_classic_input(kind, peaks, duration_s, rate_hz, record_s, band)
        return
    for unit in pulse_lengths(kind, duration_s, len(peaks), rate_hz):
        yield (
            float(unit),
            design_classic_input(kind, peaks, duration_s, rate_hz, record_s, band, float(unit)),
        )


def _scale_to_limits(
    at: PredictionModel,
    band_hz: tuple[float, float],
    history: TimeHistory,
    against: FisherInformation,
) -> tuple[TimeHistory, FisherInformation]:
    """Scale an input until one of the design's limits is reached."""
    moved = np.abs(compute_waves(at.model, at.parameters, history, at.noise_model)).max(axis=0)
    gain = float(np.min(np.array(_find_peaks(against)) / np.array([moved[:-1].max(), moved[-1]])))
    scaled = replace(history, values=gain * history.values)
    return scaled, predict_cramer_rao_bounds_from_history(
        *(at.model, at.parameters, scaled, at.noise_model),
        *(band_hz, at.priors, at.nuisance),
    )


def _find_peaks(information: FisherInformation) -> tuple[float, float]:
    """Largest deflection of any surface [rad], and load factor [g]."""
    peaks = dict(zip(information.limited, information.peaks().tolist(), strict=True))
    load = peaks.pop(LOAD_FACTOR)
    return max(peaks.values()), load


def _summarise(
    kind: str,
    pulse_s: float | None,
    information: FisherInformation,
    command: np.ndarray,
    rate_hz: float,
    count: int,
) -> ComparedInput:
    deflection, load_factor = _find_peaks(information)
    return ComparedInput(
        kind=kind,
        pulse_s=pulse_s,
        deflection=deflection,
        load_factor=load_factor,
        energy=float(np.sum(command**2)) / rate_hz,
        std_errors=tuple(map(float, information.std_errors()[:count])),
    )


# --- Peaks of an excitation in flight: deflection and rate of the surfaces, and load factor -------


@dataclass(frozen=True, slots=True, kw_only=True)
class ExcitationPeaks:
    """Peaks or limits of deflection [rad], rate [rad/s] and load factor [1].

    The first two are those of the surface that uses most.
    """

    deflection: float
    rate: float
    load_factor: float

    def override(
        self, deflection: float | None, rate: float | None, load_factor: float | None
    ) -> ExcitationPeaks:
        """Return those that are given, else these."""
        return ExcitationPeaks(
            deflection=deflection or self.deflection,
            rate=rate or self.rate,
            load_factor=load_factor or self.load_factor,
        )

    def find_scale(self, peaks: ExcitationPeaks) -> float:
        """Largest factor on an excitation with these peaks."""
        return min(self._compute_factors(peaks).values())

    def find_active(self, peaks: ExcitationPeaks) -> str:
        """Name of the limit that an excitation with these peaks reaches first."""
        factors = self._compute_factors(peaks)
        return min(factors, key=lambda name: factors[name])

    def _compute_factors(self, peaks: ExcitationPeaks) -> dict[str, float]:
        return {
            one.name: float(getattr(self, one.name) / getattr(peaks, one.name))
            for one in fields(self)
        }


def find_peaks(information: FisherInformation, period_s: float) -> ExcitationPeaks:
    """Find the peaks of deflections, their rates, and the load factor over one period."""
    waves = information.waves.sum(axis=0)
    moving = [k for k, name in enumerate(information.limited) if name != LOAD_FACTOR]
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(waves), period_s / len(waves))
    rates = np.fft.irfft(1j * omega[:, None] * np.fft.rfft(waves[:, moving], axis=0), len(waves), 0)
    load = waves[:, information.limited.index(LOAD_FACTOR)]
    return ExcitationPeaks(
        deflection=float(np.abs(waves[:, moving]).max()),
        rate=float(np.abs(rates).max()),
        load_factor=float(np.abs(load).max()),
    )


# --- Amplitudes of a design by airspeed: within limits, and above the noise -----------------------

_RATIOS = (0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3)  # of the airspeed flown
_BELOW_FLUTTER = 0.97
"""Of the flutter speed of the model: beyond, the motion of the surfaces is another one.

What feedback adds to the surfaces is that of the run; near flutter it changes with airspeed.
"""
_CLEAR = 10.0  # signal-to-noise ratio from which noise is 10 % of the response, or less


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeLevel:
    """Amplitude of a design at one airspeed.

    ``largest`` is the largest peak of any command within the limits, of which ``limited_by`` is the
    one that is reached, and ``signal_to_noise`` the ratio there: median over harmonics of the
    largest of any output. ``least`` has a ratio of 10, in proportion from there: where model error
    counts, which grows with the amplitude, it is above the true one, and below beyond ``largest``.
    [rad]
    """

    airspeed_m_s: float
    dynamic_pressure_pa: float
    airspeed_ratio: float | None
    largest: float
    limited_by: str
    signal_to_noise: float
    least: float


def propose_levels(
    store: Store, at: PredictionModel, design: ExcitationDesign, level: int, limits: ExcitationPeaks
) -> tuple[AmplitudeLevel, ...]:
    """Propose the amplitude of a design at airspeeds around that of a run, below flutter.

    Nondimensional derivatives, weight, density and the noise of the outputs are those of the run,
    and surfaces respond to commands as there, feedback included.

    Raises
    ------
    BadInput
        If the run lacks inputs of the design.
    """
    flown = store.maneuvers.get(at.run.maneuver_id).condition
    highest = _BELOW_FLUTTER * _find_flutter_speed(at)
    speeds = (ratio * flown.airspeed_m_s for ratio in _RATIOS)
    return tuple(
        _propose_level(store, at, design, level, limits, _change_airspeed(flown, speed))
        for speed in speeds
        if speed <= max(highest, flown.airspeed_m_s)
    )


def _propose_level(
    store: Store,
    at: PredictionModel,
    design: ExcitationDesign,
    level: int,
    limits: ExcitationPeaks,
    condition: Condition,
) -> AmplitudeLevel:
    there = replace(at, model=prepare(store, at.run, condition).model)
    peak = design.specification.peaks[level]
    multisine = build_multisine(design, level)
    peaks = find_peaks(there.predict_multisine(multisine), multisine.period_s)
    factor = limits.find_scale(peaks)
    # Model error grows with the amplitude: the ratio is not proportional to it.
    ratio = _compute_signal_to_noise(there.predict_multisine(multisine.scale(factor)))
    flutter = condition.flutter_speed_m_s
    return AmplitudeLevel(
        airspeed_m_s=condition.airspeed_m_s,
        dynamic_pressure_pa=condition.dynamic_pressure_pa,
        airspeed_ratio=None if flutter is None else condition.airspeed_m_s / flutter,
        largest=factor * peak,
        limited_by=limits.find_active(peaks),
        signal_to_noise=ratio,
        least=factor * peak * _CLEAR / ratio,
    )


def _compute_signal_to_noise(information: FisherInformation) -> float:
    ratios = np.concatenate([np.abs(one.signal).max(axis=1) for one in information.lines])
    return float(np.median(ratios))


def _find_flutter_speed(at: PredictionModel) -> float:
    """Find the flutter speed of the model of a run; infinite if it has none. [m/s]"""
    model = build_identified_model(at.model, at.run).model
    table = at.parameters.table(at.parameters.start)
    aircraft = Aeroelastic(model.condition, model.modes, table, model.shape)
    speeds = model.condition.airspeed * np.linspace(_RATIOS[0], _RATIOS[-1] / _BELOW_FLUTTER, 60)
    crossing = track_roots(aircraft, speeds).flutter
    return np.inf if crossing is None else float(crossing.airspeed)


def _change_airspeed(flown: Condition, airspeed_m_s: float) -> Condition:
    """Change the airspeed at constant weight: alpha is proportional to 1 / dynamic pressure."""
    alpha = flown.alpha_rad * (flown.airspeed_m_s / airspeed_m_s) ** 2
    return replace(flown, airspeed_m_s=airspeed_m_s, alpha_rad=alpha)
