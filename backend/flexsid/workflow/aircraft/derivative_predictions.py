"""Predicted derivatives at the fuel fraction of a maneuver."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.prediction import DerivativePrediction
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import list_derivative_names
from flexsid.sysid.modes.table import interpolate


def interpolate_prediction(
    store: Store, prediction: DerivativePrediction, fuel: float
) -> dict[str, tuple[float, float | None]]:
    """Interpolate value and standard error (None where not given) of predicted derivatives."""
    at = np.array(prediction.fuel, dtype=float)
    values = interpolate(at, np.asarray(store.arrays.get(prediction.values)), fuel)
    errors: list[float | None] = [None] * len(prediction.names)
    if prediction.std_errors is not None:
        table = interpolate(at, np.asarray(store.arrays.get(prediction.std_errors)), fuel)
        errors = [float(e) if np.isfinite(e) else None for e in table]
    return {
        name: (float(value), error)
        for name, value, error in zip(prediction.names, values, errors, strict=True)
        if np.isfinite(value)
    }


def list_predicted_modes(prediction: DerivativePrediction, known: Iterable[int]) -> tuple[int, ...]:
    """List the modes whose generalised force the prediction covers."""
    return tuple(mode for mode in known if f"CQ{mode}_alpha" in prediction.names)


def select_prediction(
    store: Store,
    aircraft_id: int,
    prediction_id: int | None,
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
) -> DerivativePrediction | None:
    """Select the requested prediction, or the one that covers most of these derivatives.

    Raises
    ------
    BadInput
        If the requested prediction belongs to another aircraft.
    """
    known = store.predictions.find(aircraft_id=aircraft_id)
    if prediction_id is not None:
        for prediction in known:
            if prediction.id == prediction_id:
                return prediction
        raise BadInput(
            f"prediction {prediction_id} does not belong to the aircraft of the maneuver",
            code="wrong-prediction",
            prediction_id=prediction_id,
        )
    names = set(list_derivative_names(modes, inputs))
    covering = [p for p in known if names & set(p.names)]
    return max(covering, key=lambda p: len(names & set(p.names)), default=None)
