"""Where accounts have logged in; and failed log-ins by the time at which they are forgotten.

Revision: 0048, after 0047
"""

import sqlalchemy as sa
from alembic import op

revision = "0048"
down_revision = "0047"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "login_places",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("account_id", sa.Integer(), nullable=False),
        sa.Column("place", sa.String(), nullable=False),
        sa.Column("used_at", sa.DateTime(), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_login_places"),
        sa.ForeignKeyConstraint(
            ["account_id"], ["accounts.id"], "fk_login_places_account_id", ondelete="CASCADE"
        ),
        sa.UniqueConstraint("place", "account_id", name="uq_login_places_place_account_id"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_login_places_account_id", "login_places", ["account_id"])
    # Counts of failures, of no use without the time of each.
    op.drop_table("login_failures")
    op.create_table(
        "login_failures",
        sa.Column("subject", sa.String(200), nullable=False),
        sa.Column("forgotten_at", sa.DateTime(), nullable=False),
        sa.PrimaryKeyConstraint("subject", name="pk_login_failures"),
    )


def downgrade() -> None:
    op.drop_table("login_failures")
    op.create_table(
        "login_failures",
        sa.Column("subject", sa.String(200), nullable=False),
        sa.Column("failures", sa.Integer(), nullable=False),
        sa.Column("last_at", sa.DateTime(), nullable=False),
        sa.PrimaryKeyConstraint("subject", name="pk_login_failures"),
    )
    op.drop_table("login_places")
