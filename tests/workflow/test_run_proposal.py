"""Proposed runs: model structure and band by the excitation, with reasons."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_imports import import_maneuver
from rigid_record import simulate_doublet, write_record

from flexsid.demo.campaign import add_maneuver
from flexsid.demo.flights import fly
from flexsid.errors import BadInput
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import ModelStructure, Structure
from flexsid.records.run import (
    Batch,
    EstimationRun,
    Method,
    ProposalSource,
    RunSettings,
    RunState,
)
from flexsid.records.search import SearchSettings, StructureSearch
from flexsid.storage.store import Store
from flexsid.workflow.comparison.derivative_comparison import compare
from flexsid.workflow.model_structures.model_structures import add_structure
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import apply_proposal, attach_proposal_basis, propose_run
from flexsid.workflow.runs.run_templates import queue_batch
from flexsid.workflow.structure_determination.searches import add_search
from flexsid.workflow.validation.cross_prediction import predict_maneuver
from flexsid.workflow.views.run import compute_plot_matrix

WIDE, NARROW = 1, 2  # FTA 506 to 13.7 Hz, FTA 503 to 5.4 Hz


@pytest.fixture(scope="module")
def both_bands(flown_file: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Add a maneuver of FTA 503."""
    file = tmp_path_factory.mktemp("bands") / "flown.db"
    shutil.copy(flown_file, file)
    store = Store.open(f"sqlite:///{file}")
    add_maneuver(store, fly(fta=503, label="narrow"), 1)
    store.close()
    return file


@pytest.fixture
def bands(both_bands: Path, tmp_path: Path) -> Iterator[Store]:
    file = tmp_path / "flown.db"
    shutil.copy(both_bands, file)
    store = Store.open(f"sqlite:///{file}")
    yield store
    store.close()


def _build_run(maneuver: int, method: Method = Method.EE, **structure: Any) -> EstimationRun:
    structure.setdefault("fixed", {})
    return EstimationRun(
        maneuver_id=maneuver,
        method=method,
        structure=Structure(**structure),
        settings=RunSettings(),
    )


def test_modes_in_the_band_are_proposed(bands: Store) -> None:
    narrow, wide = propose_run(bands, [NARROW]), propose_run(bands, [WIDE])
    assert narrow.structure.modes == (7,)
    assert wide.structure.modes == (7, 9)
    assert narrow.basis.source is ProposalSource.BAND
    assert narrow.basis.band_hz == pytest.approx((0.25, 5.42), abs=0.01)
    inside, above, *_ = narrow.modes
    assert (inside.name, inside.in_band, inside.proposed) == ("SW1B", True, True)
    assert (above.name, above.in_band, above.proposed) == ("SW1T", False, False)
    assert above.frequency_hz == pytest.approx(10.8, abs=0.2)
    assert "SW1T" in narrow.basis.reasons[-1]
    assert "is omitted" in narrow.basis.reasons[-1]


def test_proposal_lists_data_requirements(bands: Store) -> None:
    found = propose_run(bands, [NARROW])
    # CZ, Cm and CQ7 by alpha, q, eta7, etadot7 and five surfaces.
    assert (found.n_parameters, found.n_lines) == (27, 125)
    assert found.lines_per_input == dict.fromkeys(found.inputs, 25)
    assert found.lines_per_parameter == pytest.approx(125 / 9)
    assert found.resolution_hz == pytest.approx(1 / 24, rel=1e-3)
    assert found.modes[0].half_power_hz > found.resolution_hz
    assert found.warnings == ()
    assert "q" in found.outputs
    few = propose_run(bands, [WIDE], (1.0, 1.6))
    assert any("excited frequencies for the" in text for text in few.warnings)


def test_given_band_takes_precedence(bands: Store) -> None:
    assert propose_run(bands, [WIDE], (0.25, 5.4)).structure.modes == (7,)
    assert propose_run(bands, [WIDE], (0.25, 1.5)).structure.modes == ()


def test_maneuvers_fitted_together_have_the_modes_of_the_widest_band(bands: Store) -> None:
    assert propose_run(bands, [NARROW, WIDE]).structure.modes == (7, 9)


def test_band_of_unknown_excitation_is_that_of_moving_surfaces(
    bands: Store,
) -> None:
    bands.maneuvers.replace(replace(bands.maneuvers.get(NARROW), excitation=None))
    found = propose_run(bands, [NARROW])
    assert found.structure.modes == (7,)
    assert found.settings.band_hz == found.basis.band_hz
    assert 4.5 < found.basis.band_hz[1] < 7.0
    assert prepare(bands, apply_proposal(bands, _build_run(NARROW))).max_omega > 0


def test_a_model_of_unknown_excitation_has_that_band_without_a_run(bands: Store) -> None:
    bands.maneuvers.replace(replace(bands.maneuvers.get(NARROW), excitation=None))
    assert compute_plot_matrix(bands, NARROW, modes=(7,)).samples.size
    elsewhere = execute_run(bands, _build_run(WIDE, modes=(7,)), RUN, lambda _progress: None)
    assert elsewhere.settings.band_hz is None
    assert predict_maneuver(bands, elsewhere, NARROW).spectra.omega.size


def test_maneuvers_with_and_without_known_excitation_share_a_band(bands: Store) -> None:
    bands.maneuvers.replace(replace(bands.maneuvers.get(NARROW), excitation=None))
    low, high = propose_run(bands, [WIDE, NARROW]).settings.band_hz or (0.0, 0.0)
    assert low <= 0.25
    assert high == pytest.approx(13.7, abs=0.1), "all harmonics of the other one"


def test_saved_structure_of_the_fta_takes_precedence_over_the_band(bands: Store) -> None:
    saved = add_structure(
        bands, ModelStructure(aircraft_id=1, name="rigid", structure=Structure(fixed={}))
    )
    asked = replace(_build_run(NARROW), structure_id=saved.id, structure_version=1)
    done = execute_run(bands, asked, RUN, lambda _progress: None)
    assert done.state is RunState.SUCCEEDED
    basis = propose_run(bands, [NARROW]).basis
    assert (basis.source, basis.structure_id, basis.run_id) == (
        ProposalSource.SAVED_STRUCTURE,
        saved.id,
        done.id,
    )
    assert propose_run(bands, [WIDE]).basis.source is ProposalSource.BAND


def test_a_run_records_the_proposal_that_it_follows(bands: Store) -> None:
    followed = apply_proposal(bands, _build_run(NARROW))
    assert followed.proposal is not None
    assert (
        attach_proposal_basis(bands, _build_run(NARROW, modes=(7,))).proposal == followed.proposal
    )
    assert attach_proposal_basis(bands, _build_run(NARROW, modes=(7, 9))).proposal is None
    same = add_hashes(bands, _build_run(NARROW, modes=(7,)))
    assert same.input_hash == add_hashes(bands, followed).input_hash


def test_modes_above_the_band_are_warned_of_on_the_run(bands: Store) -> None:
    (warning,) = prepare(bands, _build_run(NARROW, modes=(7, 9))).warnings
    assert warning.startswith("SW1T (10")
    assert "lies above the highest fitted" in warning


def test_maneuver_without_model_has_no_proposal(bands: Store) -> None:
    bands.maneuvers.replace(replace(bands.maneuvers.get(NARROW), axis="lateral"))
    with pytest.raises(BadInput, match="a lateral model has antisymmetric surfaces"):
        propose_run(bands, [NARROW])


def test_the_three_methods_agree_on_what_is_proposed(bands: Store) -> None:
    """With the first two symmetric modes 9 of 44 agreed, and a pole of EE was unstable."""
    ids = []
    for method in Method:
        run = apply_proposal(bands, _build_run(NARROW, method))
        done = execute_run(bands, run, RUN, lambda _progress: None)
        assert done.state is RunState.SUCCEEDED, done.error
        assert done.id is not None
        assert done.result is not None
        assert all(pole.real < 0.0 for pole in done.result.poles)
        ids.append(done.id)
    verdict = compare(bands, ids, []).runs_verdict
    assert verdict.n_judged == 27
    assert verdict.n_consistent >= 12


@pytest.mark.parametrize("backend", ["sqlite"])
def test_a_surface_that_rests_is_no_input_of_any_request(store: Store, tmp_path: Path) -> None:
    columns = simulate_doublet()
    columns["canard"] = np.random.default_rng(1).normal(0.0, 1e-3, columns["t"].size)
    record, mapping = write_record(tmp_path, columns)
    text = mapping.read_text()
    text = text.replace('{ name = "elevator" }', '{ name = "elevator" }, { name = "canard" }')
    text += '[[channels]]\ncolumn = "canard"\nunit = "rad"\nrole = "input"\n'
    maneuver = import_maneuver(store, [record], text)
    assert maneuver.id is not None
    request = replace(_build_run(maneuver.id), structure=Structure(modes=()))
    template = replace(request, structure=Structure(modes=(), absent=("CZ_q",)))
    methods, templates = (Method.EE,), (template,)
    queue_batch(
        store, Batch(name="b"), (maneuver.id,), methods, templates, from_equation_error=False
    )
    search = add_search(
        store,
        StructureSearch(
            aircraft_id=maneuver.aircraft_id,
            maneuver_ids=(maneuver.id,),
            method=Method.EE,
            structure=Structure(modes=()),
            settings=SearchSettings(resamplings=0),
        ),
    )
    (of_batch,) = store.runs.find(maneuver_id=maneuver.id)
    for found in (
        apply_proposal(store, request),
        attach_proposal_basis(store, request),
        of_batch,
        search,
    ):
        assert found.structure.inputs == ("elevator",)
    named = replace(request, structure=Structure(modes=(), inputs=("elevator", "canard")))
    assert attach_proposal_basis(store, named).structure.inputs == ("elevator", "canard")
