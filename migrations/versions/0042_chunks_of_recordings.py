"""Samples of whole flights in chunks outside the database.

Revision: 0042, after 0041
"""

import sqlalchemy as sa
from alembic import op

revision = "0042"
down_revision = "0041"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("flight_channels", sa.Column("samples_per_chunk", sa.Integer))


def downgrade() -> None:
    with op.batch_alter_table("flight_channels") as table:
        table.drop_column("samples_per_chunk")
