"""Amplitudes of a design by airspeed: within limits, and above the noise."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexsid.records.excitation import ExcitationDesign
from flexsid.records.maneuver import Condition
from flexsid.storage.store import Store
from flexsid.sysid.estimation.fisher_information import FisherInformation
from flexsid.sysid.stability.root_tracking import track_roots
from flexsid.sysid.stability.state_family import Aeroelastic
from flexsid.workflow.excitation.excitation_designs import build_multisine
from flexsid.workflow.excitation.excitation_peaks import ExcitationPeaks, find_peaks
from flexsid.workflow.excitation.predicted_accuracy import PredictionModel
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.identified_models import build_identified_model

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
