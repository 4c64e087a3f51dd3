"""HTTP requests to a workbench."""

from __future__ import annotations

import json
import secrets
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.parse import quote, urlencode
from urllib.request import Request, urlopen

from flexsid.errors import FlexsidError


class RequestRefused(FlexsidError):
    """The workbench refused the request; ``status`` is the HTTP status."""

    def __init__(self, status: int, code: str, message: str) -> None:
        super().__init__(message, code=code)
        self.status = status


class Unreachable(FlexsidError):
    """No workbench responds at this address."""

    code = "unreachable"


@dataclass(frozen=True, slots=True)
class Connection:
    """Address of the workbench, response timeout, name of the analyst, and API token."""

    url: str
    timeout_s: float
    analyst: str = ""
    token: str | None = field(default=None, repr=False)

    def get(self, path: str, query: Mapping[str, Any]) -> bytes:
        """Return the response of a GET request to a path below ``/api/v1``."""
        return self._send(Request(self._address(path, query)))

    def post(self, path: str, body: Any, query: Mapping[str, Any]) -> bytes:
        """Return the response of a POST request with a JSON body and a query."""
        return self._send_json("POST", self._address(path, query), body)

    def post_bytes(self, path: str, content: bytes) -> bytes:
        """Return the response of a POST request with bytes."""
        kind = {"Content-Type": "application/octet-stream"}
        return self._send(Request(self._address(path), data=content, headers=kind, method="POST"))

    def put(self, path: str, body: Any) -> bytes:
        """Return the response of a PUT request with a JSON body."""
        return self._send_json("PUT", self._address(path, {}), body)

    def _send_json(self, method: str, address: str, body: Any) -> bytes:
        return self._send(
            Request(
                address,
                data=json.dumps(body).encode(),
                headers={"Content-Type": "application/json"},
                method=method,
            )
        )

    def send_files(self, path: str, files: Mapping[str, Iterable[Path]], **fields: Any) -> bytes:
        """Return the response of a POST request with files and fields (multipart form)."""
        boundary = secrets.token_hex(16)
        parts = [
            (
                f'form-data; name="{name}"; filename="{_escape_file_name(file.name)}"',
                file.read_bytes(),
            )
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
        """Send a DELETE request to a path."""
        self._send(Request(self._address(path), method="DELETE"))

    def _address(self, path: str, query: Mapping[str, Any] = MappingProxyType({})) -> str:
        given = {name: _format_value(value) for name, value in query.items() if value is not None}
        encoded = f"?{urlencode(given)}" if given else ""
        return f"{self.url.rstrip('/')}/api/v1/{path.strip('/')}{encoded}"

    def _send(self, request: Request) -> bytes:
        if self.analyst:
            request.add_header("X-Flexsid-Analyst", quote(self.analyst))
        if self.token is not None:
            request.add_unredirected_header("Authorization", f"Bearer {self.token}")
        try:
            with urlopen(request, timeout=self.timeout_s) as response:
                return response.read()
        except HTTPError as error:
            with error:
                raise _parse_refusal(error.code, error.read()) from error
        except (URLError, TimeoutError, ConnectionError) as error:
            raise Unreachable(
                f"no workbench responds at {self.url} ({error}); start one with `flexsid serve`"
            ) from error


def _parse_refusal(status: int, content: bytes) -> RequestRefused:
    try:
        problem = json.loads(content)
        return RequestRefused(status, problem["code"], problem["detail"])
    except (ValueError, KeyError, TypeError):
        return RequestRefused(
            status,
            "http-error",
            f"the server returned HTTP status {status}, not a workbench error; check the address",
        )


def _escape_file_name(name: str) -> str:
    """Return a file name escaped as in a browser form."""
    return name.replace('"', "%22").replace("\r", "%0D").replace("\n", "%0A")


def _format_value(value: Any) -> str:
    """Format a query value: lists with commas, booleans in lower case."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str) or not isinstance(value, Iterable):
        return str(value)
    return ",".join(map(str, value))
