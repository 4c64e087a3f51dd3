"""The demonstration campaign: complete, reproducible, and without changes to existing data."""

from __future__ import annotations

import itertools
import os
import shutil
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from waiting import wait_until

from flexsid.demo.campaign import (
    PLAN,
    UNSTEADY_PLAN,
    Card,
    add_aircraft,
    add_campaign,
    add_maneuver,
)
from flexsid.demo.campaign_process import CampaignProcess
from flexsid.demo.flex28 import INPUTS
from flexsid.demo.flights import fly
from flexsid.errors import FlexsidError
from flexsid.jobs.health import PartHealth, PartState
from flexsid.records.maneuver import Flight, Maneuver, Role
from flexsid.records.quality import GroundTestVerdict
from flexsid.storage import bulk
from flexsid.storage.store import Store
from flexsid.workflow.quality.ground_records import (
    compare_all_ground_records,
    compare_ground_records,
)


def test_plan_covers_the_envelope():
    cards = [card for sortie in PLAN for card in sortie.cards]
    assert len(PLAN) >= 3
    assert len(cards) >= 24
    assert min(card.airspeed_ratio for card in cards) == 0.56
    assert max(card.airspeed_ratio for card in cards) == 1.09
    assert {card.fta for card in cards} == {503, 506}
    assert len({card.fuel for card in cards}) > 10
    assert Card(0.65, 0.50, 506) in cards
    assert Card(1.09, 0.50, 506) in cards


@pytest.fixture
def whole(campaign: Path, tmp_path: Path) -> Iterator[Store]:
    """The campaign in an empty workbench."""
    file = tmp_path / "campaign.db"
    shutil.copy(campaign, file)
    assert file.stat().st_size < 250e6
    opened = Store.open(f"sqlite:///{file}")
    yield opened
    opened.close()


def _list_priorities() -> set[int]:
    """List the nice values of the processes of this test that simulate a campaign; jobs have 5."""
    children = (file.read_text().split() for file in Path("/proc/self/task").glob("*/children"))
    found = set()
    for number in itertools.chain.from_iterable(children):
        with suppress(OSError):
            if "flexsid.demo.campaign_process" in Path(f"/proc/{number}/cmdline").read_text():
                found.add(os.getpriority(os.PRIO_PROCESS, int(number)))
    return found


def test_the_server_simulates_missing_maneuvers_beside_itself(whole: Store):
    last = whole.maneuvers.find()[-1]
    with whole.transaction():
        assert last.id is not None
        whole.maneuvers.replace(replace(last, label="renamed"))
    heard: list[tuple[float, str]] = []
    # pyrefly: ignore[bad-argument-type]
    process = CampaignProcess(whole.database.url.render_as_string(), lambda *one: heard.append(one))
    shown = process.check_health()
    assert shown is not None
    assert shown.state is PartState.STARTING
    process.start()
    try:
        wait_until(lambda: _list_priorities() == {19}, "the lowest priority of the simulation")
        wait_until(lambda: process.check_health() is None, "the end of the simulation")
    finally:
        process.stop()
    assert heard[-1][0] == 1.0
    assert last.label in {one.label for one in whole.maneuvers.find()}


def test_an_interrupted_simulation_is_reported(tmp_path: Path):
    process = CampaignProcess(f"sqlite:///{tmp_path}/missing.db", lambda *one: None)
    process.start()
    try:
        shown = wait_until(lambda: _read_last_health(process), "the end of the simulation")
        assert shown.state is PartState.DEGRADED
        assert "Start flexsid demo again" in shown.text
    finally:
        process.stop()


def test_the_campaign_is_complete_and_one_flight_was_damaged(whole: Store):
    cards = sum(len(sortie.cards) for sortie in PLAN)
    assert len(whole.maneuvers.find()) == cards + 2 * len(PLAN)
    assert len(whole.maneuver_page(limit=None).items) == cards, "the ground is not listed"
    assert len(whole.maneuver_page(limit=None, ground=True).items) == 2 * len(PLAN)
    damaged = [sortie.number for sortie in PLAN if sortie.stiffness_lost]
    found = {test.flight_number: test for test in compare_all_ground_records(whole)}
    assert len(found) == len(PLAN)
    assert [n for n, t in found.items() if t.verdict is GroundTestVerdict.ALARM] == damaged
    assert {t.verdict for n, t in found.items() if n not in damaged} == {GroundTestVerdict.HEALTHY}
    assert "Inspect the structure" in found[damaged[0]].message
    assert add_campaign(whole) == 0


def test_a_ground_test_follows_corrections_of_its_records(whole: Store):
    first = compare_all_ground_records(whole)[0]
    after = whole.maneuvers.get(first.after_id)
    less = replace(after.condition, fuel_fraction=after.condition.fuel_fraction - 0.01)
    whole.maneuvers.replace(replace(after, condition=less))
    changed = compare_ground_records(whole, first.flight_id)
    assert changed.fuel_after == less.fuel_fraction
    assert changed.peaks != first.peaks
    whole.maneuvers.replace(after)
    assert compare_ground_records(whole, first.flight_id) == first


def test_campaign_is_added_once_without_changes_to_user_data(
    store: Store, monkeypatch: pytest.MonkeyPatch
):
    sortie = replace(PLAN[2], cards=PLAN[2].cards[:1])
    monkeypatch.setattr("flexsid.demo.campaign.PLAN", (sortie,))
    reported: list[tuple[float, str]] = []
    added = add_campaign(store, lambda fraction, message: reported.append((fraction, message)))
    assert added == 3 == len(store.maneuvers.find())
    assert [fraction for fraction, _ in reported] == sorted(fraction for fraction, _ in reported)
    assert reported[-1][0] == 1.0

    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    own = store.flights.add(Flight(aircraft_id=aircraft.id, number=77, description="mine"))
    assert own.id is not None
    add_maneuver(store, fly(fta=503, noise=False, label="mine"), own.id)
    dropped = store.maneuvers.find(label="3-01 FTA 506")[0]
    before = _first_samples(store, dropped)
    assert dropped.id is not None
    store.maneuvers.delete(dropped.id)

    # An interrupted campaign is completed with the same noise.
    assert add_campaign(store) == 1
    again = store.maneuvers.find(label="3-01 FTA 506")[0]
    np.testing.assert_array_equal(_first_samples(store, again), before)
    assert add_campaign(store) == 0
    assert len(store.aircraft.find()) == 1
    assert len(store.modal_tables.find()) == 2
    assert len(store.predictions.find()) == 2
    assert [structure.name for structure in store.model_structures.find()] == [
        "SP + SW1B",
        "SP + SW1B + SW1T",
        "SP + four modes",
    ]
    assert store.maneuvers.find(flight_id=own.id)[0].label == "mine"

    # Maneuvers that the user deleted are not added again.
    assert again.id is not None
    bulk.change_maneuvers(store, [again.id], bulk.Action.DELETE)
    assert add_campaign(store) == 0
    labels = {item.label for item in store.maneuver_page(limit=None).items}
    assert "mine" in labels
    assert "3-01 FTA 506" not in labels


def test_the_aircraft_with_unsteady_forces_has_a_campaign_of_its_own(
    store: Store, monkeypatch: pytest.MonkeyPatch
):
    sortie = replace(UNSTEADY_PLAN[0], cards=UNSTEADY_PLAN[0].cards[:1])
    monkeypatch.setattr("flexsid.demo.campaign.UNSTEADY_PLAN", (sortie,))
    assert add_campaign(store, unsteady=True) == 1
    assert add_campaign(store, unsteady=True) == 0
    assert [aircraft.name for aircraft in store.aircraft.find()] == ["FLEX-28U"]
    lattice = store.predictions.find(source="Doublet lattice")[0]
    assert lattice.unsteady is not None
    assert lattice.unsteady.reference_k == 0.15
    assert store.maneuvers.find()[0].airspeed_ratio == pytest.approx(0.5, rel=2e-3)


def _first_samples(store: Store, maneuver: Maneuver) -> np.ndarray:
    channel = store.channels.find(maneuver_id=maneuver.id, name="q")[0]
    return store.arrays.get(channel.array)


def test_stored_maneuver_has_condition_excitation_and_three_rates(store: Store):
    aircraft = add_aircraft(store)
    assert aircraft.id is not None
    flight = store.flights.add(Flight(aircraft_id=aircraft.id, number=9))
    assert flight.id is not None
    flown = fly(fta=503, modes_in_truth=2, seed=4, start_s=600.0, label="three rates")
    stored = add_maneuver(store, flown, flight.id)
    assert stored == store.maneuvers.get(stored.id or 0)
    assert stored.airspeed_ratio == pytest.approx(0.65, rel=2e-3)
    assert stored.condition.fuel_fraction == pytest.approx(0.5, abs=1e-4)
    assert stored.condition.alpha_rad == pytest.approx(0.06, abs=0.01)
    assert stored.excitation is not None
    assert stored.excitation.start_s == 602.0
    assert {len(own) for own in stored.excitation.harmonics.values()} == {25}
    assert stored.max_input_correlation is not None
    assert stored.max_input_correlation < 0.1

    channels = {channel.name: channel for channel in store.channels.find(maneuver_id=stored.id)}
    assert len(channels) == 5 + 45 + 5 + 8
    assert {channel.rate_hz for channel in channels.values()} == {1000.0, 200.0, 20.0}
    for channel in channels.values():
        assert channel.start_s == stored.start_s
        assert channel.n_samples / channel.rate_hz == pytest.approx(stored.duration_s)
        samples = store.arrays.get(channel.array)
        assert samples.dtype == np.float32
        assert samples.shape == (channel.n_samples,)
        assert np.isfinite(samples).all()
    assert {name for name, c in channels.items() if c.role is Role.INPUT} == set(INPUTS)
    assert {name for name, c in channels.items() if c.role is Role.COMMAND} == {
        f"{name}_command" for name in INPUTS
    }


def test_maneuver_without_flight_is_rejected(store: Store):
    with pytest.raises(FlexsidError):
        add_maneuver(store, fly(fta=503, noise=False), 12345)
    assert store.channels.find() == []


def _read_last_health(process: CampaignProcess) -> PartHealth | None:
    shown = process.check_health()
    return None if shown is None or shown.state is PartState.STARTING else shown
