"""Checksums of rows; on SQLite they are computed after all migrations.

Revision: 0041, after 0040
"""

import sqlalchemy as sa
from alembic import op

revision = "0041"
down_revision = "0040"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "row_seals",
        sa.Column("table_name", sa.String(64), nullable=False),
        sa.Column("key", sa.String(), nullable=False),
        sa.Column("seal", sa.LargeBinary(8), nullable=False),
        sa.PrimaryKeyConstraint("table_name", "key", name=op.f("pk_row_seals")),
        sqlite_with_rowid=False,
    )


def downgrade() -> None:
    op.drop_table("row_seals")
