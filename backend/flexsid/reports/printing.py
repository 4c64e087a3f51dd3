"""PDF export of a report with a local Chromium."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock

from flexsid.errors import Conflict, FlexsidError

_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_TIMEOUT_S = 120
_one_at_a_time = Lock()  # a browser needs some hundred MB


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
    with TemporaryDirectory(prefix="flexsid-report-") as name, _one_at_a_time:
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
            subprocess.run(command, capture_output=True, timeout=_TIMEOUT_S, check=False)
        except subprocess.TimeoutExpired as error:
            raise FlexsidError(
                f"{browser} did not print in {_TIMEOUT_S} s; print the HTML report by hand"
            ) from error
        if not out.is_file():
            raise FlexsidError(f"{browser} did not print; print the HTML report by hand")
        return out.read_bytes()
