"""Accounts have preferred display units.

Revision: 0034, after 0033
"""

import sqlalchemy as sa
from alembic import op

revision = "0034"
down_revision = "0033"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("accounts") as table:
        table.add_column(
            sa.Column("unit_system", sa.String(16), nullable=False, server_default="metric")
        )
        table.add_column(
            sa.Column("frequency_unit", sa.String(16), nullable=False, server_default="Hz")
        )


def downgrade() -> None:
    with op.batch_alter_table("accounts") as table:
        table.drop_column("frequency_unit")
        table.drop_column("unit_system")
