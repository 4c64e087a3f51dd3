"""Parsed uploads: files with their mapping and channels."""

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
    """Files with their mapping, before storage.

    Channels are extracted from the files and checked; those of a whole flight belong to no
    maneuver.
    """

    sources: Sources
    mapping: mappings.Mapping
    channels: tuple[RawChannel, ...] = ()
    maneuver: RawManeuver | None = None
    rows: Mapping[str, ArrayRow] = field(default_factory=dict)

    @property
    def builtin(self) -> str | None:
        """Name of the built-in aircraft that this upload needs."""
        part = self.mapping.aircraft
        return part.name if part is not None and part.builtin else None


def parse_upload(sources: Sources, mapping: mappings.Mapping) -> ParsedUpload:
    """Extract the channels of files with a mapping.

    Raises
    ------
    BadInput
        If the files do not match the mapping.
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
    """Check that sampling rates are usual; otherwise time may be in another unit."""
    low, high = USUAL_RATES_HZ
    for channel in channels:
        clock = channel.clock
        moving = channel.role in (Role.INPUT, Role.OUTPUT)
        if moving and not low <= clock.rate_hz <= high and UNUSUAL_RATE not in clock.confirmed:
            raise BadInput(
                f"Channel '{channel.name}' has {clock.rate_hz:.4g} samples per second; {low:g} to "
                f"{high:g} are usual. Check the unit of time; if it is right, write "
                f'confirmed = ["{UNUSUAL_RATE}"] in [time].',
                code="unusual-rate",
                column=channel.name,
            )
