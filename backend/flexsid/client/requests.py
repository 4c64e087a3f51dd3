"""Requests of a workbench, as its parts use them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Protocol


class Requests(Protocol):
    """Requests of a workbench."""

    def get(self, path: str, **query: Any) -> Any:
        """Return the response of a route."""
        ...

    def post(self, path: str, body: Any, **query: Any) -> Any:
        """Return the response of a route to a JSON body."""
        ...

    def get_bytes(self, path: str, **query: Any) -> bytes:
        """Return the content of a file."""
        ...

    def send_bytes(self, path: str, content: bytes) -> Any:
        """Return the response of a route to bytes."""
        ...

    def send_files(self, path: str, files: Mapping[str, Iterable[Path]], **fields: Any) -> bytes:
        """Return the response of a route to files and fields of a form."""
        ...

    def compute(self, path: str, **query: Any) -> dict[str, Any]:
        """Return the result of a job."""
        ...

    def wait(self, *run_ids: int) -> None:
        """Wait until jobs have ended."""
        ...
