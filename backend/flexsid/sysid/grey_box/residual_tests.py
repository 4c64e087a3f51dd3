"""Tests of the residuals of a grey-box model, and the poles of the model with standard errors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
import scipy
from jaxtyping import Complex, Float

from flexsid.sysid.adequacy.several_tests import adjust_by_holm
from flexsid.sysid.estimation.estimate import whiteness
from flexsid.sysid.grey_box.fit import GreyBoxData, GreyBoxEstimate
from flexsid.sysid.stability.poles import compute_polar_slopes
from flexsid.sysid.stability.transfer_function import TransferFunctionRoot

_PER_INPUT = 12  # frequencies of a band, by input: a response that is missing is smooth over them
_LEAST_POWER = 1e-3  # of the largest singular value: inputs that do not move in a band


class ResidualTest(StrEnum):
    """What a test of residuals rejects."""

    WHITENESS = "residuals are correlated over frequency"
    RESPONSE = "residuals are a response to the inputs"


@dataclass(frozen=True, slots=True, kw_only=True)
class ResidualTestResult:
    """One test of the residuals of an output.

    ``p`` is the probability of such residuals of a correct model, ``adjusted_p`` in view of all
    tests of the fit (Holm).
    """

    test: ResidualTest
    output: str
    band_hz: tuple[float, float]
    p: float
    adjusted_p: float = 1.0

    @property
    def rejects(self) -> bool:
        """Whether the model is rejected."""
        # Loads much of scipy, of the start of every command that reads records.
        from flexsid.sysid.adequacy.model_tests import FALSE_ALARM_RATE

        return self.adjusted_p < FALSE_ALARM_RATE


def run_residual_tests(
    estimate: GreyBoxEstimate, data: Sequence[GreyBoxData]
) -> tuple[ResidualTestResult, ...]:
    """Test the residuals of every output of every data set; the smallest p first.

    Notes
    -----
    Ljung-Box over frequency, and per band an F test of the regression of the residuals on the
    inputs: with L frequencies and n inputs the ratio of explained to remaining power, each over its
    degrees of freedom, is F(2 n, 2 (L - n)) for circular residuals of equal variance (Brillinger,
    Time Series, doi:10.1137/1.9780898719246, ch. 8).
    """
    found: list[ResidualTestResult] = []
    outputs = tuple(estimate.model.outputs)
    for one, residuals in zip(data, estimate.residuals, strict=True):
        scaled = residuals if one.std is None else residuals / one.std
        hz = one.omega / (2.0 * np.pi)
        for column, output in enumerate(outputs):
            name = f"{output}, {one.name}" if one.name else output
            nu = scaled[:, column]
            found.append(
                ResidualTestResult(
                    test=ResidualTest.WHITENESS,
                    output=name,
                    band_hz=(float(hz[0]), float(hz[-1])),
                    p=whiteness(nu),
                )
            )
            factors = one.get_factors()[:, [column]]
            found += _test_responses(name, hz, factors * one.inputs, nu)
    ordered = sorted(found, key=lambda test: test.p)
    adjusted = adjust_by_holm([test.p for test in ordered])
    return tuple(replace(test, adjusted_p=p) for test, p in zip(ordered, adjusted, strict=True))


def _test_responses(
    output: str,
    hz: Float[np.ndarray, " n_omega"],
    inputs: Complex[np.ndarray, "n_omega n_u"],
    nu: Complex[np.ndarray, " n_omega"],
) -> Iterator[ResidualTestResult]:
    n_bands = max(1, hz.size // (_PER_INPUT * inputs.shape[1]))
    for band in np.array_split(np.arange(hz.size), n_bands):
        left, singular, _ = np.linalg.svd(inputs[band], full_matrices=False)
        rank = int(np.count_nonzero(singular > _LEAST_POWER * max(singular[0], 1e-300)))
        remaining = band.size - rank
        total = float(np.sum(np.abs(nu[band]) ** 2))
        if remaining < 1 or not singular[0] > 0.0 or total == 0.0:
            continue
        explained = float(np.sum(np.abs(left[:, :rank].conj().T @ nu[band]) ** 2))
        rest = max(total - explained, np.finfo(float).tiny)
        ratio = explained / rank / (rest / remaining)
        p = float(scipy.special.fdtrc(2 * rank, 2 * remaining, ratio))
        limits = float(hz[band[0]]), float(hz[band[-1]])
        yield ResidualTestResult(test=ResidualTest.RESPONSE, output=output, band_hz=limits, p=p)


def compute_poles(estimate: GreyBoxEstimate) -> tuple[TransferFunctionRoot, ...]:
    """Compute the eigenvalues of A with standard errors of modulus and damping ratio.

    Notes
    -----
    d lambda = w^H dA v with left and right eigenvectors w and v, scaled so that w^H v = 1; not
    defined for a pole that is defective, whose standard errors are large.
    """
    A = estimate.matrices.A
    if A.size == 0:
        return ()
    values, right = (part.astype(complex) for part in np.linalg.eig(A))
    left = np.linalg.pinv(right)
    slopes = np.stack(
        [np.einsum("rx,xy,yr->r", left, A, right) for A, *_ in estimate.slopes], axis=1
    )
    stds = [
        np.sqrt(np.maximum(np.einsum("ri,ij,rj->r", rows, estimate.covariance, rows), 0.0))
        for rows in compute_polar_slopes(values, slopes)
    ]
    return tuple(
        TransferFunctionRoot(
            real_rad_s=float(values[k].real),
            imag_rad_s=float(values[k].imag),
            frequency_rad_s=float(abs(values[k])),
            frequency_std_rad_s=float(stds[0][k]),
            damping=float(-values[k].real / max(abs(values[k]), 1e-300)),
            damping_std=float(stds[1][k]),
        )
        for k in np.argsort(np.abs(values))
        if values[k].imag >= 0.0
    )
