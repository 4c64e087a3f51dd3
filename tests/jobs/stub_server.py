"""A server with nothing but a dispatcher, to be killed."""

from __future__ import annotations

import sys
import time

import stub_steps

from flexsid.jobs.dispatcher import Dispatcher
from flexsid.jobs.steps import Steps
from flexsid.storage.store import Store

if __name__ == "__main__":
    dispatcher = Dispatcher(
        Store.open(sys.argv[1]),
        Steps(stub_steps.prepare, stub_steps.compute, stub_steps.keep),
        count=1,
    )
    dispatcher.start()
    time.sleep(60)
