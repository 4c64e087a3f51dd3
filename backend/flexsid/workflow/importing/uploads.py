"""Uploads: files read once into a folder, previewed, and imported by a job.

The folder has the samples of the files, so that the page can be reloaded; the state of an import
is that of its job. Servers that share a database of PostgreSQL have it in the database, too, and
each copies what it needs into a folder of its own.
"""

from __future__ import annotations

import getpass
import re
import secrets
import shutil
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated

import sqlalchemy as sa

from flexsid.allowed import Allowed, Id
from flexsid.errors import FlexsidError, StorageFull, UnknownRecord
from flexsid.importers import sandbox
from flexsid.importers.mapping import MappingFile, parse_mapping
from flexsid.importers.reader_process import MANIFEST
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.job import Job
from flexsid.records.run import Progress, ReportProgress, RunState
from flexsid.storage import upload_files
from flexsid.storage.access import (
    GIGABYTE,
    AccountUploadsFull,
    Forbidden,
    check_recorded_bytes,
    get_access,
    using_access,
)
from flexsid.storage.database import sqlite_file
from flexsid.storage.files import make_private_folder
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs
from flexsid.text import LONGEST_TEXT
from flexsid.workflow.importing.flight_import import AddBuiltinAircraft, store_upload
from flexsid.workflow.importing.parsed_files import (
    IMPORT_KIND,
    ParsedUpload,
    parse_upload,
    refuse_guesses,
)

RETENTION_DAYS = 7
_UPLOADER = "account"
_DRAFT = "draft.toml"
_LISTED = 50  # newest uploads
_UNFINISHED = "unfinished"  # uploads whose files are being read
_NO_FILES = b'{"files": []}'  # of an upload that is just deleted
_NAME = re.compile(r"u[0-9a-f]{16}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Upload:
    """Files that were uploaded together."""

    id: str


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadItem:
    """An upload, and when its mapping was last edited."""

    id: str
    files: tuple[str, ...]
    changed_at: datetime


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportRequest:
    """An upload with its mapping in TOML; ``confirmed``: its guesses are confirmed."""

    upload_id: str
    mapping: Annotated[str, Allowed(min_length=1, max_length=LONGEST_TEXT)]
    aircraft_id: Id | None = None
    confirmed: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredImport:
    """Records that an import stored."""

    maneuver_id: int | None
    flight_id: int | None
    n_channels: int


@dataclass(frozen=True, slots=True)
class ImportTask:
    """Contents of files and their mapping."""

    sources: Sources
    mapping: MappingFile


def locate_uploads(store: Store) -> Path:
    """Return the folder of uploads: beside a database file, since uploads may be as large."""
    file = sqlite_file(store.database.url)
    if file is None:
        return Path(tempfile.gettempdir()) / f"flexsid-uploads-{getpass.getuser()}"
    return file.with_name(f"{file.name}-uploads")


def add_upload(store: Store, files: Sequence[Path], names: Sequence[str]) -> Upload:
    """Read files into a new upload; delete old uploads.

    Raises
    ------
    AccountUploadsFull
        If the uploads of the account would take more than its quota.
    StorageFull
        If all uploads would take more than theirs.
    UnreadableFile
        If a file cannot be read.
    """
    uploads = locate_uploads(store)
    _delete_old(store)
    upload = Upload(id=f"u{secrets.token_hex(8)}")
    folder = uploads / upload.id
    make_private_folder(uploads)
    folder.mkdir(mode=0o700)
    try:
        sandbox.decode(files, names, folder, store.quotas.expansion)
        (folder / _UPLOADER).write_text(_name_uploader())  # at the end: the upload is complete
        if upload_files.is_shared(store.database):
            upload_files.add_files(store.database, upload.id, folder, _name_uploader())
        _check_space(store, upload)
    except BaseException:
        _delete(store, {upload.id})
        raise
    return upload


def open_upload(store: Store, upload_id: str) -> Sources:
    """Return the contents of the files of an upload.

    Raises
    ------
    UnknownRecord
        If there is no such upload, or it is of another account.
    """
    folder = find_folder(store, upload_id)
    try:
        return sandbox.load(folder)
    except FileNotFoundError as error:  # deleted meanwhile
        raise _refuse_upload(upload_id) from error


def find_folder(store: Store, upload_id: str) -> Path:
    """Return the folder of an upload; raises as ``open_upload``."""
    folder = locate_uploads(store) / upload_id
    uploader = None
    if _NAME.fullmatch(upload_id) is not None:
        uploader = _read_uploader(store, folder)
    if uploader is None or (get_access() is not None and uploader != _name_uploader()):
        raise _refuse_upload(upload_id)
    if not (folder / _UPLOADER).is_file():
        _copy_here(store, folder)
    return folder


def _refuse_upload(upload_id: str) -> UnknownRecord:
    return UnknownRecord(
        f"There is no upload '{upload_id[:40]}'; uploads are stored for {RETENTION_DAYS} days."
    )


def _read_uploader(store: Store, folder: Path) -> str | None:
    if upload_files.is_shared(store.database):
        return upload_files.find_uploader(store.database, folder.name)
    file = folder / _UPLOADER
    return file.read_text() if file.is_file() else None


def _copy_here(store: Store, folder: Path) -> None:
    """Copy the files of an upload that another server received."""
    make_private_folder(folder.parent)
    with tempfile.TemporaryDirectory(dir=folder.parent) as temporary:
        copied = Path(temporary) / folder.name
        copied.mkdir(mode=0o700)
        upload_files.copy_files(store.database, folder.name, copied)
        with suppress(OSError):  # another request was faster
            copied.rename(folder)


def write_draft(store: Store, upload_id: str, text: str) -> None:
    """Store the mapping of an upload while it is edited; raises as ``open_upload``."""
    file = find_folder(store, upload_id) / _DRAFT
    if upload_files.is_shared(store.database):
        uploader = upload_files.find_uploader(store.database, upload_id) or ""
        upload_files.replace_file(store.database, upload_id, _DRAFT, uploader, text.encode())
        return
    new = file.with_name(f"{_DRAFT}.{secrets.token_hex(4)}")
    new.write_text(text, encoding="utf-8")
    new.replace(file)


def read_draft(store: Store, upload_id: str) -> str | None:
    """Read the draft of a mapping; None without one. Raises as ``open_upload``."""
    file = find_folder(store, upload_id) / _DRAFT
    if upload_files.is_shared(store.database):
        content = upload_files.read_file(store.database, upload_id, _DRAFT)
        return None if content is None else content.decode()
    return file.read_text(encoding="utf-8") if file.is_file() else None


def list_uploads(store: Store) -> list[UploadItem]:
    """List the own uploads that are not imported, most recently edited first."""
    imported = _find_imported(store)
    newest = [one for one in _list_newest(store) if one[0] not in imported][:_LISTED]
    return [
        UploadItem(
            id=upload_id,
            files=sandbox.list_names(_read_manifest(store, upload_id)),
            changed_at=changed_at,
        )
        for upload_id, changed_at in newest
    ]


def _list_newest(store: Store) -> list[tuple[str, datetime]]:
    if upload_files.is_shared(store.database):
        return upload_files.list_newest(store.database, _name_uploader())
    found: list[tuple[datetime, str]] = []
    for uploader in locate_uploads(store).glob(f"*/{_UPLOADER}"):
        folder = uploader.parent
        with suppress(UnknownRecord, FileNotFoundError):  # of another account, or just deleted
            find_folder(store, folder.name)
            draft = folder / _DRAFT
            edited = (draft if draft.exists() else uploader).stat().st_mtime
            found.append((datetime.fromtimestamp(edited, UTC), folder.name))
    return [(name, edited) for edited, name in sorted(found, reverse=True)]


def _read_manifest(store: Store, upload_id: str) -> bytes:
    if upload_files.is_shared(store.database):
        return upload_files.read_file(store.database, upload_id, MANIFEST) or _NO_FILES
    return (locate_uploads(store) / upload_id / MANIFEST).read_bytes()


def delete_upload(store: Store, upload_id: str) -> None:
    """Delete the files of an upload; imported data remain."""
    _delete(store, {find_folder(store, upload_id).name})


def _delete(store: Store, upload_ids: set[str]) -> None:
    if upload_files.is_shared(store.database):
        upload_files.delete_files(store.database, upload_ids)
    for name in upload_ids:
        shutil.rmtree(locate_uploads(store) / name, ignore_errors=True)


def check_import(
    store: Store, request: ImportRequest, add_builtin_aircraft: AddBuiltinAircraft | None
) -> int | None:
    """Check the request of an import, and return the aircraft to whose campaign it belongs.

    An aircraft that comes with the software is added.

    Returns
    -------
    int or None
        None if the import adds the aircraft.

    Raises
    ------
    BadInput
        If the mapping is invalid, or has guessed values that are not confirmed.
    CampaignFull
        If the samples would exceed the quota of the campaign.
    Forbidden
        If the account may not add an aircraft.
    UnknownRecord
        If upload or aircraft do not exist.
    """
    mapping = parse_mapping(request.mapping)
    sources = open_upload(store, request.upload_id)
    if mapping.guessed and not request.confirmed:
        refuse_guesses(store, parse_upload(sources, mapping))
    part = mapping.aircraft
    if part is not None and part.builtin and add_builtin_aircraft is not None:
        add_builtin_aircraft(store, part.name)
    campaign = _find_campaign(store, request, None if part is None else part.name)
    with store.database.reading() as connection:
        size = sandbox.count_sample_bytes(find_folder(store, request.upload_id))
        check_recorded_bytes(connection, campaign, size, store.quotas)
    return campaign


def _find_campaign(store: Store, request: ImportRequest, aircraft: str | None) -> int | None:
    if request.aircraft_id is not None:
        return store.aircraft.get(request.aircraft_id).id
    known = [] if aircraft is None else store.aircraft.find(name=aircraft)
    if known:
        return known[0].id
    access = get_access()
    if access is not None and access.writable is not None:
        raise Forbidden("new aircraft are added by administrators of all campaigns")
    return None


def prepare_import(store: Store, request: ImportRequest) -> ImportTask:
    """Return the contents of the files of an import."""
    return ImportTask(open_upload(store, request.upload_id), parse_mapping(request.mapping))


def compute_import(task: ImportTask, report: ReportProgress) -> ParsedUpload:
    """Extract and check the channels of an import.

    Of the files, only what the mapping reads when it is stored is returned.
    """
    report(Progress(fraction=0.1, message="Checking the channels"))
    upload = parse_upload(task.sources, task.mapping)
    channels = tuple(replace(one, source=_drop_arrays(one.source)) for one in upload.channels)
    return replace(
        upload,
        channels=channels,
        maneuver=None if upload.maneuver is None else replace(upload.maneuver, channels=channels),
        sources=upload.sources
        if task.mapping.modal_tables or task.mapping.predictions
        else Sources(tuple(map(_drop_arrays, upload.sources.items))),
    )


def store_import(
    store: Store, job: Job, request: ImportRequest, upload: ParsedUpload
) -> StoredImport:
    """Store the contents of an upload; raises as ``store_upload``."""
    stored = store_upload(store, upload, request.aircraft_id, confirmed=request.confirmed)
    return StoredImport(
        maneuver_id=None if stored.maneuver is None else stored.maneuver.id,
        flight_id=None if stored.flight is None else stored.flight.id,
        n_channels=len(upload.channels),
    )


def _check_space(store: Store, added: Upload) -> None:
    """Refuse an upload beyond a quota, for which uploads that are imported give way."""
    error = _find_excess(store, added)
    if error is None:
        return
    _delete(store, _find_imported(store))
    error = _find_excess(store, added)
    if error is not None:
        raise error


def _find_excess(store: Store, added: Upload) -> FlexsidError | None:
    sizes = _count_bytes(store)
    own, all_ = sizes.get(_name_uploader(), 0), sum(sizes.values())
    size = sandbox.count_sample_bytes(locate_uploads(store) / added.id)
    quotas = store.quotas
    words = "uploads that are not imported"
    if quotas.account_upload_bytes is not None and own > quotas.account_upload_bytes:
        return AccountUploadsFull(
            f"with these files of {size / GIGABYTE:.3g} GB your {words} take"
            f" {own / GIGABYTE:.3g} GB, and the quota is"
            f" {quotas.account_upload_bytes / GIGABYTE:.3g} GB; import or delete some of them (page"
            f" Import, Unfinished imports): they are stored for {RETENTION_DAYS} days"
        )
    if quotas.upload_bytes is not None and all_ > quotas.upload_bytes:
        return StorageFull(
            f"with these files of {size / GIGABYTE:.3g} GB the {words} of all accounts take"
            f" {all_ / GIGABYTE:.3g} GB, and the server stores"
            f" {quotas.upload_bytes / GIGABYTE:.3g} GB; import or delete some of them, or ask who"
            " operates it"
        )
    return None


def _count_bytes(store: Store) -> dict[str, int]:
    """Return the size of all uploads of each account. [bytes]"""
    if upload_files.is_shared(store.database):
        return upload_files.count_bytes(store.database)
    sizes: dict[str, int] = {}
    for folder in locate_uploads(store).glob("*"):
        with suppress(FileNotFoundError):  # deleted by another request
            size = sum(file.stat().st_size for file in folder.iterdir() if file.is_file())
            file = folder / _UPLOADER
            uploader = file.read_text() if file.is_file() else _UNFINISHED
            sizes[uploader] = sizes.get(uploader, 0) + size
    return sizes


def _find_imported(store: Store) -> set[str]:
    """Return the ids of uploads that are imported, in whatever campaign, and not again."""
    query = (
        sa.select(jobs.c.state, jobs.c.request["upload_id"].as_string())
        .where(jobs.c.kind == IMPORT_KIND)
        .order_by(jobs.c.id)  # the newest decides
    )
    with using_access(None), store.database.reading() as connection:
        states = {upload_id: state for state, upload_id in connection.execute(query)}
    return {one for one, state in states.items() if state == RunState.SUCCEEDED and one}


def _drop_arrays(source: SourceFile) -> SourceFile:
    return replace(source, arrays={})


def _delete_old(store: Store) -> None:
    if upload_files.is_shared(store.database):
        before = datetime.now(UTC) - timedelta(days=RETENTION_DAYS)
        upload_files.delete_older(store.database, before)
    for folder in locate_uploads(store).glob("*"):
        uploader = folder / _UPLOADER
        with suppress(FileNotFoundError):  # deleted by another request
            # A server that was killed leaves one without uploader.
            stored_at = (uploader if uploader.exists() else folder).stat().st_mtime
            if time.time() - stored_at > RETENTION_DAYS * 86400:
                shutil.rmtree(folder, ignore_errors=True)


def _name_uploader() -> str:
    access = get_access()
    return "" if access is None else f"account {access.account_id}"
