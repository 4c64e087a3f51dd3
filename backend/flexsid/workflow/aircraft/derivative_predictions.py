"""Predictions: derivatives of other sources at the fuel of a maneuver."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.prediction import DerivativePrediction
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import derivative_names
from flexsid.sysid.modes.table import interpolate


def prediction_at(
    store: Store, prediction: DerivativePrediction, fuel: float
) -> dict[str, tuple[float, float | None]]:
    """Value and standard error (None where not given) of every predicted derivative."""
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


def predicted_modes(prediction: DerivativePrediction, known: Iterable[int]) -> tuple[int, ...]:
    """Modes whose generalised force the prediction covers."""
    return tuple(mode for mode in known if f"CQ{mode}_alpha" in prediction.names)


def best_prediction(
    store: Store,
    aircraft_id: int,
    prediction_id: int | None,
    modes: tuple[int, ...],
    inputs: tuple[str, ...],
) -> DerivativePrediction | None:
    """The prediction asked for, or the one that covers most of these derivatives.

    Raises
    ------
    BadInput
        If the prediction asked for belongs to another aircraft.
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
    wanted = set(derivative_names(modes, inputs))
    covering = [p for p in known if wanted & set(p.names)]
    return max(covering, key=lambda p: len(wanted & set(p.names)), default=None)
