"""Runs of simulated maneuvers of FLEX-28, and designs of the rows of Table 1."""

from __future__ import annotations

import numpy as np

from flexsid.demo.campaign import add_maneuver
from flexsid.demo.flights import fly
from flexsid.records.decision import Structure
from flexsid.records.excitation import ExcitationDesign
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.workflow.excitation.excitation_designs import (
    DesignOrder,
    compute_design,
    specify_design,
)
from flexsid.workflow.runs.estimation import compute_run, prepare, store_result


def estimated(
    store: Store,
    flight: int,
    ratio: float,
    plan: tuple[int, float, tuple[int, ...]],
    seed: int,
    multisine: Multisine | None = None,
    turbulence: Turbulence = Turbulence.NONE,
) -> EstimationRun:
    """Eight modes fly, fewer are fitted."""
    fta, peak_deg, modes = plan
    flown = fly(
        airspeed_ratio=ratio,
        fta=fta,
        peak_deg=peak_deg,
        seed=seed,
        multisine=multisine,
        turbulence=turbulence,
    )
    maneuver = add_maneuver(store, flown, flight)
    request = EstimationRun(
        maneuver_id=maneuver.id or 0,
        method=Method.OE,
        structure=Structure(modes=modes, fixed={}),
        settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
    )
    run = store.runs.add(request)
    claimed = queue.claim(store, run.id)
    assert claimed is not None
    computed = compute_run(prepare(store, run), lambda progress: None)
    return store_result(store, run.id or 0, claimed.attempt, computed)


def planned(store: Store, fta: int, peak_deg: float) -> ExcitationDesign:
    peak = float(np.deg2rad(peak_deg))
    specification = specify_design(fta, 24.0, 100.0, 6, (peak, 2 * peak, 4 * peak), "quick")
    order = DesignOrder(name=f"FTA {fta}", specification=specification, fta=fta)
    return store.designs.add(compute_design(order, lambda progress: None))
