"""Uploads: files read once, previewed and then imported.

An upload is a folder with the samples of its files and a state, so that the page can be
reloaded, and an import interrupted by a stopped server is reported.
"""

from __future__ import annotations

import contextvars
import logging
import re
import secrets
import shutil
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from pydantic import TypeAdapter

from flexsid.errors import Cancelled, Conflict, FlexsidError, UnknownRecord
from flexsid.importers import sandbox
from flexsid.importers.mapping import parse_mapping
from flexsid.importers.source import Sources
from flexsid.storage.access import get_access
from flexsid.storage.files import make_private_folder, sync
from flexsid.storage.store import Store
from flexsid.workflow.importing.flight_import import AddBuiltinAircraft, store_upload
from flexsid.workflow.importing.parsed_files import parse_upload, refuse_guesses

_log = logging.getLogger(__name__)

RETENTION_DAYS = 7
_STATE = "state.json"
_UPLOADER = "account"
_NAME = re.compile(r"u[0-9a-f]{16}")


class UploadState(StrEnum):
    """State of an upload."""

    READ = "read"
    IMPORTING = "importing"
    IMPORTED = "imported"
    FAILED = "failed"


@dataclass(frozen=True, slots=True, kw_only=True)
class UploadProgress:
    """An upload with its state; ``progress`` is the fraction written."""

    id: str
    state: UploadState = UploadState.READ
    progress: float | None = None
    code: str | None = None
    message: str | None = None
    maneuver_id: int | None = None
    flight_id: int | None = None
    n_channels: int | None = None


_UPLOAD = TypeAdapter(UploadProgress)


class Uploads:
    """The uploads of one server, and the thread that imports them one after the other."""

    def __init__(
        self, store: Store, folder: Path, add_builtin_aircraft: AddBuiltinAircraft | None = None
    ) -> None:
        self._store = store
        self._folder = folder
        self._add_builtin_aircraft = add_builtin_aircraft
        self._lock = threading.Lock()
        self._progress: dict[str, float] = {}
        self._cancelled: set[str] = set()
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="import")

    def start(self) -> None:
        """Mark imports interrupted by a stopped server as failed; delete old uploads."""
        for path in self._folder.glob(f"*/{_STATE}"):
            upload = _UPLOAD.validate_json(path.read_bytes())
            if upload.state is UploadState.IMPORTING:
                message = (
                    "The server was stopped during this import, and unfinished parts were not "
                    "stored. Import again; existing records are refused, not duplicated."
                )
                failed = replace(
                    upload, state=UploadState.FAILED, code="interrupted", message=message
                )
                self._save(failed)
        self._delete_old()

    def stop(self) -> None:
        """Cancel running imports; their transactions are rolled back."""
        with self._lock:
            self._cancelled.update(self._progress)
        self._worker.shutdown(wait=True, cancel_futures=True)

    def read(self, files: Sequence[Path], names: Sequence[str]) -> UploadProgress:
        """Read files into a new upload; delete old uploads."""
        self._delete_old()
        upload = UploadProgress(id=f"u{secrets.token_hex(8)}")
        folder = self._folder / upload.id
        make_private_folder(self._folder)
        folder.mkdir(mode=0o700)
        try:
            sandbox.decode(files, names, folder)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        (folder / _UPLOADER).write_text(_name_uploader())
        self._save(upload)
        return upload

    def get(self, identity: str) -> UploadProgress:
        """Return an upload with its present progress."""
        upload = _UPLOAD.validate_json((self._at(identity) / _STATE).read_bytes())
        if upload.state is UploadState.IMPORTING:
            return replace(upload, progress=self._progress.get(identity, 0.0))
        return upload

    def list_active(self) -> list[UploadProgress]:
        """List uploads that are being imported or waiting."""
        with self._lock:
            waiting = list(self._progress)
        own = [identity for identity in waiting if self._is_own(self._folder / identity)]
        return [upload for upload in map(self.get, own) if upload.progress is not None]

    def sources(self, identity: str) -> Sources:
        """Return the contents of the files."""
        return sandbox.load(self._at(identity))

    def import_later(
        self,
        identity: str,
        text: str,
        aircraft_id: int | None = None,
        *,
        confirmed: bool = False,
    ) -> UploadProgress:
        """Begin to import an upload through a mapping.

        Raises
        ------
        BadInput
            If the mapping is invalid, or has guessed values without ``confirmed``.
        Conflict
            If the upload is being imported.
        """
        mapping = parse_mapping(text)
        if mapping.guessed and not confirmed:
            refuse_guesses(self._store, parse_upload(self.sources(identity), mapping))
        with self._lock:
            upload = self.get(identity)
            if upload.state is UploadState.IMPORTING:
                raise Conflict("These files are being imported already.", code="importing")
            begun = UploadProgress(id=identity, state=UploadState.IMPORTING)
            self._save(begun)
            self._progress[identity] = 0.0
            self._cancelled.discard(identity)
        # In the context of the request: with the access of its account.
        run = contextvars.copy_context().run
        self._worker.submit(run, self._import, identity, text, aircraft_id, confirmed)
        return replace(begun, progress=0.0)

    def delete(self, identity: str) -> None:
        """Cancel the import of an upload, or delete its files."""
        folder = self._at(identity)
        with self._lock:
            if identity in self._progress:
                self._cancelled.add(identity)
                return
        shutil.rmtree(folder, ignore_errors=True)

    def _delete_old(self) -> None:
        for path in self._folder.glob(f"*/{_STATE}"):
            if path.parent.name in self._progress:
                continue
            with suppress(FileNotFoundError):  # deleted by another request
                if time.time() - path.stat().st_mtime > RETENTION_DAYS * 86400:
                    shutil.rmtree(path.parent, ignore_errors=True)

    def _import(self, identity: str, text: str, aircraft_id: int | None, confirmed: bool) -> None:
        def report(fraction: float) -> None:
            self._progress[identity] = fraction
            if identity in self._cancelled:
                raise Cancelled("The import was cancelled; nothing was stored.")

        try:
            report(0.0)
            upload = parse_upload(self.sources(identity), parse_mapping(text))
            imported = store_upload(
                self._store,
                upload,
                aircraft_id,
                report,
                self._add_builtin_aircraft,
                confirmed=confirmed,
            )
            maneuver, flight = imported.maneuver, imported.flight
            result = UploadProgress(
                id=identity,
                state=UploadState.IMPORTED,
                progress=1.0,
                maneuver_id=None if maneuver is None else maneuver.id,
                flight_id=None if flight is None else flight.id,
                n_channels=len(imported.flight_channels) or None,
            )
        except FlexsidError as error:
            result = UploadProgress(
                id=identity, state=UploadState.FAILED, code=error.code, message=error.message
            )
        except Exception as error:  # any other error ends the import with a message
            _log.exception("the import of %s failed", identity)
            result = UploadProgress(
                id=identity,
                state=UploadState.FAILED,
                code="internal-error",
                message=f"The import failed ({type(error).__name__}); nothing was stored.",
            )
        with self._lock:
            self._save(result)
            self._progress.pop(identity, None)
            self._cancelled.discard(identity)

    def _at(self, identity: str) -> Path:
        folder = self._folder / identity
        known = _NAME.fullmatch(identity) is not None and (folder / _STATE).is_file()
        if not known or not self._is_own(folder):
            raise UnknownRecord(
                f"There is no upload '{identity[:40]}'; uploads are stored for {RETENTION_DAYS}"
                " days."
            )
        return folder

    def _is_own(self, folder: Path) -> bool:
        """Return whether the account of the request has uploaded these files."""
        file = folder / _UPLOADER
        return get_access() is None or (file.is_file() and file.read_text() == _name_uploader())

    def _save(self, upload: UploadProgress) -> None:
        path = self._folder / upload.id / _STATE
        new = path.with_suffix(".new")
        new.write_bytes(_UPLOAD.dump_json(upload))
        sync(new)
        new.replace(path)


def _name_uploader() -> str:
    access = get_access()
    return "" if access is None else f"account {access.account_id}"
