"""Command ``flexsid mcp``: tools of a running workbench for agents."""

from __future__ import annotations

import argparse
import os
from importlib.util import find_spec

from flexsid.client.connection import Connection
from flexsid.errors import BadInput
from flexsid.settings import Settings

_TIMEOUT_S = 60.0  # of one response, as of the client


def serve_tools(settings: Settings, arguments: argparse.Namespace) -> int:
    """Serve the tools of a workbench on standard input and output.

    Raises
    ------
    BadInput
        If the extra ``mcp`` is not installed.
    """
    if find_spec("mcp") is None:
        raise BadInput("agents need the extra `mcp`: pip install 'flexsid[mcp]'")
    from flexsid.client.agent_server import serve

    token = os.environ.get("FLEXSID_TOKEN")
    serve(Connection(arguments.url, _TIMEOUT_S, arguments.analyst, token))
    return 0
