"""Averaging of frequency responses that are estimated from time data.

Revision: 0040, after 0039
"""

import sqlalchemy as sa
from alembic import op

revision = "0040"
down_revision = "0039"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("measured_responses", sa.Column("averaging", sa.JSON(none_as_null=True)))


def downgrade() -> None:
    with op.batch_alter_table("measured_responses") as table:
        table.drop_column("averaging")
