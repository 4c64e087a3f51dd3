"""Fixtures: a finished run with simple numbers, a modal table and a prediction."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.records.run import (
    ErrorCauses,
    EstimationRun,
    Fit,
    FitBlock,
    Method,
    OutputQuality,
    ParameterEstimate,
    Pole,
    RunResult,
    RunState,
)
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import IterationStep

OMEGA = 2 * np.pi * np.array([2.0, 1.0, 4.0])  # not in order, as FRE may store them
MEASURED = np.array([[2.0 + 0j, 1j], [1.0 + 0j, 1j], [-1.0 + 1e-9j, 1j]])
FITTED = np.array([[1.0 + 0j, 1j], [1.0 + 0j, 1j], [-1.0 - 1e-9j, 1j]])


@pytest.fixture
def add_result(store: Store, add_run: Callable[..., EstimationRun]) -> Callable[..., EstimationRun]:
    """Add a run that succeeded with these (value, standard error) by name."""

    def add(
        estimates: dict[str, tuple[float, float | None]],
        method: Method = Method.OE,
        block: str = "OE",
        residualized: dict[str, float] | None = None,
        quality: tuple[OutputQuality, ...] = (),
        modal_std: dict[str, float] | None = None,
        components: tuple[tuple[float, ...], ...] = (),
        **changes: Any,
    ) -> EstimationRun:
        causes = None
        if components:
            causes = ErrorCauses(
                maneuver_ids=(1,),
                n_frequencies=(OMEGA.size,),
                omega=store.arrays.put(np.sort(OMEGA)),
                priors=("Cm_eta11 about 2",),
                components=store.arrays.put(np.array(components, dtype=np.float32)),
            )
        variances = [0.0 if sigma is None else sigma**2 for _, sigma in estimates.values()]
        result = RunResult(
            parameters=tuple(
                ParameterEstimate(
                    name=name, value=value, std_error=sigma, modal_std=(modal_std or {}).get(name)
                )
                for name, (value, sigma) in estimates.items()
            ),
            covariance=store.arrays.put(np.diag(variances)),
            fit=Fit(
                outcome="converged",
                message="",
                iterations=(IterationStep(iteration=0, cost=9.0, step=1.0),),
                cost=9.0,
                r_squared={"q": 0.9, "az_egi": 0.8},
                n_lines=3,
                n_parameters=len(estimates),
                seconds=0.1,
                start="equation-error",
                quality=quality,
            ),
            poles=(Pole(real=-1.0, imag=5.0), Pole(real=-1.0, imag=-5.0)),
            blocks=(
                FitBlock(
                    name=block,
                    outputs=("q", "az_egi"),
                    arrays={
                        "omega": store.arrays.put(OMEGA),
                        "measured": store.arrays.put(MEASURED),
                        "fitted": store.arrays.put(FITTED),
                    },
                ),
            ),
            residualized_prediction=residualized,
            prediction_id=changes.get("prediction_id"),
            error_causes=causes,
        )
        return add_run(method=method, state=RunState.SUCCEEDED, result=result, **changes)

    return add


@pytest.fixture
def modal_table(store: Store, aircraft: Aircraft) -> ModalTable:
    """Modes of which SW1B rises from 10 to 20 Hz with the fuel fraction."""
    assert aircraft.id is not None
    omega = 2 * np.pi * np.array([[10.0, 30.0, 40.0], [20.0, 30.0, 40.0]])
    return store.modal_tables.add(
        ModalTable(
            aircraft_id=aircraft.id,
            name="FEM",
            kind=ModalKind.FEM,
            fuel=(0.0, 1.0),
            numbers=(7, 8, 9),
            names=("SW1B", "AW1B", ""),
            symmetric=(True, False, True),
            arrays={
                "omega": store.arrays.put(omega),
                "zeta": store.arrays.put(np.full((2, 3), 0.02)),
            },
        )
    )


@pytest.fixture
def prediction(store: Store, aircraft: Aircraft) -> DerivativePrediction:
    """Prediction with Cm_alpha from -1 to -2 with the fuel fraction."""
    assert aircraft.id is not None
    return store.predictions.add(
        DerivativePrediction(
            aircraft_id=aircraft.id,
            source="vortex lattice",
            kind="panel code",
            fuel=(0.0, 1.0),
            names=("Cm_alpha", "Cm_q"),
            values=store.arrays.put(np.array([[-1.0, -8.0], [-2.0, -8.0]])),
        )
    )
