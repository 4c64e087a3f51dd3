"""Index of the authors of runs, by which lists are searched.

Revision: 0044, after 0043
"""

from alembic import op

revision = "0044"
down_revision = "0043"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_index("ix_runs_author", "runs", ["author"])


def downgrade() -> None:
    op.drop_index("ix_runs_author", "runs")
