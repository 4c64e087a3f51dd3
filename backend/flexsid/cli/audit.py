"""Export of the audit log: ``flexsid audit``."""

from __future__ import annotations

import argparse

import orjson

from flexsid.cli.database import open_store
from flexsid.cli.output import print_written_file, write_file
from flexsid.settings import Settings
from flexsid.storage.audit_log import read_events


def audit(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write the audit log, one event as JSON per line."""
    with open_store(settings) as store:
        lines = [orjson.dumps(event, option=orjson.OPT_UTC_Z) for event in read_events(store)]
    write_file(arguments.output, b"".join(line + b"\n" for line in lines))
    result = {"events": len(lines), "file": arguments.output}
    text = f"wrote {len(lines)} events to {arguments.output}"
    print_written_file(text, result, as_json=arguments.json)
    return 0
