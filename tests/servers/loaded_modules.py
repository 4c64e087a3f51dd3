"""Load what forked processes need, in the fork server.

What is loaded is no garbage: without ``freeze`` every forked process looks through a million
objects, and copies their memory.
"""

import gc
import os
from importlib import import_module

_CLI = ("administration", "data", "main", "models", "runs", "serve")
_MODULES = (
    *(f"flexsid.cli.{one}" for one in _CLI),
    *("flexsid.jobs.kinds", "flexsid.workflow.maintenance.database"),
    *("flexsid.streams.stream_process", "flexsid.streams.estimate_process"),
    "preloaded",
)

gc.disable()
for _module in _MODULES:
    import_module(_module)
gc.collect()
gc.freeze()
gc.enable()
os.environ.pop("PYTHONPATH", None)  # which found this module
