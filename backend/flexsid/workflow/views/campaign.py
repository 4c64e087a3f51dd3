"""Flight envelope of a campaign."""

from __future__ import annotations

from typing import Unpack

from flexsid.records.views import Envelope, EnvelopeMark
from flexsid.storage.maneuver_list import ManeuverFilters
from flexsid.storage.store import Store


def read_envelope(store: Store, **filters: Unpack[ManeuverFilters]) -> Envelope:
    """Read the flight conditions of the listed maneuvers."""
    return Envelope(
        marks=tuple(
            EnvelopeMark(
                maneuver_id=item.id,
                label=item.label,
                fta=item.fta,
                fuel_fraction=item.fuel_fraction,
                airspeed_m_s=item.airspeed_m_s,
                airspeed_ratio=item.airspeed_ratio,
                dynamic_pressure_pa=item.dynamic_pressure_pa,
            )
            for item in store.maneuver_page(limit=None, **filters).items
        )
    )
