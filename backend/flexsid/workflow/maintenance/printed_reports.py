"""Printed reports by a local Chromium, and the check of a file that a site issued.

A document is a report whose scripts of the figures and time are marks, so that the documents of
equal reports are equal and small: their content names the request.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import signal
import subprocess
import sys
import time
import zlib
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from functools import lru_cache
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory, gettempdir
from typing import Any

import numpy as np
import orjson

from flexsid.errors import BadInput, Conflict, FlexsidError
from flexsid.records.job import Job
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.arrays import ArrayRow, describe_array
from flexsid.storage.audit_recording import hash_value
from flexsid.storage.signatures import read_signed
from flexsid.storage.store import Store

# --- Printed reports: PDF files of HTML documents by a local Chromium, as jobs --------------------

# Text of a report is escaped, and cannot contain a mark.
MADE_AT = "<!-- flexsid: time -->"
FIGURE_SCRIPT = "<!-- flexsid: figures -->"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_TIMEOUT_S = 120
_FOLDER = "flexsid-report-"
_PR_SET_PDEATHSIG = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportRequest:
    """A report to be printed: name of its file, and of the array with its document."""

    name: str
    document: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedReport:
    """A printed report: name of its file, and of the array with its content."""

    name: str
    content: str
    n_bytes: int


@dataclass(frozen=True, slots=True)
class PrintingTask:
    """A document, and the time that the report states."""

    document: str
    made_at: datetime


def describe_document(document: str) -> ArrayRow:
    """Return the row of the array that stores a document."""
    return describe_array(_to_array(zlib.compress(document.encode())), "html")


def prepare_printing(store: Store, job: Job, request: ReportRequest) -> PrintingTask:
    """Return the stored document of a job, which states the time of its request."""
    assert job.created_at is not None
    document = zlib.decompress(store.arrays.get(request.document).tobytes()).decode()
    return PrintingTask(document, job.created_at)


def print_report(task: PrintingTask, report: ReportProgress) -> bytes:
    """Print a document to PDF; raises as ``to_pdf``."""
    report(Progress(fraction=0.2, message="Printing with Chromium"))
    return to_pdf(complete_document(task.document, task.made_at))


def store_printed_report(
    store: Store, job: Job, request: ReportRequest, pdf: bytes
) -> PrintedReport:
    """Store the PDF of a report."""
    content = store.arrays.put(_to_array(pdf), "pdf")
    return PrintedReport(name=request.name, content=content, n_bytes=len(pdf))


def complete_document(document: str, made_at: datetime) -> str:
    """Return the self-contained HTML of a document."""
    return document.replace(FIGURE_SCRIPT, f"<script>{_plotly()}</script>").replace(
        MADE_AT, f"{made_at:%Y-%m-%d %H:%M} UTC"
    )


def to_pdf(html: str) -> bytes:
    """Print a page to PDF with its figures drawn.

    Raises
    ------
    Conflict
        If no Chromium is installed.
    FlexsidError
        If printing fails.
    """
    browser = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if browser is None:
        raise Conflict(
            "no Chromium is installed for PDF export; open the HTML report in a browser and"
            " print it, or install chromium",
            code="no-browser",
        )
    _delete_left_folders()
    with TemporaryDirectory(prefix=_FOLDER) as name:
        folder = Path(name)
        page, out = folder / "report.html", folder / "report.pdf"
        page.write_text(html, encoding="utf-8")
        command = [
            browser,
            "--headless",
            "--disable-gpu",
            "--no-first-run",
            "--disable-extensions",
            "--no-pdf-header-footer",
            f"--user-data-dir={folder / 'profile'}",
            # The figures are drawn before this much of the page's own time has passed.
            "--virtual-time-budget=20000",
            f"--print-to-pdf={out}",
            f"{page.as_uri()}#print",
        ]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            command.insert(1, "--no-sandbox")  # not available for root; the page is our own
        try:
            subprocess.run(
                command,
                capture_output=True,
                timeout=_TIMEOUT_S,
                check=False,
                preexec_fn=_make_signal_of_parent(),
            )
        except subprocess.TimeoutExpired as error:
            raise FlexsidError(
                f"{browser} did not print in {_TIMEOUT_S} s; print the HTML report by hand"
            ) from error
        if not out.is_file():
            raise FlexsidError(f"{browser} did not print; print the HTML report by hand")
        return out.read_bytes()


def _delete_left_folders() -> None:
    """Delete the folders of workers that were killed while they printed."""
    for folder in Path(gettempdir()).glob(f"{_FOLDER}*"):
        with suppress(FileNotFoundError):  # deleted by another worker
            if time.time() - folder.stat().st_mtime > 2 * _TIMEOUT_S:
                shutil.rmtree(folder, ignore_errors=True)


def _make_signal_of_parent() -> Callable[[], object] | None:
    """Return what ends the browser with this process: cancelling a job kills its worker."""
    if sys.platform != "linux":
        return None
    library = ctypes.CDLL(None)
    return lambda: library.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _to_array(content: bytes) -> np.ndarray:
    return np.frombuffer(content, np.uint8)


@lru_cache(maxsize=1)
def _plotly() -> str:
    """Read the plotly script of the Python package."""
    text = files("plotly").joinpath("package_data", "plotly.min.js").read_text(encoding="utf-8")
    # A tag that closes the script would end it early.
    return text.replace("</script", "<\\/script")


# --- Check of a file that a site issued: signature, decision chain, hashes of the data ------------


@dataclass(frozen=True, slots=True)
class CheckedFile:
    """A file that is as its site signed it; ``key`` is the public key in hexadecimal."""

    key: str
    n_bytes: int
    n_events: int


def check_signed_file(content: bytes, expected_key: str | None = None) -> CheckedFile:
    """Check signature and decision chain of a file.

    Parameters
    ----------
    content
        The file, as it was received.
    expected_key
        Public key of the site, as it was received by another way.

    Raises
    ------
    BadInput
        If the file has no signature, was changed, is of another site, or has a decision whose
        events are not the ones that were recorded.
    """
    signed = read_signed(content)
    if expected_key is not None and signed.key != expected_key:
        raise BadInput(
            f"the file was signed with the key {signed.key}; expected {expected_key}",
            code="wrong-site-key",
        )
    n_events = 0
    if signed.content.startswith(b"{"):
        for one in orjson.loads(signed.content).get("decisions", ()):
            n_events += len(one["events"])
            _check_chain(one["decision"]["id"], one["events"])
    return CheckedFile(signed.key, len(signed.content), n_events)


def _check_chain(decision_id: int, events: list[dict[str, Any]]) -> None:
    """Refuse events of a decision that were changed or removed before the file was signed."""
    links = [("", events[0]["previous_hash"])] if events else []
    links += [(before["hash"], after["previous_hash"]) for before, after in pairwise(events)]
    is_whole = all(before == after for before, after in links)
    for event in events:
        seal = hashlib.sha256(event["sealed"].encode()).hexdigest()
        is_whole &= seal == event["hash"] and hash_value(event["data"]) == event["data_hash"]
    if not is_whole:
        raise BadInput(
            f"the events of decision {decision_id} are not the ones that were recorded: one was "
            "changed or removed; ask the site to check its database (flexsid check)",
            code="broken-chain",
        )
