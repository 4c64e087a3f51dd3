"""Capsule of a run: an RO-Crate with all that is needed to compute the run elsewhere.

Source: RO-Crate Metadata Specification 1.1.3, https://w3id.org/ro/crate/1.1.
"""

from __future__ import annotations

import hashlib
import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from typing import Any

import orjson

from flexsid.errors import BadInput, Conflict, FlexsidError
from flexsid.records.decision import HeldBy
from flexsid.records.run import EstimationRun
from flexsid.storage.content import find_changes
from flexsid.storage.copies.snapshot import take_snapshot
from flexsid.storage.signatures import SignaturePlace, read_signed, sign_content
from flexsid.storage.store import Store
from flexsid.workflow.model_structures.model_structures import describe_data_changes, get_result
from flexsid.workflow.runs.exports import export_run

CRATE, DATA, RUN, LOCK, MANIFEST = (
    "ro-crate-metadata.json",
    "data.sqlite",
    "run.json",
    "packages.txt",
    "manifest.json",
)
_FORMATS = {
    DATA: ("application/vnd.sqlite3", "Recordings, aircraft, modal tables, predictions and run"),
    RUN: ("application/json", "Settings, model structure, results and hashes of the run"),
    LOCK: ("text/plain", "Versions of the packages that were installed"),
}
_PROFILE = "https://w3id.org/ro/crate/1.1"
_EPOCH = (1980, 1, 1, 0, 0, 0)  # of all members: equal content is an equal file
_REGULAR_FILE = 0o100644 << 16
_OPTIONS = orjson.OPT_INDENT_2 | orjson.OPT_SORT_KEYS | orjson.OPT_NON_STR_KEYS | orjson.OPT_UTC_Z


@dataclass(frozen=True, slots=True)
class Capsule:
    """A capsule without damage.

    ``data`` is a snapshot of the database, ``key`` the public key of the site that signed the
    capsule; None if it is not signed.
    """

    run_id: int
    data: bytes
    versions: dict[str, str]
    key: str | None


def write_capsule(store: Store, run_id: int) -> bytes:
    """Write a run, its data, settings, software versions and results as an RO-Crate.

    Parameters
    ----------
    store
        Database.
    run_id
        A run that succeeded.

    Returns
    -------
    bytes
        ZIP archive without compression. Its manifest has the SHA-256 of every file, and the
        signature of the site.

    Raises
    ------
    UnknownRecord
        If there is no such run.
    Conflict
        If it has no result, it was altered, or its data were changed since.
    """
    run = store.runs.get(run_id)
    get_result(run)
    (changed,) = find_changes(store.database, [run.rests_on])
    if changed:
        raise Conflict(describe_data_changes(run_id, changed) or "", code="data-changed")
    versions = run.versions or {}
    files = {
        DATA: take_snapshot(store, run_ids=_list_runs(run)),
        RUN: orjson.dumps(export_run(store, run_id), option=_OPTIONS),
        LOCK: _list_packages().encode(),
    }
    files[CRATE] = orjson.dumps(_describe_crate(run, versions, files), option=_OPTIONS)
    manifest = {
        "run_id": run_id,
        "versions": versions,
        "sha256": {name: hashlib.sha256(files[name]).hexdigest() for name in sorted(files)},
    }
    listed = orjson.dumps(manifest, option=_OPTIONS).removesuffix(b"\n}")
    unsigned = listed + b",\n  " + SignaturePlace.INDENTED_JSON.value[2]
    files[MANIFEST] = sign_content(store.database, unsigned, SignaturePlace.INDENTED_JSON)
    return _pack(files)


def read_capsule(content: bytes) -> Capsule:
    """Check every byte of a capsule, and return its data.

    Raises
    ------
    BadInput
        If it is no capsule, or it was changed after it was written.
    """
    files = _unpack(content)
    manifest = files[MANIFEST]
    try:
        listed = orjson.loads(manifest)
        hashes, number, versions = listed["sha256"], listed["run_id"], listed["versions"]
        is_signed = listed["signature"] is not None
    except (ValueError, KeyError, TypeError) as error:
        raise _build_damage_error("its manifest is not readable") from error
    key = read_signed(manifest).key if is_signed else None
    for name in (CRATE, DATA, RUN, LOCK):
        if hashlib.sha256(files[name]).hexdigest() != hashes.get(name):
            raise _build_damage_error(f"{name} differs from its SHA-256 in the manifest")
    return Capsule(run_id=number, data=files[DATA], versions=versions, key=key)


def _list_runs(run: EstimationRun) -> tuple[int, ...]:
    """List a run and those that it reads values from."""
    held = (one.id for one in run.structure.fixed_to.values() if one.source is HeldBy.RUN)
    numbers = (run.id, run.settings.start_run_id, *held)
    return tuple(dict.fromkeys(number for number in numbers if number is not None))


@cache  # those that this process has begun with
def _list_packages() -> str:
    """List the installed packages with their versions, as pip freeze."""
    found = {(one.metadata["Name"] or "").lower(): one.version for one in metadata.distributions()}
    return "".join(f"{name}=={found[name]}\n" for name in sorted(found) if name)


def _describe_crate(
    run: EstimationRun, versions: Mapping[str, str], files: Mapping[str, bytes]
) -> dict[str, Any]:
    """Describe files, software and the computation of the run as JSON-LD."""
    software = {
        "@id": "#software",
        "@type": "SoftwareApplication",
        "name": "flexsid",
        "softwareVersion": versions.get("flexsid", "unknown"),
        "softwareRequirements": ", ".join(f"{k} {v}" for k, v in versions.items()),
    }
    author = {"@id": "#author", "@type": "Person", "name": run.author or "not recorded"}
    action = {
        "@id": "#run",
        "@type": "CreateAction",
        "name": f"{run.method.value} estimation, run {run.id}",
        "instrument": {"@id": "#software"},
        "agent": {"@id": "#author"},
        "object": [{"@id": DATA}],
        "result": [{"@id": RUN}],
        "startTime": run.started_at,
        "endTime": run.finished_at,
        "identifier": run.input_hash,
    }
    described = [
        {
            "@id": name,
            "@type": "File",
            "name": text,
            "encodingFormat": kind,
            "contentSize": str(len(files[name])),
            "sha256": hashlib.sha256(files[name]).hexdigest(),
        }
        for name, (kind, text) in _FORMATS.items()
    ]
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": f"Run {run.id} of flexsid",
        "description": "An estimation with its data, settings, software versions and results. "
        "flexsid recompute computes it again and compares the results.",
        "datePublished": run.finished_at or run.created_at,
        "license": "Not stated; terms of the recordings apply.",
        "hasPart": [{"@id": name} for name in _FORMATS],
        "mentions": [{"@id": "#run"}],
    }
    descriptor = {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": _PROFILE},
        "about": {"@id": "./"},
    }
    return {
        "@context": f"{_PROFILE}/context",
        "@graph": [descriptor, root, *described, action, software, author],
    }


def _pack(files: Mapping[str, bytes]) -> bytes:
    """Pack files in the order of their names; equal files are equal bytes."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(files):
            member = zipfile.ZipInfo(name, _EPOCH)
            member.create_system, member.external_attr = 3, _REGULAR_FILE
            archive.writestr(member, files[name])
    return packed.getvalue()


def _unpack(content: bytes) -> dict[str, bytes]:
    """Unpack a capsule; refused if any byte differs from what ``_pack`` writes."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            if sorted(archive.namelist()) != sorted((CRATE, DATA, RUN, LOCK, MANIFEST)):
                raise BadInput(
                    "the file is not a capsule of a run; export one with flexsid capsule",
                    code="not-a-capsule",
                )
            sizes = [member.file_size for member in archive.infolist()]
            if sum(sizes) > len(content):  # nothing is compressed
                raise _build_damage_error("its sizes are wrong")
            files = {name: archive.read(name) for name in archive.namelist()}
    except FlexsidError:
        raise
    except Exception as error:  # zipfile raises a dozen kinds for damaged archives
        raise _build_damage_error("it is no ZIP archive, or a damaged one") from error
    if _pack(files) != content:
        raise _build_damage_error("bytes of the archive outside its files differ")
    return files


def _build_damage_error(reason: str) -> BadInput:
    return BadInput(
        f"the capsule was changed after it was written: {reason}; ask for a new copy",
        code="damaged-capsule",
    )
