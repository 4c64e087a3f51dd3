"""Predictions for an excitation design: accuracy, comparison with classic inputs, amplitudes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends

from flexsid.api.context import TheStore
from flexsid.api.parameters import query_as
from flexsid.api.router import make_router
from flexsid.api.serialization import Json
from flexsid.api.submission import add_job_routes
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import AMPLITUDES, INPUT_COMPARISON, OPTIMAL_DESIGN, PREDICTED_ACCURACY
from flexsid.records.views import ExpectedMode
from flexsid.storage.store import Store
from flexsid.workflow.excitation.amplitude_optimisation import AmplitudeQuery, OptimisedAmplitudes
from flexsid.workflow.excitation.classic_inputs import InputComparison
from flexsid.workflow.excitation.optimal_designs import (
    OptimalDesign,
    OptimalDesignQuery,
)
from flexsid.workflow.excitation.predicted_accuracy import DesignQuery, ExpectedErrors

router = make_router("/designs/{design_id}", tag="designs")


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedSummary:
    """Expected signal of the modes, correlation of the surface deflections, information by input.

    ``information`` is the information of the harmonics of each input, as a number of parameters.
    """

    modes: list[ExpectedMode]
    surfaces: list[str]
    correlation: list[list[float]]
    information: dict[str, float]


TheDesignQuery = Annotated[DesignQuery, Depends(query_as(DesignQuery, "design_id"))]
TheAmplitudeQuery = Annotated[AmplitudeQuery, Depends(query_as(AmplitudeQuery, "design_id"))]
TheOptimalDesignQuery = Annotated[
    OptimalDesignQuery, Depends(query_as(OptimalDesignQuery, "design_id"))
]


def _get_title(store: Store, query: DesignQuery) -> str:
    return store.designs.get(query.design_id).name


for _path, _kind, _name in (
    ("/predicted-accuracy", PREDICTED_ACCURACY, "predicted_accuracy"),
    ("/classic-inputs", INPUT_COMPARISON, "input_comparison"),
    ("/amplitudes", AMPLITUDES, "amplitudes"),
    ("/optimal-design", OPTIMAL_DESIGN, "optimal_design"),
):
    add_job_routes(router, _path, _kind, _name, _get_title, "design_id")


@router.get("/expected-errors", response_model=ExpectedErrors)
def get_expected_errors(store: TheStore, query: TheDesignQuery) -> Json:
    """Return the stored standard errors of the derivatives of a run for this excitation."""
    return Json(get_result(store, PREDICTED_ACCURACY, query).errors)


@router.get("/expected-response", response_model=ExpectedSummary)
def get_expected_response(store: TheStore, query: TheDesignQuery) -> Json:
    """Return the stored signal-to-noise ratio of the modes and correlation of the surfaces."""
    found = get_result(store, PREDICTED_ACCURACY, query).response
    return Json(
        ExpectedSummary(
            modes=list(found.modes),
            surfaces=list(found.surfaces),
            correlation=found.correlation.tolist(),
            information={name: float(one.sum()) for name, one in found.information.items()},
        )
    )


@router.get("/classic-inputs", response_model=InputComparison)
def get_input_comparison(store: TheStore, query: TheDesignQuery) -> Json:
    """Return the stored comparison with doublets, 3-2-1-1s and sweeps of equal limits."""
    return Json(get_result(store, INPUT_COMPARISON, query))


@router.get("/amplitudes", response_model=OptimisedAmplitudes)
def get_amplitudes(store: TheStore, query: TheAmplitudeQuery) -> Json:
    """Return the stored amplitudes of minimax relative standard error, and D-optimal ones.

    Limits: largest deflection of any surface [rad], its rate [rad/s] and load factor [g], feedback
    included; if omitted, those of the design. ``levels`` are amplitudes by airspeed within them.
    """
    return Json(get_result(store, AMPLITUDES, query))


@router.get("/optimal-design", response_model=OptimalDesign)
def get_optimal_design(store: TheStore, query: TheOptimalDesignQuery) -> Json:
    """Return the stored gain of the design that is optimal for an objective within limits.

    Objectives: ``flutter`` speed, ``derivatives`` by name, ``damping`` of a mode, and
    ``structures``, the distance of the run's model structure from the smaller one of another run.
    Limits: deflection [rad], rate [rad/s] and load factor [g]; if omitted, those of the design.
    """
    return Json(get_result(store, OPTIMAL_DESIGN, query))
