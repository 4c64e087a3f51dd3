"""Storing of a maneuver from the frames of a stream, as it is cut out of an imported recording."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.errors import BadInput, FlexsidError
from flexsid.records.decision import Structure
from flexsid.records.live import Frame, LiveStream, LiveTestPoint, LiveTestPointStatus, StreamHeader
from flexsid.records.maneuver import (
    ConditioningStep,
    Correction,
    Cut,
    FlightChannel,
    Maneuver,
    ManeuverProposal,
    StepKind,
)
from flexsid.records.run import EstimationRun, RunSettings
from flexsid.storage.jobs import batches
from flexsid.storage.store import Store
from flexsid.workflow.importing.maneuver_cutting import (
    RecordedFlight,
    find_recorded_maneuvers,
    store_cut,
)
from flexsid.workflow.runs import estimation
from flexsid.workflow.runs.run_identity import add_hashes
from flexsid.workflow.runs.run_proposal import apply_proposal

LONGEST_REPAIR_S = 0.1
"""Two frames: a longer gap within a maneuver is not interpolated well, and no run is queued. [s]"""


def store_test_point(
    store: Store,
    stream: LiveStream,
    header: StreamHeader,
    frames: Sequence[Frame],
    interval_s: tuple[float, float],
) -> LiveTestPoint:
    """Store a maneuver of a stream, and queue the run that is proposed for it.

    The same test point is stored once. Samples that were not received are interpolated, and are
    named as repairs of the maneuver.

    Parameters
    ----------
    store
        The campaign.
    stream
        The stream; without a flight nothing but the test point is stored.
    header
        Channels.
    frames
        As they were received, with the trim before the maneuver and the decay after it.
    interval_s
        Begin and end of the excitation, by the recorder. [s]

    Returns
    -------
    LiveTestPoint
        With the reason why there is no maneuver or no run.
    """
    assert stream.id is not None
    known = store.live_test_points.find(stream_id=stream.id, start_s=interval_s[0])
    if known:
        return known[0]
    maneuver_id = run_id = None
    message = ""
    with store.transaction():
        try:
            with store.transaction():
                maneuver, message = _store_maneuver(store, stream, header, frames, interval_s)
                maneuver_id = maneuver.id
        except FlexsidError as error:
            message = f"not stored: {error.message}"
        if maneuver_id is not None and not message:
            run_id, message = _queue_run(store, maneuver_id, stream)
        return store.live_test_points.add(
            LiveTestPoint(
                stream_id=stream.id,
                start_s=interval_s[0],
                stop_s=interval_s[1],
                status=LiveTestPointStatus.STORED
                if maneuver_id is not None
                else LiveTestPointStatus.REFUSED,
                maneuver_id=maneuver_id,
                run_id=run_id,
                message=message,
                author=stream.author,
            )
        )


def join_frames(
    header: StreamHeader, frames: Sequence[Frame], flight_id: int, source: str
) -> RecordedFlight:
    """Join frames to channels as of a recording, NaN where samples are missing.

    Raises
    ------
    BadInput
        If there is no frame.
    """
    if not frames:
        raise BadInput("no frame of the maneuver was received", code="no-frames")
    numbers = np.array([frame.number for frame in frames])
    first, count = int(numbers.min()), int(np.ptp(numbers)) + 1
    start_s = frames[0].time_s + (first - frames[0].number) * header.frame_s
    recorded: dict[str, tuple[FlightChannel, np.ndarray]] = {}
    for k, (group, (n, width)) in enumerate(zip(header.groups, header.frame_shapes, strict=True)):
        samples = np.full((count, n, width), np.nan, dtype=np.float32)
        for frame in frames:
            samples[frame.number - first] = frame.samples[k]
        columns = samples.reshape(-1, width).T
        for channel, values in zip(group, columns, strict=True):
            recorded[channel.name] = (
                FlightChannel(
                    flight_id=flight_id,
                    name=channel.name,
                    unit=channel.unit,
                    role=channel.role,
                    rate_hz=channel.rate_hz,
                    start_s=start_s,
                    n_samples=values.size,
                    array="",
                    source_file=source,
                ),
                np.ascontiguousarray(values),
            )
    return {channel.name: recorded[channel.name] for channel in header.channels}


def _store_maneuver(
    store: Store,
    stream: LiveStream,
    header: StreamHeader,
    frames: Sequence[Frame],
    interval_s: tuple[float, float],
) -> tuple[Maneuver, str]:
    """Store a maneuver; return it, and why no run of it is queued."""
    if stream.flight_id is None:
        raise BadInput("the stream has no flight", code="no-flight")
    flight = store.flights.get(stream.flight_id)
    received = join_frames(header, frames, stream.flight_id, f"stream {stream.id}")
    complete = {name: _interpolate(channel, x) for name, (channel, x) in received.items()}
    proposals = find_recorded_maneuvers(store, flight, complete)
    proposal = _find_proposal(proposals, interval_s)
    index = len(store.maneuvers.find(flight_id=stream.flight_id)) + 1
    label = f"{flight.number}-{index:02d}" + (f" FTA {proposal.fta}" if proposal.fta else "")
    cut = Cut(label=label, start_s=proposal.start_s, stop_s=proposal.stop_s, fta=proposal.fta)
    maneuver = store_cut(store, flight, complete, cut, proposals)
    assert maneuver.id is not None
    longest_s = _store_repairs(store, maneuver.id, received, stream)
    if longest_s > LONGEST_REPAIR_S + 1e-9:
        return maneuver, (
            f"{longest_s:.2f} s in a row were not received and are interpolated; no run is queued: "
            "use the times without gaps, or repeat the maneuver"
        )
    return maneuver, ""


def _find_proposal(
    found: Sequence[ManeuverProposal], interval_s: tuple[float, float]
) -> ManeuverProposal:
    """Return the maneuver with most of an interval."""
    shared = [min(p.stop_s, interval_s[1]) - max(p.start_s, interval_s[0]) for p in found]
    if not shared or max(shared) <= 0.0:
        raise BadInput(
            f"no excitation was found from {interval_s[0]:.2f} to {interval_s[1]:.2f} s",
            code="no-maneuver",
        )
    return found[int(np.argmax(shared))]


def _interpolate(channel: FlightChannel, samples: np.ndarray) -> tuple[FlightChannel, np.ndarray]:
    """Replace missing samples by straight lines, until they are repaired."""
    missing = np.isnan(samples)
    if missing.all():
        raise BadInput(
            f"no sample of channel '{channel.name}' was received",
            code="no-samples",
            channel=channel.name,
        )
    if missing.any():
        index = np.arange(samples.size)
        filled = np.interp(index[missing], index[~missing], samples[~missing])
        samples = samples.copy()
        samples[missing] = filled
    return channel, samples


def _store_repairs(
    store: Store, maneuver_id: int, received: RecordedFlight, stream: LiveStream
) -> float:
    """Store the repair of every gap of a channel; return the longest one. [s]"""
    longest_s = 0.0
    for channel in store.channels.find(maneuver_id=maneuver_id):
        source, samples = received[channel.name]
        first = round((channel.start_s - source.start_s) * channel.rate_hz)
        missing = np.isnan(samples[first : first + channel.n_samples])
        edges = np.flatnonzero(np.diff(np.concatenate([[False], missing, [False]]).astype(int)))
        stretches = tuple((int(a), int(b)) for a, b in edges.reshape(-1, 2).tolist())
        if not stretches:
            continue
        longest_s = max(longest_s, *((b - a) / channel.rate_hz for a, b in stretches))
        store.conditioning.add(
            ConditioningStep(
                maneuver_id=maneuver_id,
                channel=channel.name,
                correction=Correction(
                    channel=channel.name,
                    kind=StepKind.REPAIR,
                    stretches=stretches,
                    basis="not received",
                ),
                author=stream.author,
            )
        )
    return longest_s


def _queue_run(store: Store, maneuver_id: int, stream: LiveStream) -> tuple[int | None, str]:
    """Queue the run that is proposed for a maneuver, with the method of the run of the stream."""
    template = store.runs.get(stream.run_id)
    try:
        run = apply_proposal(
            store,
            EstimationRun(
                maneuver_id=maneuver_id,
                method=template.method,
                structure=Structure(fixed={}),
                settings=RunSettings(),
                author=stream.author,
            ),
        )
        estimation.prepare(store, run)
        stored, _ = batches.add_once(store, add_hashes(store, run))
    except FlexsidError as error:
        return None, f"no run was queued: {error.message}"
    return stored.id, ""
