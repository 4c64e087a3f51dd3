"""Summaries of the results of runs, from which a dashboard is read.

Revision: 0036, after 0035
"""

import re

import sqlalchemy as sa
from alembic import op

revision = "0036"
down_revision = "0035"
branch_labels = None
depends_on = None

_DERIVATIVE = re.compile(r"^(CZ|Cm|CY|Cl|Cn|CQ\d+)_(\w+)$")
_ACCURATE = 0.2


def upgrade() -> None:
    summaries = op.create_table(
        "run_summaries",
        sa.Column("run_id", sa.Integer(), nullable=False),
        sa.Column("axis", sa.String(16), nullable=False),
        sa.Column("adequacy", sa.String(16), nullable=False),
        sa.Column("n_accurate", sa.Integer(), nullable=False),
        sa.Column("estimates", sa.JSON(none_as_null=True), nullable=False),
        sa.ForeignKeyConstraint(["run_id"], ["runs.id"], ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id"),
    )
    op.create_index(
        "ix_run_summaries_list", "run_summaries", ["run_id", "adequacy", "n_accurate", "axis"]
    )
    names = ("structure", "settings", "result")
    runs = sa.table(
        "runs",
        *(sa.column("id", sa.Integer), sa.column("maneuver_id", sa.Integer)),
        *(sa.column(name, sa.JSON(none_as_null=True)) for name in names),
    )
    connection = op.get_bind()
    ended = sa.select(runs.c.id).where(runs.c.result.is_not(None))
    for number in list(connection.scalars(ended)):
        row = connection.execute(sa.select(runs).where(runs.c.id == number)).mappings().one()
        connection.execute(sa.insert(summaries).values(run_id=number, **_summarise(row)))


def downgrade() -> None:
    op.drop_table("run_summaries")


def _summarise(row: sa.RowMapping) -> dict[str, object]:
    result = row["result"]
    derivatives = [one for one in result["parameters"] if _DERIVATIVE.match(one["name"])]
    errors = [_divide_by_size("std_error", one) for one in derivatives]
    additional = row["settings"].get("additional_maneuver_ids") or ()
    return {
        "axis": row["structure"].get("axis") or "longitudinal",
        "adequacy": (result.get("adequacy") or {}).get("state") or "not tested",
        "n_accurate": sum(error is not None and error <= _ACCURATE for error in errors),
        "estimates": {
            "maneuver_ids": [row["maneuver_id"], *additional],
            "names": [one["name"] for one in derivatives],
            "std_errors": errors,
            "insensitivities": [_divide_by_size("insensitivity", one) for one in derivatives],
        },
    }


def _divide_by_size(name: str, one: dict[str, float | None]) -> float | None:
    error, value = one.get(name), one["value"]
    return None if error is None or not value else float(f"{error / abs(value):.3g}")
