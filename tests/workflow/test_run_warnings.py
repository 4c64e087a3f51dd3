"""Refused requests, and warnings about the model of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flexsid.demo.flex28 import load_truth
from flexsid.errors import BadInput
from flexsid.records.decision import Structure
from flexsid.records.run import EstimationRun, Method, OutOfBandModes, RunSettings
from flexsid.storage.store import Store
from flexsid.workflow.fits.computation import compute_run
from flexsid.workflow.fits.estimation_task import EstimationTask
from flexsid.workflow.runs.estimation import prepare

Ask = Callable[..., EstimationTask]


@pytest.fixture
def ask(flown_url: str) -> Iterator[Ask]:
    store = Store.open(flown_url)

    def prepared(
        method: Method, modes: tuple[int, ...] = (7, 9), **structure: Any
    ) -> EstimationTask:
        structure.setdefault("fixed", {})
        return prepare(
            store,
            EstimationRun(
                maneuver_id=1,
                method=method,
                structure=Structure(modes=modes, **structure),
                settings=RunSettings(out_of_band_modes=OutOfBandModes.OMITTED),
            ),
        )

    yield prepared
    store.close()


def test_antisymmetric_mode_raises_a_warning(ask: Ask) -> None:
    (warning,) = ask(Method.OE, modes=(7, 8)).warnings
    assert warning.startswith("AW1B is not symmetric")
    assert ask(Method.OE).warnings == ()


def test_omitted_excited_inputs_raise_a_warning(ask: Ask) -> None:
    (warning,) = ask(Method.OE, inputs=("bfs", "wf1s", "wf3s", "wf4s")).warnings
    assert warning.startswith("wf2s is excited too")


@pytest.mark.parametrize("inputs", [("wf4s",), ("bfs", "wf1s")])
def test_frequency_response_error_of_some_inputs_finds_the_truth(
    ask: Ask, inputs: tuple[str, ...]
) -> None:
    task = ask(Method.FRE, inputs=inputs)
    assert task.model.inputs == inputs
    assert task.warnings == ()
    found = compute_run(task, lambda progress: None).estimate
    assert {block.name for block in found.lines} == set(inputs)
    truth = load_truth().derivatives_at(0.5, 2).named()
    expected = np.array([truth[name] for name in found.names])
    error = (found.values - expected) / found.std_errors
    assert np.mean(np.abs(error) <= 2.0) >= 0.85
    assert 0.5 < np.sqrt(np.mean(error**2)) < 1.4


@pytest.mark.parametrize("method", [Method.EE, pytest.param(Method.OE, marks=pytest.mark.long)])
def test_a_surface_with_the_wrong_sign_is_named(ask: Ask, flown_url: str, method: Method) -> None:
    def list_reversed() -> list[str]:
        warnings = compute_run(ask(method, modes=(7,)), lambda progress: None).warnings
        return [text for text in warnings if "opposite sign" in text]

    assert list_reversed() == []
    store = Store.open(flown_url)
    (channel,) = store.channels.find(maneuver_id=1, name="wf3s")
    turned = -np.asarray(store.arrays.get(channel.array))
    with store.transaction():
        array = store.arrays.put(turned, channel.unit)
        store.channels.replace(replace(channel, array=array))
    store.close()
    (warning,) = list_reversed()
    assert warning.startswith("The derivatives of wf3s are -")


def test_frequency_responses_need_the_deflection_of_every_excited_input(
    ask: Ask, flown_url: str
) -> None:
    store = Store.open(flown_url)
    channel = store.channels.find(maneuver_id=1, name="wf2s")[0]
    with store.transaction():
        store.channels.delete(channel.id or 0)
    task = ask(Method.FRE, inputs=("bfs", "wf1s"))
    with pytest.raises(BadInput, match="assigned to none of bfs, wf1s, wf3s, wf4s") as refused:
        compute_run(task, lambda progress: None)
    assert refused.value.code == "inputs-excluded"
    store.close()


def test_equation_error_holds_delays_that_the_other_methods_estimate(ask: Ask) -> None:
    task = ask(Method.EE, free_delays=True)
    assert task.warnings == ("Equation error holds the delays; OE and FRE estimate them.",)
    found = compute_run(task, lambda progress: None)
    assert not any(name.startswith("delay_") for name in found.estimate.names)
    assert "delay_q" in ask(Method.OE, free_delays=True).extras


def test_extra_parameters_of_equation_error_are_refused(ask: Ask) -> None:
    with pytest.raises(BadInput, match="'omega_7' needs OE or FRE"):
        ask(Method.EE, extra_parameters=("omega_7",))


def test_error_of_a_shape_without_mode_has_the_syntax(ask: Ask) -> None:
    with pytest.raises(BadInput, match="shape_<output>_<mode>, such as shape_alpha_7"):
        ask(Method.OE, extra_parameters=("shape_xyz",))
