"""The audit log: who changed what, when and from where."""

from __future__ import annotations

from flexsid.api.context import TheStore
from flexsid.api.router import make_router
from flexsid.api.serialization import After, Json, JsonRoute, Limit
from flexsid.records.audit_event import AuditEvent
from flexsid.storage import audit_log
from flexsid.storage.paging import Page

router = make_router("/audit-events", tag="session", route_class=JsonRoute)


@router.get("", response_model=Page[AuditEvent])
def list_audit_events(store: TheStore, limit: Limit = 100, after: After = None) -> Json:
    """List the changes by accounts in the campaigns of which one is an administrator.

    `sealed` is the event as JSON, and `hash` its SHA-256; it includes the hash of the event before.
    """
    return Json(audit_log.read_page(store, limit=limit, after=after))
