"""A server with nothing but a dispatcher, to be killed or frozen: database, Dask, patience."""

from __future__ import annotations

import sys
import time

import stub_steps

from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.executors import make_workers
from flexsid.storage.store import Store

if __name__ == "__main__":
    database, dask, patience = sys.argv[1:]
    dispatcher = Dispatcher(
        Store.open(database),
        stub_steps.load(),
        make_workers(stub_steps.compute, dask or None, 1),
        patience_s=float(patience),
    )
    dispatcher.start()
    time.sleep(120)
