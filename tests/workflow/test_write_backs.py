"""Write back of a posterior: versions, priors of the next record, no data counted twice, undo."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flexsid.errors import BadInput, Conflict
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunResult, RunSettings
from flexsid.records.write_back import WriteBack
from flexsid.storage.store import Store
from flexsid.workflow.fits.estimation_task import EstimationTask
from flexsid.workflow.flutter.flutter_models import FlutterQuery, identify_query
from flexsid.workflow.modal_data.modal_tables import open_modes
from flexsid.workflow.runs.estimation import prepare
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.write_backs import propose_write_back, undo_write_back, write_back

pytestmark = pytest.mark.parametrize("backend", ["sqlite"])


@pytest.fixture
def flown(flown_url: str):
    store = Store.open(flown_url)
    yield store
    store.close()


def build_run(maneuver_id: int, **changes: Any) -> EstimationRun:
    run = EstimationRun(
        maneuver_id=maneuver_id,
        method=Method.EE,
        structure=Structure(modes=(7, 9), fixed={}),
        settings=RunSettings(),
    )
    return replace(run, **changes)


def estimate(store: Store, **changes: Any) -> tuple[int, EstimationRun, RunResult]:
    run = execute_run(store, build_run(1, **changes), RUN, lambda progress: None)
    assert run.id is not None
    assert run.result is not None
    return run.id, run, run.result


def add_record(store: Store) -> int:
    """Add another record, of the same samples and another id."""
    maneuver = store.maneuvers.add(replace(store.maneuvers.get(1), id=None, label="next"))
    for channel in store.channels.find(maneuver_id=1):
        store.channels.add(replace(channel, id=None, maneuver_id=maneuver.id))
    assert maneuver.id is not None
    return maneuver.id


def undo(store: Store, written: WriteBack, author: str) -> WriteBack:
    return undo_write_back(store, written.id or 0, author)


def prepare_default(store: Store, maneuver_id: int, **changes: Any) -> tuple[EstimationTask, int]:
    run = add_hashes(store, build_run(maneuver_id, **changes))
    assert run.modal_table_id is not None
    return prepare(store, run), run.modal_table_id


def test_the_next_record_starts_from_it_and_the_same_record_does_not(flown: Store) -> None:
    number, run, _ = estimate(flown)
    proposal = propose_write_back(flown, number)
    assert len(flown.write_backs.find()) == 0
    other = add_record(flown)
    before = prepare_default(flown, other)
    written = write_back(flown, number, " both methods agree ", "Ann")
    assert (written.reason, written.author) == ("both methods agree", "Ann")
    assert written.former_prediction_id == before[0].prediction_id
    assert written.former_modal_table_id == before[1] == run.modal_table_id
    task, table = prepare_default(flown, other)
    assert (task.prediction_id, table) == (written.prediction_id, written.modal_table_id)
    sentence = next(text for text in task.warnings if "write-back" in text)
    assert f"posterior of run {number}" in sentence
    assert "maneuver 1" in sentence
    version = flown.predictions.get(written.prediction_id)
    assert version.source == proposal.prediction == "Panel code (version 2)"
    same, same_table = prepare_default(flown, 1)
    assert (same.prediction_id, same_table) == (before[0].prediction_id, before[1])
    assert any("count twice" in text for text in same.warnings)
    with pytest.raises(BadInput, match="contains the data of maneuver 1") as refused:
        add_hashes(flown, build_run(1, prediction_id=written.prediction_id))
    assert refused.value.code == "counted-twice"
    with pytest.raises(BadInput, match="name the version before it"):
        add_hashes(flown, build_run(1, modal_table_id=written.modal_table_id))


def test_undo_makes_the_former_version_the_default_and_deletes_nothing(flown: Store) -> None:
    number, run, result = estimate(flown)
    other = add_record(flown)
    written = write_back(flown, number, "first try", "Ann")
    newer = prepare_default(flown, other)
    undone = undo(flown, written, "Bob")
    assert (undone.undone_by, undone.author) == ("Bob", "Ann")
    task, table = prepare_default(flown, other)
    assert (task.prediction_id, table) == (result.prediction_id, run.modal_table_id)
    assert task.written is None
    named = build_run(
        other, prediction_id=written.prediction_id, modal_table_id=written.modal_table_id
    )
    assert prepare(flown, named).prediction_id == newer[0].prediction_id
    with pytest.raises(Conflict, match="undone already"):
        undo(flown, written, "Bob")
    again = write_back(flown, number, "second try", "Ann")
    assert flown.predictions.get(again.prediction_id).source == "Panel code (version 3)"
    with pytest.raises(Conflict, match="written back already"):
        write_back(flown, number, "twice", "Ann")


def test_the_prior_is_the_joint_posterior_over_fuel(flown: Store) -> None:
    number, _, result = estimate(flown)
    posterior = result.posterior
    assert posterior is not None
    C = np.asarray(flown.arrays.get(posterior.covariance))
    other = add_record(flown)
    written = write_back(flown, number, "x")
    task, _ = prepare_default(flown, other, method=Method.OE, settings=RunSettings(prior_spread=1))
    priors = task.list_priors()
    names = ("CZ_alpha", "CQ7_eta7", task.nuisance_names[0])
    values = dict(zip(posterior.names, posterior.values, strict=True))
    assert [priors[name][0] for name in names] == pytest.approx([values[name] for name in names])
    assert priors.joint is not None
    joint = priors.joint.select(names)
    place = [posterior.names.index(name) for name in joint.names]
    own = C[np.ix_(place, place)]
    off = ~np.eye(3, dtype=bool)
    assert joint.covariance[off] == pytest.approx(own[off])
    # What the covariance of a run does not hold, such as the error of the modal table, is added.
    assert (np.diag(joint.covariance) >= 0.999 * np.diag(own)).all()
    plain, _ = prepare_default(flown, other, method=Method.OE)
    assert "CZ_alpha" not in plain.list_priors()  # estimates of several records stay independent
    version = flown.predictions.get(written.prediction_id)
    column = version.names.index("CQ7_eta7")
    assert version.std_errors is not None
    std = np.asarray(flown.arrays.get(version.std_errors))[:, column]
    change = np.asarray(flown.arrays.get(version.values))[:, column] - values["CQ7_eta7"]
    row = version.fuel.index(written.fuel_fraction)
    assert change[row] == pytest.approx(0.0, abs=1e-12)
    assert std**2 == pytest.approx(std[row] ** 2 + (0.3 * change) ** 2)


def test_estimated_frequencies_and_damping_change_the_modal_table(flown: Store) -> None:
    settings = RunSettings(priors={"omega_7": (1.0, 0.03), "zeta_7": (1.0, 0.5)})
    structure = Structure(modes=(7, 9), fixed={}, extra_parameters=("omega_7", "zeta_7"))
    number, _, result = estimate(flown, method=Method.OE, structure=structure, settings=settings)
    found = {one.name: one for one in result.parameters}
    written = write_back(flown, number, "x")
    before, after = (
        open_modes(flown, flown.modal_tables.get(own or 0))
        for own in (written.former_modal_table_id, written.modal_table_id)
    )
    column = before.table.numbers.index(7)
    factor = found["omega_7"]
    assert factor.std_error is not None
    assert after.omega_std is not None
    assert after.zeta is not None
    assert after.omega[:, column] == pytest.approx(factor.value * before.omega[:, column])
    # Runs use it independently of the derivatives, with which its error is correlated.
    relative = after.omega_std[:, column] / before.omega[:, column]
    assert relative == pytest.approx(np.sqrt(2.0) * factor.std_error)
    assert after.table.version == before.table.version + 1
    other = prepare(flown, add_hashes(flown, build_run(add_record(flown))))
    flown_damping = other.model.modes.zeta[other.model.modes.numbers.index(7)]
    assert flown_damping == pytest.approx(after.zeta[0, column])


def test_what_is_no_posterior_of_another_condition_is_refused(flown: Store) -> None:
    omitted = RunSettings(out_of_band_modes=OutOfBandModes.OMITTED)
    with pytest.raises(BadInput, match="omits modes"):
        write_back(flown, estimate(flown, settings=omitted)[0], "x")
    number, run, result = estimate(flown)
    with pytest.raises(BadInput, match="reason is empty"):
        write_back(flown, number, "  ")
    earlier = replace(result, posterior=None)
    flown.runs.replace(replace(run, result=earlier, result_hash=None))
    with pytest.raises(Conflict, match="no joint posterior"):
        write_back(flown, number, "x")


def test_no_record_counts_twice_in_a_fusion(flown: Store) -> None:
    number, _, _ = estimate(flown)
    write_back(flown, number, "x")
    later = execute_run(flown, build_run(add_record(flown)), RUN, lambda progress: None)
    assert later.id is not None
    with pytest.raises(BadInput, match=f"Leave out run {number}") as refused:
        identify_query(flown, FlutterQuery(run_ids=(number, later.id)))
    assert refused.value.code == "counted-twice"
    identify_query(flown, FlutterQuery(run_ids=(later.id,)))
