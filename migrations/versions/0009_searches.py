"""Searches for model structure are kept with all their candidates.

Revision: 0009, after 0008
"""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "searches",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("maneuver_ids", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("method", sa.String(length=8), nullable=False),
        sa.Column("structure", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("settings", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("modal_table_id", sa.Integer(), nullable=True),
        sa.Column("damping_table_id", sa.Integer(), nullable=True),
        sa.Column("prediction_id", sa.Integer(), nullable=True),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("progress", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("error", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("result", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("versions", sa.JSON(none_as_null=True), nullable=True),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("finished_at", sa.DateTime(), nullable=True),
        sa.ForeignKeyConstraint(
            ["aircraft_id"], ["aircraft.id"], name=op.f("fk_searches_aircraft_id_aircraft")
        ),
        sa.ForeignKeyConstraint(
            ["modal_table_id"],
            ["modal_tables.id"],
            name=op.f("fk_searches_modal_table_id_modal_tables"),
        ),
        sa.ForeignKeyConstraint(
            ["damping_table_id"],
            ["modal_tables.id"],
            name=op.f("fk_searches_damping_table_id_modal_tables"),
        ),
        sa.ForeignKeyConstraint(
            ["prediction_id"],
            ["predictions.id"],
            name=op.f("fk_searches_prediction_id_predictions"),
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_searches")),
        sqlite_autoincrement=True,
    )
    for column in (
        "aircraft_id",
        "modal_table_id",
        "damping_table_id",
        "prediction_id",
        "state",
    ):
        op.create_index(op.f(f"ix_searches_{column}"), "searches", [column])


def downgrade() -> None:
    op.drop_table("searches")
