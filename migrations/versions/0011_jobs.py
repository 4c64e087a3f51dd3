"""Runs have a hash, a priority and a log, and stand in batches; servers hold a lease.

Revision: 0011, after 0010
"""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("runs") as runs:
        runs.add_column(sa.Column("priority", sa.Integer(), nullable=False, server_default="0"))
        runs.add_column(sa.Column("after_run_id", sa.Integer(), nullable=True))
        runs.add_column(sa.Column("limits", sa.JSON(), nullable=True))
        runs.add_column(sa.Column("data_hash", sa.String(64), nullable=True))
        runs.add_column(sa.Column("input_hash", sa.String(64), nullable=True))
        runs.add_column(sa.Column("worker", sa.String(), nullable=True))
        runs.add_column(sa.Column("owner", sa.String(), nullable=True))
        runs.add_column(sa.Column("deaths", sa.Integer(), nullable=False, server_default="0"))
        runs.create_foreign_key(
            op.f("fk_runs_after_run_id_runs"), "runs", ["after_run_id"], ["id"], ondelete="SET NULL"
        )
        runs.create_index(op.f("ix_runs_after_run_id"), ["after_run_id"])
        runs.create_index(op.f("ix_runs_input_hash"), ["input_hash"])
        runs.create_index(op.f("ix_runs_state_priority_id"), ["state", "priority", "id"])
        runs.create_index(op.f("ix_runs_finished_at"), ["finished_at"])
    op.create_table(
        "batches",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_batches")),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "batch_runs",
        sa.Column("batch_id", sa.Integer(), nullable=False),
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["batch_id"],
            ["batches.id"],
            name=op.f("fk_batch_runs_batch_id_batches"),
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["run_id"], ["runs.id"], name=op.f("fk_batch_runs_run_id_runs"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("batch_id", "run_id", name=op.f("pk_batch_runs")),
    )
    op.create_index(op.f("ix_batch_runs_run_id"), "batch_runs", ["run_id"])
    op.create_table(
        "run_events",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(), nullable=False),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("message", sa.String(), nullable=False),
        sa.ForeignKeyConstraint(
            ["run_id"], ["runs.id"], name=op.f("fk_run_events_run_id_runs"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_run_events")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_run_events_run_id"), "run_events", ["run_id"])
    leases = op.create_table(
        "leases",
        sa.Column("name", sa.String(32), nullable=False),
        sa.Column("holder", sa.String(), nullable=True),
        sa.Column("epoch", sa.Integer(), nullable=False),
        sa.Column("beats", sa.BigInteger(), nullable=False),
        sa.Column("status", sa.JSON(), nullable=True),
        sa.PrimaryKeyConstraint("name", name=op.f("pk_leases")),
    )
    op.bulk_insert(leases, [{"name": "dispatcher", "epoch": 0, "beats": 0}])
    if op.get_bind().dialect.name == "postgresql":
        # Samples do not compress, and a part of them is read without the rest.
        op.execute("ALTER TABLE arrays ALTER COLUMN data SET STORAGE EXTERNAL")


def downgrade() -> None:
    if op.get_bind().dialect.name == "postgresql":
        op.execute("ALTER TABLE arrays ALTER COLUMN data SET STORAGE EXTENDED")
    op.drop_table("leases")
    op.drop_table("run_events")
    op.drop_table("batch_runs")
    op.drop_table("batches")
    with op.batch_alter_table("runs") as runs:
        for index in ("finished_at", "state_priority_id", "input_hash", "after_run_id"):
            runs.drop_index(op.f(f"ix_runs_{index}"))
        runs.drop_constraint(op.f("fk_runs_after_run_id_runs"), type_="foreignkey")
        for column in (
            *("deaths", "owner", "worker", "input_hash", "data_hash", "limits"),
            *("after_run_id", "priority"),
        ):
            runs.drop_column(column)
