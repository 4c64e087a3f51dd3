"""Grey-box fits of python-control's frequency responses, and their models for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from flexsid.errors import BadInput
from flexsid.sysid.grey_box.fit import GreyBoxEstimate, fit_grey_box, list_response_data
from flexsid.sysid.grey_box.model import GreyBox
from flexsid.sysid.signals import FrequencyResponse

if TYPE_CHECKING:
    import control


def fit_frequency_response_data(
    model: GreyBox,
    data: control.FrequencyResponseData,
    std: np.ndarray | None = None,
    condition: Any = None,
) -> tuple[control.StateSpace, GreyBoxEstimate]:
    """Fit a grey-box model to frequency responses of python-control.

    Parameters
    ----------
    model
        Model with as many inputs and outputs as the data, in their order.
    data
        Responses, ``control.FrequencyResponseData`` or ``control.frequency_response(...)``.
    std
        Standard deviations of their complex errors, of the shape of ``data.frdata`` (outputs,
        inputs, frequencies); by default equal at all frequencies of a response. Only their
        course over frequency matters.
    condition
        Given to the function of the model.

    Returns
    -------
    system, estimate
        ``control.StateSpace`` with the fitted parameters, and these with standard errors.

    Raises
    ------
    BadInput
        If the data have other numbers of inputs or outputs.
    NotIdentifiable
        As ``fit_grey_box``.
    """
    omega, values = np.asarray(data.omega, dtype=float), np.asarray(data.frdata)
    shape = len(model.outputs), len(model.inputs)
    if values.shape[:2] != shape:
        raise BadInput(
            f"the data have {values.shape[0]} outputs and {values.shape[1]} inputs; "
            f"'{model.title}' has {shape[0]} and {shape[1]}",
            code="other-channels",
        )
    if std is not None and np.shape(std) != values.shape:
        raise BadInput(
            f"std has the shape {np.shape(std)}; expected {values.shape}", code="wrong-shape"
        )
    response = FrequencyResponse(
        omega,
        values.transpose(2, 0, 1).astype(complex),
        tuple(model.outputs),
        tuple(model.inputs),
        None if std is None else np.asarray(std, dtype=float).transpose(2, 0, 1),
    )
    estimate = fit_grey_box(model, list_response_data([response], model), condition)
    return estimate.matrices.to_control(), estimate
