"""What can go wrong, in words that an analyst can act on.

Every error carries a stable ``code`` (the API and the CLI show it) and a
sentence that says what was found, what was expected and what to do.
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
    """A request, setting or value is not what it must be."""

    code = "bad-input"


class UnreadableFile(BadInput):
    """A file is not what it says; the message names row, column or field."""

    code = "unreadable-file"


class UnknownRecord(FlexsidError):
    """No record has this identity."""

    code = "unknown-record"


class Conflict(FlexsidError):
    """The record is not in a state that allows this, or already exists."""

    code = "conflict"


class NotIdentifiable(FlexsidError):
    """The data carry too little information for the parameters asked for."""

    code = "not-identifiable"


class Cancelled(FlexsidError):
    """The user asked to stop."""

    code = "cancelled"
