"""First schema.

Revision: 0001, the first
"""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "aircraft",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("geometry", sa.JSON(), nullable=False),
        sa.Column("mass", sa.JSON(), nullable=False),
        sa.Column("surfaces", sa.JSON(), nullable=False),
        sa.Column("sensors", sa.JSON(), nullable=False),
        sa.Column("combinations", sa.JSON(), nullable=False),
        sa.Column("instruments", sa.JSON(), nullable=False),
        sa.Column("polar", sa.JSON(), nullable=True),
        sa.Column("flutter", sa.JSON(), nullable=True),
        sa.Column("description", sa.String(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_aircraft")),
        sa.UniqueConstraint("name", name=op.f("uq_aircraft_name")),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "arrays",
        sa.Column("hash", sa.String(length=64), nullable=False),
        sa.Column("dtype", sa.String(length=16), nullable=False),
        sa.Column("shape", sa.JSON(), nullable=False),
        sa.Column("unit", sa.String(), nullable=False),
        sa.Column("n_bytes", sa.BigInteger(), nullable=False),
        sa.Column("data", sa.LargeBinary(), nullable=False),
        sa.PrimaryKeyConstraint("hash", name=op.f("pk_arrays")),
    )
    op.create_table(
        "flights",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("flown_on", sa.Date(), nullable=True),
        sa.Column("description", sa.String(), nullable=False),
        sa.ForeignKeyConstraint(
            ["aircraft_id"], ["aircraft.id"], name=op.f("fk_flights_aircraft_id")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_flights")),
        sa.UniqueConstraint("aircraft_id", "number", name=op.f("uq_flights_aircraft_id_number")),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "modal_tables",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("fuel", sa.JSON(), nullable=False),
        sa.Column("numbers", sa.JSON(), nullable=False),
        sa.Column("names", sa.JSON(), nullable=False),
        sa.Column("symmetric", sa.JSON(), nullable=False),
        sa.Column("points", sa.JSON(), nullable=False),
        sa.Column("gauges", sa.JSON(), nullable=False),
        sa.Column("arrays", sa.JSON(), nullable=False),
        sa.Column("origin", sa.String(), nullable=False),
        sa.ForeignKeyConstraint(
            ["aircraft_id"], ["aircraft.id"], name=op.f("fk_modal_tables_aircraft_id")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_modal_tables")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_modal_tables_aircraft_id"), "modal_tables", ["aircraft_id"])

    op.create_table(
        "model_structures",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("structure", sa.JSON(), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(
            ["aircraft_id"], ["aircraft.id"], name=op.f("fk_model_structures_aircraft_id")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_model_structures")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_model_structures_aircraft_id"), "model_structures", ["aircraft_id"])

    op.create_table(
        "predictions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("source", sa.String(), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("fuel", sa.JSON(), nullable=False),
        sa.Column("names", sa.JSON(), nullable=False),
        sa.Column("values", sa.String(length=64), nullable=False),
        sa.Column("std_errors", sa.String(length=64), nullable=True),
        sa.Column("note", sa.String(), nullable=False),
        sa.ForeignKeyConstraint(
            ["aircraft_id"], ["aircraft.id"], name=op.f("fk_predictions_aircraft_id")
        ),
        sa.ForeignKeyConstraint(
            ["std_errors"], ["arrays.hash"], name=op.f("fk_predictions_std_errors")
        ),
        sa.ForeignKeyConstraint(["values"], ["arrays.hash"], name=op.f("fk_predictions_values")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_predictions")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_predictions_aircraft_id"), "predictions", ["aircraft_id"])
    op.create_index(op.f("ix_predictions_std_errors"), "predictions", ["std_errors"])
    op.create_index(op.f("ix_predictions_values"), "predictions", ["values"])

    op.create_table(
        "maneuvers",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("aircraft_id", sa.Integer(), nullable=False),
        sa.Column("flight_id", sa.Integer(), nullable=False),
        sa.Column("label", sa.String(), nullable=False),
        sa.Column("start_s", sa.Double(), nullable=False),
        sa.Column("duration_s", sa.Double(), nullable=False),
        sa.Column("condition", sa.JSON(), nullable=False),
        sa.Column("fta", sa.Integer(), nullable=True),
        sa.Column("axis", sa.String(), nullable=False),
        sa.Column("excitation", sa.JSON(), nullable=True),
        sa.Column("airspeed_ratio", sa.Double(), nullable=True),
        sa.Column("max_input_correlation", sa.Double(), nullable=True),
        sa.Column("source_file", sa.String(), nullable=True),
        sa.Column("source_hash", sa.String(), nullable=True),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("airspeed_m_s", sa.Double(), nullable=False),
        sa.Column("dynamic_pressure_pa", sa.Double(), nullable=False),
        sa.Column("fuel_fraction", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(
            ["aircraft_id"], ["aircraft.id"], name=op.f("fk_maneuvers_aircraft_id")
        ),
        sa.ForeignKeyConstraint(["flight_id"], ["flights.id"], name=op.f("fk_maneuvers_flight_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_maneuvers")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_maneuvers_aircraft_id"), "maneuvers", ["aircraft_id"])
    op.create_index(op.f("ix_maneuvers_airspeed_ratio"), "maneuvers", ["airspeed_ratio"])
    op.create_index(op.f("ix_maneuvers_flight_id"), "maneuvers", ["flight_id"])
    op.create_index(op.f("ix_maneuvers_fta"), "maneuvers", ["fta"])
    op.create_index(op.f("ix_maneuvers_fuel_fraction"), "maneuvers", ["fuel_fraction"])

    op.create_table(
        "channels",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("maneuver_id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("unit", sa.String(), nullable=False),
        sa.Column("role", sa.String(), nullable=False),
        sa.Column("rate_hz", sa.Double(), nullable=False),
        sa.Column("start_s", sa.Double(), nullable=False),
        sa.Column("n_samples", sa.Integer(), nullable=False),
        sa.Column("array", sa.String(length=64), nullable=False),
        sa.ForeignKeyConstraint(["array"], ["arrays.hash"], name=op.f("fk_channels_array")),
        sa.ForeignKeyConstraint(
            ["maneuver_id"],
            ["maneuvers.id"],
            name=op.f("fk_channels_maneuver_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_channels")),
        sa.UniqueConstraint("maneuver_id", "name", name=op.f("uq_channels_maneuver_id_name")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_channels_array"), "channels", ["array"])

    op.create_table(
        "runs",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("maneuver_id", sa.Integer(), nullable=False),
        sa.Column("method", sa.String(length=8), nullable=False),
        sa.Column("structure", sa.JSON(), nullable=False),
        sa.Column("settings", sa.JSON(), nullable=False),
        sa.Column("modal_table_id", sa.Integer(), nullable=True),
        sa.Column("damping_table_id", sa.Integer(), nullable=True),
        sa.Column("prediction_id", sa.Integer(), nullable=True),
        sa.Column("structure_id", sa.Integer(), nullable=True),
        sa.Column("state", sa.String(length=16), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("progress", sa.JSON(), nullable=True),
        sa.Column("error", sa.JSON(), nullable=True),
        sa.Column("result", sa.JSON(), nullable=True),
        sa.Column("versions", sa.JSON(), nullable=True),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("started_at", sa.DateTime(), nullable=True),
        sa.Column("finished_at", sa.DateTime(), nullable=True),
        sa.ForeignKeyConstraint(
            ["damping_table_id"], ["modal_tables.id"], name=op.f("fk_runs_damping_table_id")
        ),
        sa.ForeignKeyConstraint(
            ["maneuver_id"], ["maneuvers.id"], name=op.f("fk_runs_maneuver_id")
        ),
        sa.ForeignKeyConstraint(
            ["modal_table_id"], ["modal_tables.id"], name=op.f("fk_runs_modal_table_id")
        ),
        sa.ForeignKeyConstraint(
            ["prediction_id"], ["predictions.id"], name=op.f("fk_runs_prediction_id")
        ),
        sa.ForeignKeyConstraint(
            ["structure_id"], ["model_structures.id"], name=op.f("fk_runs_structure_id")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_runs")),
        sqlite_autoincrement=True,
    )
    op.create_index(op.f("ix_runs_damping_table_id"), "runs", ["damping_table_id"])
    op.create_index(op.f("ix_runs_maneuver_id_method_id"), "runs", ["maneuver_id", "method", "id"])
    op.create_index(op.f("ix_runs_modal_table_id"), "runs", ["modal_table_id"])
    op.create_index(op.f("ix_runs_prediction_id"), "runs", ["prediction_id"])
    op.create_index(op.f("ix_runs_state_id"), "runs", ["state", "id"])
    op.create_index(op.f("ix_runs_structure_id"), "runs", ["structure_id"])


def downgrade() -> None:
    op.drop_table("runs")
    op.drop_table("channels")
    op.drop_table("maneuvers")
    op.drop_table("predictions")
    op.drop_table("model_structures")
    op.drop_table("modal_tables")
    op.drop_table("flights")
    op.drop_table("arrays")
    op.drop_table("aircraft")
