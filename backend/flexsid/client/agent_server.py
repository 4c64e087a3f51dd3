"""Tools of a workbench for agents, and the server of the Model Context Protocol (MCP).

A tool is made from the OpenAPI description of a route, so that a new route is a new tool. Nothing
that approves, deletes or changes records is a tool.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import quote

import anyio
import mcp_types as types
from anyio import to_thread
from mcp.server.lowlevel import Server
from mcp.server.stdio import stdio_server

import flexsid
from flexsid.client.connection import Connection
from flexsid.errors import BadInput, FlexsidError

# --- Tools for agents: the routes of a workbench that read, and those that propose ----------------

PROPOSALS = frozenset({"request_run", "request_search", "add_model_structure", "propose_decision"})
"""Routes that propose: runs, searches for a model structure, structures, and their approval."""

LARGEST_RESULT = 200_000
"""Characters of one result: longer ones exceed what an agent can read at once."""

_PREFIX = "/api/v1/"
_REFERENCE = "#/components/schemas/"


@dataclass(frozen=True, slots=True)
class Tool:
    """A route as a tool: ``schema`` describes its arguments, of which ``in_path`` are in the path.

    A route that proposes has its request in the argument ``body``.
    """

    name: str
    description: str
    method: str
    path: str
    schema: dict[str, Any]
    in_path: frozenset[str]

    @property
    def is_proposal(self) -> bool:
        """Whether it proposes; the others read only."""
        return self.name in PROPOSALS


def list_tools(description: Mapping[str, Any]) -> dict[str, Tool]:
    """List the tools of an OpenAPI description by name.

    Parameters
    ----------
    description
        ``GET /api/v1/openapi.json``.

    Returns
    -------
    dict
        Routes with a JSON response that read, and those of ``PROPOSALS``.
    """
    components = description["components"]["schemas"]
    found: dict[str, Tool] = {}
    for path, methods in description["paths"].items():
        for method, operation in methods.items():
            name = operation["operationId"]
            reads = method == "get" and _returns_json(operation)
            if path.startswith(_PREFIX) and (reads or name in PROPOSALS):
                found[name] = _build_tool(method, path, operation, components)
    return found


def call_tool(connection: Connection, tool: Tool, arguments: Mapping[str, Any]) -> str:
    """Call a tool; return its result as JSON with its source and the runs that it rests on.

    Raises
    ------
    BadInput
        If an argument is unknown or missing, or the result is too long.
    RequestRefused
        If the workbench refuses the request.
    Unreachable
        If no workbench responds.
    """
    known = tool.schema["properties"]
    unknown = sorted(set(arguments) - set(known))
    missing = sorted(set(tool.schema["required"]) - set(arguments))
    if unknown or missing:
        wrong = [f"'{name}' is no argument" for name in unknown]
        wrong += [f"'{name}' is missing" for name in missing]
        raise BadInput(
            f"{tool.name}: {', '.join(wrong)}; its arguments are {', '.join(known)}",
            code="bad-argument",
        )
    path = tool.path
    for name in tool.in_path:
        path = path.replace(f"{{{name}}}", quote(str(arguments[name]), safe=""))
    query = {n: v for n, v in arguments.items() if n not in tool.in_path and n != "body"}
    if tool.method == "get":
        result = json.loads(connection.get(path, query))
    else:
        result = json.loads(connection.post(path, arguments["body"], query))
    run_ids = sorted(_find_run_ids(result, is_run=path.split("/")[0] == "runs"))
    source = f"{tool.method.upper()} {_PREFIX}{path}"
    text = json.dumps(
        {"source": source, "query": query, "run_ids": run_ids, "result": result},
        ensure_ascii=False,
    )
    if len(text) > LARGEST_RESULT:
        raise BadInput(
            f"the result of {tool.name} has {len(text)} characters, more than {LARGEST_RESULT}; "
            "select fewer records or a smaller part",
            code="result-too-long",
        )
    return text


def _returns_json(operation: Mapping[str, Any]) -> bool:
    return "application/json" in operation["responses"].get("200", {}).get("content", {})


def _build_tool(
    method: str, path: str, operation: Mapping[str, Any], components: Mapping[str, Any]
) -> Tool:
    properties: dict[str, Any] = {}
    required: list[str] = []
    in_path: set[str] = set()
    for parameter in operation.get("parameters", ()):
        if parameter["in"] not in ("path", "query"):
            continue
        name = parameter["name"]
        properties[name] = parameter["schema"]
        if parameter.get("required", False):
            required.append(name)
        if parameter["in"] == "path":
            in_path.add(name)
    if "requestBody" in operation:
        properties["body"] = operation["requestBody"]["content"]["application/json"]["schema"]
        required.append("body")
    schema = {
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }
    used = _collect_references(schema, components)
    if used:
        schema = _rename_references(schema)
        schema["$defs"] = {name: _rename_references(components[name]) for name in sorted(used)}
    return Tool(
        name=operation["operationId"],
        description=operation.get("description", operation["summary"]),
        method=method,
        path=path.removeprefix(_PREFIX),
        schema=schema,
        in_path=frozenset(in_path),
    )


def _iterate_values(value: Any) -> Iterable[tuple[str, Any]]:
    """Yield every key and value below a JSON value."""
    if isinstance(value, Mapping):
        for key, one in value.items():
            yield key, one
            yield from _iterate_values(one)
    elif isinstance(value, list):
        for one in value:
            yield from _iterate_values(one)


def _collect_references(schema: Any, components: Mapping[str, Any]) -> set[str]:
    found: set[str] = set()
    remaining = [schema]
    while remaining:
        for key, value in _iterate_values(remaining.pop()):
            name = str(value).removeprefix(_REFERENCE)
            if key == "$ref" and name not in found:
                found.add(name)
                remaining.append(components[name])
    return found


def _rename_references(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {
            key: one.replace(_REFERENCE, "#/$defs/") if key == "$ref" else _rename_references(one)
            for key, one in value.items()
        }
    return [_rename_references(one) for one in value] if isinstance(value, list) else value


def _find_run_ids(result: Any, *, is_run: bool) -> set[int]:
    """Find the ids of all runs that a result names; a run is named by its own id."""
    found: set[int] = set()
    for key, value in _iterate_values(result):
        if key in ("run_id", "run_ids") or key.endswith(("_run_id", "_run_ids")):
            named = value if isinstance(value, list) else [value]
            found.update(one for one in named if isinstance(one, int))
    if is_run and isinstance(result, Mapping):
        items = result.get("items", [result])
        found.update(one["id"] for one in items if isinstance(one, Mapping) and "id" in one)
    return found


# --- Server of the Model Context Protocol (MCP), by which agents use the tools of a workbench -----

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
