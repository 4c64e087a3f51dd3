"""Predicted standard errors of pre-flight simulations, until now computed when they were listed.

Revision: 0037, after 0036
"""

import sqlalchemy as sa
from alembic import op

revision = "0037"
down_revision = "0036"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column(
        "preflight_simulations", sa.Column("expected", sa.JSON(none_as_null=True), nullable=True)
    )


def downgrade() -> None:
    op.drop_column("preflight_simulations", "expected")
