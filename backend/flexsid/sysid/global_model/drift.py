"""Variation of derivatives over the envelope: average slopes, and whether they are significant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Bool, Float

from flexsid.sysid.adequacy.several_tests import adjust_by_holm
from flexsid.sysid.global_model.fit import GlobalModel

_LEVEL = 0.05  # probability of a false drift in a campaign


@dataclass(frozen=True, slots=True, eq=False)
class Drift:
    """Average slopes of the derivatives, (variable, derivative), and their standard errors.

    ``probability`` is that of a slope at least as large where there is none, in view of the
    number of slopes.
    """

    slopes: Float[np.ndarray, "n_v p"]
    std_errors: Float[np.ndarray, "n_v p"]
    probability: Float[np.ndarray, "n_v p"]

    @property
    def is_significant(self) -> Bool[np.ndarray, "n_v p"]:
        """Whether each derivative varies with each variable, at 5 % for the campaign."""
        return self.probability < _LEVEL


def estimate_drift(model: GlobalModel, conditions: Float[np.ndarray, "n n_v"]) -> Drift:
    """Estimate the average slopes of all derivatives, and test them against zero.

    Parameters
    ----------
    model
        The global model.
    conditions
        Conditions over which slopes are averaged, such as those of the runs. [any]

    Notes
    -----
    A slope over its standard error is normal without drift, p = erfc(|z| / sqrt 2); the p of all
    slopes are adjusted by Holm's method [1]_.

    References
    ----------
    .. [1] Holm, S., "A Simple Sequentially Rejective Multiple Test Procedure," Scandinavian
       Journal of Statistics, vol. 6, no. 2, 1979, pp. 65-70.
    """
    each = [model.average_slopes(conditions, k) for k in range(conditions.shape[1])]
    slopes, std = (np.stack(parts) for parts in zip(*each, strict=True))
    ratios = np.abs(slopes) / np.where(std > 0.0, std, np.inf)
    p = scipy.special.erfc(ratios / np.sqrt(2.0))
    adjusted = adjust_by_holm(p.ravel().tolist())
    return Drift(slopes, std, np.reshape(adjusted, p.shape))
