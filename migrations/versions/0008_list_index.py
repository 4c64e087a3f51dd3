"""Lists of runs are counted from an index that starts with what every list asks.

Revision: 0008, after 0007
"""

from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

NEWEST = ("maneuver_id", "method", "id", "deleted_at", "state")
LISTED = (
    *("deleted_at", "method", "state", "maneuver_id", "id", "author"),
    *("created_at", "finished_at"),
)
BEFORE = (
    *("maneuver_id", "method", "id", "state", "deleted_at", "author"),
    *("created_at", "finished_at"),
)


def upgrade() -> None:
    op.drop_index("ix_runs_list", "runs")
    op.create_index("ix_runs_list", "runs", LISTED)
    op.create_index("ix_runs_newest", "runs", NEWEST)


def downgrade() -> None:
    op.drop_index("ix_runs_newest", "runs")
    op.drop_index("ix_runs_list", "runs")
    op.create_index("ix_runs_list", "runs", BEFORE)
