"""Errors that are reported to the user.

Every error has a stable ``code`` (the API and the CLI show it) and a
message: what was found, what was expected, what to do.
"""

from __future__ import annotations


class FlexsidError(Exception):
    """Base of every error that a user can cause or must know about."""

    code = "error"

    def __init__(self, message: str, *, code: str | None = None, **context: object) -> None:
        super().__init__(message)
        self.message = message
        self.context = context
        if code is not None:
            self.code = code


class BadInput(FlexsidError):
    """A request, setting or value is not valid."""

    code = "bad-input"


class UnreadableFile(BadInput):
    """A file does not have its stated format; the message names row, column or field."""

    code = "unreadable-file"


class ContentTooLarge(UnreadableFile):
    """Files have more content than is accepted."""

    code = "content-too-large"


class StorageFull(FlexsidError):
    """There is no space for what would be stored."""

    code = "storage-full"


class UnknownRecord(FlexsidError):
    """No record has this identity."""

    code = "unknown-record"


class Conflict(FlexsidError):
    """The record is not in a state that allows this, or already exists."""

    code = "conflict"


class NotIdentifiable(FlexsidError):
    """The data have too little information for the requested parameters."""

    code = "not-identifiable"


class Cancelled(FlexsidError):
    """The user cancelled the job."""

    code = "cancelled"
