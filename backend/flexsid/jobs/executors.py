"""Choice of the executor: local worker processes or a Dask cluster."""

from __future__ import annotations

from flexsid.jobs.dispatcher import Workers
from flexsid.jobs.local import LocalWorkers
from flexsid.jobs.worker import LoadKinds


def make_workers(
    load_kinds: LoadKinds, dask: str | None = None, count: int | None = None
) -> Workers:
    """Return the workers of a Dask cluster, or worker processes of this computer.

    Parameters
    ----------
    load_kinds
        Function that returns the kinds of jobs, in every worker.
    dask
        Address of a Dask scheduler.
    count
        Number of processes of this computer; default: one less than the number of cores.
    """
    if dask is None:
        return LocalWorkers(load_kinds, count)
    from flexsid.jobs.cluster import ClusterWorkers

    return ClusterWorkers(load_kinds, dask)
