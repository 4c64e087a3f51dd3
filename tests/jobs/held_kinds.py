"""Server for a browser: its jobs are stubs, with requests as the page shows them."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import stub_kinds

if TYPE_CHECKING:
    from flexsid.jobs.kind import Kind, Kinds
    from flexsid.records.job import Job
    from flexsid.storage.store import Store


class HeldKinds(stub_kinds.EveryKind):
    """Stubs of any request, whose job states what happens by its author."""

    def __missing__(self, name: str) -> Kind[Any, Any]:
        return replace(super().__missing__(name), request=object, prepare=prepare)


def load() -> Kinds:
    return HeldKinds()


def prepare(store: Store, job: Job, request: object) -> dict[str, Any]:
    what, file = job.author.split()
    return {"do": what, "file": file}


def serve() -> int:
    from flexsid.api import app
    from flexsid.cli.main import main

    app.load_kinds = load
    return main(sys.argv[1:])
