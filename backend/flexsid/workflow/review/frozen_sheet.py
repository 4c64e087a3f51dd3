"""Sheets of evidence as they were when a decision was made."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import cache

import numpy as np
from pydantic import TypeAdapter

from flexsid.errors import BadInput, UnknownRecord
from flexsid.records.condition_sheet import ConditionSheet
from flexsid.records.decision import Decision, DecisionEvent, FrozenFigure
from flexsid.storage.store import Store
from flexsid.workflow.review.condition_sheet import find_condition

KIND = "condition-sheet"
"""Kind of the frozen figures that are sheets."""

_NAME = "sheet "  # of a sheet in the sealed data of an event, before its id
_MOST_SHEETS = 10  # of one decision: each is some 100 kB
_UNIT = "application/json"

ReadSheet = Callable[[int], ConditionSheet]
"""Returns the sheet of the condition of a maneuver."""


def freeze_sheets(
    store: Store, decision: Decision, author: str, read_sheet: ReadSheet
) -> dict[str, str]:
    """Store the sheets of the conditions that the runs of a proposal were flown at.

    Returns
    -------
    dict
        SHA-256 of the stored sheets by name, for the event that makes the decision. Empty for a
        global model, whose runs are its evidence.
    """
    if decision.proposal.structure is None:
        return {}
    conditions: dict[int, None] = {}
    for run_id in decision.proposal.run_ids:
        with suppress(UnknownRecord):  # deleted meanwhile, as the sealed evidence states
            item = find_condition(store, store.runs.get(run_id).maneuver_id)
            conditions[item.id] = None
    frozen: dict[str, str] = {}
    for condition_id in list(conditions)[:_MOST_SHEETS]:
        sheet = read_sheet(condition_id)
        content = np.frombuffer(_get_adapter().dump_json(sheet), dtype=np.uint8)
        item = sheet.condition
        figure = store.frozen_figures.add(
            FrozenFigure(
                kind=KIND,
                query=f"condition_id={condition_id}",
                title=f"{item.aircraft_name}, {item.airspeed_m_s:.1f} m/s,"
                f" fuel {100.0 * sheet.record.fuel_fraction:.0f} %",
                array=store.arrays.put(content, _UNIT),
                author=author,
            )
        )
        frozen[f"{_NAME}{figure.id}"] = figure.array
    return frozen


def hash_frozen_sheets(store: Store, data: Mapping[str, str]) -> dict[str, str]:
    """Hash the stored sheets that sealed data of an event name."""
    return {
        name: store.frozen_figures.get(int(name.removeprefix(_NAME))).array
        for name in data
        if name.startswith(_NAME)
    }


def list_frozen_sheets(store: Store, events: Sequence[DecisionEvent]) -> list[FrozenFigure]:
    """List the sheets that were frozen when the decision of these events was made."""
    names = dict.fromkeys(name for one in events for name in one.data if name.startswith(_NAME))
    return [store.frozen_figures.get(int(name.removeprefix(_NAME))) for name in names]


def read_frozen_sheet(store: Store, figure_id: int) -> ConditionSheet:
    """Read a sheet as it was frozen.

    Raises
    ------
    BadInput
        If the frozen figure is no sheet.
    """
    figure = store.frozen_figures.get(figure_id)
    if figure.kind != KIND:
        raise BadInput(
            f"frozen figure {figure_id} is a figure of {figure.kind}, not a sheet",
            code="not-a-sheet",
        )
    return _get_adapter().validate_json(store.arrays.get(figure.array).tobytes())


@cache
def _get_adapter() -> TypeAdapter[ConditionSheet]:
    return TypeAdapter(ConditionSheet)
