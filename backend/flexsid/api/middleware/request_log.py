"""Log and metrics of requests: an id for each, a line of JSON with accounts, and counts.

Lines and metrics have paths without queries, and neither headers nor bodies, so that they contain
no secrets.
"""

from __future__ import annotations

import json
import logging
import secrets
import time
from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime

from fastapi import Depends, FastAPI, Response
from starlette.datastructures import MutableHeaders
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from flexsid.api.authorization import authorize, client_address
from flexsid.api.context import TheContext
from flexsid.api.errors import make_problem
from flexsid.api.router import PREFIX
from flexsid.settings import Mode, Settings
from flexsid.storage.access import using_access
from flexsid.storage.jobs import job_list, leases

# --- Log and metrics of requests: an id for each, a line of JSON with accounts, and counts --------

_log = logging.getLogger("flexsid.requests")

LARGEST_HEADERS = 64 * 1024
_BUCKETS_S = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)


class RequestMetrics:
    """Counts and durations of requests since the server started, by route."""

    def __init__(self) -> None:
        self._counts: Counter[tuple[str, str, int]] = Counter()
        self._buckets: Counter[float] = Counter()
        self._total_s = 0.0

    def count(self, method: str, route: str, status: int, duration_s: float) -> None:
        """Count one request."""
        self._counts[method, route, status] += 1
        self._total_s += duration_s
        self._buckets[next((top for top in _BUCKETS_S if duration_s <= top), float("inf"))] += 1

    def write(self) -> Iterator[str]:
        """Yield the lines of the Prometheus text format."""
        yield "# TYPE flexsid_requests_total counter"
        for (method, route, status), count in sorted(self._counts.items()):
            labels = f'method="{method}",route="{route}",status="{status}"'
            yield f"flexsid_requests_total{{{labels}}} {count}"
        yield "# TYPE flexsid_request_duration_seconds histogram"
        below = 0
        for top in (*_BUCKETS_S, float("inf")):
            below += self._buckets[top]
            label = "+Inf" if top == float("inf") else f"{top:g}"
            yield f'flexsid_request_duration_seconds_bucket{{le="{label}"}} {below}'
        yield f"flexsid_request_duration_seconds_sum {self._total_s:.6f}"
        yield f"flexsid_request_duration_seconds_count {below}"


class RequestLog:
    """Middleware that gives each request an id, counts it, and logs it on servers with accounts."""

    def __init__(self, app: ASGIApp, metrics: RequestMetrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on; refuse oversized headers with 431."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun = time.perf_counter()
        identity = scope["request_id"] = secrets.token_hex(8)
        status = 500

        async def send_with_id(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)["X-Request-Id"] = identity
            await send(message)

        try:
            size = sum(len(name) + len(value) for name, value in scope["headers"])
            if size > LARGEST_HEADERS:
                problem = make_problem(431, "headers-too-large", refuse_headers(size))
                await problem(scope, receive, send_with_id)
            else:
                await self._app(scope, receive, send_with_id)
        finally:
            duration_s = time.perf_counter() - begun
            route = getattr(scope.get("route"), "path", "other").removeprefix(PREFIX)
            self._metrics.count(scope["method"], route, status, duration_s)
            _log_request(scope, status, duration_s)


def refuse_headers(size: int) -> str:
    """Return why headers of this size are refused. [bytes]"""
    return f"the headers have {size} bytes; expected at most {LARGEST_HEADERS}"


def _log_request(scope: Scope, status: int, duration_s: float) -> None:
    settings: Settings = scope["app"].state.settings
    if settings.mode is Mode.PERSONAL:
        return
    found = scope.get("state", {}).get("identity")
    entry = {
        "request_id": scope["request_id"],
        "address": client_address(settings, HTTPConnection(scope)),
        "account": None if found is None else found.account.name,
        "method": scope["method"],
        "path": scope["path"],
        "status": status,
        "ms": round(1000 * duration_s, 1),
    }
    _log.info("request", extra={"entry": entry})


class JsonFormatter(logging.Formatter):
    """Formats every record of the log as one line of JSON."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line."""
        at = datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds")
        line = {
            "at": at,
            "level": record.levelname,
            "logger": record.name,
            "message": record.getMessage(),
            **getattr(record, "entry", {}),
        }
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=False)


# --- Metrics for Prometheus at ``/metrics``: requests, jobs and workers ---------------------------


def add_metrics(app: FastAPI, metrics: RequestMetrics) -> None:
    """Serve the metrics; with accounts a token is needed, of any account."""

    @app.get(
        "/metrics",
        tags=["health"],
        dependencies=[Depends(authorize)],
        response_class=Response,
        responses={200: {"content": {"text/plain": {"schema": {"type": "string"}}}}},
    )
    def get_metrics(context: TheContext) -> Response:
        """Return numbers of requests, jobs and workers in the text format of Prometheus."""
        with using_access(None):  # numbers of all campaigns, without their records
            states = job_list.count_throughput(context.store).states
            pool = leases.status(context.store)
        lines = [*metrics.write(), "# TYPE flexsid_jobs gauge"]
        lines += [f'flexsid_jobs{{state="{state.value}"}} {n}' for state, n in states.items()]
        workers = 0 if pool is None else pool["workers"]
        lines += ["# TYPE flexsid_workers gauge", f"flexsid_workers {workers}"]
        text = "\n".join(lines) + "\n"
        return Response(text, media_type="text/plain; version=0.0.4")
