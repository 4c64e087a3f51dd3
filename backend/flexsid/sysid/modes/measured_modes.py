"""Modes of a structure from measured frequency responses, with their standard deviations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flexsid.errors import BadInput
from flexsid.sysid.modes.modal_model import POWERS, fit_modal_model
from flexsid.sysid.modes.polyreference import PoleColumn


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredModes:
    """Modes identified in the band of frequency responses.

    ``omega`` are natural frequencies [rad/s], ``damping`` damping ratios [1], ``std_omega`` and
    ``std_damping`` their standard deviations by the covariance of the estimator. ``shapes``
    (n_modes, n_outputs) are per unit eta: of one kg m2 of generalised mass where ``scaled`` (a
    driving point was measured), else of largest component one. ``fitted`` is the response of
    these modes and of the out-of-band modes, ``unmodelled`` are frequencies where the residuals
    resemble a mode that is not identified [rad/s].
    """

    omega: Float[np.ndarray, " n_modes"]
    damping: Float[np.ndarray, " n_modes"]
    std_omega: Float[np.ndarray, " n_modes"]
    std_damping: Float[np.ndarray, " n_modes"]
    shapes: Complex[np.ndarray, "n_modes n_outputs"]
    scaled: bool
    fitted: Complex[np.ndarray, "n_omega n_outputs n_references"]
    unmodelled: Float[np.ndarray, " n_unmodelled"]


def identify_modes(
    omega: Float[np.ndarray, " n_omega"],
    responses: Complex[np.ndarray, "n_omega n_outputs n_references"],
    columns: tuple[PoleColumn, ...],
    quantity: str,
    driving: tuple[tuple[int, int], ...] = (),
    line_correlation: float = 1.0,
    std: Float[np.ndarray, "n_omega n_outputs n_references"] | None = None,
    *,
    is_fixed: bool = False,
) -> MeasuredModes:
    """Identify the modes in the band of frequency responses by maximum likelihood.

    Parameters
    ----------
    omega
        Frequencies, all positive. [rad/s]
    responses
        ``displacement``, ``velocity`` or ``acceleration``, as ``quantity`` states, per force.
    columns
        Stable poles, the start values; modes that are missing there are added.
    driving
        Pairs (output, reference) at one point in one direction; they give the scale.
    line_correlation, std
        Of the noise over frequency, see ``fit_modal_model``.
    is_fixed
        Whether the modes are those of ``columns``; none is added or removed.

    Raises
    ------
    BadInput
        If there is no mode, or the quantity is unknown.

    Notes
    -----
    Estimator and covariance: see ``fit_modal_model``.
    """
    if quantity not in POWERS:
        raise BadInput(
            f"a response is of {', '.join(POWERS)}, not '{quantity}'", code="bad-quantity"
        )
    n_in = responses.shape[2]
    model, unmodelled = fit_modal_model(
        omega,
        responses,
        quantity,
        np.array([column.value for column in columns], dtype=complex),
        np.array([column.participation for column in columns], dtype=complex).reshape(-1, n_in),
        line_correlation,
        std,
        is_fixed=is_fixed,
    )
    std_omega, std_damping = model.compute_std()
    size = np.abs(model.poles)
    inside = (size >= omega[0]) & (size <= omega[-1])
    if not inside.any():
        raise BadInput(
            "the responses do not differ from noise by any mode in this band; take a wider band, "
            "or check that they are frequency responses per force",
            code="no-modes",
        )
    poles = model.poles[inside]
    shapes, scaled = _scale_shapes(
        model.shapes[inside], model.participation[inside], poles, driving
    )
    return MeasuredModes(
        omega=np.abs(poles),
        damping=-np.real(poles) / np.abs(poles),
        std_omega=std_omega[inside],
        std_damping=std_damping[inside],
        shapes=shapes,
        scaled=scaled,
        fitted=model.fitted,
        unmodelled=unmodelled,
    )


def _scale_shapes(
    psi: Complex[np.ndarray, "n_modes n_outputs"],
    part: Complex[np.ndarray, "n_modes n_references"],
    roots: Complex[np.ndarray, " n_modes"],
    driving: tuple[tuple[int, int], ...],
) -> tuple[Complex[np.ndarray, "n_modes n_outputs"], bool]:
    """Scale shapes to unit generalised mass by a driving point, else to largest one.

    A residue of a structure with proportional damping is phi_o phi_d / (2 j omega_d m); at a
    driving point it gives phi_d itself.
    """
    if not driving:
        largest = np.argmax(np.abs(psi), axis=1)
        return psi / psi[np.arange(psi.shape[0]), largest][:, None], False
    # The driving point with the largest motion in a mode gives its scale.
    outputs, references = np.array(driving).T
    best = np.argmax(np.abs(psi[:, outputs] * part[:, references]), axis=1)
    modes = np.arange(psi.shape[0])
    residue = part[modes, references[best]] * 2j * np.imag(roots)
    at_point = np.sqrt(psi[modes, outputs[best]] * residue + 0j)
    return psi * (residue / at_point)[:, None], True
