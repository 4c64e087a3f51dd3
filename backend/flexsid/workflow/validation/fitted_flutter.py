"""Flutter prediction of a fit from its parameters and their covariance, without a database."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from flexsid.sysid.estimation.parameters import Parameters
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction, predict_flutter
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.sysid.stability.state_family import Aeroelastic
from flexsid.workflow.fits.estimation_task import EstimationTask

_BAND = (0.35, 2.0)  # of the airspeed flown: range of the flutter search


def predict_flutter_of_fit(
    task: EstimationTask,
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    covariance: Float[np.ndarray, "n_theta n_theta"],
) -> FlutterPrediction:
    """Predict flutter at the density of the first maneuver by the model with these parameters."""
    model, table = task.model, parameters.table(theta)
    names = list(model.derivative_names)
    own = [k for k, name in enumerate(parameters.names) if name in names]
    places = np.array([names.index(parameters.names[k]) for k in own], dtype=int)
    rows, columns = np.divmod(places, len(model.variables))
    modes = model.modes.tuned(dict(zip(parameters.names, theta.tolist(), strict=True)))
    found = IdentifiedModes(
        Aeroelastic(model.condition, modes, table, model.shape),
        UncertainDerivatives(rows, columns, covariance[np.ix_(own, own)]),
    )
    airspeed = model.condition.airspeed
    labels = dict(zip(map(str, model.modes.numbers), task.mode_names, strict=True))
    return predict_flutter(found, (_BAND[0] * airspeed, _BAND[1] * airspeed), called=labels)
