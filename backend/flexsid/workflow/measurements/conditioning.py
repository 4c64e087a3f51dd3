"""Conditioning: corrections of channels that were decided, applied wherever samples are read.

What was recorded is never changed: steps stand beside it, and one that is undone is as if it
had never been, except that it can be seen.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.conditioning import ConditioningStep, Correction, StepKind
from flexsid.storage.channels import read_channels
from flexsid.storage.store import Store
from flexsid.sysid.preparation.artefacts import repair
from flexsid.workflow.measurements.recording import Conditioning

_LONGEST_DELAY_S = 1.0
_SCALES = (0.01, 100.0)


def conditioning_of(store: Store, maneuver_id: int | None) -> dict[str, Conditioning]:
    """Corrections in force by channel; channels without any are not in it."""
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


def take_steps(
    store: Store, maneuver_id: int, corrections: Sequence[Correction], author: str = ""
) -> list[ConditioningStep]:
    """Take corrections, all or none.

    Raises
    ------
    BadInput
        If a channel is not recorded, or a correction is impossible.
    Conflict
        If a channel has a delay or calibration already: undo that first.
    """
    if not corrections:
        raise BadInput("no correction was given", code="no-correction")
    channels = read_channels(store.database, maneuver_id, [c.channel for c in corrections])
    with store.transaction():
        store.maneuvers.get(maneuver_id)
        taken = {
            (step.channel, step.correction.kind)
            for step in store.conditioning.find(maneuver_id=maneuver_id, undone_at=None)
            if step.correction.kind is not StepKind.REPAIR
        }
        kept = []
        for one in corrections:
            if one.channel not in channels:
                raise BadInput(
                    f"the maneuver has no channel '{one.channel}'",
                    code="unknown-channel",
                    channel=one.channel,
                )
            if (one.channel, one.kind) in taken:
                raise Conflict(
                    f"'{one.channel}' has a {one.kind.value} already; undo that first",
                    code="already-conditioned",
                    channel=one.channel,
                )
            channel, samples = channels[one.channel]
            _check(one, np.asarray(samples, dtype=float), channel.rate_hz)
            if one.kind is not StepKind.REPAIR:
                taken.add((one.channel, one.kind))
            step = ConditioningStep(
                maneuver_id=maneuver_id, correction=one, channel=one.channel, author=author
            )
            kept.append(store.conditioning.add(step))
    return kept


def undo_step(store: Store, maneuver_id: int, step_id: int, author: str = "") -> ConditioningStep:
    """Undo a step; it stays in the record with who undid it.

    Raises
    ------
    UnknownRecord
        If the maneuver has no such step.
    Conflict
        If it was undone before.
    """
    with store.transaction():
        step = store.conditioning.get(step_id)
        if step.maneuver_id != maneuver_id:
            raise UnknownRecord(f"maneuver {maneuver_id} has no conditioning step {step_id}")
        if step.undone_at is not None:
            raise Conflict("this step is undone already", code="already-undone")
        undone = replace(step, undone_at=datetime.now(UTC), undone_by=author)
        return store.conditioning.replace(undone)


def _check(one: Correction, samples: np.ndarray, rate_hz: float) -> None:
    name = one.channel
    if one.kind is StepKind.DELAY:
        if not abs(one.delay_s) <= _LONGEST_DELAY_S or one.delay_s == 0.0:
            raise BadInput(
                f"'{name}': a delay of {one.delay_s:g} s is none that a recorder has; up to "
                f"{_LONGEST_DELAY_S:g} s are expected, and not zero",
                code="bad-delay",
                channel=name,
            )
    elif one.kind is StepKind.CALIBRATION:
        if not (_SCALES[0] <= abs(one.scale) <= _SCALES[1] and math.isfinite(one.bias)):
            raise BadInput(
                f"'{name}': scale factor {one.scale:g} with bias {one.bias:g} is impossible; "
                f"scale factors from {_SCALES[0]:g} to {_SCALES[1]:g}, below zero where a sign is "
                "wrong, are expected",
                code="bad-calibration",
                channel=name,
            )
    elif not one.stretches:
        raise BadInput(
            f"'{name}': a repair needs the samples to replace", code="no-stretch", channel=name
        )
    else:
        repair(samples, one.stretches, rate_hz)
