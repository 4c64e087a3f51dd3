"""HTTP requests to a workbench, progress of what they started, and their results as DataFrames."""

from __future__ import annotations

import io
import json
import secrets
import sys
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType, ModuleType
from typing import TYPE_CHECKING, Any, Protocol, TextIO
from urllib.error import HTTPError, URLError
from urllib.parse import quote, urlencode
from urllib.request import Request, urlopen

from flexsid.errors import FlexsidError

if TYPE_CHECKING:
    import pandas


# --- HTTP requests to a workbench -----------------------------------------------------------------


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


# --- Requests of a workbench, as its parts use them -----------------------------------------------


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


# --- Progress of runs on one line of a terminal or notebook ---------------------------------------

_WIDTH = 30


class ProgressLine:
    """Progress bar on one line; silent unless the output is a terminal or notebook."""

    def __init__(self, shown: bool, out: TextIO | None = None) -> None:
        self._out = sys.stderr if out is None else out
        self._shown = shown and _is_interactive(self._out)

    def show(self, runs: Sequence[dict[str, Any]]) -> None:
        """Show the progress of runs."""
        if not self._shown:
            return
        share = sum(map(get_fraction, runs)) / len(runs)
        bar = "█" * round(_WIDTH * share)
        print(f"\r{bar:<{_WIDTH}} {share:4.0%} {_describe(runs):<50.50}", end="", file=self._out)
        self._out.flush()

    def end(self) -> None:
        """End the line."""
        if self._shown:
            print(file=self._out)


def get_fraction(run: dict[str, Any]) -> float:
    """Return the completed fraction of a run."""
    if run["finished_at"] is not None:
        return 1.0
    return 0.0 if run["progress"] is None else run["progress"]["fraction"]


def _describe(runs: Sequence[dict[str, Any]]) -> str:
    if len(runs) == 1:
        (run,) = runs
        message = "" if run["progress"] is None else run["progress"]["message"]
        return f"run {run['id']} {run['state']} {message}"
    done = sum(run["finished_at"] is not None for run in runs)
    return f"{done} of {len(runs)} runs"


def _is_interactive(out: TextIO) -> bool:
    """Return whether the output is a terminal or a notebook."""
    return out.isatty() or type(out).__module__.startswith("ipykernel")


# --- Polling of runs until they have ended --------------------------------------------------------

_ENDED = frozenset({"succeeded", "failed", "cancelled"})
_UNREACHABLE_S = 60.0  # longer than the restart of a server


class RunFailed(FlexsidError):
    """A run did not succeed."""

    code = "run-failed"


def poll_until_ended(
    fetch: Callable[[Sequence[int]], list[dict[str, Any]]],
    run_ids: Sequence[int],
    timeout_s: float | None,
    line: ProgressLine,
) -> list[dict[str, Any]]:
    """Poll until all runs have ended, show their progress, and return them.

    Raises
    ------
    TimeoutError
        If the runs have not ended within ``timeout_s``.
    Unreachable
        If the workbench did not respond for a minute.
    """
    started = responded = time.monotonic()
    pause = 0.05
    runs: list[dict[str, Any]] = []
    while not all(run["state"] in _ENDED for run in runs) or len(runs) < len(run_ids):
        if timeout_s is not None and time.monotonic() - started > timeout_s:
            listed = ", ".join(map(str, run_ids))
            raise TimeoutError(f"runs {listed} have not ended in {timeout_s:g} s")
        time.sleep(pause if runs else 0.0)
        pause = min(1.2 * pause, 1.0)
        try:
            runs = fetch(run_ids)
            responded = time.monotonic()
        except Unreachable:
            if time.monotonic() - responded > _UNREACHABLE_S:
                raise
            time.sleep(1.0)
            continue
        line.show(runs)
    return runs


def describe_failure(run: dict[str, Any]) -> str:
    """Return why a run has no result, as a sentence."""
    reason = "" if run["error"] is None else f": {run['error']['message']}"
    return f"run {run['id']} {run['state']}{reason}"


# --- Conversion of responses to DataFrames; requires pandas ---------------------------------------


def table(items: Sequence[dict[str, Any]], index: str | None = "id") -> pandas.DataFrame:
    """Return one row per item; nested fields get columns ``outer.inner``, times are parsed."""
    frame = _pandas().json_normalize(list(items))
    for name in frame.columns:
        if name.endswith("_at"):
            frame[name] = _pandas().to_datetime(frame[name], format="ISO8601", utc=True)
    return frame.set_index(index) if index is not None and index in frame.columns else frame


def matrix(values: Sequence[Sequence[float]], names: Sequence[str]) -> pandas.DataFrame:
    """Return a square matrix with the same names on rows and columns."""
    return _pandas().DataFrame(values, index=list(names), columns=list(names))


def tabulate_comparison(comparison: dict[str, Any]) -> pandas.DataFrame:
    """Return a comparison with columns ``value`` and ``std_error`` per source.

    Predictions also have ``difference_sigma``, their largest difference from a run.
    """
    rows: dict[str, dict[tuple[str, str], float | None]] = {}
    for row in comparison["rows"]:
        cells: dict[tuple[str, str], float | None] = {}
        for source, value in zip(comparison["sources"], row["values"], strict=True):
            predicted = source["kind"] == "prediction"
            for part in ("value", "std_error", *(("difference_sigma",) if predicted else ())):
                cells[source["label"], part] = None if value is None else value[part]
        cells["max_difference_sigma", ""] = row["max_difference_sigma"]
        rows[row["name"]] = cells
    return _pandas().DataFrame.from_dict(rows, orient="index", dtype=float)


def read_csv(content: bytes) -> pandas.DataFrame:
    """Parse a CSV response."""
    return _pandas().read_csv(io.BytesIO(content))


def join_samples(channels: list[dict[str, Any]]) -> pandas.DataFrame:
    """Join the samples of channels by time; units are in ``attrs``."""
    columns = [
        _pandas().Series(one["values"], index=one["time_s"], name=one["name"], dtype=float)
        for one in channels
    ]
    table = _pandas().concat(columns, axis=1).sort_index().rename_axis("time_s")
    table.attrs["units"] = {one["name"]: one["unit"] for one in channels}
    return table


def _pandas() -> ModuleType:
    try:
        import pandas
    except ImportError as error:
        raise FlexsidError(
            "tables need pandas; install it with `pip install flexsid[client]`, or use plain"
            " responses of `Workbench.get`",
            code="no-pandas",
        ) from error
    return pandas
