"""Analyses of flutter summaries: the headings of their pages.

Revision: 0035, after 0034
"""

import sqlalchemy as sa
from alembic import op

revision = "0035"
down_revision = "0034"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("flutter_summaries") as table:
        table.add_column(sa.Column("analyses", sa.JSON(), nullable=False, server_default="[]"))


def downgrade() -> None:
    with op.batch_alter_table("flutter_summaries") as table:
        table.drop_column("analyses")
