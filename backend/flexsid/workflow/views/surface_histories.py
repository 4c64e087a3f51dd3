"""Surfaces over time as measured and as their commands move them through the servos."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.maneuver import Role
from flexsid.records.views import ChannelTrace, SurfaceHistories, SurfaceHistory
from flexsid.storage.store import Store
from flexsid.sysid.preparation.symmetry import find_pairs
from flexsid.sysid.simulation.recording import apply_instruments
from flexsid.workflow.aircraft.aircraft_models import get_recorded_servo
from flexsid.workflow.measurements.recording import COMMAND_SUFFIX
from flexsid.workflow.views.channels import list_input_names, read_traces
from flexsid.workflow.views.maneuver import POINTS


def read_surface_histories(
    store: Store,
    maneuver_id: int,
    start_s: float | None = None,
    stop_s: float | None = None,
    points: int = POINTS,
) -> SurfaceHistories:
    """Read all measured surfaces over a window, with their commands through servo and instrument.

    The command of a side is the sum of its own and of those of the parts that it is a term of.
    Commands are the recorded excitation: what feedback adds is in the measured deflections only.

    Raises
    ------
    BadInput
        If no surface was measured.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    names = list_input_names(store, maneuver)
    if not names:
        raise BadInput(
            "no surface of this maneuver was measured; import its deflections as inputs",
            code="no-surfaces",
        )
    commands = [c.name for c in store.channels.find(maneuver_id=maneuver_id, role=Role.COMMAND)]
    traces = {one.name: one for one in read_traces(store, maneuver, (*names, *commands))}
    window = (-np.inf if start_s is None else start_s, np.inf if stop_s is None else stop_s)
    found = {}
    for name in names:
        commanded = _compute_commanded(aircraft, name, traces)
        found[name] = SurfaceHistory(
            measured=_cut(traces[name], window),
            commanded=None if commanded is None else _cut(commanded, window),
        )
    right = {left: other for left, other, _ in find_pairs(names)}
    for terms in list_surface_parts(aircraft).values():
        sides = tuple(side for side, _ in terms)
        if len(sides) == 2 and set(sides) <= set(names):
            right |= [sides]
    rows = ((name, right[name]) if name in right else (name,) for name in names)
    return SurfaceHistories(
        maneuver_id=maneuver_id,
        rows=tuple(
            tuple(found[name] for name in row) for row in rows if row[0] not in right.values()
        ),
        points=points,
    )


def _compute_commanded(
    aircraft: Aircraft, surface: str, traces: Mapping[str, ChannelTrace]
) -> ChannelTrace | None:
    """Compute what the recording of a surface is if it follows its command alone."""
    # Of parts s = (l + r) / 2 and a = (r - l) / 2 the sides are s - a and s + a.
    signs = {surface: 1.0} | {
        part: float(np.sign(dict(terms)[surface]))
        for part, terms in list_surface_parts(aircraft).items()
        if surface in dict(terms)
    }
    given = [
        (sign, traces[name + COMMAND_SUFFIX])
        for name, sign in signs.items()
        if name + COMMAND_SUFFIX in traces
    ]
    if not given or len({one.values.size for _, one in given}) > 1:
        return None
    first = given[0][1]
    command = np.sum([sign * one.values for sign, one in given], axis=0)
    if not np.isfinite(command).all():  # with lost samples there is no transform
        return None
    command -= command[0]
    rate_hz = 1.0 / float(np.median(np.diff(first.time_s)))
    servo = get_recorded_servo(aircraft, surface)
    moved = apply_instruments(command[:, None], rate_hz, [servo])[:, 0]
    trim = np.nanmean(traces[surface].values) - moved.mean()
    return replace(first, name=surface, values=moved + trim)


def _cut(trace: ChannelTrace, window: tuple[float, float]) -> ChannelTrace:
    inside = (trace.time_s >= window[0]) & (trace.time_s <= window[1])
    return replace(trace, time_s=trace.time_s[inside], values=trace.values[inside])
