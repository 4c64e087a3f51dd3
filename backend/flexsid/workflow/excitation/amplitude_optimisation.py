"""Allocation: amplitudes that make a design tell most within limits, beside those it has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.excitation import ExcitationDesign
from flexsid.storage.store import Store
from flexsid.sysid.estimation.allocation import allocate_d_optimal, allocate_minimax
from flexsid.sysid.estimation.expectation import LOAD_FACTOR, Expectation
from flexsid.workflow.excitation.excitation_designs import check_amplitudes, multisine_of
from flexsid.workflow.excitation.predicted_accuracy import Circumstances, circumstances
from flexsid.workflow.model_structures.run_results import result_of

_TOLD = 4.0  # standard errors from zero at which a derivative's relative error means something


@dataclass(frozen=True, slots=True, kw_only=True)
class AllocatedPeak:
    """Largest of a command or of what is limited: as designed, minimax and D-optimal.

    [unit of the command] or [g]
    """

    name: str
    limit: float | None
    flat: float
    minimax: float
    d_optimal: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AllocatedError:
    """Relative standard error of a derivative under the three; ``counts`` for the worst. [1]"""

    name: str
    value: float
    counts: bool
    flat: float
    minimax: float
    d_optimal: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Allocation:
    """``gains`` of the inputs by criterion, peaks of commands and of what is limited."""

    gains: dict[str, dict[str, float]]
    commands: tuple[AllocatedPeak, ...]
    limited: tuple[AllocatedPeak, ...]
    errors: tuple[AllocatedError, ...]
    next: str | None = None


def allocate(
    store: Store,
    design: ExcitationDesign,
    run_id: int,
    level: int = 0,
    deflection: float | None = None,
    load_factor: float | None = None,
) -> Allocation:
    """Find amplitudes for a run's model, and tell what each derivative gains or loses.

    Parameters
    ----------
    store, design, run_id, level
        What would be flown, and what is known of the aircraft.
    deflection
        Largest of any surface, feedback included; that of the design by default. [rad]
    load_factor
        Largest change at the centre of gravity; that of the design by default. [g]

    Raises
    ------
    BadInput
        If no derivative of the run stands clear of its error.
    NotAllocated
        If the optimiser fails.
    """
    at = circumstances(store, run_id)
    flat = at.expect(design, level)
    given = np.array([load_factor if n == LOAD_FACTOR else deflection for n in flat.limited], float)
    limits = np.where(np.isnan(given), _limits_of(flat), given)
    counts = _counting(at)
    if not counts.any():
        raise BadInput(
            f"no derivative of run {run_id} is known to a quarter of its size; take a better one",
            code="nothing-counts",
        )
    gains = {
        "flat": np.ones(len(flat.inputs)),
        "minimax": allocate_minimax(flat, limits, counts),
        "d_optimal": allocate_d_optimal(flat, limits),
    }
    told = {name: _scaled(at, design, level, flat, g) for name, g in gains.items()}
    errors = {name: one.std_errors() / np.abs(one.theta) for name, one in told.items()}
    made = multisine_of(design, level)
    period = np.arange(round(design.wish.duration_s * design.wish.rate_hz)) / design.wish.rate_hz
    commands = np.abs(made.sample(period)).max(axis=0)
    places = range(len(at.derivatives))
    return Allocation(
        gains={n: dict(zip(flat.inputs, g.tolist(), strict=True)) for n, g in gains.items()},
        commands=tuple(
            AllocatedPeak(
                name=name, limit=None, **{n: float(commands[k] * g[k]) for n, g in gains.items()}
            )
            for k, name in enumerate(flat.inputs)
        ),
        limited=tuple(
            AllocatedPeak(
                name=name,
                limit=float(limits[k]),
                **{n: float(one.peaks()[k]) for n, one in told.items()},
            )
            for k, name in enumerate(flat.limited)
        ),
        errors=tuple(
            AllocatedError(
                name=flat.names[k],
                value=float(flat.theta[k]),
                counts=bool(counts[k]),
                **{n: float(e[k]) for n, e in errors.items()},
            )
            for k in places
            if flat.theta[k] != 0.0
        ),
    )


def rescale_design(
    store: Store, design: ExcitationDesign, name: str, gains: Mapping[str, float], note: str = ""
) -> ExcitationDesign:
    """Keep a design with the same lines and phases and other amplitudes.

    Raises
    ------
    BadInput
        If a gain belongs to no input of the design, or is too large for a control surface.
    """
    inputs = {own.name for own in design.wish.inputs}
    for own in gains:
        if own not in inputs:
            raise BadInput(
                f"the design has no input '{own}'; it has {', '.join(sorted(inputs))}",
                code="unknown-input",
                input=own,
            )
    wish = replace(
        design.wish,
        inputs=tuple(
            replace(own, relative_peak=own.relative_peak * gains.get(own.name, 1.0))
            for own in design.wish.inputs
        ),
    )
    check_amplitudes(wish)
    return store.designs.add(
        replace(design, id=None, created_at=None, name=name, wish=wish, note=note)
    )


def _limits_of(flat: Expectation) -> np.ndarray:
    """The design's own peaks: of all surfaces together, and of the load factor."""
    peaks = flat.peaks()
    surfaces = np.array([name != LOAD_FACTOR for name in flat.limited])
    return np.where(surfaces, peaks[surfaces].max(), peaks)


def _counting(at: Circumstances) -> np.ndarray:
    """Derivatives that stand clear of their error in the run: others have no relative one."""
    rows = {row.name: row for row in result_of(at.run).parameters}
    errors = [rows[name].std_error for name in at.parameters.names]
    clear = [
        error is not None and abs(value) > _TOLD * error
        for value, error in zip(at.parameters.start, errors, strict=True)
    ]
    return np.array(clear) & (np.arange(len(clear)) < len(at.derivatives))


def _scaled(
    at: Circumstances, design: ExcitationDesign, level: int, flat: Expectation, gains: np.ndarray
) -> Expectation:
    """Expect again: what the model misses grows with the amplitude, and weights follow."""
    made = multisine_of(design, level)
    tones = {
        name: replace(own, amplitudes=own.amplitudes * gains[flat.inputs.index(name)])
        for name, own in made.tones.items()
    }
    return at.expect_of(replace(made, tones=tones))
