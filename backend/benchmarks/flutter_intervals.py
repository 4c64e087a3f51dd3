"""Intervals of the flutter speed: ``python backend/benchmarks/flutter_intervals.py``.

Campaigns of two maneuvers on FLEX-28 (eight-mode truth), simulated in time and in closed loop, in
still air and in turbulence. Derivatives of the prediction are wrong by 30 or 50 %, frequencies of
the finite element model by 3 %, or by .3 % in a model that was updated from a ground vibration
test and states it. The models of an oracle are true, and known to be. All maneuvers are estimated
by the proposed runs of output error, and flutter is predicted from one run and from both. Prints
one JSON line per kind of campaign: how many 95 % intervals hold the true flutter speed, and error
and half width relative to it. An argument sets the number of campaigns.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import sys
import tempfile
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.errors import FlexsidError
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.modal_data import ModalKind
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.model.reduction import FEM_FREQUENCY
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, analyse_flutter
from flexsid.workflow.runs.run_proposal import apply_proposal

FUEL = 0.5
AIRSPEEDS = ((0.50, 0.65), (0.65, 0.80), (0.80, 0.95))
AIR = (Turbulence.NONE, Turbulence.LIGHT, Turbulence.NONE, Turbulence.MODERATE)
PREDICTION_ERRORS = (0.3, 0.5)
FREQUENCY_ERRORS = {"wrong": 0.03, "updated": 0.003, "oracle": 1e-6}
CAMPAIGNS = 96  # a multiple of all combinations


@dataclass(frozen=True, slots=True)
class Campaign:
    """Errors of the models and maneuvers of one campaign."""

    seed: int
    models: str

    @property
    def airspeeds(self) -> tuple[float, float]:
        """Airspeeds over the flutter speed."""
        return AIRSPEEDS[self.seed % 3]

    @property
    def air(self) -> Turbulence:
        """Turbulence of both maneuvers."""
        return AIR[(self.seed // 3) % 4]

    @property
    def prediction_error(self) -> float:
        """Relative standard deviation of the errors of predicted derivatives."""
        if self.models == "oracle":
            return 0.0
        return PREDICTION_ERRORS[(self.seed // 12) % 2]


@dataclass(frozen=True, slots=True)
class Outcome:
    """A predicted flutter speed and half of its 95 % interval, over the true speed."""

    campaign: Campaign
    runs: str
    speed: float | None
    reach: float | None


def fly_campaign(campaign: Campaign) -> list[Outcome]:
    """Fly two maneuvers, estimate and predict flutter from each and from both."""
    truth = load_truth()
    true_speed = truth.flutter_speed_at(FUEL)
    with tempfile.TemporaryDirectory() as folder:
        address = f"sqlite:///{Path(folder) / 'flexsid.db'}"
        upgrade(address)
        store = Store.open(address)
        aircraft_id = add_wrong_models(store, campaign)
        flight = store.flights.add(Flight(aircraft_id=aircraft_id, number=1))
        ids = []
        for place, ratio in enumerate(campaign.airspeeds):
            flown = fly(
                airspeed_ratio=ratio,
                fuel=FUEL,
                peak_deg=2.0 if ratio < 0.9 else 1.6,
                seed=(4100, campaign.seed, place),
                turbulence=campaign.air,
            )
            maneuver = add_maneuver(store, flown, flight.id or 0)
            request = EstimationRun(
                maneuver_id=maneuver.id or 0,
                method=Method.OE,
                structure=Structure(fixed={}),
                settings=RunSettings(out_of_band_modes=OutOfBandModes.RETAINED),
            )
            run = execute_run(store, apply_proposal(store, request), RUN, lambda progress: None)
            ids.append(run.id or 0)
        outcomes = []
        for words, own in (("one", (ids[0],)), ("one", (ids[1],)), ("two", tuple(ids))):
            speed = reach = None
            try:
                found = analyse_flutter(store, FlutterQuery(run_ids=own))
            except FlexsidError:
                found = None
            if found and found.airspeed_m_s and found.low_m_s is not None and found.high_m_s:
                speed = found.airspeed_m_s / true_speed
                reach = 0.5 * (found.high_m_s - found.low_m_s) / true_speed
            outcomes.append(Outcome(campaign, words, speed, reach))
        store.close()
    return outcomes


def add_wrong_models(store: Store, campaign: Campaign) -> int:
    """Add FLEX-28 with wrong frequencies and predictions; return the aircraft's id."""
    rng = np.random.default_rng((4200, campaign.seed))
    known = add_aircraft(store).id or 0
    aircraft = store.aircraft.get(known)
    copy = store.aircraft.add(replace(aircraft, id=None, name="wrong models"))
    table = next(t for t in store.modal_tables.find(aircraft_id=known) if t.kind is ModalKind.FEM)
    omega = np.array(store.arrays.get(table.arrays["omega"]))
    error = FREQUENCY_ERRORS[campaign.models]
    arrays = table.arrays | {
        "omega": store.arrays.put(omega * (1.0 + error * rng.standard_normal(omega.shape[1])))
    }
    arrays.pop("omega_std", None)
    if campaign.models != "wrong":
        arrays["omega_std"] = store.arrays.put(error * omega)
    store.modal_tables.add(replace(table, id=None, aircraft_id=copy.id or 0, arrays=arrays))
    prediction = store.predictions.find(aircraft_id=known)[0]
    values = truth_of(prediction.names, prediction.fuel)
    wrong = values * (1.0 + campaign.prediction_error * rng.standard_normal(values.shape[1]))
    store.predictions.add(
        replace(prediction, id=None, aircraft_id=copy.id or 0, values=store.arrays.put(wrong))
    )
    return copy.id or 0


def truth_of(names: tuple[str, ...], fuel: tuple[float, ...]) -> np.ndarray:
    """Return the true derivatives (n_fuel, n_names)."""
    truth = load_truth()
    tables = [truth.derivatives_at(one, 8).named() for one in fuel]
    return np.array([[table[name] for name in names] for table in tables])


def main(campaigns: int) -> None:
    """Fly all campaigns in processes and print what holds."""
    every = [Campaign(seed, models) for models in FREQUENCY_ERRORS for seed in range(campaigns)]
    found: dict[tuple[str, bool, str], list[Outcome]] = defaultdict(list)
    with ProcessPoolExecutor() as pool:
        for outcomes in pool.map(fly_campaign, every):
            for one in outcomes:
                is_still = one.campaign.air is Turbulence.NONE
                found[one.campaign.models, is_still, one.runs].append(one)
    for (models, is_still, runs), outcomes in found.items():
        pairs = [(o.speed, o.reach) for o in outcomes if o.speed is not None]
        errors = np.array([speed - 1.0 for speed, _ in pairs])
        reach = np.array([half for _, half in pairs], dtype=float)
        print(
            json.dumps(
                {
                    "name": f"flutter_from_{runs}_{'still' if is_still else 'turbulence'}",
                    "models": models,
                    "frequency_error": FREQUENCY_ERRORS[models],
                    "frequency_std": FEM_FREQUENCY
                    if models == "wrong"
                    else FREQUENCY_ERRORS[models],
                    "held": int(np.sum(np.abs(errors) <= reach)),
                    "predicted": len(pairs),
                    "asked": len(outcomes),
                    "rms_error": float(f"{np.sqrt(np.mean(errors**2)):.3g}"),
                    "median_half_width": float(f"{np.median(reach):.3g}"),
                    "worst_errors_over_half_width": [
                        float(f"{x:.3g}") for x in np.sort(np.abs(errors) / reach)[-3:]
                    ],
                }
            ),
            flush=True,
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else CAMPAIGNS)
