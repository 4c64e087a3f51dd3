"""Corrections of mode names and symmetries by analysts."""

from __future__ import annotations

from dataclasses import replace

from flexsid.records.modal_table import ModalTable
from flexsid.storage.store import Store


def apply_corrections(store: Store, table: ModalTable) -> ModalTable:
    """Return a table with corrected mode names and symmetries."""
    if table.id is None:
        return table
    names, symmetric, reasons = (
        list(part) for part in (table.names, table.symmetric, table.reasons)
    )
    reasons += [""] * (len(names) - len(reasons))
    for correction in store.mode_corrections.find(modal_table_id=table.id):
        if correction.number in table.numbers:
            index = table.numbers.index(correction.number)
            names[index], symmetric[index] = correction.name, correction.symmetric
            by = f", by {correction.author}" if correction.author else ""
            reasons[index] = f"{correction.reason} (corrected{by})"
    return replace(table, names=tuple(names), symmetric=tuple(symmetric), reasons=tuple(reasons))
