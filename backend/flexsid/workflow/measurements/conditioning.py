"""Conditioning: stored corrections of channels, applied wherever samples are read.

Recorded samples are never changed: steps are stored separately, and an undone step has no
effect but stays in the record.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.maneuver import ConditioningStep, Correction, Maneuver, StepKind
from flexsid.storage.channels import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.preparation.spikes_and_dropouts import repair_samples
from flexsid.workflow.measurements.recording import Conditioning

_LONGEST_DELAY_S = 1.0
_SCALES = (0.01, 100.0)


def read_conditioning(store: Store, maneuver_id: int | None) -> dict[str, Conditioning]:
    """Read the active corrections by channel; channels without any are omitted."""
    found: dict[str, Conditioning] = {}
    for step in store.conditioning.find(maneuver_id=maneuver_id, undone_at=None):
        one, before = step.correction, found.get(step.channel, Conditioning())
        if one.kind is StepKind.DELAY:
            after = replace(before, delay_s=one.delay_s)
        elif one.kind is StepKind.CALIBRATION:
            after = replace(before, scale=one.scale, bias=one.bias)
        else:
            after = replace(before, stretches=(*before.stretches, *one.stretches))
        found[step.channel] = after
    return found


def add_conditioning_steps(
    store: Store, maneuver_id: int, corrections: Sequence[Correction], author: str = ""
) -> list[ConditioningStep]:
    """Store corrections, all or none; return those of the maneuver.

    A shared correction is stored with every maneuver of the aircraft that has the channel.

    Raises
    ------
    BadInput
        If a channel is not recorded, or a correction is impossible.
    Conflict
        If a channel has a delay or calibration already: undo that first.
    """
    if not corrections:
        raise BadInput("no correction was given", code="no-correction")
    shared = [one for one in corrections if one.is_shared]
    if any(one.kind is StepKind.REPAIR for one in shared):
        raise BadInput("a repair is of the samples of one maneuver; it cannot be shared",
                       code="repair-not-shared")  # fmt: skip
    with store.transaction():
        maneuver = store.maneuvers.get(maneuver_id)
        steps = _add_to_maneuver(store, maneuver, corrections, author)
        if shared:
            for other in store.maneuvers.find(aircraft_id=maneuver.aircraft_id):
                recorded = {c.name for c in store.channels.find(maneuver_id=other.id)}
                own = [one for one in shared if one.channel in recorded]
                if other.id != maneuver_id and own:
                    _add_to_maneuver(store, other, own, author)
    return steps


def _add_to_maneuver(
    store: Store, maneuver: Maneuver, corrections: Sequence[Correction], author: str
) -> list[ConditioningStep]:
    assert maneuver.id is not None
    channels = read_channels(store.database, maneuver.id, [c.channel for c in corrections])
    existing = {
        (step.channel, step.correction.kind)
        for step in store.conditioning.find(maneuver_id=maneuver.id, undone_at=None)
        if step.correction.kind is not StepKind.REPAIR
    }
    steps = []
    for one in corrections:
        if one.channel not in channels:
            raise BadInput(
                f"the maneuver has no channel '{one.channel}'",
                code="unknown-channel",
                channel=one.channel,
            )
        if (one.channel, one.kind) in existing:
            raise Conflict(
                f"'{one.channel}' of {maneuver.label} has a {one.kind.value} already; undo that "
                "first",
                code="already-conditioned",
                channel=one.channel,
                maneuver_id=maneuver.id,
            )
        channel, samples = channels[one.channel]
        _check(one, np.asarray(samples, dtype=float), channel.rate_hz)
        if one.kind is not StepKind.REPAIR:
            existing.add((one.channel, one.kind))
        step = ConditioningStep(
            maneuver_id=maneuver.id, correction=one, channel=one.channel, author=author
        )
        steps.append(store.conditioning.add(step))
    return steps


def add_shared_corrections(store: Store, maneuver: Maneuver) -> None:
    """Store the shared corrections of the aircraft with a new maneuver, by their authors."""
    recorded = {c.name for c in store.channels.find(maneuver_id=maneuver.id)}
    known: dict[tuple[str, StepKind], ConditioningStep] = {}
    for other in store.maneuvers.find(aircraft_id=maneuver.aircraft_id):
        if other.id == maneuver.id:
            continue
        for step in store.conditioning.find(maneuver_id=other.id, undone_at=None):
            if step.correction.is_shared and step.channel in recorded:
                known[step.channel, step.correction.kind] = step
    for step in known.values():
        _add_to_maneuver(store, maneuver, [step.correction], step.author)


def undo_step(store: Store, maneuver_id: int, step_id: int, author: str = "") -> ConditioningStep:
    """Undo a step; it stays in the record with the author of the undo.

    A shared correction is undone in all maneuvers of the aircraft.

    Raises
    ------
    UnknownRecord
        If the maneuver has no such step.
    Conflict
        If it is undone already.
    """
    with store.transaction():
        step = store.conditioning.get(step_id)
        if step.maneuver_id != maneuver_id:
            raise UnknownRecord(f"maneuver {maneuver_id} has no conditioning step {step_id}")
        if step.undone_at is not None:
            raise Conflict("this step is undone already", code="already-undone")
        now = datetime.now(UTC)
        if step.correction.is_shared:
            aircraft_id = store.maneuvers.get(maneuver_id).aircraft_id
            for other in store.maneuvers.find(aircraft_id=aircraft_id):
                for same in store.conditioning.find(maneuver_id=other.id, undone_at=None):
                    if same.correction == step.correction and same.id != step.id:
                        store.conditioning.replace(replace(same, undone_at=now, undone_by=author))
        return store.conditioning.replace(replace(step, undone_at=now, undone_by=author))


def _check(one: Correction, samples: np.ndarray, rate_hz: float) -> None:
    name = one.channel
    if one.kind is StepKind.DELAY:
        if not abs(one.delay_s) <= _LONGEST_DELAY_S or one.delay_s == 0.0:
            raise BadInput(
                f"'{name}': a delay of {one.delay_s:g} s is not plausible; up to "
                f"{_LONGEST_DELAY_S:g} s are expected, and not zero",
                code="bad-delay",
                channel=name,
            )
    elif one.kind is StepKind.CALIBRATION:
        if not (_SCALES[0] <= abs(one.scale) <= _SCALES[1] and math.isfinite(one.bias)):
            raise BadInput(
                f"'{name}': scale factor {one.scale:g} with bias {one.bias:g} is not plausible; "
                f"scale factors from {_SCALES[0]:g} to {_SCALES[1]:g} are expected, negative for a "
                "wrong sign",
                code="bad-calibration",
                channel=name,
            )
    elif not one.stretches:
        raise BadInput(
            f"'{name}': a repair needs the samples to replace", code="no-stretch", channel=name
        )
    else:
        repair_samples(samples, one.stretches, rate_hz)
