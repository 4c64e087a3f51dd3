"""Refits on which a prediction rests are runs, and name the run that they are derived from.

Revision: 0019, after 0018
"""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"
branch_labels = None
depends_on = None

_LISTS = {
    "ix_runs_newest": ("maneuver_id", "method", "id", "deleted_at", "state"),
    "ix_runs_list": (
        *("deleted_at", "method", "state", "maneuver_id", "id", "author"),
        *("created_at", "finished_at"),
    ),
}


def upgrade() -> None:
    # The table is not rebuilt: it has all results.
    op.execute(
        "ALTER TABLE runs ADD COLUMN derived_from_run_id INTEGER"
        " CONSTRAINT fk_runs_derived_from_run_id REFERENCES runs (id)"
    )
    op.add_column("runs", sa.Column("derivation", sa.JSON(none_as_null=True), nullable=True))
    op.create_index("ix_runs_derived_from_run_id", "runs", ["derived_from_run_id"])
    for name, columns in _LISTS.items():
        op.drop_index(name, "runs")
        op.create_index(name, "runs", [*columns, "derived_from_run_id"])


def downgrade() -> None:
    for name, columns in _LISTS.items():
        op.drop_index(name, "runs")
        op.create_index(name, "runs", columns)
    op.drop_index("ix_runs_derived_from_run_id", "runs")
    with op.batch_alter_table("runs") as runs:
        runs.drop_column("derivation")
        runs.drop_column("derived_from_run_id")
