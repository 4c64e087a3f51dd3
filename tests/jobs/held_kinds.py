"""Server for a browser: its jobs are stubs, with requests as the page shows them."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import stub_kinds

if TYPE_CHECKING:
    from flexsid.jobs.kind import Kinds
    from flexsid.records.job import Job
    from flexsid.storage.store import Store


def load() -> Kinds:
    return {
        name: replace(kind, request=object, prepare=prepare)
        for name, kind in stub_kinds.load().items()
    }


def prepare(store: Store, job: Job, request: object) -> dict[str, Any]:
    what, file = job.author.split()
    return {"do": what, "file": file}


def serve() -> int:
    from flexsid.api import app
    from flexsid.cli.main import main

    app.load_kinds = load
    return main(sys.argv[1:])
