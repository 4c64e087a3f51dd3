"""Mode shapes at all nodes: one array per fuel weight and mode.

A figure needs one mode at up to four fuel weights; one array of all modes may have a hundred
megabytes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import sqlalchemy as sa

from flexsid.storage.arrays import Arrays, describe_array
from flexsid.storage.database import Database
from flexsid.storage.tables import modal_shapes


class ModalShapes:
    """Store of shapes (n_nodes, 6) by modal table, fuel index and mode index."""

    def __init__(self, database: Database, arrays: Arrays) -> None:
        self._database = database
        self._arrays = arrays

    def put(self, modal_table_id: int, shapes: np.ndarray) -> None:
        """Store all shapes of a table, (n_fuel, n_modes, n_nodes, 6)."""
        n_fuel, n_modes = shapes.shape[:2]
        with self._database.transaction() as connection:
            for fuel in range(n_fuel):
                content = [describe_array(shapes[fuel, mode]) for mode in range(n_modes)]
                names = self._arrays.put_many(content)
                rows = [
                    {"modal_table_id": modal_table_id, "fuel": fuel, "mode": mode, "array": name}
                    for mode, name in enumerate(names)
                ]
                connection.execute(sa.insert(modal_shapes), rows)

    def copy(self, modal_table_id: int, new_id: int) -> None:
        """Refer from a new table to the stored shapes of another."""
        columns = modal_shapes.c
        query = sa.select(columns.fuel, columns.mode, columns.array).where(
            columns.modal_table_id == modal_table_id
        )
        with self._database.transaction() as connection:
            # Rows, since access and audit log cannot see those of INSERT ... SELECT.
            rows = [
                {"modal_table_id": new_id, **shape}
                for shape in connection.execute(query).mappings()
            ]
            if rows:
                connection.execute(sa.insert(modal_shapes), rows)

    def has(self, modal_table_id: int) -> bool:
        """Return whether a table has stored shapes."""
        query = sa.select(modal_shapes.c.mode).where(
            modal_shapes.c.modal_table_id == modal_table_id
        )
        with self._database.reading() as connection:
            return connection.execute(query.limit(1)).first() is not None

    def get(
        self, modal_table_id: int, places: Sequence[tuple[int, int]]
    ) -> dict[tuple[int, int], np.ndarray]:
        """Return shapes by (fuel index, mode index)."""
        columns = modal_shapes.c
        query = sa.select(columns.fuel, columns.mode, columns.array).where(
            columns.modal_table_id == modal_table_id,
            sa.tuple_(columns.fuel, columns.mode).in_(list(places)),
        )
        with self._database.reading() as connection:
            names = {(fuel, mode): name for fuel, mode, name in connection.execute(query)}
        arrays = self._arrays.get_many(names.values())
        return {place: arrays[name] for place, name in names.items()}
