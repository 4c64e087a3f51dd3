"""Channels state what they are between their samples.

Revision: 0051, after 0050
"""

import sqlalchemy as sa
from alembic import op

revision = "0051"
down_revision = "0050"
branch_labels = None
depends_on = None

TABLES = ("channels", "flight_channels")
_KEPT = {"sqlite_autoincrement": True}


def upgrade() -> None:
    for name in TABLES:
        op.add_column(name, sa.Column("between_samples", sa.String(), nullable=True))


def downgrade() -> None:
    for name in reversed(TABLES):
        with op.batch_alter_table(name, table_kwargs=_KEPT) as batch:
            batch.drop_column("between_samples")
