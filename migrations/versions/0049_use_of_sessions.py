"""When a session was last used.

Revision: 0049, after 0048
"""

from datetime import UTC, datetime

import sqlalchemy as sa
from alembic import op

revision = "0049"
down_revision = "0048"
branch_labels = None
depends_on = None

_KEPT = {"sqlite_autoincrement": True}


def upgrade() -> None:
    op.add_column("login_sessions", sa.Column("used_at", sa.DateTime()))
    # When they were last used is not known.
    used_at = sa.column("used_at", sa.DateTime())
    now = datetime.now(UTC).replace(tzinfo=None)
    op.execute(sa.table("login_sessions", used_at).update().values(used_at=now))
    with op.batch_alter_table("login_sessions", table_kwargs=_KEPT) as batch:
        batch.alter_column("used_at", existing_type=sa.DateTime(), nullable=False)


def downgrade() -> None:
    with op.batch_alter_table("login_sessions", table_kwargs=_KEPT) as batch:
        batch.drop_column("used_at")
