"""Checksums of samples, compared on every read.

Revision: 0043, after 0042
"""

import sqlalchemy as sa
from alembic import op

revision = "0043"
down_revision = "0042"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("arrays", sa.Column("checksum", sa.LargeBinary))


def downgrade() -> None:
    with op.batch_alter_table("arrays") as table:
        table.drop_column("checksum")
