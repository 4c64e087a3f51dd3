"""A server with only a dispatcher, to be killed or stopped: database, Dask, lease timeout."""

from __future__ import annotations

import sys
import time

import stub_kinds

from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.dispatcher_process import make_workers
from flexsid.storage.store import Store

if __name__ == "__main__":
    database, dask, lease_timeout = sys.argv[1:]
    dispatcher = Dispatcher(
        Store.open(database),
        stub_kinds.load(),
        make_workers(stub_kinds.load, dask or None, 1),
        lease_timeout_s=float(lease_timeout),
    )
    dispatcher.start()
    time.sleep(600)
