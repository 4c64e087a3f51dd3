"""Tools for agents: what a workbench reads and proposes, by the Model Context Protocol."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import anyio
import jsonschema
import pytest
from interface import DESCRIPTION
from mcp import Client
from mcp.client.stdio import StdioServerParameters

from flexsid.client.agent_server import (
    LARGEST_RESULT,
    PROPOSALS,
    Tool,
    build_server,
    call_tool,
    list_tools,
)
from flexsid.client.connection import Connection
from flexsid.errors import BadInput

TOOLS = list_tools(DESCRIPTION)


class Recorded(Connection):
    """A connection that responds with a given result."""

    result: Any = None

    def get(self, path: str, query: Any) -> bytes:
        return json.dumps({"path": path} | self.result).encode()


def respond(result: dict[str, Any]) -> Connection:
    connection = Recorded("", 1.0)
    Recorded.result = result
    return connection


def run_in_thread(scenario: Callable[[], Coroutine[Any, Any, None]]) -> None:
    """Run a coroutine in a thread of its own: that of a browser test has a loop already."""
    with ThreadPoolExecutor(1) as executor:
        executor.submit(anyio.run, scenario).result()


def use(url: str, scenario: Callable[[Client], Coroutine[Any, Any, None]]) -> None:
    async def run() -> None:
        async with Client(build_server(Connection(url, 60.0, "agent"))) as client:
            await scenario(client)

    run_in_thread(run)


def read_text(called: Any) -> str:
    (content,) = called.content
    return content.text


def test_every_tool_reads_or_proposes_and_none_approves():
    methods = {
        operation["operationId"]: method
        for path in DESCRIPTION["paths"].values()
        for method, operation in path.items()
    }
    for name, tool in TOOLS.items():
        assert (methods[name] == "get") != tool.is_proposal
        jsonschema.Draft202012Validator.check_schema(tool.schema)
        json.dumps(tool.schema)
    assert TOOLS.keys() > PROPOSALS
    assert {"list_runs", "get_run", "get_dashboard", "list_predictions"} <= TOOLS.keys()
    changing = ("vote_", "delete_", "edit_", "cancel_", "change_", "stop_", "withdraw_", "accept_")
    assert not [name for name in TOOLS if name.startswith(changing)]
    assert "stream_events" not in TOOLS  # never ends
    assert "report_run" not in TOOLS  # no JSON


def test_references_of_a_schema_are_complete():
    body = TOOLS["request_run"].schema
    text = json.dumps(body)
    assert "#/components" not in text
    assert text.count("#/$defs/") > 3
    example = {"body": {"maneuver_id": 1, "method": "OE"}}
    jsonschema.validate(example, body)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"body": {"maneuver_id": "one", "method": "OE"}}, body)


def test_results_cite_their_runs():
    def cite(tool: Tool, result: dict[str, Any], **arguments: Any) -> list[int]:
        return json.loads(call_tool(respond(result), tool, arguments))["run_ids"]

    assert cite(TOOLS["list_runs"], {"items": [{"id": 4}, {"id": 2}], "next": None}) == [2, 4]
    assert cite(TOOLS["get_run"], {"id": 7, "derived_from_run_id": None}, run_id=7) == [7]
    nested = {"id": 3, "cells": [{"run_id": 5}, {"best": {"run_ids": [6, 5]}}]}
    assert cite(TOOLS["get_dashboard"], nested, aircraft_id=3) == [5, 6]


def test_arguments_are_refused_by_name_and_cannot_change_the_path():
    with pytest.raises(BadInput, match=r"'run' is no argument, 'run_id' is missing"):
        call_tool(respond({}), TOOLS["get_run"], {"run": 1})
    sent = json.loads(call_tool(respond({}), TOOLS["get_run"], {"run_id": "../jobs/1?a=b"}))
    assert sent["result"]["path"] == "runs/..%2Fjobs%2F1%3Fa%3Db"
    with pytest.raises(BadInput, match="select fewer records"):
        call_tool(respond({"samples": "x" * LARGEST_RESULT}), TOOLS["get_run"], {"run_id": 1})


def test_an_agent_reads_runs_and_proposes_one(live_url: str) -> None:
    async def scenario(client: Client) -> None:
        listed = await client.list_tools()
        assert {tool.name for tool in listed.tools} == TOOLS.keys()
        runs = json.loads(read_text(await client.call_tool("list_runs", {"state": "succeeded"})))
        assert runs["run_ids"] == sorted(run["id"] for run in runs["result"]["items"])
        body = {"maneuver_id": 1, "method": "EE", "label": "proposed by an agent"}
        asked = await client.call_tool("request_run", {"body": body})
        assert asked.is_error  # 'label' is no field: the reason names it
        assert "label" in read_text(asked)
        # Unlike the runs of other tests at this server: those are not estimated again.
        body = {"maneuver_id": 1, "method": "EE", "settings": {"max_iterations": 93}}
        proposed = json.loads(read_text(await client.call_tool("request_run", {"body": body})))
        assert proposed["result"]["author"] == "agent"
        assert proposed["run_ids"] == [proposed["result"]["id"]]
        for name in ("vote_on_decision", "delete_run", "no-tool"):
            refused = await client.call_tool(name, {})
            assert refused.is_error
            assert read_text(refused) == f"unknown-tool: there is no tool '{name}'"

    use(live_url, scenario)


def test_the_command_serves_on_standard_input_and_output(live_url: str) -> None:
    arguments = ["-m", "flexsid.cli.main", "mcp", "--url", live_url]

    async def run() -> None:
        async with Client(StdioServerParameters(command=sys.executable, args=arguments)) as client:
            called = await client.call_tool("list_aircraft", {})
            assert json.loads(read_text(called))["source"] == "GET /api/v1/aircraft"

    run_in_thread(run)
