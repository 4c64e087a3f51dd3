"""Server of the Model Context Protocol (MCP), by which agents use the tools of a workbench."""

from __future__ import annotations

import json
from typing import Any

import anyio
import mcp_types as types
from anyio import to_thread
from mcp.server.lowlevel import Server
from mcp.server.stdio import stdio_server

import flexsid
from flexsid.client.connection import Connection
from flexsid.client.tools import Tool, call_tool, list_tools
from flexsid.errors import FlexsidError

_INSTRUCTIONS = (
    "Estimates of the aerodynamic derivatives of flexible aircraft from flight test, and what rests"
    " on them. Cite the ids of runs (`run_ids` of every result) with each statement, give standard"
    " errors with values, and state where a run is suspect. You can propose runs and model"
    " structures. Analysts approve them."
)


def build_server(connection: Connection) -> Server[Any]:
    """Build a server with the tools that a workbench describes.

    Parameters
    ----------
    connection
        Of the workbench; its token decides what exists for the agent.

    Raises
    ------
    RequestRefused, Unreachable
        If the workbench does not describe its routes.
    """
    tools = list_tools(json.loads(connection.get("openapi.json", {})))

    async def list_all(context: Any, params: Any) -> types.ListToolsResult:
        return types.ListToolsResult(tools=[_describe(tool) for tool in tools.values()])

    async def call(context: Any, params: types.CallToolRequestParams) -> types.CallToolResult:
        tool = tools.get(params.name)
        try:
            if tool is None:
                raise FlexsidError(f"there is no tool '{params.name}'", code="unknown-tool")
            given = params.arguments or {}
            text = await to_thread.run_sync(call_tool, connection, tool, given)
        except FlexsidError as error:
            return _write_result(f"{error.code}: {error}", is_error=True)
        return _write_result(text)

    return Server(
        "flexsid",
        version=flexsid.__version__,
        instructions=_INSTRUCTIONS,
        on_list_tools=list_all,
        on_call_tool=call,
    )


def serve(connection: Connection) -> None:
    """Serve the tools of a workbench on standard input and output, until the input ends."""
    server = build_server(connection)

    async def run() -> None:
        async with stdio_server() as (received, sent):
            await server.run(received, sent, server.create_initialization_options())

    anyio.run(run)


def _describe(tool: Tool) -> types.Tool:
    return types.Tool(
        name=tool.name,
        description=tool.description,
        input_schema=tool.schema,
        annotations=types.ToolAnnotations(
            read_only_hint=not tool.is_proposal, destructive_hint=False
        ),
    )


def _write_result(text: str, *, is_error: bool = False) -> types.CallToolResult:
    return types.CallToolResult(
        content=[types.TextContent(type="text", text=text)], is_error=is_error
    )
