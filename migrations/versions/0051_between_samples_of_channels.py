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


def upgrade() -> None:
    for name in TABLES:
        op.add_column(name, sa.Column("between_samples", sa.String(), nullable=True))


def downgrade() -> None:
    for name in reversed(TABLES):
        op.drop_column(name, "between_samples")
