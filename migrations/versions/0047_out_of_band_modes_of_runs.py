"""Settings of runs and templates from before out-of-band modes were a choice state what they meant.

Revision: 0047, after 0046

Their models omit these modes, as those of all searches did. Without the field they would be
read as a new run, which retains them. The hash of a run that it held for is renewed, so that an
altered run stays recognisable.
"""

import hashlib
import json
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0047"
down_revision = "0046"
branch_labels = None
depends_on = None

_FIELD = "out_of_band_modes"
_SEALED = ("maneuver_id", "method", "structure", "settings", "result", "versions")
_UNDECIDED = (
    "an earlier version computed this search, whose model omits the modes that runs retain."
    " Search again, or open a candidate as a run."
)
_JSON = sa.JSON(none_as_null=True)


def upgrade() -> None:
    connection = op.get_bind()
    for name in ("runs", "run_templates"):
        nested = () if name == "run_templates" else ("structure", "result", "versions")
        table = sa.table(
            name,
            *map(sa.column, ("id", "maneuver_id", "method", "result_hash")),
            *(sa.column(column, _JSON) for column in ("settings", *nested)),
        )
        # Without results, of 100 kB each.
        is_without = ~sa.cast(table.c.settings, sa.String).contains(f'"{_FIELD}"')
        listed = sa.select(table.c.id, table.c.settings).where(is_without)
        for number, settings in connection.execute(listed).all():
            values: dict[str, Any] = {"settings": {**settings, _FIELD: "omitted"}}
            this = table.c.id == number
            if nested:
                query = sa.select(*(table.c[name] for name in (*_SEALED, "result_hash")))
                *sealed, stored = connection.execute(query.where(this)).one()
                if stored is not None and _hash(sealed) == stored:
                    sealed[_SEALED.index("settings")] = values["settings"]
                    values["result_hash"] = _hash(sealed)
            connection.execute(sa.update(table).where(this).values(**values))
    _mark_searches(connection)


def _mark_searches(connection: sa.Connection) -> None:
    """State for which reason a result of a search proposes nothing."""
    table = sa.table("searches", sa.column("id"), sa.column("result", _JSON))
    for number in connection.scalars(sa.select(table.c.id)).all():
        result = connection.scalar(sa.select(table.c.result).where(table.c.id == number))
        if result is None or "undecided" in result:
            continue
        for candidate in result["candidates"]:
            candidate["proposed"] = False
        marked = {
            **result,
            "undecided": _UNDECIDED,
            "sentence": f"Not decided: {_UNDECIDED} Until now: {result['sentence']}",
        }
        connection.execute(sa.update(table).where(table.c.id == number).values(result=marked))


def downgrade() -> None:
    """Retain the field: earlier versions read it too."""


def _hash(sealed: list[Any]) -> str:
    text = json.dumps(sealed, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()
