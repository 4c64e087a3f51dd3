"""ExcitationDesign: what was wanted of a multisine, and the phases that were found."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.sysid.excitation.designer import Wish


@dataclass(frozen=True, slots=True, kw_only=True)
class ExcitationDesign:
    """A design that is kept; ``wish`` and ``phases`` [rad] together reproduce it.

    ``fta`` is the lowest number of the design in Table 1, where it is one.
    """

    name: str
    wish: Wish
    phases: dict[str, tuple[float, ...]]
    peak_factors: dict[str, float]
    fta: int | None = None
    note: str = ""
    created_at: datetime | None = None
    id: int | None = None
