"""Commands ``flexsid capsule`` and ``flexsid recompute``: a run to be computed elsewhere."""

from __future__ import annotations

import argparse
from pathlib import Path

from flexsid.cli.database import open_store
from flexsid.cli.output import print_result, write_file
from flexsid.cli.runs import report_progress
from flexsid.errors import BadInput
from flexsid.settings import Settings
from flexsid.storage.signatures import check_key
from flexsid.verification.recomputation import recompute_capsule
from flexsid.workflow.runs.capsule import read_capsule, write_capsule


def export(settings: Settings, arguments: argparse.Namespace) -> int:
    """Write the capsule of a run."""
    with open_store(settings) as store:
        content = write_capsule(store, arguments.run)
    file = Path(arguments.output or f"flexsid-run-{arguments.run}.crate.zip")
    write_file(file, content)
    found = {"file": str(file), "n_bytes": len(content)}
    print_result([f"wrote {file}, {len(content)} bytes"], found, as_json=arguments.json)
    return 0


def recompute(settings: Settings, arguments: argparse.Namespace) -> int:
    """Check a capsule and compute its run again, without a database; return 1 if it differs."""
    file = Path(arguments.file)
    try:
        content = file.read_bytes()
    except OSError as error:
        raise BadInput(f"{file} cannot be read: {error.strerror}") from error
    capsule = read_capsule(content)
    if arguments.key is not None and capsule.key != check_key(arguments.key):
        raise BadInput(
            f"the capsule was signed with the key {capsule.key or 'of no site'}; expected "
            f"{arguments.key}",
            code="wrong-site-key",
        )
    found = recompute_capsule(capsule, report_progress)
    lines = [
        f"run {found.run_id}: {'agrees' if found.agrees else 'DIFFERS'}, "
        f"largest relative difference by part (limit {found.tolerance:g}):",
        *(f"  {one.name:<24}{one.difference:.1e}" for one in found.compared),
        *(f"  {name} {was}, here {now}" for name, (was, now) in found.versions.items()),
        f"signed with the key {found.key}" if found.key else "not signed",
    ]
    print_result(lines, found, as_json=arguments.json)
    return 0 if found.agrees else 1
