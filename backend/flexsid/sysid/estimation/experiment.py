"""Experiment: what was measured at the lines of one maneuver, and what explains it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.sysid.model.aeroelastic import AeroelasticModel


@dataclass(frozen=True, slots=True)
class Experiment:
    """What was measured at the lines of one maneuver.

    ``instruments`` is each output's measured over true response; inputs have
    theirs removed already. Lines of one ``group`` follow each other and share a noise
    covariance: one group for OE, one per input for FRE. Where lines are computed from
    others, ``source`` holds those, and ``gain`` how the noise of each enters each line here.
    ``edges_s`` are the times at which the record may begin or end in motion. [s]
    """

    name: str
    model: AeroelasticModel
    instruments: Complex[np.ndarray, "n_omega n_y"]
    omega: Float[np.ndarray, " n_omega"]
    inputs: Complex[np.ndarray, "n_omega n_u"]
    measured: Complex[np.ndarray, "n_omega n_y"]
    group: np.ndarray
    group_names: tuple[str, ...]
    source: Experiment | None = None
    gain: Complex[np.ndarray, "n_omega n_source"] | None = None
    edges_s: tuple[float, ...] = ()
