"""Versions of global models, which are written once.

Revision: 0032, after 0030
"""

import sqlalchemy as sa
from alembic import op

revision = "0032"
down_revision = "0030"
branch_labels = None
depends_on = None

TABLE = "global_model_versions"


def upgrade() -> None:
    op.create_table(
        TABLE,
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("axis", sa.String(), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("label", sa.String(), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("sentence", sa.String(), nullable=False),
        sa.Column("variables", sa.JSON(), nullable=False),
        sa.Column("prediction_id", sa.Integer(), nullable=True),
        sa.Column("runs", sa.JSON(), nullable=False),
        sa.Column("result", sa.String(length=64), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(
            ["aircraft_id"],
            ["aircraft.id"],
            name=op.f("fk_global_model_versions_aircraft_id_aircraft"),
        ),
        sa.ForeignKeyConstraint(
            ["prediction_id"],
            ["predictions.id"],
            name=op.f("fk_global_model_versions_prediction_id_predictions"),
        ),
        sa.ForeignKeyConstraint(
            ["result"], ["arrays.hash"], name=op.f("fk_global_model_versions_result_arrays")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_global_model_versions")),
        sa.UniqueConstraint(
            *("aircraft_id", "axis", "version"),
            name=op.f("uq_global_model_versions_aircraft_id_axis_version"),
        ),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_global_model_versions_prediction_id"), TABLE, ["prediction_id"])
    op.create_index(op.f("ix_global_model_versions_result"), TABLE, ["result"])
    if op.get_bind().dialect.name == "postgresql":
        op.execute(
            f"CREATE TRIGGER {TABLE}_append_only BEFORE UPDATE OR DELETE ON {TABLE}"
            " FOR EACH ROW EXECUTE FUNCTION flexsid_append_only()"
        )
        return
    for action in ("UPDATE", "DELETE"):
        op.execute(
            f"CREATE TRIGGER {TABLE}_no_{action.lower()} BEFORE {action} ON {TABLE}"
            f" BEGIN SELECT RAISE(ABORT, '{TABLE} is append-only'); END"
        )


def downgrade() -> None:
    op.drop_table(TABLE)
