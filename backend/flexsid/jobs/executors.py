"""Executors: who computes, by what the environment says."""

from __future__ import annotations

from flexsid.jobs.dispatcher import Workers
from flexsid.jobs.local import LocalWorkers
from flexsid.jobs.worker import Compute


def make_workers(compute: Compute, dask: str | None = None, count: int | None = None) -> Workers:
    """Return the workers of a Dask cluster, or else processes of this computer.

    Parameters
    ----------
    compute
        What they carry out.
    dask
        Address of a Dask scheduler.
    count
        How many processes of this computer; by default one less than there are cores.
    """
    if dask is None:
        return LocalWorkers(compute, count)
    from flexsid.jobs.cluster import ClusterWorkers

    return ClusterWorkers(compute, dask)
