"""The demonstration campaigns of FLEX-28 and of FLEX-28U, simulated and stored."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from datetime import date
from functools import partial
from math import radians

from threadpoolctl import threadpool_limits

from flexsid.demo.aircraft import describe_aircraft, describe_controller
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import FlownManeuver, add_uncut_flight, fly
from flexsid.demo.sources import (
    build_measured_responses,
    build_modal_tables,
    build_model_structures,
    build_predictions,
    simulate_ground_test,
)
from flexsid.demo.truth_flight import FaultKind, SurfaceFault
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Channel, Flight, Maneuver
from flexsid.storage.store import Store
from flexsid.workflow.flutter.controllers import add_controller
from flexsid.workflow.model_structures.model_structures import add_structure

Report = Callable[[float, str], None]
"""Called with the completed fraction and a message."""

SEED = 28

RECORD, REPEAT = "1-04 FTA 506", "5-01 FTA 506"
"""Maneuver of the first sheet, and the one that repeats it at another fuel."""


@dataclass(frozen=True, slots=True)
class Card:
    """One maneuver of the flight plan; ``amplitude`` is relative to that of its airspeed."""

    airspeed_ratio: float
    fuel: float
    fta: int
    amplitude: float = 1.0
    n_periods: int = 1
    fault: SurfaceFault | None = None

    @property
    def peak_deg(self) -> float:
        """Peak deflection, smaller where the response is larger. [deg]"""
        if self.airspeed_ratio > 1.0:
            return 1.2 * self.amplitude
        return (2.0 if self.airspeed_ratio < 0.9 else 1.6) * self.amplitude


@dataclass(frozen=True, slots=True)
class Sortie:
    """One flight of the plan; fuel burns from card to card."""

    number: int
    flown_on: date
    description: str
    cards: tuple[Card, ...]
    stiffness_lost: float = 0.0  # relative stiffness loss of the first bending mode in the flight


_UNCOMMANDED = SurfaceFault(
    kind=FaultKind.OSCILLATING, surface="wf1s", amplitude=radians(0.3), frequency_hz=6.3
)
PLAN = (
    Sortie(
        1,
        date(2025, 5, 13),
        "Clearance to 0.80 of the flutter speed, heavy",
        (
            *(Card(0.56, 0.92, 503), Card(0.56, 0.86, 506)),
            *(Card(0.65, 0.80, 503), Card(0.65, 0.74, 506)),
            *(Card(0.72, 0.68, 503), Card(0.72, 0.62, 506)),
            *(Card(0.80, 0.56, 503), Card(0.80, 0.50, 506)),
        ),
    ),
    Sortie(
        2,
        date(2025, 5, 15),
        "Clearance to 0.95 of the flutter speed",
        (
            *(Card(0.56, 0.66, 503), Card(0.56, 0.60, 506)),
            *(Card(0.65, 0.55, 503), Card(0.65, 0.50, 506)),
            *(Card(0.80, 0.42, 503), Card(0.80, 0.34, 506)),
            *(Card(0.95, 0.22, 503), Card(0.95, 0.12, 506)),
        ),
        stiffness_lost=0.06,
    ),
    Sortie(
        3,
        date(2025, 5, 22),
        "Through the flutter speed under control of the loop",
        (
            Card(0.80, 0.90, 506),
            *(Card(0.95, 0.80, 503), Card(0.95, 0.72, 506)),
            *(Card(1.02, 0.64, 503), Card(1.02, 0.57, 506)),
            *(Card(1.09, 0.50, 506), Card(1.09, 0.42, 503), Card(1.09, 0.25, 506)),
            Card(0.65, 0.15, 506),
        ),
    ),
    Sortie(
        5,
        date(2025, 5, 27),
        "Amplitudes, repeated periods, and surfaces that do not follow",
        (
            *(Card(0.65, 0.62, 506, amplitude=0.5), Card(0.65, 0.58, 506, amplitude=2.0)),
            Card(0.65, 0.54, 506, n_periods=2),
            Card(0.65, 0.48, 506, fault=SurfaceFault(kind=FaultKind.STUCK, surface="wf2s")),
            Card(0.65, 0.44, 506, fault=_UNCOMMANDED),
        ),
    ),
)
UNSTEADY_PLAN = (
    Sortie(
        1,
        date(2025, 6, 3),
        "Clearance to 0.95 of the flutter speed",
        (
            Card(0.50, 0.70, 506),
            *(Card(0.65, 0.64, 503), Card(0.65, 0.60, 506)),
            *(Card(0.80, 0.52, 503), Card(0.80, 0.46, 506)),
            *(Card(0.95, 0.36, 503), Card(0.95, 0.30, 506)),
        ),
    ),
)
"""Of FLEX-28U; its structure is that of FLEX-28, and has no records on the ground."""

_FIRST_CARD_S = 600.0
_BETWEEN_CARDS_S = 90.0


def add_campaign(
    store: Store,
    report: Report | None = None,
    seed: int = SEED,
    *,
    unsteady: bool = False,
    niceness: int = 0,
) -> int:
    """Simulate and store the missing maneuvers of the campaign.

    Parameters
    ----------
    store
        A migrated store.
    report
        Called with the completed fraction and a message after every maneuver.
    seed
        The same seed gives the same samples.
    unsteady
        True for the campaign of FLEX-28U, whose air forces lag the motion.
    niceness
        Of the processes that simulate, once they have those of the first sheet.

    Returns
    -------
    int
        Number of maneuvers added.
    """
    report_progress = report or (lambda fraction, message: None)
    aircraft = add_aircraft(store, unsteady=unsteady)
    missing = _find_missing(store, aircraft, seed, unsteady=unsteady)
    if missing:
        report_progress(0.0, f"{len(missing)} maneuvers to simulate")
    flown = _fly_all([simulate for _, simulate in missing], niceness)
    for count, ((flight_id, _), one) in enumerate(zip(missing, flown, strict=True), start=1):
        maneuver = add_maneuver(store, one, flight_id)
        # Complete with the uncut flight.
        report_progress(
            count / (len(missing) + 1), f"{count} of {len(missing)} maneuvers, {maneuver.label}"
        )
    if not unsteady:
        add_uncut_flight(store, aircraft, seed)
    report_progress(1.0, "the campaign is complete")
    return len(missing)


def add_aircraft(store: Store, *, unsteady: bool = False) -> Aircraft:
    """Store FLEX-28 or FLEX-28U with modal tables, predictions and structures, if missing."""
    truth = load_truth(unsteady=unsteady)
    known = store.aircraft.find(name=truth.name)
    if known:
        return known[0]
    with store.transaction():
        aircraft = store.aircraft.add(describe_aircraft(truth))
        assert aircraft.id is not None
        for table in build_modal_tables(truth, aircraft.id, store.arrays.put):
            store.modal_tables.add(table)
        store.measured_responses.add(build_measured_responses(truth, aircraft.id, store.arrays.put))
        for prediction in build_predictions(truth, aircraft.id, store.arrays.put):
            store.predictions.add(prediction)
        for structure in build_model_structures(aircraft.id):
            add_structure(store, structure)
        add_controller(store, describe_controller(truth, aircraft.id))
    return aircraft


def add_maneuver(store: Store, flown: FlownManeuver, flight_id: int) -> Maneuver:
    """Store a simulated maneuver with all channels in one transaction."""
    with store.transaction():
        aircraft_id = store.flights.get(flight_id).aircraft_id
        maneuver = store.maneuvers.add(
            replace(flown.maneuver, aircraft_id=aircraft_id, flight_id=flight_id)
        )
        for channel in flown.channels:
            fields = channel.save(store.arrays.put)
            store.channels.add(Channel(maneuver_id=maneuver.id, start_s=maneuver.start_s, **fields))
    return maneuver


_Simulation = partial[FlownManeuver]


def _find_missing(
    store: Store, aircraft: Aircraft, seed: int, *, unsteady: bool
) -> list[tuple[int, _Simulation]]:
    """Return flight and simulation of what is not stored yet, e.g. after an interruption."""
    missing = []
    for sortie in UNSTEADY_PLAN if unsteady else PLAN:
        flight = _flight(store, aircraft, sortie)
        assert flight.id is not None
        present = {maneuver.label for maneuver in store.maneuvers.find(flight_id=flight.id)}
        records = list(_simulate_cards(sortie, seed, unsteady=unsteady))
        if not unsteady:
            records += _simulate_ground_records(sortie, seed)
        missing += [(flight.id, one) for one in records if one.keywords["label"] not in present]
    # First what the first sheet rests on; ground records last, so that cards have low numbers.
    labels = [simulate.keywords["label"] for _, simulate in missing]
    n_first = labels.index(RECORD) + 1 if RECORD in labels else 0

    def rank(entry: tuple[int, tuple[int, _Simulation]]) -> int:
        place, (_, simulate) = entry
        if place < n_first or simulate.keywords["label"] == REPEAT:
            return 0
        return 2 if simulate.func is simulate_ground_test else 1

    return [entry for _, entry in sorted(enumerate(missing), key=rank)]


def _simulate_cards(sortie: Sortie, seed: int, *, unsteady: bool) -> Iterator[_Simulation]:
    for number, card in enumerate(sortie.cards):
        yield partial(
            fly,
            airspeed_ratio=card.airspeed_ratio,
            fuel=card.fuel,
            fta=card.fta,
            peak_deg=card.peak_deg,
            n_periods=card.n_periods,
            fault=card.fault,
            seed=(seed, sortie.number, number),
            start_s=_FIRST_CARD_S + number * _BETWEEN_CARDS_S,
            label=f"{sortie.number}-{number + 1:02d} FTA {card.fta}",
            unsteady=unsteady,
        )


def _simulate_ground_records(sortie: Sortie, seed: int) -> Iterator[_Simulation]:
    """Yield the records before take-off and after landing; the second shows damage."""
    landed_s = _FIRST_CARD_S + len(sortie.cards) * _BETWEEN_CARDS_S + 300.0
    # Climb, approach and taxi burn fuel too.
    before, after = sortie.cards[0].fuel + 0.05, max(0.02, sortie.cards[-1].fuel - 0.05)
    for number, when, fuel, lost, start_s in (
        (100, "before", before, 0.0, -300.0),
        (101, "after", after, sortie.stiffness_lost, landed_s),
    ):
        yield partial(
            simulate_ground_test,
            fuel=fuel,
            stiffness_lost=lost,
            seed=(seed, sortie.number, number),
            start_s=start_s,
            label=f"{sortie.number} mini-GVT {when} flight",
        )


def _flight(store: Store, aircraft: Aircraft, sortie: Sortie) -> Flight:
    assert aircraft.id is not None
    known = store.flights.find(aircraft_id=aircraft.id, number=sortie.number)
    if known:
        return known[0]
    return store.flights.add(
        Flight(
            aircraft_id=aircraft.id,
            number=sortie.number,
            flown_on=sortie.flown_on,
            description=sortie.description,
        )
    )


def _simulate(one: _Simulation, niceness: int = 0) -> FlownManeuver:
    if niceness and hasattr(os, "nice"):
        os.nice(niceness - os.nice(0))
    return one()


def _prepare_process() -> None:
    # Ctrl-C reaches the whole process group; the parent ends its processes.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threadpool_limits(1)


def _fly_all(simulations: Sequence[_Simulation], niceness: int) -> Iterator[FlownManeuver]:
    """Simulate in order; after the first sheet in several processes, if four maneuvers are left."""
    labels = [one.keywords["label"] for one in simulations]
    n_first = labels.index(REPEAT) + 1 if REPEAT in labels else 0
    # Starting the processes takes longer than these.
    yield from map(_simulate, simulations[:n_first])
    rest = simulations[n_first:]
    if len(rest) < 4:
        yield from map(_simulate, rest)
        return
    context = multiprocessing.get_context("spawn")
    # One thread each: the matrices are small. More than four processes take longer to start.
    processes = min(4, os.cpu_count() or 1)
    with ProcessPoolExecutor(
        max_workers=processes, mp_context=context, initializer=_prepare_process
    ) as pool:
        try:
            yield from pool.map(partial(_simulate, niceness=niceness), rest)
        finally:
            pool.shutdown(cancel_futures=True)
