"""Signatures (Ed25519) of the site on files that it issues, written into the files themselves."""

from __future__ import annotations

import base64
import binascii
import os
import re
import secrets
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import (
    Ed25519PrivateKey,
    Ed25519PublicKey,
)

from flexsid.errors import BadInput
from flexsid.storage.database import Database, sqlite_file

# --- Signatures Ed25519 (RFC 8032) of raw keys of 32 bytes ----------------------------------------


def derive_public_key(secret: bytes) -> bytes:
    """Derive the public key (32 bytes) of a secret of 32 random bytes."""
    return Ed25519PrivateKey.from_private_bytes(secret).public_key().public_bytes_raw()


def sign(secret: bytes, message: bytes) -> bytes:
    """Sign a message; the signature has 64 bytes."""
    return Ed25519PrivateKey.from_private_bytes(secret).sign(message)


def is_valid(public: bytes, message: bytes, signature: bytes) -> bool:
    """Whether a signature of a message was made with the secret of a public key."""
    try:
        Ed25519PublicKey.from_public_bytes(public).verify(signature, message)
    except (InvalidSignature, ValueError):
        return False
    return True


# --- Signatures of the site on files that it issues, written into the files themselves ------------

_CONTEXT = b"flexsid file\n"  # what else is signed with the key is no file
_KEY_LENGTH, _SIGNATURE_LENGTH = 32, 64  # bytes
_TEXT_LENGTH = (_KEY_LENGTH + _SIGNATURE_LENGTH) * 4 // 3  # of key and signature in base64
_PRIVATE = 0o600
_HEX_KEY = re.compile(r"[0-9a-f]{64}")


class SignaturePlace(Enum):
    """Where a file has its signature: text before and after it, and the text if unsigned."""

    COMMENT = (b"\n<!-- flexsid-signature ", b" -->\n", b"")  # HTML and Markdown
    PDF = (b"\n%flexsid-signature ", b"\n", b"")
    JSON = (b'"signature":"', b'"}', b'"signature":null}')
    INDENTED_JSON = (b'"signature": "', b'"\n}', b'"signature": null\n}')


@dataclass(frozen=True, slots=True)
class SignedContent:
    """Content of a file without its signature, and the public key of the site that signed it."""

    content: bytes
    key: str


def sign_content(database: Database, content: bytes, place: SignaturePlace) -> bytes:
    """Sign a file with the key of the site, which is made at first use.

    A database server has no folder for the key: without a file for it, its files are not signed.

    Parameters
    ----------
    database
        Database of the site, with the file of its key; by default it is beside that of SQLite.
    content
        The file. JSON ends in a member ``signature`` that is null.
    place
        Where the signature is written.
    """
    secret = _read_secret(database)
    if secret is None:
        return content
    before, after, unsigned = place.value
    assert content.endswith(unsigned), f"the content does not end in {unsigned!r}"
    signature = derive_public_key(secret) + sign(secret, _CONTEXT + content)
    return content.removesuffix(unsigned) + before + base64.urlsafe_b64encode(signature) + after


def read_signed(file: bytes) -> SignedContent:
    """Check the signature of a file, and return its content.

    Raises
    ------
    BadInput
        If the file has no signature, or it was changed after it was signed.
    """
    for before, after, unsigned in (place.value for place in SignaturePlace):
        head, found = file[: -len(after) - _TEXT_LENGTH], file[-len(after) - _TEXT_LENGTH :]
        if not head.endswith(before) or not found.endswith(after):
            continue
        try:
            known = base64.b64decode(found[:_TEXT_LENGTH], altchars=b"-_", validate=True)
        except binascii.Error:
            break
        content = head.removesuffix(before) + unsigned
        key, signature = known[:_KEY_LENGTH], known[_KEY_LENGTH:]
        if not is_valid(key, _CONTEXT + content, signature):
            raise BadInput(
                "the file differs from what was signed: a byte of it, or of the signature, was "
                "changed; ask for a new copy",
                code="bad-signature",
            )
        return SignedContent(content, key.hex())
    raise BadInput(
        "the file ends in no signature of flexsid; expected a report, a decision or an exported "
        "run as the site issued it",
        code="no-signature",
    )


def read_public_key(database: Database) -> str | None:
    """Return the public key of the site in hexadecimal; None where it does not sign."""
    secret = _read_secret(database)
    return None if secret is None else derive_public_key(secret).hex()


def check_key(key: str) -> str:
    """Check a public key in hexadecimal.

    Raises
    ------
    BadInput
        If it has not 64 digits.
    """
    if _HEX_KEY.fullmatch(key) is None:
        raise BadInput(f"'{key}' is no public key; expected 64 digits 0-9 and a-f")
    return key


def _read_secret(database: Database) -> bytes | None:
    """Read the secret of the site, or make it."""
    place, file = database.site_key, sqlite_file(database.url)
    if place is None and file is not None:
        place = file.with_name(f"{file.name}-site-key")
    if place is None:
        return None
    try:
        if not place.exists():
            _write_secret(place)
        secret = place.read_bytes()
    except OSError as error:
        raise BadInput(
            f"the key of the site, {place}, cannot be read or made: {error.strerror}; name a file "
            "in a folder of the server by FLEXSID_SITE_KEY",
            code="bad-site-key",
        ) from error
    if len(secret) != _KEY_LENGTH:
        raise BadInput(
            f"{place} has {len(secret)} bytes; expected a key of {_KEY_LENGTH}; restore it from a "
            "copy, or remove it: earlier signatures then are of another key",
            code="bad-site-key",
        )
    return secret


def _write_secret(place: Path) -> None:
    """Write a new secret, unless another process was first."""
    partial = place.with_name(f"{place.name}.{secrets.token_hex(4)}")
    number = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL, _PRIVATE)
    try:
        with os.fdopen(number, "wb") as stream:
            stream.write(secrets.token_bytes(_KEY_LENGTH))
            stream.flush()
            os.fsync(stream.fileno())
        os.link(partial, place)
    except FileExistsError:
        pass
    finally:
        partial.unlink()
