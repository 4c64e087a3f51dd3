"""All work in the background is a job of one table; a run has the id of its job.

Ids of jobs are never reused, those of runs that were deleted included; the table of runs lost
that property in an earlier migration.

Revision: 0017, after 0016
"""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"
branch_labels = None
depends_on = None

_JSON = sa.JSON(none_as_null=True)
_ESTIMATION, _SEARCH = "estimation", "structure-search"
_RUN_STATE = (
    *("author", "state", "attempt", "priority", "limits", "progress", "error", "worker"),
    *("created_at", "started_at", "finished_at"),
)
_SEARCH_STATE = ("author", "state", "progress", "error", "created_at", "finished_at")


def upgrade() -> None:
    connection = op.get_bind()
    op.create_table(
        "jobs",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(32), nullable=False),
        sa.Column("title", sa.String(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("request", _JSON, nullable=True),
        sa.Column("request_hash", sa.String(64), nullable=True),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("priority", sa.Integer(), nullable=False),
        sa.Column("after_job_id", sa.Integer(), nullable=True),
        sa.Column("limits", _JSON, nullable=True),
        sa.Column("progress", _JSON, nullable=True),
        sa.Column("error", _JSON, nullable=True),
        sa.Column("result", _JSON, nullable=True),
        sa.Column("versions", _JSON, nullable=True),
        sa.Column("worker", sa.String(), nullable=True),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.Column("started_at", sa.DateTime(), nullable=True),
        sa.Column("finished_at", sa.DateTime(), nullable=True),
        sa.Column("process_id", sa.String(), nullable=True),
        sa.Column("deaths", sa.Integer(), nullable=False, server_default="0"),
        sa.ForeignKeyConstraint(
            ["after_job_id"], ["jobs.id"], name="fk_jobs_after_job_id", ondelete="SET NULL"
        ),
        sa.PrimaryKeyConstraint("id", name="pk_jobs"),
        sqlite_autoincrement=True,
    )
    for columns in (
        *(["request_hash"], ["after_job_id"], ["finished_at"]),
        *(["state", "priority", "author", "id"], ["kind", "state", "id"]),
    ):
        op.create_index(f"ix_jobs_{'_'.join(columns)}", "jobs", columns)
    state = ", ".join(_RUN_STATE)
    connection.execute(
        sa.text(
            f"INSERT INTO jobs (id, kind, title, after_job_id, process_id, deaths, {state})"
            f" SELECT id, '{_ESTIMATION}', '', after_run_id, process_id, deaths, {state} FROM runs"
            " ORDER BY id"
        )
    )
    _count_jobs_from(_find_largest_run_id(connection))
    _replace_log("run", "job")
    _change_runs_up()
    _change_searches_up(connection)


def downgrade() -> None:
    connection = op.get_bind()
    with op.batch_alter_table("searches", table_kwargs={"sqlite_autoincrement": True}) as searches:
        searches.drop_index("ix_searches_job_id")
        searches.drop_constraint("fk_searches_job_id_jobs", type_="foreignkey")
        searches.drop_column("job_id")
    with op.batch_alter_table("runs", table_kwargs={"sqlite_autoincrement": True}) as runs:
        runs.drop_constraint("fk_runs_id_jobs", type_="foreignkey")
        runs.add_column(sa.Column("process_id", sa.String(), nullable=True))
        runs.add_column(sa.Column("deaths", sa.Integer(), nullable=False, server_default="0"))
        runs.create_index("ix_runs_state_priority_id", ["state", "priority", "id"])
    if connection.dialect.name == "postgresql":
        op.execute("CREATE SEQUENCE runs_id_seq OWNED BY runs.id")
        op.execute("ALTER TABLE runs ALTER COLUMN id SET DEFAULT nextval('runs_id_seq')")
        op.execute("SELECT setval('runs_id_seq', last_value, is_called) FROM jobs_id_seq")
    else:
        _set_sqlite_sequence("runs", _read_sqlite_sequence(connection, "jobs"))
    # The log of other jobs has no place in the earlier schema.
    op.execute("DELETE FROM job_events WHERE job_id NOT IN (SELECT id FROM runs)")
    _replace_log("job", "run")
    op.drop_table("jobs")


def _change_runs_up() -> None:
    postgresql = op.get_bind().dialect.name == "postgresql"
    if postgresql:
        op.execute("ALTER TABLE runs ALTER COLUMN id DROP DEFAULT")
        op.execute("DROP SEQUENCE IF EXISTS runs_id_seq")
    with op.batch_alter_table("runs") as runs:
        runs.drop_index("ix_runs_state_priority_id")
        runs.drop_column("process_id")
        runs.drop_column("deaths")
        runs.create_foreign_key("fk_runs_id_jobs", "jobs", ["id"], ["id"])


def _change_searches_up(connection: sa.Connection) -> None:
    with op.batch_alter_table("searches", table_kwargs={"sqlite_autoincrement": True}) as searches:
        searches.add_column(sa.Column("job_id", sa.Integer(), nullable=True))
        searches.create_foreign_key("fk_searches_job_id_jobs", "jobs", ["job_id"], ["id"])
        searches.create_index("ix_searches_job_id", ["job_id"])
    # A search that was running is resumed, as every search of a stopped server was.
    op.execute("UPDATE searches SET state = 'queued' WHERE state = 'running'")
    state = ", ".join(_SEARCH_STATE)
    for number in list(connection.scalars(sa.text("SELECT id FROM searches ORDER BY id"))):
        job = connection.scalar(
            sa.text(
                f"INSERT INTO jobs (kind, title, attempt, priority, request, {state})"
                f" SELECT '{_SEARCH}', '', 0, 0, CAST(:request AS JSON), {state}"
                " FROM searches WHERE id = :number RETURNING id"
            )
            if connection.dialect.name == "postgresql"
            else sa.text(
                f"INSERT INTO jobs (kind, title, attempt, priority, request, {state})"
                f" SELECT '{_SEARCH}', '', 0, 0, :request, {state}"
                " FROM searches WHERE id = :number RETURNING id"
            ),
            {"number": number, "request": f'{{"search_id":{number}}}'},
        )
        connection.execute(
            sa.text("UPDATE searches SET job_id = :job WHERE id = :number"),
            {"job": job, "number": number},
        )


def _replace_log(before: str, after: str) -> None:
    """Move the log to a table that refers to jobs or runs; events keep their ids."""
    old, new, key = f"{before}_events", f"{after}_events", f"{after}_id"
    postgresql = op.get_bind().dialect.name == "postgresql"
    last = _read_sqlite_sequence(op.get_bind(), old) if not postgresql else 0
    op.create_table(
        new,
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column(key, sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(), nullable=False),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("attempt", sa.Integer(), nullable=False),
        sa.Column("message", sa.String(), nullable=False),
        sa.ForeignKeyConstraint(
            [key], [f"{after}s.id"], name=f"fk_{new}_{key}_{after}s", ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=f"pk_{new}"),
        sqlite_autoincrement=True,
    )
    op.execute(
        f"INSERT INTO {new} (id, {key}, at, kind, attempt, message)"
        f" SELECT id, {before}_id, at, kind, attempt, message FROM {old} ORDER BY id"
    )
    op.create_index(f"ix_{new}_{key}", new, [key])
    if postgresql:
        op.execute(f"SELECT setval('{new}_id_seq', last_value, is_called) FROM {old}_id_seq")
    else:
        _set_sqlite_sequence(new, last)
    op.drop_table(old)


def _find_largest_run_id(connection: sa.Connection) -> int:
    """Return the largest id that a run ever had, as far as anything stored shows it."""
    largest = connection.scalar(sa.text("SELECT max(id) FROM runs")) or 0
    for table in ("run_events", "batch_runs"):
        largest = max(largest, connection.scalar(sa.text(f"SELECT max(run_id) FROM {table}")) or 0)
    if connection.dialect.name == "postgresql":
        given = sa.text("SELECT CASE WHEN is_called THEN last_value ELSE 0 END FROM runs_id_seq")
        return max(largest, connection.scalar(given) or 0)
    return max(largest, _read_sqlite_sequence(connection, "runs"))


def _count_jobs_from(largest: int) -> None:
    if op.get_bind().dialect.name == "postgresql":
        if largest:
            op.execute(f"SELECT setval('jobs_id_seq', {largest})")
        return
    _set_sqlite_sequence("jobs", largest)


def _read_sqlite_sequence(connection: sa.Connection, table: str) -> int:
    query = sa.text("SELECT seq FROM sqlite_sequence WHERE name = :name")
    return connection.scalar(query, {"name": table}) or 0


def _set_sqlite_sequence(table: str, value: int) -> None:
    connection = op.get_bind()
    connection.execute(sa.text("DELETE FROM sqlite_sequence WHERE name = :n"), {"n": table})
    connection.execute(
        sa.text("INSERT INTO sqlite_sequence (name, seq) VALUES (:n, :v)"), {"n": table, "v": value}
    )
