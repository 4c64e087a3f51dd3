"""Empty environments in which a release is installed, and what a user would run there."""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from artifacts import ROOT, UV

_TOOLS = ("mypy", "openapi-python-client")
_OF_GENERATED_CLIENT = ("attrs", "httpx", "python-dateutil")
_PAGES = ("README.md", "docs/how-to/library.md", "docs/how-to/notebook.md")
_SCRIPTS = Path(__file__).parent / "scripts"
_PATIENCE_S = 300.0


class CheckFailed(Exception):
    """A step of the check failed; the log has its output."""


@dataclass(frozen=True, slots=True)
class Log:
    """What is printed and stored of the steps."""

    file: IO[str]

    def write(self, line: str) -> None:
        """Write one line."""
        for file in (None, self.file):
            print(line, file=file, flush=True)

    def step(self, name: str, action: Callable[[], object]) -> None:
        """Carry out a step, and write how long it took.

        Raises
        ------
        CheckFailed
            If a program of the step failed.
        """
        begin = time.monotonic()
        try:
            action()
        except subprocess.CalledProcessError as error:
            self.write(str(error.stdout or "") + str(error.stderr or ""))
            raise CheckFailed(f"{name}: {error}") from error
        except OSError as error:
            raise CheckFailed(f"{name}: {error}") from error
        self.write(f"{time.monotonic() - begin:7.1f} s  {name}")


def find_python(number: str) -> Path | None:
    """Return a Python of this version, fetched if there is none; None if it cannot be fetched."""
    find = (UV, "python", "find", "--no-project", "--no-python-downloads", number)
    found = _ask_uv(*find) or _find_in_pyenv(number)
    if not found:
        _ask_uv(UV, "python", "install", number)
        found = _ask_uv(*find)
    return Path(found) if found else None


def _find_in_pyenv(number: str) -> str:
    # uv sees only the version that pyenv has selected.
    root = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    found = sorted(root.glob(f"versions/{number}.*/bin/python"))
    return str(found[-1]) if found else ""


def _ask_uv(*arguments: str | Path) -> str:
    # Elsewhere than in the project, whose own environment would be found.
    environment = {k: v for k, v in os.environ.items() if k != "VIRTUAL_ENV"}
    done = subprocess.run(
        arguments, capture_output=True, text=True, check=False, cwd="/", env=environment
    )
    return done.stdout.strip() if done.returncode == 0 else ""


def install_tools(folder: Path) -> None:
    """Install the programs that check and generate, apart from what they check."""
    _run(UV, "venv", "--quiet", folder)
    _install(folder, *_TOOLS)


def check(
    log: Log, python: Path, package: Path, folder: Path, tools: Path, *, lowest: bool = False
) -> None:
    """Install a package in an empty environment, and run there what users run.

    Parameters
    ----------
    log
        Receives the steps.
    python
        Interpreter of the environment.
    package
        Wheel or sdist.
    folder
        New folder of environment and working files.
    tools
        Environment of the checking programs.
    lowest
        Whether the lowest versions of the requirements are installed.
    """
    environment, work = folder / "environment", folder / "work"
    work.mkdir(parents=True)
    program = environment / "bin" / "flexsid"
    database = ("--database", f"sqlite:///{work / 'demo.db'}")

    def run_program(*arguments: str) -> None:
        _run(program, *arguments, *database, cwd=work)

    def run_python(*arguments: str | Path, url: str = "") -> None:
        _run(environment / "bin" / "python", *arguments, cwd=work, FLEXSID_URL=url)

    def step(name: str, action: Callable[[], object]) -> None:
        log.step(f"{folder.name}: {name}", action)

    def install() -> None:
        _run(UV, "venv", "--quiet", "--python", python, environment)
        if lowest:
            resolution = ("--resolution", "lowest-direct", "--extra", "client")
            _install(environment, *resolution, "--requirements", ROOT / "pyproject.toml")
            _install(environment, "--no-deps", package)
        else:
            _install(environment, f"{package}[client]")

    def install_extension() -> None:
        shutil.copytree(ROOT / "examples" / "extension", work / "extension")
        _install(environment, work / "extension")

    def generate_client(url: str) -> None:
        description = work / "openapi.json"
        with urllib.request.urlopen(f"{url}/api/v1/openapi.json") as response:
            description.write_bytes(response.read())
        generator = tools / "bin" / "openapi-python-client"
        options = ("--meta", "none", "--output-path", work / "generated_client")
        _run(generator, "generate", "--path", description, *options, cwd=work)
        _install(environment, *_OF_GENERATED_CLIENT)
        run_python(_copy(_SCRIPTS / "generated.py", work), url=url)

    def check_types() -> None:
        script = _copy(_SCRIPTS / "stranger.py", work)
        options = ("--strict", "--python-executable", environment / "bin" / "python")
        _run(tools / "bin" / "mypy", *options, script, cwd=work)
        run_python(script)

    def run_pages(url: str) -> None:
        for page in _PAGES:
            script = work / f"{Path(page).stem}.py"
            script.write_text(read_program(ROOT / page).replace("http://127.0.0.1:8000", url))
            run_python(script)

    step(f"install {package.name}", install)
    step("import the library", lambda: run_python(_SCRIPTS / "library.py"))
    step("mypy --strict and run a script", check_types)
    step("flexsid verify", lambda: run_program("verify"))
    step("flexsid demo --no-serve", lambda: run_program("demo", "--no-serve"))
    step("install the extension template", install_extension)
    with serve(program, database, work) as url:
        step("use the extensions", lambda: run_python(_SCRIPTS / "extensions.py", url=url))
        step("generate and use a client", lambda: generate_client(url))
        step("run the notebooks", lambda: run_pages(url))
    shutil.rmtree(environment)  # half a gigabyte; that of a failed check stays


def read_program(page: Path) -> str:
    """Return the program of a page: all its blocks of Python."""
    text = page.read_text(encoding="utf-8")
    return "\n".join(re.findall(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE))


@contextmanager
def serve(program: Path, database: tuple[str, ...], work: Path) -> Iterator[str]:
    """Serve a database on a free port of this computer."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    url = f"http://127.0.0.1:{port}"
    output = (work / "server.log").open("w", encoding="utf-8")
    with (
        output,
        subprocess.Popen(
            [program, "serve", *database],
            cwd=work,
            env=_make_environment(FLEXSID_PORT=str(port)),
            stdout=output,
            stderr=subprocess.STDOUT,
        ) as server,
    ):
        try:
            _wait_until_ready(url, server)
            yield url
        finally:
            server.terminate()


def _wait_until_ready(url: str, server: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + _PATIENCE_S
    while server.poll() is None and time.monotonic() < end:
        try:
            with urllib.request.urlopen(f"{url}/api/v1/health/ready"):
                return
        except (urllib.error.URLError, ConnectionError):
            time.sleep(0.2)
    raise CheckFailed(f"flexsid serve was not ready: see {server.args!r}")


def _copy(script: Path, folder: Path) -> Path:
    return Path(shutil.copy(script, folder))


def _install(environment: Path, *arguments: str | Path) -> None:
    _run(UV, "pip", "install", "--quiet", "--python", environment / "bin" / "python", *arguments)


def _run(*command: str | Path, cwd: Path | None = None, **variables: str) -> None:
    environment = _make_environment(**variables)
    subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, check=True, timeout=1800
    )


def _make_environment(**variables: str) -> dict[str, str]:
    """Return the environment of this process without settings of flexsid and Python."""
    own = {k: v for k, v in os.environ.items() if not k.startswith(("FLEXSID_", "PYTHON"))}
    return {**own, "PYTHONWARNINGS": "default", **variables}
