"""Commands ``flexsid verify``, ``capsule`` and ``recompute``: checks of results elsewhere."""

from __future__ import annotations

import argparse
import sys
from datetime import UTC, datetime
from pathlib import Path

from flexsid import reports
from flexsid.cli.administration import open_store
from flexsid.cli.output import print_result, write_file
from flexsid.cli.runs import report_progress
from flexsid.errors import BadInput
from flexsid.settings import Settings
from flexsid.storage.database import Database
from flexsid.storage.signatures import SignaturePlace, check_key, read_public_key, sign_content
from flexsid.verification.recomputation import recompute_capsule
from flexsid.verification.requirements import measure_requirements, report_verification
from flexsid.workflow.maintenance.printed_reports import check_signed_file
from flexsid.workflow.runs.capsule import read_capsule, write_capsule

# --- Command ``flexsid verify``: check of a received file, or of the installation -----------------


def verify(settings: Settings, arguments: argparse.Namespace) -> int:
    """Check a file, or the installation, or print the public key; return 1 for a failure."""
    if arguments.site_key:
        return _print_key(settings, as_json=arguments.json)
    if arguments.file is None:
        return _verify_installation(settings, Path(arguments.output), as_json=arguments.json)
    return _verify_file(Path(arguments.file), arguments.key, as_json=arguments.json)


def _verify_file(file: Path, key: str | None, *, as_json: bool) -> int:
    try:
        content = file.read_bytes()
    except OSError as error:
        raise BadInput(f"{file} cannot be read: {error.strerror}") from error
    found = check_signed_file(content, None if key is None else check_key(key))
    lines = [f"{file} is as it was signed, {found.n_bytes} bytes, with the key {found.key}"]
    if found.n_events:
        lines.append(f"{found.n_events} events of decisions are complete and unchanged")
    if key is None:
        lines.append("compare the key with that of the site (there: flexsid verify --site-key)")
    print_result(lines, found, as_json=as_json)
    return 0


def _verify_installation(settings: Settings, output: Path, *, as_json: bool) -> int:
    found = measure_requirements(lambda text: print(text, file=sys.stderr))
    html = reports.to_html(report_verification(found), datetime.now(UTC))
    content = sign_content(
        Database(settings.database, site_key=settings.site_key),
        html.encode(),
        SignaturePlace.COMMENT,
    )
    write_file(output, content)
    lines = [
        f"{one.requirement.id} {'fulfilled' if one.is_fulfilled else 'NOT FULFILLED'}: "
        f"{one.requirement.statement}: "
        f"{one.failure if one.value is None else f'{one.value:.3g}'}, "
        f"limit {one.requirement.limit:.3g}"
        for one in found
    ]
    result = {
        "file": str(output),
        "requirements": [
            {
                "id": one.requirement.id,
                "requirement": one.requirement.statement,
                "reference": one.requirement.reference,
                "limit": one.requirement.limit,
                "measured": one.value,
                "is_fulfilled": one.is_fulfilled,
            }
            for one in found
        ],
    }
    print_result([*lines, f"wrote {output}"], result, as_json=as_json)
    return 0 if all(one.is_fulfilled for one in found) else 1


def _print_key(settings: Settings, *, as_json: bool) -> int:
    key = read_public_key(Database(settings.database, site_key=settings.site_key))
    if key is None:
        raise BadInput("a database server has no key of the site: its files are not signed")
    print_result([key], {"key": key}, as_json=as_json)
    return 0


# --- Commands ``flexsid capsule`` and ``flexsid recompute``: a run to be computed elsewhere -------


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
