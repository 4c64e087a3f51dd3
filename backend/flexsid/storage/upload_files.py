"""Files of uploads in a database that several servers share, each with a disk of its own.

The server that received the files may be gone when they are imported. Another one reads them here;
on SQLite, whose servers share the folder of the database, nothing is stored.
"""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from flexsid.storage.access import using_access
from flexsid.storage.database import Database
from flexsid.storage.tables import upload_files

_PART_BYTES = 8 * 1024**2  # of a row, which is in memory as a whole
_FILES = upload_files.c


def is_shared(database: Database) -> bool:
    """Return whether servers of the database may have disks of their own."""
    return database.url.get_backend_name() == "postgresql"


def add_files(database: Database, upload_id: str, folder: Path, uploader: str) -> None:
    """Store the files of a folder, completely or not at all."""
    with using_access(None), database.transaction() as connection:
        for file in sorted(one for one in folder.iterdir() if one.is_file()):
            with file.open("rb") as opened:
                part = 0
                while (data := opened.read(_PART_BYTES)) or part == 0:
                    _add_part(connection, upload_id, file.name, part, uploader, data)
                    part += 1


def replace_file(
    database: Database, upload_id: str, name: str, uploader: str, content: bytes
) -> None:
    """Store a file of at most some megabytes, in place of one of this name."""
    with using_access(None), database.transaction() as connection:
        is_same = (_FILES.upload_id == upload_id) & (_FILES.name == name)
        connection.execute(sa.delete(upload_files).where(is_same))
        _add_part(connection, upload_id, name, 0, uploader, content)


def read_file(database: Database, upload_id: str, name: str) -> bytes | None:
    """Return the content of a file of some megabytes; None if there is none."""
    query = sa.select(_FILES.data).where(_FILES.upload_id == upload_id, _FILES.name == name)
    with using_access(None), database.reading() as connection:
        parts = list(connection.scalars(query.order_by(_FILES.part)))
    return b"".join(parts) if parts else None


def copy_files(database: Database, upload_id: str, folder: Path) -> None:
    """Write the files of an upload into a folder."""
    with using_access(None), database.reading() as connection:
        query = sa.select(_FILES.id, _FILES.name).where(_FILES.upload_id == upload_id)
        for number, name in connection.execute(query.order_by(_FILES.name, _FILES.part)).all():
            data = connection.scalar(sa.select(_FILES.data).where(_FILES.id == number))
            with (folder / name).open("ab") as file:
                file.write(data or b"")


def find_uploader(database: Database, upload_id: str) -> str | None:
    """Return whose upload it is; None if there is no such upload."""
    query = sa.select(_FILES.uploader).where(_FILES.upload_id == upload_id).limit(1)
    with using_access(None), database.reading() as connection:
        return connection.scalar(query)


def list_newest(database: Database, uploader: str) -> list[tuple[str, datetime]]:
    """List the uploads of an account with the time of their last change, the newest first."""
    changed_at = sa.func.max(_FILES.created_at, type_=_FILES.created_at.type)
    query = (
        sa.select(_FILES.upload_id, changed_at)
        .where(_FILES.uploader == uploader)
        .group_by(_FILES.upload_id)
        .order_by(changed_at.desc())
    )
    with using_access(None), database.reading() as connection:
        return [(upload_id, changed) for upload_id, changed in connection.execute(query)]


def count_bytes(database: Database) -> dict[str, int]:
    """Return the size of all files of each account. [bytes]"""
    size = sa.func.sum(sa.func.octet_length(_FILES.data))
    query = sa.select(_FILES.uploader, size).group_by(_FILES.uploader)
    with using_access(None), database.reading() as connection:
        return {uploader: int(n_bytes) for uploader, n_bytes in connection.execute(query)}


def delete_files(database: Database, upload_ids: set[str]) -> None:
    """Delete uploads."""
    with using_access(None), database.transaction() as connection:
        connection.execute(sa.delete(upload_files).where(_FILES.upload_id.in_(upload_ids)))


def delete_older(database: Database, than: datetime) -> None:
    """Delete the uploads that were stored before a time."""
    old = sa.select(_FILES.upload_id).where(_FILES.created_at < than)
    with using_access(None), database.transaction() as connection:
        connection.execute(sa.delete(upload_files).where(_FILES.upload_id.in_(old)))


def _add_part(
    connection: Connection, upload_id: str, name: str, part: int, uploader: str, data: bytes
) -> None:
    row = {"upload_id": upload_id, "name": name, "part": part, "uploader": uploader}
    moment = datetime.now(UTC)
    connection.execute(sa.insert(upload_files).values(**row, data=data, created_at=moment))
