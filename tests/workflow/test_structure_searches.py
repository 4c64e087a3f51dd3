"""Model structure searches over flown maneuvers, and runs of their candidates."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import fly
from flexsid.errors import BadInput, Conflict
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.modal_data import ModalTable
from flexsid.records.run import AdequacyState, Method, RunState
from flexsid.records.search import InitialTerms, SearchSettings, StructureSearch
from flexsid.storage.store import Store
from flexsid.sysid.simulation.turbulence import Turbulence
from flexsid.workflow.structure_determination.searches import (
    compute_search,
    create_candidate_run,
    get_result,
    prepare_search,
)
from flexsid.workflow.structure_determination.term_search import HoldingRun

ABSENT = (
    "CZ_eta9", "CZ_etadot9", "CZ_wf2s", "Cm_eta7", "Cm_etadot9", "Cm_bfs", "CQ7_q",
    "CQ7_etadot9", "CQ7_wf1s", "CQ9_alpha", "CQ9_q", "CQ9_etadot7", "CQ9_bfs",
)  # fmt: skip
SPEEDS = (0.65, 0.7, 0.75)


@pytest.fixture(scope="module")
def flown_store(migrated_file: Path, tmp_path_factory: pytest.TempPathFactory):
    """Three maneuvers of FLEX-28 with two modes and without the terms above."""
    file = tmp_path_factory.mktemp("searched") / "searched.db"
    file.write_bytes(migrated_file.read_bytes())
    store = Store.open(f"sqlite:///{file}")
    aircraft = add_aircraft(store)
    for table in store.modal_tables.find():
        store.modal_tables.replace(select_modes(store, table, (7, 9)))
    flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
    for number, ratio in enumerate(SPEEDS):
        flown = fly(
            airspeed_ratio=ratio, modes_in_truth=2, seed=number, label=f"m{number}", absent=ABSENT
        )
        add_maneuver(store, flown, flight.id or 0)
    yield store
    store.close()


def select_modes(store: Store, table: ModalTable, numbers: tuple[int, ...]) -> ModalTable:
    """Return a modal table without the other modes."""
    inside = [table.numbers.index(number) for number in numbers]
    arrays = dict(table.arrays)
    for name in set(arrays) - {"nodes", "lines", "shown", "shown_lines", "node_ids"}:
        values = store.arrays.get(arrays[name])
        arrays[name] = store.arrays.put(np.ascontiguousarray(values[:, inside]), "")
    of_modes = ("numbers", "names", "symmetric", "reasons")
    retained: dict[str, Any] = {
        n: tuple(getattr(table, n)[k] for k in inside) for n in of_modes if getattr(table, n)
    }
    return replace(table, arrays=arrays, **retained)


def build_search(
    method: Method, maneuvers: tuple[int, ...] = (1,), **settings: Any
) -> StructureSearch:
    return StructureSearch(
        aircraft_id=1,
        maneuver_ids=maneuvers,
        method=method,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=replace(SearchSettings(resamplings=4), **settings),
    )


@pytest.mark.parametrize("method", Method)
def test_every_method_finds_the_terms_of_a_flown_maneuver(flown_store: Store, method: Method):
    progress = []
    result = compute_search(prepare_search(flown_store, build_search(method)), progress.append)
    assert result.undecided == ""
    proposed = result.proposed
    assert proposed is not None
    assert sorted(proposed.structure.absent) == sorted(ABSENT)
    assert proposed.n_terms == 44 - len(ABSENT)
    assert proposed is result.candidates[0], "the true structure also predicts best"
    # of two modes that fly, not eight
    assert proposed.flutter_m_s == pytest.approx(70.1, abs=1.0)
    assert result.sentence.startswith(f"{method.value} over m0 supports 31 of 44 terms")
    assert [step.fraction for step in progress] == sorted(step.fraction for step in progress)
    terms = {term.name: term for group in result.groups for term in group.terms}
    assert set(terms) == set(proposed.structure.free or ()) | set(ABSENT)
    assert all((terms[name].stability or 0.0) <= 0.5 for name in ABSENT)
    assert terms["CZ_alpha"].stability == 1.0


def test_turbulence_hides_no_absent_terms(flown_store: Store):
    """With the noise that feedback brings to the surfaces every absent term seems significant."""
    flown = fly(
        airspeed_ratio=0.8,
        modes_in_truth=2,
        seed=5,
        label="turbulence",
        absent=ABSENT,
        turbulence=Turbulence.LIGHT,
    )
    maneuver = add_maneuver(flown_store, flown, flight_id=1)
    request = build_search(Method.OE, (maneuver.id or 0,))
    proposed = compute_search(prepare_search(flown_store, request), lambda progress: None).proposed
    assert proposed is not None
    assert len(set(ABSENT) - set(proposed.structure.absent)) <= 2
    assert abs((proposed.flutter_m_s or 0.0) - 70.1) < 2.0 * (proposed.flutter_std_m_s or 0.0)


def test_nothing_is_proposed_where_a_test_rejects_the_model_with_all_terms(flown_store: Store):
    """With a derivative held at a wrong value the terms compensate it."""
    wrong = 0.7 * load_truth().derivatives_at(0.5, 2).named()["Cm_alpha"]
    request = build_search(Method.OE)
    structure = replace(request.structure, fixed={"Cm_alpha": wrong})
    task = prepare_search(flown_store, replace(request, structure=structure))
    result = compute_search(task, lambda progress: None)
    assert result.proposed is None
    full = max(result.candidates, key=lambda one: one.n_terms)
    assert full.adequacy is AdequacyState.SUSPECT
    assert result.undecided == (
        f"the tests of a run reject the model with all terms. {full.adequacy_reason}"
    )
    assert result.sentence == f"Not decided: {result.undecided}"


def test_terms_that_a_stored_run_holds_are_not_proposed_for_removal(flown_store: Store):
    task = prepare_search(flown_store, build_search(Method.OE))
    assert not task.held
    held = {"CQ7_q": HoldingRun(12, 5.0)}
    result = compute_search(replace(task, held=held), lambda progress: None)
    assert result.proposed is not None
    assert "CQ7_q" not in result.proposed.structure.absent
    assert "CQ7_q stays, since run 12 holds it at 5 standard errors." in result.warnings


def test_search_over_a_campaign_is_cross_validated(flown_store: Store):
    request = build_search(
        Method.OE,
        (1, 2),
        validate_on=(3,),
        initial_terms=InitialTerms.EQUATION_ERROR,
        resamplings=2,
    )
    result = compute_search(prepare_search(flown_store, request), lambda progress: None)
    assert result.proposed is not None
    assert sorted(result.proposed.structure.absent) == sorted(ABSENT)
    assert [one.name for one in result.proposed.predicted] == ["m2"]
    assert (result.proposed.predicted[0].r_squared or 0.0) > 0.8


def test_candidate_run_is_created_once(flown_store: Store):
    result = compute_search(
        prepare_search(flown_store, build_search(Method.EE)), lambda progress: None
    )
    waiting = flown_store.searches.add(build_search(Method.EE, (1, 2)))
    with pytest.raises(Conflict, match="has no result yet"):
        get_result(waiting)
    stored = flown_store.searches.add(
        replace(build_search(Method.EE, (1, 2)), state=RunState.SUCCEEDED, result=result)
    )
    assert stored.id is not None
    assert flown_store.searches.get(stored.id).result == result
    run = create_candidate_run(flown_store, stored.id, 0, "ada")
    assert create_candidate_run(flown_store, stored.id, 0, "bob") == run
    assert run.structure == result.candidates[0].structure
    assert run.settings.additional_maneuver_ids == (2,)
    assert run.author == "ada"


def test_invalid_searches_are_refused(flown_store: Store):
    for request, message in (
        (build_search(Method.EE, ()), "at least one maneuver"),
        (build_search(Method.EE, (1, 1)), "named twice"),
        (build_search(Method.EE, (1,), validate_on=(1,)), "for the search and for validation"),
        (build_search(Method.EE, f_in=2.0), "f_out 20 is above f_in 2"),
    ):
        with pytest.raises(BadInput, match=message):
            prepare_search(flown_store, request)
