"""Requests to a workbench, and what it refuses."""

from __future__ import annotations

import json
import secrets
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.parse import quote, urlencode
from urllib.request import Request, urlopen

from flexsid.errors import FlexsidError


class RequestRefused(FlexsidError):
    """The workbench did not do what it was asked; ``status`` is that of HTTP."""

    def __init__(self, status: int, code: str, message: str) -> None:
        super().__init__(message, code=code)
        self.status = status


class Unreachable(FlexsidError):
    """No workbench answers at this address."""

    code = "unreachable"


@dataclass(frozen=True, slots=True)
class Connection:
    """Where the workbench is, how long an answer may take, and who asks."""

    url: str
    timeout_s: float
    analyst: str = ""

    def get(self, path: str, query: Mapping[str, Any]) -> bytes:
        """Read what stands at a path below ``/api/v1``."""
        asked = urlencode(
            {name: _text(value) for name, value in query.items() if value is not None}
        )
        return self._send(Request(f"{self._address(path)}{'?' if asked else ''}{asked}"))

    def post(self, path: str, body: Any) -> bytes:
        """Send a body as JSON."""
        return self._send(
            Request(
                self._address(path),
                data=json.dumps(body).encode(),
                headers={"Content-Type": "application/json"},
                method="POST",
            )
        )

    def send_files(self, path: str, files: Mapping[str, Iterable[Path]], **fields: Any) -> bytes:
        """Send files, and fields that are not None, as a form of a page does."""
        boundary = secrets.token_hex(16)
        parts = [
            (f'form-data; name="{name}"; filename="{_quoted(file.name)}"', file.read_bytes())
            for name, named in files.items()
            for file in named
        ]
        parts += [
            (f'form-data; name="{name}"', str(value).encode())
            for name, value in fields.items()
            if value is not None
        ]
        body = b"".join(
            f"--{boundary}\r\nContent-Disposition: {head}\r\n\r\n".encode() + content + b"\r\n"
            for head, content in parts
        )
        kind = {"Content-Type": f"multipart/form-data; boundary={boundary}"}
        data = body + f"--{boundary}--\r\n".encode()
        return self._send(Request(self._address(path), data=data, headers=kind, method="POST"))

    def delete(self, path: str) -> None:
        """Delete what stands at a path."""
        self._send(Request(self._address(path), method="DELETE"))

    def _address(self, path: str) -> str:
        return f"{self.url.rstrip('/')}/api/v1/{path.strip('/')}"

    def _send(self, request: Request) -> bytes:
        if self.analyst:
            request.add_header("X-Flexsid-Analyst", quote(self.analyst))
        try:
            with urlopen(request, timeout=self.timeout_s) as answer:
                return answer.read()
        except HTTPError as error:
            with error:
                raise _refusal(error.code, error.read()) from error
        except (URLError, TimeoutError, ConnectionError) as error:
            raise Unreachable(
                f"no workbench answers at {self.url} ({error}); start one with `flexsid serve`"
            ) from error


def _refusal(status: int, content: bytes) -> RequestRefused:
    try:
        problem = json.loads(content)
        return RequestRefused(status, problem["code"], problem["detail"])
    except (ValueError, KeyError, TypeError):
        return RequestRefused(
            status, "http-error", f"the server answered {status}; is it a workbench?"
        )


def _quoted(name: str) -> str:
    """A file's name as pages send it."""
    return name.replace('"', "%22").replace("\r", "%0D").replace("\n", "%0A")


def _text(value: Any) -> str:
    """Write a value as the interface reads it: lists with commas, truth in small letters."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str) or not isinstance(value, Iterable):
        return str(value)
    return ",".join(map(str, value))
