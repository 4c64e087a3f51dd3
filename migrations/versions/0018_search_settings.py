"""Settings of a search name the initial terms and the resamplings of the frequencies.

Revision: 0018, after 0017
"""

import sqlalchemy as sa
from alembic import op

revision = "0018"
down_revision = "0017"
branch_labels = None
depends_on = None

_RENAMED = {"begin": "initial_terms", "draws": "resamplings"}


def upgrade() -> None:
    _rename_keys(_RENAMED)


def downgrade() -> None:
    _rename_keys({new: old for old, new in _RENAMED.items()})


def _rename_keys(names: dict[str, str]) -> None:
    connection = op.get_bind()
    searches = sa.table(
        "searches", sa.column("id", sa.Integer), sa.column("settings", sa.JSON(none_as_null=True))
    )
    for number, settings in list(connection.execute(sa.select(searches))):
        renamed = {names.get(key, key): value for key, value in settings.items()}
        this = searches.c.id == number
        connection.execute(sa.update(searches).where(this).values(settings=renamed))
