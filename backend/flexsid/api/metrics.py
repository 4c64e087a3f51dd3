"""Metrics for Prometheus at ``/metrics``: requests, jobs and workers."""

from __future__ import annotations

from fastapi import Depends, FastAPI, Response

from flexsid.api.authorization import authorize
from flexsid.api.context import TheContext
from flexsid.api.middleware.request_log import RequestMetrics
from flexsid.storage import job_list, leases
from flexsid.storage.access import using_access


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
