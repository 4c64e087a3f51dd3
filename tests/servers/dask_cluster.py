"""A Dask scheduler and workers in separate processes."""

from __future__ import annotations

import atexit
import os
import shutil
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

import dask.config
from distributed import Client
from ports import find_free_port
from ruamel.yaml import YAML
from waiting import PATIENCE_S, wait_until

from flexsid.jobs.cluster import write_cluster_certificate


@cache
def configuration() -> Path:
    """Certificate of all clusters of the tests, which Dask of this process uses, too."""
    file = Path(tempfile.mkdtemp(prefix="flexsid-dask-")) / "cluster.yaml"
    atexit.register(shutil.rmtree, file.parent, ignore_errors=True)
    write_cluster_certificate(file, datetime.now(UTC))
    os.environ["DASK_CONFIG"] = str(file)
    dask.config.update(dask.config.config, YAML(typ="safe").load(file))
    return file


class Cluster:
    """A scheduler with workers that can be added and killed one by one."""

    def __init__(self, folder: Path, workers: int = 2, path: Path | None = None) -> None:
        self._folder = folder
        self._port = find_free_port()
        self.address = f"tls://127.0.0.1:{self._port}"
        self._environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(
                [*([str(path)] if path else []), *filter(None, sys.path)]
            ),
            "PYTHONWARNINGS": "ignore",
            "DASK_CONFIG": str(configuration()),
        }
        self._scheduler = self._start_scheduler()
        self.workers: list[subprocess.Popen[bytes]] = []
        for _ in range(workers):
            self.add_worker()
        self.wait_for(workers)

    def restart(self) -> None:
        """Kill the scheduler and all workers, and start as many again."""
        count = len(self.workers)
        self.close()
        self.workers.clear()
        self._scheduler = self._start_scheduler()
        for _ in range(count):
            self.add_worker()
        self.wait_for(count)

    def add_worker(self) -> subprocess.Popen[bytes]:
        """Start a worker with one thread."""
        worker = self._start(
            *("worker", self.address, "--nthreads", "1", "--no-dashboard", "--no-nanny"),
            *("--local-directory", str(self._folder), "--death-timeout", str(PATIENCE_S)),
        )
        self.workers.append(worker)
        return worker

    def wait_for(self, workers: int) -> None:
        """Wait until this number of workers is connected."""
        with Client(self.address, timeout=PATIENCE_S, set_as_default=False) as client:
            scheduler: Any = client
            wait_until(lambda: len(scheduler.nthreads()) == workers, f"{workers} workers")

    def close(self) -> None:
        """Kill the scheduler and all workers."""
        for process in (*self.workers, self._scheduler):
            process.kill()
            process.wait()

    def _start_scheduler(self) -> subprocess.Popen[bytes]:
        return self._start(
            "scheduler", "--host", "127.0.0.1", "--port", str(self._port), "--no-dashboard"
        )

    def _start(self, *arguments: str) -> subprocess.Popen[bytes]:
        with (self._folder / f"{arguments[0]}.log").open("ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", "distributed.cli.dask_" + arguments[0], *arguments[1:]],
                env=self._environment,
                stdout=log,
                stderr=log,
            )
