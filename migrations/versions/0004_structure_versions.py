"""Model structures have versions, and runs name the one they used.

Revision: 0004, after 0003
"""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("model_structures") as structures:
        structures.add_column(sa.Column("author", sa.String(), nullable=False, server_default=""))
        structures.add_column(
            sa.Column("version", sa.Integer(), nullable=False, server_default="1")
        )
        structures.add_column(sa.Column("changed_at", sa.DateTime(), nullable=True))
    with op.batch_alter_table("runs") as runs:
        runs.add_column(sa.Column("structure_version", sa.Integer(), nullable=True))
    op.create_table(
        "structure_versions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("structure_id", sa.Integer(), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("structure", sa.JSON(), nullable=False),
        sa.Column("note", sa.String(), nullable=False),
        sa.Column("author", sa.String(), nullable=False),
        sa.Column("created_at", sa.DateTime(), nullable=False),
        sa.ForeignKeyConstraint(
            ["structure_id"],
            ["model_structures.id"],
            name=op.f("fk_structure_versions_structure_id_model_structures"),
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_structure_versions")),
        sa.UniqueConstraint(
            "structure_id", "version", name=op.f("uq_structure_versions_structure_id_version")
        ),
        sqlite_autoincrement=True,
    )
    # What was kept so far is the first version of each.
    op.execute(
        "INSERT INTO structure_versions"
        " (structure_id, version, name, structure, note, author, created_at)"
        " SELECT id, 1, name, structure, note, '', created_at FROM model_structures"
    )


def downgrade() -> None:
    op.drop_table("structure_versions")
    with op.batch_alter_table("runs") as runs:
        runs.drop_column("structure_version")
    with op.batch_alter_table("model_structures") as structures:
        structures.drop_column("changed_at")
        structures.drop_column("version")
        structures.drop_column("author")
