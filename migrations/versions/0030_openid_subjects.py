"""Accounts have a user of the OpenID provider.

Revision: 0030, after 0028
"""

import sqlalchemy as sa
from alembic import op

revision = "0030"
down_revision = "0028"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("accounts") as table:
        table.add_column(sa.Column("subject", sa.String(), nullable=True))
    op.create_index("ix_accounts_subject", "accounts", ["subject"], unique=True)


def downgrade() -> None:
    op.drop_index("ix_accounts_subject", "accounts")
    with op.batch_alter_table("accounts") as table:
        table.drop_column("subject")
