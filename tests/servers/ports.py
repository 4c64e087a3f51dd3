"""Ports of servers that tests start."""

from __future__ import annotations

import os
import socket
from itertools import count

# Below those that systems give to connections and to whoever asks for any port: one of them could
# be taken between its choice and the start of the server, or while the server is restarted.
_FIRST, _LAST = 10_000, 32_000
_OF_PROCESS = 100

_next = count(_FIRST + 7 * _OF_PROCESS * os.getpid() % (_LAST - _FIRST))


def find_free_port() -> int:
    """Return a port that nothing listens on, another one with every call."""
    while True:
        port = _FIRST + (next(_next) - _FIRST) % (_LAST - _FIRST)
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
            return port
