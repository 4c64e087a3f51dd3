"""Channels know their source, flights have channels, mappings are kept.

Revision: 0003, after 0002
"""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

SOURCE = ("sensor", "source_file", "source_hash", "source_field")


def upgrade() -> None:
    with op.batch_alter_table("channels") as channels:
        for name in SOURCE:
            channels.add_column(sa.Column(name, sa.String(), nullable=True))
    op.create_table(
        "flight_channels",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("flight_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("unit", sa.String(), nullable=False),
        sa.Column("role", sa.String(), nullable=False),
        sa.Column("rate_hz", sa.Double(), nullable=False),
        sa.Column("start_s", sa.Double(), nullable=False),
        sa.Column("n_samples", sa.Integer(), nullable=False),
        sa.Column("array", sa.String(length=64), nullable=False),
        *(sa.Column(name, sa.String(), nullable=True) for name in SOURCE),
        sa.ForeignKeyConstraint(
            ["array"], ["arrays.hash"], name=op.f("fk_flight_channels_array_arrays")
        ),
        sa.ForeignKeyConstraint(
            ["flight_id"],
            ["flights.id"],
            name=op.f("fk_flight_channels_flight_id_flights"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_flight_channels")),
        sa.UniqueConstraint("flight_id", "name", name=op.f("uq_flight_channels_flight_id_name")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_flight_channels_array"), "flight_channels", ["array"])
    op.create_table(
        "mappings",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("text", sa.String(), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_mappings")),
        sa.UniqueConstraint("name", name=op.f("uq_mappings_name")),
        sqlite_autoincrement=True,
    )


def downgrade() -> None:
    op.drop_table("mappings")
    op.drop_table("flight_channels")
    with op.batch_alter_table("channels") as channels:
        for name in SOURCE:
            channels.drop_column(name)
