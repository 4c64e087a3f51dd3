"""Fixtures: a server with the demonstration campaign, and a browser."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest
from demonstration import campaign_file_with_runs
from playwright.sync_api import (
    Browser,
    ConsoleMessage,
    Error,
    Page,
    Response,
    expect,
    sync_playwright,
)
from ports import find_free_port
from preloaded import ForkedCommand
from waiting import PATIENCE_MS, PATIENCE_S, wait_until

ROOT = Path(__file__).parents[2]
# The first has no window, and takes a fifth less processor time for the same tests.
CHROMIUM = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
QUIET = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
]
FLEXSID = [
    sys.executable,
    "-c",
    "import sys; from flexsid.cli.main import main; sys.exit(main(sys.argv[1:]))",
]


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    program = next(filter(None, map(shutil.which, CHROMIUM)), None)
    if program is None:
        reason = "no Chromium on PATH; on Debian: apt-get install chromium"
        if os.environ.get("CI") == "true":
            pytest.fail(reason)
        pytest.skip(reason)
    expect.set_options(timeout=PATIENCE_MS)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=QUIET)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def server(
    request: pytest.FixtureRequest, campaign: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[str]:
    """Address of a server that runs on its own copy of the campaign.

    That of a module with ``HAS_RUNS = True`` has the runs ``RUN_IDS``.
    """
    folder = tmp_path_factory.mktemp("server")
    database = folder / "flexsid.db"
    has_runs = getattr(request.module, "HAS_RUNS", False)
    shutil.copy(campaign_file_with_runs() if has_runs else campaign, database)
    with _serving_preloaded(database, folder / "server.log") as url:
        yield url


@pytest.fixture
def own_server(campaign: Path, tmp_path: Path) -> Iterator[str]:
    """Address of a server of one test, for tests that change the data."""
    database = tmp_path / "own.db"
    shutil.copy(campaign, database)
    with _serving_preloaded(database, tmp_path / "own.log") as url:
        yield url


ServingOn = Callable[[Path, Path], AbstractContextManager[str]]


@pytest.fixture(scope="session")
def serving_on() -> ServingOn:
    """Context manager that serves a database, from its file and that of the log."""
    return _serving_preloaded


@contextmanager
def _serving_preloaded(database: Path, log: Path) -> Iterator[str]:
    """A server that is forked from loaded libraries; its address."""
    port = find_free_port()
    process = ForkedCommand(
        ["serve", "--database", f"sqlite:///{database}"],
        log.parent,
        {**os.environ, "FLEXSID_PORT": str(port)},
        log,
        log,
    )
    try:
        _wait_until_healthy(f"http://127.0.0.1:{port}", lambda: process.poll() is None, log)
        yield f"http://127.0.0.1:{port}"
        assert process.poll() is None, "the server ended by itself"
    finally:
        process.terminate()
        process.wait(PATIENCE_S)


@contextmanager
def serving(
    database: Path,
    port: int,
    log: Path,
    program: Sequence[str] = FLEXSID,
) -> Iterator[subprocess.Popen[bytes]]:
    """A server on this database and port, until it is killed or no longer needed."""
    with log.open("a") as output:
        process = subprocess.Popen(
            [*program, "serve", "--database", f"sqlite:///{database}"],
            cwd=ROOT / "backend",
            env={
                **os.environ,
                "FLEXSID_PORT": str(port),
                "OPENBLAS_NUM_THREADS": "1",
            },
            stdout=output,
            stderr=subprocess.STDOUT,
        )
        try:
            _wait_until_healthy(f"http://127.0.0.1:{port}", lambda: process.poll() is None, log)
            yield process
        finally:
            process.terminate()
            process.wait(timeout=PATIENCE_S)


@pytest.fixture
def page(browser: Browser, server: str) -> Iterator[Page]:
    """A page that fails the test on console errors or failed requests."""
    with watched_page(browser, server) as page:
        yield page


@pytest.fixture
def refused(browser: Browser, server: str) -> Iterator[Page]:
    """The same, where the server may refuse a request (422)."""
    with watched_page(browser, server, refused=422) as page:
        yield page


@pytest.fixture
def two_pages(browser: Browser, own_server: str) -> Iterator[tuple[Page, Page]]:
    """Pages of two independent browsers, where stale edits may be refused (409)."""
    with (
        watched_page(browser, own_server, refused=409) as one,
        watched_page(browser, own_server, refused=409) as other,
    ):
        yield one, other


@contextmanager
def watched_page(browser: Browser, server: str, refused: int | None = None) -> Iterator[Page]:
    """A page that fails its test on console errors or refused requests."""
    with opened_page(browser, server) as page, watched(page, refused):
        yield page


@contextmanager
def opened_page(browser: Browser, server: str) -> Iterator[Page]:
    """A page in a context of its own."""
    # Animations without a screen are drawn by the processor that computes.
    context = browser.new_context(
        viewport={"width": 1440, "height": 1000}, base_url=server, reduced_motion="reduce"
    )
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    yield page
    context.close()


@contextmanager
def watched(page: Page, refused: int | None = None) -> Iterator[None]:
    """Fail the test on console errors or refused requests of a page."""
    problems: list[str] = []

    def record_message(message: ConsoleMessage) -> None:
        if message.type in ("error", "warning") and not (
            refused is not None and str(refused) in message.text
        ):
            problems.append(message.text)

    def record_error(error: Error) -> None:
        problems.append(str(error))

    def record_response(response: Response) -> None:
        if response.status >= 400 and response.status != refused:
            problems.append(f"{response.status} {response.url}")

    page.on("console", record_message)
    page.on("pageerror", record_error)
    page.on("response", record_response)
    yield
    page.remove_listener("console", record_message)
    page.remove_listener("pageerror", record_error)
    page.remove_listener("response", record_response)
    assert not problems, "\n".join(problems)


def _wait_until_healthy(address: str, is_running: Callable[[], bool], log: Path) -> None:
    def is_healthy() -> bool:
        assert is_running(), f"the server ended:\n{log.read_text()}"
        try:
            with urllib.request.urlopen(f"{address}/api/v1/health", timeout=PATIENCE_S):
                return True
        except (urllib.error.URLError, ConnectionError, TimeoutError):
            return False

    wait_until(is_healthy, "a response of the server")
