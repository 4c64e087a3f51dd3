"""Live identification: streams of samples while the aircraft flies."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

from fastapi import Body, Path, Query, Response, status
from pydantic import Field

from flexsid.api.authorization import NamedAnalyst, TheAnalyst
from flexsid.api.context import TheContext, TheStore
from flexsid.api.models.requests import LATEST_S, Id, Moment, Name, Number, Request, Text, Title
from flexsid.api.models.responses import (
    ReceivedFrames,
    ReceiverItem,
    ReceiverOption,
    StreamDetail,
    StreamHistory,
)
from flexsid.api.router import make_router
from flexsid.api.serialization import Identity, Json, Limit, Reference, drop_none
from flexsid.errors import Conflict
from flexsid.records.live import (
    Acknowledgement,
    AlarmKind,
    LiveStream,
    LiveTestPoint,
    LiveTestPointStatus,
    ReceiverSettings,
    StreamHeader,
    StreamStatus,
    StripChart,
)
from flexsid.records.run import EstimationRun
from flexsid.records.views import DefaultChannels
from flexsid.storage.lists.list_query import Items
from flexsid.storage.live_history import list_alarms, list_states
from flexsid.storage.store import Store
from flexsid.streams.receiver import Receiver
from flexsid.streams.receivers import is_installed, load_receivers
from flexsid.text import LARGEST_ID
from flexsid.workflow.live.frame_assembler import compute_packet_size
from flexsid.workflow.views.maneuver import select_default_channels

router = make_router("/live", tag="live")

LARGEST_PUSH = 1024**2  # bytes of packets in one request
MOST_COLUMNS = 4000
"""Columns of a strip chart."""

_Speed = Annotated[float, Field(strict=True, gt=0.0, le=1000.0)]
_Limits = Annotated[tuple[Number, Number], Field(description="lowest and highest value")]
_Since = Annotated[
    float | None, Query(ge=-LATEST_S, le=LATEST_S, description="Time of the recorder. [s]")
]
_Names = Annotated[str, Query(description="Names of channels, separated by commas.")]


class ReceiverRequest(Request):
    """A receiver by name, with its options (`GET /live/receivers`)."""

    name: Name
    options: Annotated[dict[Name, Any], Field(max_length=20, default_factory=dict)]


class StreamRequest(Request):
    """A stream to start, processed by model, channels and settings of a run.

    Maneuvers are stored in the flight; without one they are not stored.
    """

    run_id: Id
    title: Title
    receiver: ReceiverRequest
    flight_id: Id | None = None
    next_airspeed_m_s: Annotated[float, Field(strict=True, gt=0.0, le=1000.0)] | None = None
    limits: Annotated[dict[Name, _Limits], Field(max_length=500, default_factory=dict)]


class AcknowledgementRequest(Request):
    """An alarm of a state, and what was noted when it was acknowledged."""

    kind: AlarmKind
    subject: Name
    time_s: Moment
    note: Text = ""


class TestPointRequest(Request):
    """Whether a test point is accepted or is to be repeated."""

    __test__ = False

    status: LiveTestPointStatus
    message: Text = ""


@router.get("/receivers", response_model=Items[ReceiverItem])
def list_receivers() -> Json:
    """List the ways to receive samples, with their options."""
    return Json(
        Items(items=[_describe_receiver(receiver) for receiver in load_receivers().values()])
    )


@router.get("/streams", response_model=Items[LiveStream])
def list_streams(store: TheStore, aircraft_id: Reference = None) -> Json:
    """List streams, newest first."""
    found = store.live_streams.find(**drop_none(aircraft_id=aircraft_id))
    return Json(Items(items=found[::-1]))


@router.post("/streams", response_model=LiveStream, status_code=status.HTTP_201_CREATED)
def start_stream(context: TheContext, body: StreamRequest, analyst: TheAnalyst) -> Json:
    """Start a stream in processes of its own; it runs until it is stopped or ends."""
    store = context.store
    run = store.runs.get(body.run_id)
    stream = LiveStream(
        aircraft_id=store.maneuvers.get(run.maneuver_id).aircraft_id,
        run_id=body.run_id,
        title=body.title,
        receiver=ReceiverSettings(**body.receiver.model_dump()),
        flight_id=body.flight_id,
        next_airspeed_m_s=body.next_airspeed_m_s,
        limits=body.limits,
        author=analyst,
    )
    stored = context.streams.start(stream)
    location = {"Location": f"/api/v1/live/streams/{stored.id}"}
    return Json(stored, status.HTTP_201_CREATED, location)


@router.get("/streams/{stream_id}", response_model=StreamDetail)
def get_stream(context: TheContext, stream_id: Identity) -> Json:
    """Return a stream: channels, present state, test points and alarms.

    Every new state is also sent as the event `live` of `GET /events`.
    """
    store = context.store
    stream = store.live_streams.get(stream_id)
    task = context.streams.find_task(stream_id)
    header = None if task is None else task.header
    run = store.runs.get(stream.run_id)
    return Json(
        StreamDetail(
            stream=stream,
            header=header,
            packet_bytes=None if header is None else compute_packet_size(header),
            outputs=() if task is None else tuple(output.name for output in task.outputs),
            inputs=() if task is None else task.inputs,
            default_channels=None if header is None else _select_channels(store, run, header),
            snapshot=context.streams.find_snapshot(stream_id),
            test_points=tuple(store.live_test_points.find(stream_id=stream_id)),
            alarms=list_alarms(store, stream_id),
            acknowledgements=tuple(store.live_acknowledgements.find(stream_id=stream_id)),
            expected_std_errors={
                one.name: one.std_error for one in (run.result.parameters if run.result else ())
            },
        )
    )


def _select_channels(store: Store, run: EstimationRun, header: StreamHeader) -> DefaultChannels:
    maneuver = store.maneuvers.get(run.maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    roles = {channel.name: channel.role for channel in header.channels}
    return select_default_channels(aircraft, run.structure.axis, maneuver.excitation, roles)


@router.post("/streams/{stream_id}/stop", response_model=LiveStream)
def stop_stream(context: TheContext, stream_id: Identity) -> Json:
    """Stop a stream; a maneuver that is being flown is stored as far as it was received."""
    context.store.live_streams.get(stream_id)
    return Json(context.streams.stop(stream_id))


@router.delete("/streams/{stream_id}", status_code=status.HTTP_204_NO_CONTENT)
def delete_stream(store: TheStore, stream_id: Identity) -> Response:
    """Delete a stopped stream with its states; stored maneuvers and runs remain."""
    stream = store.live_streams.get(stream_id)
    if stream.status is StreamStatus.RUNNING:
        raise Conflict(f"stream {stream_id} is running; stop it first", code="stream-running")
    store.live_streams.delete(stream_id)
    return Response(status_code=status.HTTP_204_NO_CONTENT)


@router.post("/streams/{stream_id}/frames", response_model=ReceivedFrames)
def push_frames(
    context: TheContext,
    stream_id: Identity,
    body: Annotated[bytes, Body(media_type="application/octet-stream", max_length=LARGEST_PUSH)],
) -> Json:
    """Pass packets of frames to a stream with the receiver `push`, one after the other.

    A packet is `FXS1`, the number of the frame (unsigned 32-bit integer), the time of its first
    sample (64-bit float, s), and the samples of every group of channels of one rate as 32-bit
    floats, sample by sample; all little-endian. Missing samples are NaN.
    """
    context.store.live_streams.get(stream_id)
    return Json(ReceivedFrames(frames=context.streams.push(stream_id, body)))


@router.get("/streams/{stream_id}/samples", response_model=StripChart)
def get_stream_samples(
    context: TheContext,
    stream_id: Identity,
    channels: _Names,
    since_s: _Since = None,
    columns: Annotated[int, Query(ge=1, le=MOST_COLUMNS)] = 600,
) -> Json:
    """Return the lowest and highest value of channels in each column of a strip chart.

    The server has the last ten minutes of a running stream; without `since_s` all of them.
    Newer columns are sent as the event `samples` of `GET /events?stream_id=...`.
    """
    context.store.live_streams.get(stream_id)
    names = tuple(name.strip() for name in channels.split(",") if name.strip())
    return Json(context.streams.read_samples(stream_id, names, since_s, columns))


@router.get("/streams/{stream_id}/history", response_model=StreamHistory)
def get_stream_history(
    store: TheStore, stream_id: Identity, since_s: _Since = None, limit: Limit = 300
) -> Json:
    """Return what was known at each second of the maneuvers of a stream, oldest first.

    Stored as it was known then; a replay of the same samples has the same states.
    """
    store.live_streams.get(stream_id)
    states, more = list_states(store, stream_id, since_s, limit)
    return Json(StreamHistory(states=tuple(states), more=more))


@router.post(
    "/streams/{stream_id}/acknowledgements",
    response_model=Acknowledgement,
    status_code=status.HTTP_201_CREATED,
)
def acknowledge_alarm(
    context: TheContext, stream_id: Identity, body: AcknowledgementRequest, analyst: NamedAnalyst
) -> Json:
    """Acknowledge an alarm by name."""
    context.store.live_streams.get(stream_id)
    alarm = body.make_record(Acknowledgement, stream_id=stream_id, author=analyst)
    stored = context.store.live_acknowledgements.add(alarm)
    context.streams.publish(stream_id)
    return Json(stored, status.HTTP_201_CREATED)


@router.put("/test-points/{point_id}", response_model=LiveTestPoint)
def decide_test_point(
    store: TheStore,
    point_id: Annotated[int, Path(ge=1, le=LARGEST_ID)],
    body: TestPointRequest,
    analyst: NamedAnalyst,
) -> Json:
    """Accept a test point, or mark it to be repeated."""
    point = store.live_test_points.get(point_id)
    changed = replace(point, status=body.status, message=body.message, author=analyst)
    return Json(store.live_test_points.replace(changed))


def _describe_receiver(receiver: Receiver) -> ReceiverItem:
    schema = receiver.options.model_json_schema()
    required = schema.get("required", ())
    return ReceiverItem(
        name=receiver.name,
        label=receiver.label,
        missing_extra=None if is_installed(receiver) else receiver.extra,
        options=tuple(
            ReceiverOption(
                name=name,
                type=part.get("type", "any"),
                description=part.get("description", ""),
                default=part.get("default"),
                is_required=name in required,
            )
            for name, part in schema.get("properties", {}).items()
        ),
    )
