"""Modal tables have versions, reasons, notes and shapes at many nodes; flutter and GVT data.

Revision: 0007, after 0006
"""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("modal_tables") as changed:
        changed.add_column(sa.Column("version", sa.Integer(), nullable=False, server_default="1"))
        changed.add_column(sa.Column("reasons", sa.JSON(), nullable=False, server_default="[]"))
        changed.add_column(sa.Column("notes", sa.JSON(), nullable=False, server_default="[]"))
    op.create_table(
        "modal_shapes",
        sa.Column("modal_table_id", sa.Integer(), nullable=False),
        sa.Column("fuel", sa.Integer(), nullable=False),
        sa.Column("mode", sa.Integer(), nullable=False),
        sa.Column("array", sa.String(64), nullable=False),
        sa.ForeignKeyConstraint(
            ["modal_table_id"],
            ["modal_tables.id"],
            name=op.f("fk_modal_shapes_modal_table_id"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(["array"], ["arrays.hash"], name=op.f("fk_modal_shapes_array")),
        sa.PrimaryKeyConstraint("modal_table_id", "fuel", "mode", name=op.f("pk_modal_shapes")),
    )
    op.create_index(op.f("ix_modal_shapes_array"), "modal_shapes", ["array"])
    op.create_table(
        "mode_corrections",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("modal_table_id", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("symmetric", sa.Boolean(), nullable=False),
        sa.Column("reason", sa.String(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(
            ["modal_table_id"],
            ["modal_tables.id"],
            name=op.f("fk_mode_corrections_modal_table_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_mode_corrections")),
        sqlite_autoincrement=True,
    )
    op.create_index(
        op.f("ix_mode_corrections_modal_table_id"), "mode_corrections", ["modal_table_id"]
    )
    for name, more in (
        ("flutter_summaries", [sa.Column("points", sa.JSON(), nullable=False)]),
        (
            "measured_responses",
            [
                sa.Column("fuel", sa.Double(), nullable=False),
                sa.Column("quantity", sa.String(), nullable=False),
                sa.Column("outputs", sa.JSON(), nullable=False),
                sa.Column("references", sa.JSON(), nullable=False),
            ],
        ),
    ):
        op.create_table(
            name,
            sa.Column("id", sa.Integer(), nullable=False),
            sa.Column("aircraft_id", sa.Integer(), nullable=False),
            sa.Column("name", sa.String(), nullable=False),
            *more,
            sa.Column("arrays", sa.JSON(), nullable=False),
            sa.Column("notes", sa.JSON(), nullable=False),
            sa.Column("origin", sa.String(), nullable=False),
            sa.ForeignKeyConstraint(
                ["aircraft_id"], ["aircraft.id"], name=op.f(f"fk_{name}_aircraft_id")
            ),
            sa.PrimaryKeyConstraint("id", name=op.f(f"pk_{name}")),
            sqlite_autoincrement=True,
        )
        op.create_index(op.f(f"ix_{name}_aircraft_id"), name, ["aircraft_id"])


def downgrade() -> None:
    for name in ("measured_responses", "flutter_summaries", "mode_corrections", "modal_shapes"):
        op.drop_table(name)
    with op.batch_alter_table("modal_tables") as changed:
        for column in ("notes", "reasons", "version"):
            changed.drop_column(column)
