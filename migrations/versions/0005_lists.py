"""Maneuvers and runs are deleted softly and tagged; lists are read from an index.

Revision: 0005, after 0004
"""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

LISTED = (
    *("maneuver_id", "method", "id", "state", "deleted_at", "author"),
    *("created_at", "finished_at"),
)


def upgrade() -> None:
    for table in ("maneuvers", "runs"):
        with op.batch_alter_table(table) as changed:
            changed.add_column(sa.Column("deleted_at", sa.DateTime(), nullable=True))
    op.drop_index("ix_runs_maneuver_id_method_id", "runs")
    op.create_index("ix_runs_list", "runs", LISTED)
    for table, owner, owners in (
        ("maneuver_tags", "maneuver_id", "maneuvers"),
        ("run_tags", "run_id", "runs"),
    ):
        op.create_table(
            table,
            sa.Column(owner, sa.Integer(), nullable=False),
            sa.Column("tag", sa.String(), nullable=False),
            sa.ForeignKeyConstraint(
                [owner],
                [f"{owners}.id"],
                name=op.f(f"fk_{table}_{owner}_{owners}"),
                ondelete="CASCADE",
            ),
            sa.PrimaryKeyConstraint(owner, "tag", name=op.f(f"pk_{table}")),
        )
        op.create_index(op.f(f"ix_{table}_tag"), table, ["tag"])
    op.create_table(
        "saved_views",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("page", sa.String(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("search", sa.String(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_saved_views")),
        sa.UniqueConstraint("page", "name", name=op.f("uq_saved_views_page_name")),
        sqlite_autoincrement=True,
    )


def downgrade() -> None:
    op.drop_table("saved_views")
    op.drop_table("run_tags")
    op.drop_table("maneuver_tags")
    op.drop_index("ix_runs_list", "runs")
    op.create_index("ix_runs_maneuver_id_method_id", "runs", ["maneuver_id", "method", "id"])
    for table in ("runs", "maneuvers"):
        with op.batch_alter_table(table) as changed:
            changed.drop_column("deleted_at")
