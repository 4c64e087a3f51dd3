"""Modal tables with names and symmetries as analysts have corrected them."""

from __future__ import annotations

from dataclasses import replace

from flexsid.records.modal_table import ModalTable
from flexsid.storage.store import Store


def corrected(store: Store, table: ModalTable) -> ModalTable:
    """The table with names and symmetries as analysts have corrected them."""
    if table.id is None:
        return table
    names, symmetric, reasons = (
        list(part) for part in (table.names, table.symmetric, table.reasons)
    )
    reasons += [""] * (len(names) - len(reasons))
    for correction in store.mode_corrections.find(modal_table_id=table.id):
        if correction.number in table.numbers:
            place = table.numbers.index(correction.number)
            names[place], symmetric[place] = correction.name, correction.symmetric
            by = f", by {correction.author}" if correction.author else ""
            reasons[place] = f"{correction.reason} (corrected{by})"
    return replace(table, names=tuple(names), symmetric=tuple(symmetric), reasons=tuple(reasons))
