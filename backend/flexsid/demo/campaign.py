"""The demonstration campaign: three flights of FLEX-28, simulated and stored."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import date

from threadpoolctl import threadpool_limits

from flexsid.demo.aircraft import NAME, describe_aircraft, describe_controller
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import FlownManeuver, fly
from flexsid.demo.ground import simulate_ground_test
from flexsid.demo.sources import build_modal_tables, build_model_structures, build_predictions
from flexsid.demo.vibration_test import build_measured_responses
from flexsid.demo.whole_flight import add_uncut_flight
from flexsid.records.aircraft import Aircraft
from flexsid.records.flight import Flight
from flexsid.records.maneuver import Channel, Maneuver
from flexsid.storage.store import Store
from flexsid.workflow.flutter.controllers import add_controller
from flexsid.workflow.model_structures.model_structures import add_structure

Report = Callable[[float, str], None]
"""Called with the completed fraction and a message."""

SEED = 28


@dataclass(frozen=True, slots=True)
class Card:
    """One maneuver of the flight plan."""

    airspeed_ratio: float
    fuel: float
    fta: int

    @property
    def peak_deg(self) -> float:
        """Peak deflection, smaller where the response is larger. [deg]"""
        if self.airspeed_ratio > 1.0:
            return 1.2
        return 2.0 if self.airspeed_ratio < 0.9 else 1.6


@dataclass(frozen=True, slots=True)
class Sortie:
    """One flight of the plan; fuel burns from card to card."""

    number: int
    flown_on: date
    description: str
    cards: tuple[Card, ...]
    stiffness_lost: float = 0.0  # relative stiffness loss of the first bending mode in the flight

    @property
    def ground_fuel(self) -> tuple[float, float]:
        """Fuel on the runway before and after, with that of climb, approach and taxi."""
        return self.cards[0].fuel + 0.05, max(0.02, self.cards[-1].fuel - 0.05)


def _cards(*plan: tuple[float, float, int]) -> tuple[Card, ...]:
    return tuple(Card(*entry) for entry in plan)


PLAN = (
    Sortie(
        1,
        date(2025, 5, 13),
        "Clearance to 0.80 of the flutter speed, heavy",
        _cards(
            (0.56, 0.92, 503),
            (0.56, 0.86, 506),
            (0.65, 0.80, 503),
            (0.65, 0.74, 506),
            (0.72, 0.68, 503),
            (0.72, 0.62, 506),
            (0.80, 0.56, 503),
            (0.80, 0.50, 506),
        ),
    ),
    Sortie(
        2,
        date(2025, 5, 15),
        "Clearance to 0.95 of the flutter speed",
        _cards(
            (0.56, 0.66, 503),
            (0.56, 0.60, 506),
            (0.65, 0.55, 503),
            (0.65, 0.50, 506),
            (0.80, 0.42, 503),
            (0.80, 0.34, 506),
            (0.95, 0.22, 503),
            (0.95, 0.12, 506),
        ),
        stiffness_lost=0.06,
    ),
    Sortie(
        3,
        date(2025, 5, 22),
        "Through the flutter speed under control of the loop",
        _cards(
            (0.80, 0.90, 506),
            (0.95, 0.80, 503),
            (0.95, 0.72, 506),
            (1.02, 0.64, 503),
            (1.02, 0.57, 506),
            (1.09, 0.50, 506),
            (1.09, 0.42, 503),
            (1.09, 0.25, 506),
            (0.65, 0.15, 506),
        ),
    ),
)
_FIRST_CARD_S = 600.0
_BETWEEN_CARDS_S = 90.0


def add_campaign(store: Store, report: Report | None = None, seed: int = SEED) -> int:
    """Simulate and store the missing maneuvers of the campaign.

    Parameters
    ----------
    store
        A migrated store.
    report
        Called with the completed fraction and a message after every maneuver.
    seed
        The same seed gives the same samples.

    Returns
    -------
    int
        Number of maneuvers added.
    """
    report_progress = report or (lambda fraction, message: None)
    aircraft = add_aircraft(store)
    missing = _find_missing(store, aircraft, seed)
    add_uncut_flight(store, aircraft, seed)
    if missing:
        report_progress(0.0, f"flying {len(missing)} maneuvers")
    else:
        report_progress(1.0, "the campaign is complete")
    flown = _fly_all([task.order for task in missing])
    for count, (task, maneuver) in enumerate(zip(missing, flown, strict=True), start=1):
        add_maneuver(store, maneuver, task.flight_id)
        report_progress(count / len(missing), f"flown {maneuver.label}")
    return len(missing)


def add_aircraft(store: Store) -> Aircraft:
    """Store FLEX-28 with modal tables, predictions and model structures, if missing."""
    known = store.aircraft.find(name=NAME)
    if known:
        return known[0]
    truth = load_truth()
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
        maneuver = store.maneuvers.add(
            Maneuver(
                aircraft_id=store.flights.get(flight_id).aircraft_id,
                flight_id=flight_id,
                label=flown.label,
                start_s=flown.start_s,
                duration_s=flown.duration_s,
                condition=flown.condition,
                fta=flown.fta,
                axis=flown.axis,
                excitation=flown.excitation,
                airspeed_ratio=flown.airspeed_ratio,
                max_input_correlation=flown.max_input_correlation,
                note=flown.note,
            )
        )
        for channel in flown.channels:
            store.channels.add(
                Channel(
                    name=channel.name,
                    unit=channel.unit,
                    role=channel.role,
                    rate_hz=channel.rate_hz,
                    start_s=flown.start_s,
                    n_samples=channel.samples.size,
                    array=store.arrays.put(channel.samples, channel.unit),
                    maneuver_id=maneuver.id,
                )
            )
    return maneuver


@dataclass(frozen=True, slots=True)
class _GroundRecord:
    fuel: float
    stiffness_lost: float


@dataclass(frozen=True, slots=True)
class _Order:
    card: Card | _GroundRecord
    seed: tuple[int, ...]
    start_s: float
    label: str


@dataclass(frozen=True, slots=True)
class _Task:
    flight_id: int
    order: _Order


def _find_missing(store: Store, aircraft: Aircraft, seed: int) -> list[_Task]:
    """Return the cards that are not stored yet, e.g. after an interruption."""
    tasks = []
    for sortie in PLAN:
        flight = _flight(store, aircraft, sortie)
        assert flight.id is not None
        present = {maneuver.label for maneuver in store.maneuvers.find(flight_id=flight.id)}
        orders = [
            _Order(
                card,
                (seed, sortie.number, place),
                _FIRST_CARD_S + place * _BETWEEN_CARDS_S,
                f"{sortie.number}-{place + 1:02d} FTA {card.fta}",
            )
            for place, card in enumerate(sortie.cards)
        ]
        orders += _ground_records(sortie, seed)
        tasks += [_Task(flight.id, order) for order in orders if order.label not in present]
    # ground records last, so that the cards have the first numbers
    return sorted(tasks, key=lambda task: isinstance(task.order.card, _GroundRecord))


def _ground_records(sortie: Sortie, seed: int) -> list[_Order]:
    """Return ground records before take-off and after landing; the second shows damage."""
    landed_s = _FIRST_CARD_S + len(sortie.cards) * _BETWEEN_CARDS_S + 300.0
    before, after = sortie.ground_fuel
    return [
        _Order(
            _GroundRecord(before, 0.0),
            (seed, sortie.number, 100),
            -300.0,
            f"{sortie.number} mini-GVT before flight",
        ),
        _Order(
            _GroundRecord(after, sortie.stiffness_lost),
            (seed, sortie.number, 101),
            landed_s,
            f"{sortie.number} mini-GVT after flight",
        ),
    ]


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


def _fly_all(orders: Sequence[_Order]) -> Iterator[FlownManeuver]:
    """Simulate in order, in several processes if there are at least four maneuvers."""
    if len(orders) < 4:
        yield from map(_fly_card, orders)
        return
    context = multiprocessing.get_context("spawn")
    # One thread each: the matrices are small. More than four processes take longer to start.
    processes = min(4, os.cpu_count() or 1)
    with ProcessPoolExecutor(
        max_workers=processes, mp_context=context, initializer=threadpool_limits, initargs=(1,)
    ) as pool:
        try:
            yield from pool.map(_fly_card, orders)
        finally:
            pool.shutdown(cancel_futures=True)


def _fly_card(order: _Order) -> FlownManeuver:
    if isinstance(order.card, _GroundRecord):
        return simulate_ground_test(
            fuel=order.card.fuel,
            stiffness_lost=order.card.stiffness_lost,
            seed=order.seed,
            start_s=order.start_s,
            label=order.label,
        )
    return fly(
        airspeed_ratio=order.card.airspeed_ratio,
        fuel=order.card.fuel,
        fta=order.card.fta,
        peak_deg=order.card.peak_deg,
        seed=order.seed,
        start_s=order.start_s,
        label=order.label,
    )
