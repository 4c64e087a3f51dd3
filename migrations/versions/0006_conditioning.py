"""What was decided about the channels of a maneuver, and how good it was found to be.

Revision: 0006, after 0005
"""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "conditioning_steps",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("maneuver_id", sa.Integer(), nullable=False),
        sa.Column("channel", sa.String(), nullable=False),
        sa.Column("correction", sa.JSON(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("undone_by", sa.String(), nullable=True),
        sa.Column("undone_at", sa.DateTime(), nullable=True),
        sa.ForeignKeyConstraint(
            ["maneuver_id"],
            ["maneuvers.id"],
            name=op.f("fk_conditioning_steps_maneuver_id_maneuvers"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_conditioning_steps")),
        sqlite_autoincrement=True,
    )
    op.create_index(
        op.f("ix_conditioning_steps_maneuver_id"), "conditioning_steps", ["maneuver_id"]
    )
    op.create_table(
        "maneuver_quality",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("maneuver_id", sa.Integer(), nullable=False),
        sa.Column("content_hash", sa.String(64), nullable=False),
        sa.Column("verdict", sa.String(), nullable=False),
        sa.Column("summary", sa.String(), nullable=False),
        sa.Column("figures", sa.JSON(), nullable=False),
        sa.Column("report", sa.JSON(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(
            ["maneuver_id"],
            ["maneuvers.id"],
            name=op.f("fk_maneuver_quality_maneuver_id_maneuvers"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_maneuver_quality")),
        sa.UniqueConstraint("maneuver_id", name=op.f("uq_maneuver_quality_maneuver_id")),
        sqlite_autoincrement=True,
    )


def downgrade() -> None:
    op.drop_table("maneuver_quality")
    op.drop_table("conditioning_steps")
