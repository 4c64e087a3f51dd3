"""All that the demonstration has: the campaign of FLEX-28, and aircraft with other motions."""

from __future__ import annotations

from flexsid.demo.campaign import Report, add_campaign
from flexsid.demo.independent_surfaces import add_independent
from flexsid.demo.transport import add_transport
from flexsid.storage.store import Store


def add_demonstration(store: Store, report: Report, *, unsteady: bool) -> None:
    """Simulate and store what is missing, with the arguments of ``add_campaign``."""
    add_campaign(store, report, unsteady=unsteady)
    add_transport(store)
    add_independent(store)
