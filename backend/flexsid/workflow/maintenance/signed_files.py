"""Check of a file that a site issued: signature, decision chain, hashes of the data."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import orjson

from flexsid.errors import BadInput
from flexsid.storage.event_chain import hash_value
from flexsid.storage.signatures import read_signed


@dataclass(frozen=True, slots=True)
class CheckedFile:
    """A file that is as its site signed it; ``key`` is the public key in hexadecimal."""

    key: str
    n_bytes: int
    n_events: int


def check_signed_file(content: bytes, expected_key: str | None = None) -> CheckedFile:
    """Check signature and decision chain of a file.

    Parameters
    ----------
    content
        The file, as it was received.
    expected_key
        Public key of the site, as it was received by another way.

    Raises
    ------
    BadInput
        If the file has no signature, was changed, is of another site, or has a decision whose
        events are not the ones that were recorded.
    """
    signed = read_signed(content)
    if expected_key is not None and signed.key != expected_key:
        raise BadInput(
            f"the file was signed with the key {signed.key}; expected {expected_key}",
            code="wrong-site-key",
        )
    n_events = 0
    if signed.content.startswith(b"{"):
        for one in orjson.loads(signed.content).get("decisions", ()):
            n_events += len(one["events"])
            _check_chain(one["decision"]["id"], one["events"])
    return CheckedFile(signed.key, len(signed.content), n_events)


def _check_chain(decision_id: int, events: list[dict[str, Any]]) -> None:
    """Refuse events of a decision that were changed or removed before the file was signed."""
    links = [("", events[0]["previous_hash"])] if events else []
    links += [(before["hash"], after["previous_hash"]) for before, after in pairwise(events)]
    is_whole = all(before == after for before, after in links)
    for event in events:
        seal = hashlib.sha256(event["sealed"].encode()).hexdigest()
        is_whole &= seal == event["hash"] and hash_value(event["data"]) == event["data_hash"]
    if not is_whole:
        raise BadInput(
            f"the events of decision {decision_id} are not the ones that were recorded: one was "
            "changed or removed; ask the site to check its database (flexsid check)",
            code="broken-chain",
        )
