"""Addresses from which users log in: all of them from one may be a proxy that is not listed."""

from __future__ import annotations

import logging

from starlette.requests import HTTPConnection

from flexsid.api.authorization import peer_address
from flexsid.jobs.health import PartHealth, PartState
from flexsid.settings import Settings

_log = logging.getLogger(__name__)

_FEWEST_NAMES = 3


class LoginAddresses:
    """Log-ins since the start of a server that is known by another address than its own."""

    def __init__(self) -> None:
        self._names: dict[str, set[str]] = {}
        self._is_relayed = False  # by a listed proxy

    def add(self, settings: Settings, request: HTTPConnection, name: str) -> None:
        """Add a log-in; with the one that lets the addresses be suspect, log a warning."""
        peer = peer_address(request)
        before = self.check()
        self._is_relayed |= settings.url is None or settings.is_proxy(peer)
        if not self._is_relayed:
            self._names.setdefault(peer, set()).add(name.casefold())
        after = self.check()
        if after is not None and before is None:
            _log.warning(after.text)

    def check(self) -> PartHealth | None:
        """Return a part that is degraded if all log-ins come from one address; None otherwise."""
        if self._is_relayed or len(self._names) != 1:
            return None
        [(address, names)] = self._names.items()
        if len(names) < _FEWEST_NAMES:
            return None
        text = (
            f"All {len(names)} users have logged in from {address}, which FLEXSID_PROXIES does not "
            "name. If a proxy has this address, name it there; otherwise limits of failed log-ins "
            "and the audit log take all users for one address."
        )
        return PartHealth("proxy", PartState.DEGRADED, text)
