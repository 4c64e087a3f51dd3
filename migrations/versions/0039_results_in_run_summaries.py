"""What lists of runs show of results, until now read out of each result of 100 kB.

Revision: 0039, after 0038
"""

import sqlalchemy as sa
from alembic import op

revision = "0039"
down_revision = "0038"
branch_labels = None
depends_on = None

_REQUIRED = {"outcome": sa.String(32), "n_warnings": sa.Integer(), "n_poles": sa.Integer()}
_OPTIONAL = {"n_iterations": sa.Integer(), "worst_r_squared": sa.Double()}


def upgrade() -> None:
    columns = [sa.Column(name, kind) for name, kind in (_REQUIRED | _OPTIONAL).items()]
    for column in columns:
        op.add_column("run_summaries", column)
    summaries = sa.table(
        "run_summaries", sa.column("run_id"), *(sa.column(c.name) for c in columns)
    )
    runs = sa.table("runs", sa.column("id"), sa.column("result", sa.JSON(none_as_null=True)))
    connection = op.get_bind()
    read = sa.select(runs.c.result["fit"], runs.c.result["poles"])
    for number in list(connection.scalars(sa.select(summaries.c.run_id))):
        fit, poles = connection.execute(read.where(runs.c.id == number)).one()
        of_run = sa.update(summaries).where(summaries.c.run_id == number)
        connection.execute(of_run.values(**_summarise(fit), n_poles=len(poles or ())))
    with op.batch_alter_table("run_summaries") as table:
        for name, kind in _REQUIRED.items():
            table.alter_column(name, existing_type=kind, nullable=False)


def downgrade() -> None:
    with op.batch_alter_table("run_summaries") as table:
        for name in (*_REQUIRED, *_OPTIONAL):
            table.drop_column(name)


def _summarise(fit: dict) -> dict[str, object]:
    iterations = fit["iterations"]
    return {
        "outcome": fit["outcome"],
        "n_iterations": iterations[-1]["iteration"] if iterations else None,
        "n_warnings": len(fit.get("warnings") or ()),
        "worst_r_squared": min((fit.get("r_squared") or {}).values(), default=None),
    }
