"""Errors of the parameters of a run by their causes: the noise at each frequency, and priors."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.run import ErrorCauses, EstimationRun, RunResult
from flexsid.records.views import NoiseShares
from flexsid.storage.arrays import describe_array
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import ErrorComponents


def store_error_causes(
    store: Store, components: ErrorComponents | None, maneuver_ids: tuple[int, ...]
) -> ErrorCauses | None:
    """Store the errors by their causes in single precision; None where some are not known."""
    if components is None or any(one.shape[1] == 0 for one in components.noise):
        return None
    matrix = np.concatenate([*components.noise, components.prior], axis=1)
    if not np.isfinite(matrix).all():
        return None
    omega, values = store.arrays.put_many(
        [
            describe_array(np.concatenate(components.omega), "rad/s"),
            describe_array(matrix.astype(np.float32)),
        ]
    )
    return ErrorCauses(
        maneuver_ids=maneuver_ids,
        n_frequencies=tuple(one.size for one in components.omega),
        omega=omega,
        priors=components.prior_names,
        components=values,
    )


def load_components(store: Store, result: RunResult) -> ErrorComponents | None:
    """Load the error components of a run by its parameters; None in those of earlier releases."""
    causes = result.error_causes
    if causes is None:
        return None
    arrays = store.arrays.get_many([causes.omega, causes.components])
    ends = np.cumsum(causes.n_frequencies)
    *noise, prior = np.split(arrays[causes.components].astype(float), ends, axis=1)
    omega = np.split(arrays[causes.omega], ends[:-1])
    return ErrorComponents(tuple(omega), tuple(noise), causes.priors, prior)


def read_noise_shares(
    store: Store, run: EstimationRun, name: str, maneuver_id: int
) -> NoiseShares | None:
    """Read on which frequencies of a maneuver the estimate of one parameter rests.

    The errors that noise causes at different frequencies are independent; each has its share of
    their variance. That of several maneuvers is over all of them.

    Returns
    -------
    NoiseShares or None
        None if the run is not of this maneuver, or does not have the causes of its errors.

    Raises
    ------
    BadInput
        If the run did not estimate the parameter; ``code`` is ``unknown-parameter``.
    """
    result = run.result
    if result is None:
        return None
    names = [parameter.name for parameter in result.parameters]
    if name not in names:
        raise BadInput(
            f"run {run.id} did not estimate '{name}'; expected one of {', '.join(names)}",
            code="unknown-parameter",
        )
    components = load_components(store, result)
    causes = result.error_causes
    if components is None or causes is None or maneuver_id not in causes.maneuver_ids:
        return None
    own = components.select([names.index(name)])
    at = causes.maneuver_ids.index(maneuver_id)
    total = float(sum(np.sum(one**2) for one in own.noise))
    if total == 0.0:  # of a value that rests on its prior alone
        return None
    return NoiseShares(
        run_id=run.id or 0,
        name=name,
        frequency_hz=own.omega[at] / (2.0 * np.pi),
        shares=own.noise[at][0] ** 2 / total,
    )
