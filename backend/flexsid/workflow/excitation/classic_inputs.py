"""Comparison of a design with classic inputs within the same limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import NotIdentifiable
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.estimation.fisher_information import (
    LOAD_FACTOR,
    FisherInformation,
    compute_waves,
    predict_cramer_rao_bounds_from_history,
)
from flexsid.sysid.excitation.classic_inputs import KINDS, design_classic_input, pulse_lengths
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.signals import TimeHistory
from flexsid.workflow.excitation.excitation_designs import build_multisine
from flexsid.workflow.excitation.predicted_accuracy import (
    DesignQuery,
    PredictionModel,
    load_prediction_model,
)


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
