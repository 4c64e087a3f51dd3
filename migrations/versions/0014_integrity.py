"""What runs were computed from, and a hash of each result.

Results of earlier releases are sealed as they are now; what they were computed from was not
recorded.

Revision: 0014, after 0013
"""

import hashlib
import json

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"
branch_labels = None
depends_on = None

_SEALED = ("maneuver_id", "method", "structure", "settings", "result", "versions")
_NESTED = ("structure", "settings", "result", "versions")


def upgrade() -> None:
    op.add_column("runs", sa.Column("rests_on", sa.JSON(none_as_null=True), nullable=True))
    op.add_column("runs", sa.Column("result_hash", sa.String(64), nullable=True))
    runs = sa.table(
        "runs",
        sa.column("id", sa.Integer),
        sa.column("result_hash", sa.String),
        *(sa.column(name, sa.JSON if name in _NESTED else None) for name in _SEALED),
    )
    connection = op.get_bind()
    ended = sa.select(runs.c.id).where(runs.c.result.is_not(None))
    for number in list(connection.scalars(ended)):
        this = runs.c.id == number
        query = sa.select(*(runs.c[name] for name in _SEALED)).where(this)
        content = list(connection.execute(query).one())
        text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
        digest = hashlib.sha256(text.encode()).hexdigest()
        connection.execute(sa.update(runs).where(this).values(result_hash=digest))


def downgrade() -> None:
    op.drop_column("runs", "result_hash")
    op.drop_column("runs", "rests_on")
