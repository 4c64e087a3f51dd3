"""Upload: files that were read, and what their mapping makes of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from flexsid.errors import BadInput
from flexsid.importers import mapping as mappings
from flexsid.importers.channels import RawChannel
from flexsid.importers.clock import UNUSUAL_RATE, USUAL_RATES_HZ
from flexsid.importers.maneuver import RawManeuver, extract_maneuver, extract_recording
from flexsid.importers.source import Sources
from flexsid.records.maneuver import Role
from flexsid.storage.arrays import ArrayRow


@dataclass(frozen=True, slots=True)
class ParsedUpload:
    """Files that were read and the mapping that explains them; nothing is stored yet.

    The channels have been taken out of the files and checked; those of a whole
    flight belong to no maneuver.
    """

    sources: Sources
    mapping: mappings.Mapping
    channels: tuple[RawChannel, ...] = ()
    maneuver: RawManeuver | None = None
    rows: Mapping[str, ArrayRow] = field(default_factory=dict)

    @property
    def builtin(self) -> str | None:
        """Name of the aircraft that the workbench brings along and this upload needs."""
        part = self.mapping.aircraft
        return part.name if part is not None and part.builtin else None


def explain(sources: Sources, mapping: mappings.Mapping) -> ParsedUpload:
    """Take out of files what a mapping says that they hold.

    Raises
    ------
    BadInput
        If the files do not hold what the mapping says.
    """
    if mapping.recording is None:
        return ParsedUpload(sources, mapping)
    raw = None
    if mapping.maneuver is None:
        channels = extract_recording(mapping.recording, sources)
    else:
        raw = extract_maneuver(mapping.maneuver, mapping.recording, sources)
        channels = raw.channels
    _check_rates(channels)
    return ParsedUpload(sources, mapping, channels, raw)


def _check_rates(channels: Sequence[RawChannel]) -> None:
    """Refuse a rate at which nobody samples motion: its time may be in another unit."""
    low, high = USUAL_RATES_HZ
    for channel in channels:
        clock = channel.clock
        moving = channel.role in (Role.INPUT, Role.OUTPUT)
        if moving and not low <= clock.rate_hz <= high and UNUSUAL_RATE not in clock.confirmed:
            raise BadInput(
                f"Channel '{channel.name}' has {clock.rate_hz:.4g} samples per second; {low:g} to "
                f"{high:g} are usual. Is the unit of time right? If it is, write "
                f'confirmed = ["{UNUSUAL_RATE}"] in [time].',
                code="unusual-rate",
                column=channel.name,
            )
