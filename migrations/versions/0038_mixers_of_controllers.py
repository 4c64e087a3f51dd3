"""Mixers and rate limits of controllers.

Revision: 0038, after 0037
"""

import sqlalchemy as sa
from alembic import op

revision = "0038"
down_revision = "0037"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("controllers") as table:
        table.add_column(sa.Column("commands", sa.JSON(), nullable=False, server_default="[]"))
        table.add_column(sa.Column("mixer", sa.JSON(), nullable=False, server_default="[]"))
        table.add_column(sa.Column("rate_limit_rad_s", sa.Double(), nullable=True))


def downgrade() -> None:
    with op.batch_alter_table("controllers") as table:
        for name in ("commands", "mixer", "rate_limit_rad_s"):
            table.drop_column(name)
