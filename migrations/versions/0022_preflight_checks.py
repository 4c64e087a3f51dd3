"""Pre-flight simulations have limited surfaces and margins of their loop.

Revision: 0022, after 0021
"""

import sqlalchemy as sa
from alembic import op

revision = "0022"
down_revision = "0021"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("preflight_simulations") as table:
        table.add_column(sa.Column("checks", sa.JSON(none_as_null=True), nullable=True))


def downgrade() -> None:
    with op.batch_alter_table("preflight_simulations") as table:
        table.drop_column("checks")
