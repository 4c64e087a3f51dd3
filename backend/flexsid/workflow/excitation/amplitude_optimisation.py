"""Optimise the amplitudes of a design within limits, by the minimax and D-optimal criteria."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.excitation.fisher_information import LOAD_FACTOR, FisherInformation
from flexsid.sysid.excitation.input_optimisation import (
    optimise_amplitudes_d_optimal,
    optimise_amplitudes_minimax,
)
from flexsid.workflow.excitation.classic_inputs import AmplitudeLevel, find_peaks, propose_levels
from flexsid.workflow.excitation.excitation_designs import build_multisine, check_amplitudes
from flexsid.workflow.excitation.predicted_accuracy import (
    Deflection,
    DesignQuery,
    Limit,
    PredictionModel,
    Rate,
    load_prediction_model,
)
from flexsid.workflow.model_structures.model_structures import get_result

_SIGNIFICANT = 4.0  # standard errors from zero, from which a relative error is meaningful


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeQuery(DesignQuery):
    """A design, a run, and limits, by default those of the design.

    ``deflection`` is the largest of any surface, feedback included [rad], ``rate`` its largest
    rate [rad/s], and ``load_factor`` the largest change at the centre of gravity [g].
    The rate limits the levels by airspeed only.
    """

    deflection: Deflection | None = None
    rate: Rate | None = None
    load_factor: Limit | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimisedPeak:
    """Peak of a command or of a limited quantity: as designed, minimax and D-optimal.

    [unit of the command] or [g]
    """

    name: str
    limit: float | None
    flat: float
    minimax: float
    d_optimal: float


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimisedError:
    """Relative standard error of a derivative by criterion; ``counts`` in the minimax. [1]"""

    name: str
    value: float
    counts: bool
    flat: float
    minimax: float
    d_optimal: float


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimisedAmplitudes:
    """``gains`` of the inputs by criterion, peaks of commands and of limited quantities.

    ``levels`` are amplitudes of the design as it is, by airspeed.
    """

    gains: dict[str, dict[str, float]]
    commands: tuple[OptimisedPeak, ...]
    limited: tuple[OptimisedPeak, ...]
    errors: tuple[OptimisedError, ...]
    levels: tuple[AmplitudeLevel, ...] = ()
    next: str | None = None


def optimise_amplitudes(
    store: Store, query: AmplitudeQuery, report: ReportProgress
) -> OptimisedAmplitudes:
    """Optimise amplitudes for the model of a run and predict the standard errors of derivatives.

    Raises
    ------
    BadInput
        If no derivative of the run exceeds four standard errors.
    OptimisationFailed
        If the optimiser fails.
    """
    at, design = load_prediction_model(store, query.run_id), store.designs.get(query.design_id)
    multisine = build_multisine(design, query.level)
    flat = at.predict_multisine(multisine)
    given = [query.load_factor if n == LOAD_FACTOR else query.deflection for n in flat.limited]
    given = np.array(given, float)
    limits = np.where(np.isnan(given), _find_peaks(flat), given)
    counts = _find_significant(at)
    if not counts.any():
        raise BadInput(
            f"no derivative of run {query.run_id} exceeds {_SIGNIFICANT:g} standard errors;"
            " select a more accurate run",
            code="no-significant-derivative",
        )
    report(Progress(fraction=0.3, message="Optimising amplitudes"))
    gains = {
        "flat": np.ones(len(flat.inputs)),
        "minimax": optimise_amplitudes_minimax(flat, limits, counts),
        "d_optimal": optimise_amplitudes_d_optimal(flat, limits),
    }
    report(Progress(fraction=0.6, message="Predicting standard errors"))
    predicted = {
        name: _predict_scaled(at, design, query.level, flat, g) for name, g in gains.items()
    }
    std_errors = {name: at.compute_std_errors(one) for name, one in predicted.items()}
    own = find_peaks(flat, multisine.period_s)
    allowed = own.override(query.deflection, query.rate, query.load_factor)
    report(Progress(fraction=0.7, message="Proposing levels by airspeed"))
    levels = propose_levels(store, at, design, query.level, allowed)
    period = (
        np.arange(round(design.specification.duration_s * design.specification.rate_hz))
        / design.specification.rate_hz
    )
    commands = np.abs(multisine.sample(period)).max(axis=0)
    columns = range(len(at.derivatives))
    return OptimisedAmplitudes(
        gains={n: dict(zip(flat.inputs, g.tolist(), strict=True)) for n, g in gains.items()},
        commands=tuple(
            OptimisedPeak(
                name=name, limit=None, **{n: float(commands[k] * g[k]) for n, g in gains.items()}
            )
            for k, name in enumerate(flat.inputs)
        ),
        limited=tuple(
            OptimisedPeak(
                name=name,
                limit=float(limits[k]),
                **{n: float(one.peaks()[k]) for n, one in predicted.items()},
            )
            for k, name in enumerate(flat.limited)
        ),
        errors=tuple(
            OptimisedError(
                name=flat.names[k],
                value=float(flat.theta[k]),
                counts=bool(counts[k]),
                **{n: float(e[k] / abs(flat.theta[k])) for n, e in std_errors.items()},
            )
            for k in columns
            if flat.theta[k] != 0.0
        ),
        levels=levels,
    )


def rescale_design(
    store: Store, design: ExcitationDesign, name: str, gains: Mapping[str, float], note: str = ""
) -> ExcitationDesign:
    """Save a design with the same harmonics and phases and other amplitudes.

    Raises
    ------
    BadInput
        If a gain belongs to no input of the design, or is too large for a control surface.
    """
    inputs = {own.name for own in design.specification.inputs}
    for own in gains:
        if own not in inputs:
            raise BadInput(
                f"the design has no input '{own}'; it has {', '.join(sorted(inputs))}",
                code="unknown-input",
                input=own,
            )
    specification = replace(
        design.specification,
        inputs=tuple(
            replace(own, relative_peak=own.relative_peak * gains.get(own.name, 1.0))
            for own in design.specification.inputs
        ),
    )
    check_amplitudes(specification)
    return store.designs.add(
        replace(design, id=None, created_at=None, name=name, specification=specification, note=note)
    )


def _find_peaks(flat: FisherInformation) -> np.ndarray:
    """Return the peaks of the design: largest of all surfaces, and of the load factor."""
    peaks = flat.peaks()
    surfaces = np.array([name != LOAD_FACTOR for name in flat.limited])
    return np.where(surfaces, peaks[surfaces].max(), peaks)


def _find_significant(at: PredictionModel) -> np.ndarray:
    """Find derivatives with a meaningful relative error: more than four standard errors."""
    std_errors = {row.name: row.std_error for row in get_result(at.run).parameters}
    derivatives = set(at.derivatives)

    def is_significant(name: str, value: float) -> bool:
        std_error = std_errors[name]
        return std_error is not None and abs(value) > _SIGNIFICANT * std_error

    return np.array(
        [
            name in derivatives and is_significant(name, value)
            for name, value in zip(at.parameters.names, at.parameters.start, strict=True)
        ]
    )


def _predict_scaled(
    at: PredictionModel,
    design: ExcitationDesign,
    level: int,
    flat: FisherInformation,
    gains: np.ndarray,
) -> FisherInformation:
    """Predict again: model error grows with the amplitude, and weights with it."""
    multisine = build_multisine(design, level)
    tones = {
        name: replace(own, amplitudes=own.amplitudes * gains[flat.inputs.index(name)])
        for name, own in multisine.tones.items()
    }
    return at.predict_multisine(replace(multisine, tones=tones))
