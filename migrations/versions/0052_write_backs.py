"""Write-backs: posteriors of runs as versions of modal tables and predictions.

Revision: 0052, after 0051
"""

import sqlalchemy as sa
from alembic import op

revision = "0052"
down_revision = "0051"
branch_labels = None
depends_on = None

TABLE = "write_backs"
_REFERENCES = {
    "aircraft_id": "aircraft",
    "prediction_id": "predictions",
    "former_prediction_id": "predictions",
    "modal_table_id": "modal_tables",
    "former_modal_table_id": "modal_tables",
}


def upgrade() -> None:
    op.create_table(
        TABLE,
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("run_hash", sa.String(length=64), nullable=False),
        sa.Column("reason", sa.String(), nullable=False),
        sa.Column("sentence", sa.String(), nullable=False),
        sa.Column("maneuver_ids", sa.JSON(), nullable=False),
        sa.Column("fuel_fraction", sa.Double(), nullable=False),
        sa.Column("modes", sa.JSON(), nullable=False),
        sa.Column("names", sa.JSON(), nullable=False),
        sa.Column("values", sa.JSON(), nullable=False),
        sa.Column("covariance", sa.String(length=64), nullable=False),
        sa.Column("adequacy", sa.String(), nullable=False),
        sa.Column("prediction_id", sa.Integer(), nullable=False),
        sa.Column("former_prediction_id", sa.Integer(), nullable=True),
        sa.Column("modal_table_id", sa.Integer(), nullable=True),
        sa.Column("former_modal_table_id", sa.Integer(), nullable=True),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("undone_by", sa.String(), nullable=True),
        sa.Column("undone_at", sa.DateTime(), nullable=True),
        sa.Column("id", sa.Integer(), nullable=False),
        *(
            sa.ForeignKeyConstraint(
                [column], [f"{table}.id"], name=op.f(f"fk_{TABLE}_{column}_{table}")
            )
            for column, table in _REFERENCES.items()
        ),
        sa.ForeignKeyConstraint(
            ["covariance"], ["arrays.hash"], name=op.f(f"fk_{TABLE}_covariance_arrays")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f(f"pk_{TABLE}")),
        sqlite_autoincrement=True,
    )
    for column in (*_REFERENCES, "covariance"):
        op.create_index(op.f(f"ix_{TABLE}_{column}"), TABLE, [column])


def downgrade() -> None:
    op.drop_table(TABLE)
