"""Index by which the list of maneuvers is counted.

Revision: 0045, after 0044
"""

from alembic import op

revision = "0045"
down_revision = "0044"
branch_labels = None
depends_on = None

_COLUMNS = (
    *("deleted_at", "axis", "aircraft_id", "flight_id", "fta", "id"),
    *("airspeed_ratio", "fuel_fraction"),
)


def upgrade() -> None:
    op.create_index("ix_maneuvers_list", "maneuvers", _COLUMNS)


def downgrade() -> None:
    op.drop_index("ix_maneuvers_list", "maneuvers")
