"""Commands ``flexsid live`` and ``flexsid mcp``, which talk to a running workbench."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Iterable
from importlib.util import find_spec
from typing import Any

from flexsid.cli.output import print_result
from flexsid.client import Workbench
from flexsid.client.connection import Connection
from flexsid.client.live import Live
from flexsid.errors import BadInput
from flexsid.settings import Settings

# --- Command ``flexsid live``: streams of a running workbench -------------------------------------


def run_action(settings: Settings, arguments: argparse.Namespace) -> int:
    """Run one of the actions on streams."""
    live = Workbench(arguments.url, analyst=arguments.analyst).live
    result, lines = ACTIONS[arguments.action](live, arguments)
    print_result(lines, result, as_json=arguments.json)
    return 0


def parse_options(texts: Iterable[str]) -> dict[str, Any]:
    """Parse options of a receiver, such as ``port=5005`` and ``channels.q=ATTITUDE.pitchspeed``.

    Raises
    ------
    BadInput
        If a text has no name or no value.
    """
    options: dict[str, Any] = {}
    for text in texts:
        path, equals, value = text.partition("=")
        name, dot, key = path.partition(".")
        if not equals or not name or (dot and not key):
            raise BadInput(f"--option is {text!r}; expected NAME=VALUE or NAME.KEY=VALUE")
        if dot:
            options.setdefault(name, {})[key] = value
        else:
            options[name] = _parse_value(value)
    return options


def _parse_value(text: str) -> Any:
    """Return a number where the text is one."""
    try:
        value = json.loads(text)
    except ValueError:
        return text
    return value if isinstance(value, int | float) and not isinstance(value, bool) else text


def _list_receivers(live: Live, arguments: argparse.Namespace) -> tuple[Any, list[str]]:
    found = live.receivers()
    lines = []
    for one in found:
        extra = one["missing_extra"]
        lines.append(f"{one['name']:9} {one['label']}" + (f" (flexsid[{extra}])" if extra else ""))
        lines += [f"          {o['name']}: {o['description']}" for o in one["options"]]
    return found, lines


def _start(live: Live, arguments: argparse.Namespace) -> tuple[Any, list[str]]:
    if arguments.run is None or arguments.receiver is None:
        raise BadInput("start needs --run and --receiver")
    settings = {"flight_id": arguments.flight, "next_airspeed_m_s": arguments.next}
    number = live.start(
        arguments.run,
        arguments.title or arguments.receiver,
        arguments.receiver,
        parse_options(arguments.option),
        **{name: value for name, value in settings.items() if value is not None},
    )
    return {"id": number}, [f"stream {number}: {arguments.url.rstrip('/')}/live/{number}"]


def _list_streams(live: Live, arguments: argparse.Namespace) -> tuple[Any, list[str]]:
    rows = live.streams().reset_index().to_dict("records")
    return rows, [f"{one['id']:4} {one['status']:8} {one['title']}" for one in rows]


def _show(live: Live, arguments: argparse.Namespace) -> tuple[Any, list[str]]:
    found = live.stream(_get_id(arguments))
    state = (found["snapshot"] or {}).get("state") or {}
    estimate = state.get("estimate") or {}
    lines = [f"{found['stream']['title']}: {found['stream']['status']}"]
    if state:
        lines.append(
            f"{state['time_s']:.1f} s, {state['phase']}, {state['lost_frames']} frames lost"
        )
    lines += [
        f"{m['name']}: {m['frequency']:.2f} rad/s, damping ratio {m['damping']:.4f}"
        for m in estimate.get("modes", ())
    ]
    if estimate.get("flutter_m_s") is not None:
        lines.append(f"flutter speed {estimate['flutter_m_s']:.2f} m/s")
    lines += [f"ALARM {a['kind']}, {a['subject']}: {a['evidence']}" for a in found["alarms"]]
    return found, lines


def _stop(live: Live, arguments: argparse.Namespace) -> tuple[Any, list[str]]:
    stream = live.stop(_get_id(arguments))
    return stream, [f"stream {stream['id']}: {stream['status']}"]


def _get_id(arguments: argparse.Namespace) -> int:
    if arguments.stream is None:
        raise BadInput(f"{arguments.action} needs the id of a stream")
    return arguments.stream


ACTIONS: dict[str, Callable[[Live, argparse.Namespace], tuple[Any, list[str]]]] = {
    "receivers": _list_receivers,
    "start": _start,
    "list": _list_streams,
    "show": _show,
    "stop": _stop,
}


# --- Command ``flexsid mcp``: tools of a running workbench for agents -----------------------------

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
