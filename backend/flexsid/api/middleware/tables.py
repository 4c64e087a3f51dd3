"""Tables of responses as files: ``.csv`` or ``.json`` behind the address of any GET.

``GET /runs/3`` has several tables; ``GET /runs/3.csv?table=parameters`` is one of them, with all
digits of its numbers.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import Any
from urllib.parse import parse_qsl, urlencode

import orjson
from starlette.datastructures import MutableHeaders
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from flexsid.api.errors import make_problem
from flexsid.text import escape_spreadsheet_cell

_FORMS = {".csv": "text/csv; charset=utf-8", ".json": "application/json"}
_PARAMETER = "table"
_LIST, _NEXT, _AFTER = "items", "next", "after"  # of a page of a list
_NOT_OF_THE_TABLE = frozenset({b"content-type", b"content-length", b"content-disposition"})

Row = dict[str, Any]


class TableFiles:
    """Answers a GET of ``<address>.csv`` or ``.json`` with a table of the response of the address.

    Parameters
    ----------
    app
        Application behind it.
    prefix
        Begin of the addresses that have tables.
    own
        Begin of addresses below it without tables: those of figures, which have forms of their
        own, and of the description.
    """

    def __init__(self, app: ASGIApp, prefix: str, own: tuple[str, ...]) -> None:
        self._app = app
        self._prefix = prefix
        self._own = own

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer the request of a table; pass any other on."""
        path = scope["path"] if scope["type"] == "http" and scope["method"] == "GET" else ""
        form = next((form for form in _FORMS if path.endswith(form)), None)
        if form is None or not path.startswith(self._prefix) or path.startswith(self._own):
            await self._app(scope, receive, send)
            return
        query = parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
        names = [value for name, value in query if name == _PARAMETER]
        if len(names) > 1:
            detail = f"{_PARAMETER} is given {len(names)} times"
            await make_problem(422, "repeated-parameter", detail)(scope, receive, send)
            return
        named = names[0] if names else None
        others = [pair for pair in query if pair[0] != _PARAMETER]
        address = {**scope, "path": path.removesuffix(form)}
        if raw := scope.get("raw_path"):
            address["raw_path"] = raw.removesuffix(form.encode())
        try:
            answer = await self._read(address, receive, others)
        except _NoTables:
            detail = f"{address['path']} has no tables; read it without {form}"
            await make_problem(404, "no-table", detail)(scope, receive, send)
            return
        if "route" in address:
            scope["route"] = address["route"]  # by which requests are counted
        if answer.status != 200:
            for message in answer.messages:
                await send(message)
            return
        content = orjson.loads(answer.body)
        tables = dict(_list_tables(content))
        name = named if named is not None else _LIST if _LIST in tables else _get_only(tables)
        if name is None or name not in tables:
            known = f"its tables are {', '.join(map(repr, tables))}" if tables else "it has none"
            asked = "no table is named" if named is None else f"there is no table '{named}'"
            detail = f"{asked}: {known}; name one by {_PARAMETER}"
            await make_problem(422, "unknown-table", detail)(scope, receive, send)
            return
        found = tables[name]
        while name == _LIST and isinstance(content, dict) and content.get(_NEXT):
            page = [*(pair for pair in others if pair[0] != _AFTER), (_AFTER, content[_NEXT])]
            more = await self._read(address, receive, page)
            if more.status != 200:
                for message in more.messages:
                    await send(message)
                return
            content = orjson.loads(more.body)
            found = [*found, *content[_LIST]]
        rows = [_flatten(row) for row in found]
        file = write_csv(rows).encode() if form == ".csv" else orjson.dumps(rows)
        response = Response(file, media_type=_FORMS[form])
        for header, value in answer.headers:
            if header not in _NOT_OF_THE_TABLE:
                response.raw_headers.append((header, value))
        place = path.removeprefix(self._prefix).removesuffix(form).replace("/", "-")
        of_table = "" if named is None else f"-{named.replace('.', '-')}"
        MutableHeaders(raw=response.raw_headers)["content-disposition"] = (
            f'attachment; filename="flexsid-{place}{of_table}{form}"'
        )
        await response(scope, receive, send)

    async def _read(self, scope: Scope, receive: Receive, query: list[tuple[str, str]]) -> _Answer:
        answer = _Answer()
        scope["query_string"] = urlencode(query).encode("latin-1")
        await self._app(scope, receive, answer)
        return answer


class _NoTables(Exception):
    """The response is a file, or a stream that does not end."""


class _Answer:
    """Response of the application, held until it is complete."""

    def __init__(self) -> None:
        self.messages: list[Message] = []

    async def __call__(self, message: Message) -> None:
        self.messages.append(message)
        if self.status == 200 and (b"content-type", b"application/json") not in self.headers:
            raise _NoTables

    @property
    def status(self) -> int:
        return int(self.messages[0]["status"])

    @property
    def headers(self) -> list[tuple[bytes, bytes]]:
        return list(self.messages[0]["headers"])

    @property
    def body(self) -> bytes:
        return b"".join(one.get("body", b"") for one in self.messages[1:])


def write_csv(rows: list[Row]) -> str:
    """Write rows as CSV, with the columns of all rows in the order in which they first occur.

    Numbers have all their digits; text that a spreadsheet would run as a formula is quoted.
    """
    columns = list(dict.fromkeys(name for row in rows for name in row))
    out = io.StringIO(newline="")
    writer = csv.writer(out)
    writer.writerow(map(escape_spreadsheet_cell, columns))
    writer.writerows([_format_cell(row.get(name)) for name in columns] for row in rows)
    return out.getvalue()


def _list_tables(content: Any, name: str = "") -> Iterator[tuple[str, list[Row]]]:
    """Yield the lists of objects within a response, by their dotted names."""
    if isinstance(content, list):
        if all(isinstance(row, dict) for row in content):
            yield name, content
    elif isinstance(content, dict):
        for key, value in content.items():
            yield from _list_tables(value, f"{name}.{key}" if name else key)


def _get_only(tables: dict[str, list[Row]]) -> str | None:
    return next(iter(tables)) if len(tables) == 1 else None


def _flatten(row: Row, name: str = "") -> Row:
    """Return a row with dotted names in place of objects within it."""
    found: Row = {}
    for key, value in row.items():
        whole = f"{name}.{key}" if name else key
        found |= _flatten(value, whole) if isinstance(value, dict) else {whole: value}
    return found


def _format_cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return escape_spreadsheet_cell(value)
    return orjson.dumps(value).decode()
