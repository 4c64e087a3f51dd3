"""Controllers of aircraft, and designs flown in simulation.

Revision: 0012, after 0011
"""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "controllers",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("reads", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("drives", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("laws", sa.JSON(none_as_null=True), nullable=False),
        sa.Column("delay_s", sa.Double(), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(
            ["aircraft_id"], ["aircraft.id"], name=op.f("fk_controllers_aircraft_id_aircraft")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_controllers")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_controllers_aircraft_id"), "controllers", ["aircraft_id"])
    op.create_table(
        "rehearsals",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("design_id", sa.Integer(), nullable=False),
        sa.Column("level", sa.Integer(), nullable=False),
        sa.Column("model_run_id", sa.Integer(), nullable=False),
        sa.Column("controller_id", sa.Integer(), nullable=True),
        sa.Column("maneuver_id", sa.Integer(), nullable=False),
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        *(
            sa.ForeignKeyConstraint(
                [column],
                [f"{table}.id"],
                name=op.f(f"fk_rehearsals_{column}_{table}"),
                ondelete="CASCADE",
            )
            for column, table in (
                ("design_id", "designs"),
                ("model_run_id", "runs"),
                ("maneuver_id", "maneuvers"),
                ("run_id", "runs"),
            )
        ),
        sa.ForeignKeyConstraint(
            ["controller_id"],
            ["controllers.id"],
            name=op.f("fk_rehearsals_controller_id_controllers"),
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_rehearsals")),
        sqlite_autoincrement=True,
    )
    for column in ("design_id", "model_run_id", "controller_id", "maneuver_id", "run_id"):
        op.create_index(op.f(f"ix_rehearsals_{column}"), "rehearsals", [column])


def downgrade() -> None:
    op.drop_table("rehearsals")
    op.drop_table("controllers")
