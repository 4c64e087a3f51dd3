"""Choice of the executor: local worker processes or a Dask cluster."""

from __future__ import annotations

from flexsid.jobs.dispatcher import Workers
from flexsid.jobs.local import LocalWorkers
from flexsid.jobs.worker import Compute


def make_workers(compute: Compute, dask: str | None = None, count: int | None = None) -> Workers:
    """Return the workers of a Dask cluster, or worker processes of this computer.

    Parameters
    ----------
    compute
        Function that computes a task.
    dask
        Address of a Dask scheduler.
    count
        Number of processes of this computer; default: one less than the number of cores.
    """
    if dask is None:
        return LocalWorkers(compute, count)
    from flexsid.jobs.cluster import ClusterWorkers

    return ClusterWorkers(compute, dask)
