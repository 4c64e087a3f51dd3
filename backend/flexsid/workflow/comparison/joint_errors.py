"""Joint errors of runs: the covariance between their estimates of every derivative."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from flexsid.records.run import EstimationRun, RunResult
from flexsid.storage.store import Store
from flexsid.sysid.estimation.agreement import compute_joint_covariance
from flexsid.sysid.estimation.error_components import ErrorComponents


def compute_covariances(
    store: Store, finished: Sequence[tuple[EstimationRun, RunResult]], names: Sequence[str]
) -> Mapping[str, Float[np.ndarray, "n_runs n_runs"]]:
    """Compute the covariance between runs by derivative; NaN without a standard error.

    Runs of one maneuver share its noise, those with the same prior means their errors, and all
    runs the errors of modal table, mass, airspeed and density. Runs of earlier releases share the
    latter only.
    """
    place = {name: k for k, name in enumerate(names)}
    held = np.zeros((len(names), len(finished)))
    std_errors, components, maneuvers = [], [], []
    for number, (_, result) in enumerate(finished):
        at = [place[parameter.name] for parameter in result.parameters]
        total = np.full(len(names), np.nan)
        total[at] = [p.std_error or np.nan for p in result.parameters]
        held[at, number] = [p.held_std for p in result.parameters]
        std_errors.append(np.sqrt(np.maximum(total**2 - held[:, number] ** 2, 0.0)))
        found = None if result.error_causes is None else _load_components(store, result)
        if found is not None:
            from_names = np.zeros((len(names), len(at)))
            from_names[at, np.arange(len(at))] = 1.0
            found = found.transform(from_names)
        components.append(found)
        causes = result.error_causes
        maneuvers.append(() if causes is None else causes.maneuver_ids)
    covariance = compute_joint_covariance(std_errors, components, maneuvers)
    covariance += held[:, :, None] * held[:, None, :]
    return dict(zip(names, covariance, strict=True))


def _load_components(store: Store, result: RunResult) -> ErrorComponents | None:
    """Load the error components of a run, by the order of its parameters."""
    causes = result.error_causes
    if causes is None:
        return None
    arrays = store.arrays.get_many([causes.omega, causes.components])
    ends = np.cumsum(causes.n_frequencies)
    *noise, prior = np.split(arrays[causes.components].astype(float), ends, axis=1)
    omega = np.split(arrays[causes.omega], ends[:-1])
    return ErrorComponents(tuple(omega), tuple(noise), causes.priors, prior)
