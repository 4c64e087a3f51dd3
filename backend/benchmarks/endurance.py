"""Memory and descriptors of a server in long use: ``python backend/benchmarks/endurance.py``.

A day of a team in fast motion: 2,000 runs of equation error in batches, and 5,000 page loads (the
page and the requests that it makes) beside them. Resident memory and open files of the server and
its processes are read between batches. Prints a JSON line per tenth, and their growth from the
second tenth, when caches are full, to the last one; the bar is 5 %.

``--runs``, ``--loads`` and ``--database URL``, an empty database, change the defaults.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPConnection
from pathlib import Path

import jobs
import numpy as np

_ROUNDS = 10
_PAGES = (
    ("/campaign", "maneuvers?limit=50", "runs?limit=50", "health"),
    ("/maneuvers/{maneuver}", "maneuvers/{maneuver}", "runs?maneuver_id={maneuver}", "{history}"),
    ("/runs/{run}", "runs/{run}", "{fit}", "notes?run_id={run}"),
    ("/jobs", "jobs?limit=50", "batches?limit=20"),
    ("/review", "decisions", "aircraft"),
)
_FIGURES = {
    "{history}": "figures/time-history?maneuver_id={maneuver}",
    "{fit}": "figures/fit?run_id={run}",
}


def list_processes(root: int) -> Iterator[int]:
    """Yield a process and its descendants."""
    yield root
    for task in Path(f"/proc/{root}/task").iterdir():
        for child in (task / "children").read_text().split():
            yield from list_processes(int(child))


def is_server(process: int) -> bool:
    """Whether a process is ``flexsid serve``."""
    words = Path(f"/proc/{process}/cmdline").read_bytes().split(b"\0")
    return b"flexsid.cli.main" in words and b"serve" in words


def measure(root: int) -> tuple[float, int]:
    """Return resident memory without shared pages [MB], and the number of open files."""
    memory, files = 0.0, 0
    for process in list_processes(root):
        rollup = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
        memory += sum(int(line.split()[1]) for line in rollup if line.startswith("Pss:")) / 1024.0
        files += len(list(Path(f"/proc/{process}/fd").iterdir()))
    return memory, files


def load_page(port: int, page: tuple[str, ...], names: dict[str, int]) -> int:
    """Load a page and its data over one connection; return the number of errors."""
    connection, errors = HTTPConnection("127.0.0.1", port, timeout=60), 0
    for index, path in enumerate(page):
        address = _FIGURES.get(path, path).format(**names)
        header = {"Accept": "text/html"} if index == 0 else {}
        target = address if index == 0 else f"/api/v1/{address}"
        connection.request("GET", target, headers=header)
        response = connection.getresponse()
        response.read()
        errors += response.status >= 400
    connection.close()
    return errors


def main() -> None:
    """Compute and read, and print what grows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=2000)
    parser.add_argument("--loads", type=int, default=5000)
    parser.add_argument("--database", help="an empty database; by default a file")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        url = arguments.database or f"sqlite:///{folder}/flexsid.db"
        ids = jobs.fill(url, arguments.runs // _ROUNDS)
        with jobs.server(url, None, jobs.default_count()) as port:
            client = jobs.Client(port)
            (root,) = (own for own in list_processes(os.getpid()) if is_server(own))
            found = []
            for number in range(_ROUNDS):
                body = jobs.make_batch(ids, ["EE"])
                body["settings"] = {"max_iterations": 500 + number}  # else the same runs as before
                batch = client.post("/api/v1/batches", body)
                newest = client.get("/api/v1/runs?limit=1&state=succeeded")["items"][0]["id"]
                errors = 0
                with ThreadPoolExecutor(4) as pool:
                    asked = [
                        pool.submit(
                            load_page,
                            port,
                            _PAGES[k % len(_PAGES)],
                            {"maneuver": ids[k % len(ids)], "run": newest},
                        )
                        for k in range(arguments.loads // _ROUNDS)
                    ]
                    errors = sum(one.result() for one in asked)
                jobs.wait_for_batch(client, batch["id"])
                memory, files = measure(root)
                found.append((memory, files))
                line = {"name": "endurance", "tenth": number + 1, "memory_mb": round(memory, 1)}
                print(json.dumps(line | {"files": files, "errors": errors}), flush=True)
    growth = np.array(found[-1]) / np.array(found[1]) - 1.0
    names = ("endurance_memory_growth", "endurance_files_growth")
    for name, value in zip(names, growth.tolist(), strict=True):
        print(json.dumps({"name": name, "value": round(value, 4), "bar": 0.05}), flush=True)


if __name__ == "__main__":
    main()
