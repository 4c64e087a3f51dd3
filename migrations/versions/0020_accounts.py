"""Accounts, memberships, sessions, tokens and the audit log; the campaign of each record.

Jobs of runs and of searches get the campaign of their aircraft, and so do batches of one
aircraft. Other records without an aircraft have no campaign.

Revision: 0020, after 0019
"""

import sqlalchemy as sa
from alembic import op

revision = "0020"
down_revision = "0019"
branch_labels = None
depends_on = None

_OF_CAMPAIGN = ("mappings", "designs", "saved_views", "frozen_figures", "jobs", "batches")
_JSON = sa.JSON(none_as_null=True)


def upgrade() -> None:
    for name in _OF_CAMPAIGN:
        # A plain column keeps the table in place; SQLite allows a reference that is null.
        reference = sa.ForeignKey("aircraft.id", name=f"fk_{name}_aircraft_id")
        if op.get_bind().dialect.name == "sqlite":
            op.execute(
                f"ALTER TABLE {name} ADD COLUMN aircraft_id INTEGER"
                f" CONSTRAINT fk_{name}_aircraft_id REFERENCES aircraft (id)"
            )
        else:
            op.add_column(name, sa.Column("aircraft_id", sa.Integer, reference, nullable=True))
        op.create_index(f"ix_{name}_aircraft_id", name, ["aircraft_id"])
    _assign_campaigns()
    op.create_table(
        "accounts",
        sa.Column("id", sa.Integer, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("skeleton", sa.String, nullable=False),
        sa.Column("password_hash", sa.String),
        sa.Column("invitation_hash", sa.String(64)),
        sa.Column("invited_until", sa.DateTime),
        sa.Column("disabled_at", sa.DateTime),
        sa.Column("created_at", sa.DateTime, nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_accounts"),
        sa.UniqueConstraint("skeleton", name="uq_accounts_skeleton"),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "memberships",
        sa.Column("id", sa.Integer, nullable=False),
        sa.Column("account_id", sa.Integer, nullable=False),
        sa.Column("aircraft_id", sa.Integer),
        sa.Column("role", sa.String(16), nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_memberships"),
        sa.ForeignKeyConstraint(
            ["account_id"], ["accounts.id"], "fk_memberships_account_id", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["aircraft_id"], ["aircraft.id"], "fk_memberships_aircraft_id"),
        sa.UniqueConstraint(
            "account_id", "aircraft_id", name="uq_memberships_account_id_aircraft_id"
        ),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_memberships_account_id", "memberships", ["account_id"])
    op.create_index("ix_memberships_aircraft_id", "memberships", ["aircraft_id"])
    op.create_table(
        "login_sessions",
        sa.Column("id", sa.Integer, nullable=False),
        sa.Column("account_id", sa.Integer, nullable=False),
        sa.Column("secret_hash", sa.String(64), nullable=False),
        sa.Column("address", sa.String, nullable=False),
        sa.Column("expires_at", sa.DateTime, nullable=False),
        sa.Column("created_at", sa.DateTime, nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_login_sessions"),
        sa.ForeignKeyConstraint(
            ["account_id"], ["accounts.id"], "fk_login_sessions_account_id", ondelete="CASCADE"
        ),
        sa.UniqueConstraint("secret_hash", name="uq_login_sessions_secret_hash"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_login_sessions_account_id", "login_sessions", ["account_id"])
    op.create_index("ix_login_sessions_expires_at", "login_sessions", ["expires_at"])
    op.create_table(
        "api_tokens",
        sa.Column("id", sa.Integer, nullable=False),
        sa.Column("account_id", sa.Integer, nullable=False),
        sa.Column("name", sa.String, nullable=False),
        sa.Column("secret_hash", sa.String(64), nullable=False),
        sa.Column("role", sa.String(16), nullable=False),
        sa.Column("aircraft_id", sa.Integer),
        sa.Column("expires_at", sa.DateTime, nullable=False),
        sa.Column("used_at", sa.DateTime),
        sa.Column("created_at", sa.DateTime, nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_api_tokens"),
        sa.ForeignKeyConstraint(
            ["account_id"], ["accounts.id"], "fk_api_tokens_account_id", ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(["aircraft_id"], ["aircraft.id"], "fk_api_tokens_aircraft_id"),
        sa.UniqueConstraint("secret_hash", name="uq_api_tokens_secret_hash"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_api_tokens_account_id", "api_tokens", ["account_id"])
    op.create_index("ix_api_tokens_aircraft_id", "api_tokens", ["aircraft_id"])
    op.create_table(
        "login_failures",
        sa.Column("subject", sa.String(200), nullable=False),
        sa.Column("failures", sa.Integer, nullable=False),
        sa.Column("last_at", sa.DateTime, nullable=False),
        sa.PrimaryKeyConstraint("subject", name="pk_login_failures"),
    )
    op.create_table(
        "audit_events",
        sa.Column("id", sa.Integer, nullable=False),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("author", sa.String, nullable=False),
        sa.Column("address", sa.String, nullable=False),
        sa.Column("request_id", sa.String(64), nullable=False),
        sa.Column("operation", sa.String, nullable=False),
        sa.Column("aircraft_id", sa.Integer),
        sa.Column("changes", _JSON, nullable=False),
        sa.Column("previous_hash", sa.String(64), nullable=False),
        sa.Column("sealed", sa.String, nullable=False),
        sa.Column("hash", sa.String(64), nullable=False),
        sa.Column("created_at", sa.DateTime, nullable=False),
        sa.PrimaryKeyConstraint("id", name="pk_audit_events"),
        sa.ForeignKeyConstraint(["aircraft_id"], ["aircraft.id"], "fk_audit_events_aircraft_id"),
        sa.UniqueConstraint("number", name="uq_audit_events_number"),
        sqlite_autoincrement=True,
    )
    op.create_index("ix_audit_events_aircraft_id", "audit_events", ["aircraft_id"])


def downgrade() -> None:
    for name in (
        *("audit_events", "login_failures", "api_tokens", "login_sessions", "memberships"),
        "accounts",
    ):
        op.drop_table(name)
    for name in reversed(_OF_CAMPAIGN):
        op.drop_index(f"ix_{name}_aircraft_id", name)
        # In place: a copy of the table would forget the largest id that was given.
        op.execute(f"ALTER TABLE {name} DROP COLUMN aircraft_id")


def _assign_campaigns() -> None:
    op.execute(
        "UPDATE jobs SET aircraft_id = (SELECT maneuvers.aircraft_id FROM runs"
        " JOIN maneuvers ON maneuvers.id = runs.maneuver_id WHERE runs.id = jobs.id)"
    )
    op.execute(
        "UPDATE jobs SET aircraft_id = (SELECT min(searches.aircraft_id) FROM searches"
        " WHERE searches.job_id = jobs.id) WHERE aircraft_id IS NULL"
    )
    op.execute(
        "UPDATE batches SET aircraft_id = (SELECT min(jobs.aircraft_id) FROM batch_runs"
        " JOIN jobs ON jobs.id = batch_runs.run_id WHERE batch_runs.batch_id = batches.id"
        " HAVING min(jobs.aircraft_id) = max(jobs.aircraft_id))"
    )
