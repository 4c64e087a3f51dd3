"""Accounts have preferred display units; templates of runs.

Revision: 0034, after 0033
"""

import sqlalchemy as sa
from alembic import op

revision = "0034"
down_revision = "0033"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("accounts") as table:
        table.add_column(
            sa.Column("unit_system", sa.String(16), nullable=False, server_default="metric")
        )
        table.add_column(
            sa.Column("frequency_unit", sa.String(16), nullable=False, server_default="Hz")
        )

    op.create_table(
        "run_templates",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("method", sa.String(8), nullable=False),
        sa.Column("settings", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("revision", sa.Integer(), nullable=False),
        sa.Column("original_id", sa.Integer(), nullable=True),
        sa.Column("is_deleted", sa.Boolean(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(["aircraft_id"], ["aircraft.id"]),
        sa.ForeignKeyConstraint(["original_id"], ["run_templates.id"]),
        sa.PrimaryKeyConstraint("id"),
        sa.UniqueConstraint("original_id", "revision"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_run_templates_aircraft_id", "run_templates", ["aircraft_id"])
    # The table is not rebuilt: it has all results.
    op.execute(
        "ALTER TABLE runs ADD COLUMN run_template_id INTEGER"
        " CONSTRAINT fk_runs_run_template_id REFERENCES run_templates (id)"
    )
    op.add_column("runs", sa.Column("run_template_revision", sa.Integer(), nullable=True))
    op.create_index("ix_runs_run_template_id", "runs", ["run_template_id"])


def downgrade() -> None:
    op.drop_index("ix_runs_run_template_id", "runs")
    with op.batch_alter_table("runs") as runs:
        runs.drop_column("run_template_revision")
        runs.drop_column("run_template_id")
    op.drop_table("run_templates")
    with op.batch_alter_table("accounts") as table:
        table.drop_column("frequency_unit")
        table.drop_column("unit_system")
