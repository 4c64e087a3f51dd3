"""Uploads: files read once into a folder, previewed, and imported by a job.

The folder has the samples of the files, so that the page can be reloaded; the state of an import
is that of its job.
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
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import sqlalchemy as sa

from flexsid.allowed import Allowed, Id
from flexsid.errors import FlexsidError, StorageFull, UnknownRecord
from flexsid.importers import sandbox
from flexsid.importers.mapping import MappingFile, parse_mapping
from flexsid.importers.source import SourceFile, Sources
from flexsid.records.job import Job
from flexsid.records.run import Progress, ReportProgress, RunState
from flexsid.storage.access import Forbidden, get_access, using_access
from flexsid.storage.database import sqlite_file
from flexsid.storage.files import make_private_folder
from flexsid.storage.quotas import GIGABYTE, AccountUploadsFull, check_recorded_bytes
from flexsid.storage.store import Store
from flexsid.storage.tables import jobs
from flexsid.text import LONGEST_TEXT
from flexsid.workflow.importing.flight_import import AddBuiltinAircraft, store_upload
from flexsid.workflow.importing.parsed_files import ParsedUpload, parse_upload, refuse_guesses
from flexsid.workflow.importing.remembered_columns import IMPORT_KIND

RETENTION_DAYS = 7
_UPLOADER = "account"
_DRAFT = "draft.toml"
_LISTED = 50  # newest uploads
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
    _delete_old(uploads)
    upload = Upload(id=f"u{secrets.token_hex(8)}")
    folder = uploads / upload.id
    make_private_folder(uploads)
    folder.mkdir(mode=0o700)
    try:
        sandbox.decode(files, names, folder, store.quotas.expansion)
        (folder / _UPLOADER).write_text(_name_uploader())  # at the end: the upload is complete
        _check_space(store, upload)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return upload


def open_upload(store: Store, upload_id: str) -> Sources:
    """Return the contents of the files of an upload.

    Raises
    ------
    UnknownRecord
        If there is no such upload, or it is of another account.
    """
    return sandbox.load(find_folder(store, upload_id))


def find_folder(store: Store, upload_id: str) -> Path:
    """Return the folder of an upload; raises as ``open_upload``."""
    folder = locate_uploads(store) / upload_id
    uploader = folder / _UPLOADER
    is_known = _NAME.fullmatch(upload_id) is not None and uploader.is_file()
    if not is_known or (get_access() is not None and uploader.read_text() != _name_uploader()):
        raise UnknownRecord(
            f"There is no upload '{upload_id[:40]}'; uploads are stored for {RETENTION_DAYS} days."
        )
    return folder


def write_draft(store: Store, upload_id: str, text: str) -> None:
    """Store the mapping of an upload while it is edited; raises as ``open_upload``."""
    file = find_folder(store, upload_id) / _DRAFT
    new = file.with_name(f"{_DRAFT}.{secrets.token_hex(4)}")
    new.write_text(text, encoding="utf-8")
    new.replace(file)


def read_draft(store: Store, upload_id: str) -> str | None:
    """Read the draft of a mapping; None without one. Raises as ``open_upload``."""
    file = find_folder(store, upload_id) / _DRAFT
    return file.read_text(encoding="utf-8") if file.is_file() else None


def list_uploads(store: Store) -> list[UploadItem]:
    """List the own uploads that are not imported, most recently edited first."""
    imported = _find_imported(store)
    found: list[tuple[float, Path]] = []
    for uploader in locate_uploads(store).glob(f"*/{_UPLOADER}"):
        folder = uploader.parent
        with suppress(UnknownRecord, FileNotFoundError):  # of another account, or just deleted
            find_folder(store, folder.name)
            draft = folder / _DRAFT
            edited = (draft if draft.exists() else uploader).stat().st_mtime
            if folder.name not in imported:
                found.append((edited, folder))
    newest = sorted(found, reverse=True)[:_LISTED]
    return [
        UploadItem(
            id=folder.name,
            files=tuple(source.name for source in sandbox.load(folder).items),
            changed_at=datetime.fromtimestamp(changed, UTC),
        )
        for changed, folder in newest
    ]


def delete_upload(store: Store, upload_id: str) -> None:
    """Delete the files of an upload; imported data remain."""
    shutil.rmtree(find_folder(store, upload_id), ignore_errors=True)


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
    for name in _find_imported(store):
        shutil.rmtree(locate_uploads(store) / name, ignore_errors=True)
    error = _find_excess(store, added)
    if error is not None:
        raise error


def _find_excess(store: Store, added: Upload) -> FlexsidError | None:
    own, all_ = 0, 0
    for folder in locate_uploads(store).glob("*"):
        with suppress(FileNotFoundError):  # deleted by another request
            size = sum(file.stat().st_size for file in folder.iterdir() if file.is_file())
            all_ += size
            is_own = (folder / _UPLOADER).read_text() == _name_uploader()
            own += size if is_own else 0
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


def _delete_old(uploads: Path) -> None:
    for folder in uploads.glob("*"):
        uploader = folder / _UPLOADER
        with suppress(FileNotFoundError):  # deleted by another request
            # A server that was killed leaves one without uploader.
            stored_at = (uploader if uploader.exists() else folder).stat().st_mtime
            if time.time() - stored_at > RETENTION_DAYS * 86400:
                shutil.rmtree(folder, ignore_errors=True)


def _name_uploader() -> str:
    access = get_access()
    return "" if access is None else f"account {access.account_id}"
