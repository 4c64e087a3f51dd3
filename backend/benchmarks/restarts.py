"""What restarts cost: ``python backend/benchmarks/restarts.py [--restarts 50] [--kill]``.

The started command is stopped as a service manager does (or killed) while it computes and
acknowledges notes, again and again. Prints one JSON line: jobs that failed, notes that were lost or
stored twice, and ids that were given twice; any of these fails the benchmark.

``--database URL`` is an empty database; by default a file.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from pathlib import Path

for _folder in ("servers", "aircraft"):
    sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / _folder))

from rigid_record import simulate_doublet, write_record
from shipped import Client, ask_command, serving_installed
from waiting import wait_until

NOTES = 4  # of each start
LONG = {
    "duration_s": 20.0,
    "rate_hz": 100.0,
    "peaks": [0.01, 0.02, 0.04],
    "inputs": [
        {"name": name, "harmonics": list(range(4 + k, 400, 4))}
        for k, name in enumerate(("bfs", "wf1s", "wf2s", "wf3s"))
    ],
    "effort": "patient",
}


def request_jobs(client: Client, number: int) -> None:
    """Request a long design, and a run."""
    client.send("post", "designs/searches", {**LONG, "name": f"design {number}", "seed": number})
    client.send("post", "runs", {"maneuver_id": 1, "method": "EE", "settings": {}})


def write_notes(client: Client, number: int, acknowledged: list[tuple[int, str]]) -> None:
    """Write notes, and record those that were acknowledged."""
    for k in range(NOTES):
        note = {"subject": "maneuver", "key": "1", "text": f"note {k} of start {number}"}
        acknowledged.append((client.send("post", "notes", note)["id"], note["text"]))


def is_computing(client: Client) -> bool:
    """Return whether a job is running."""
    return bool(client.get("jobs?state=running")["items"])


def has_ended(client: Client) -> bool:
    """Return whether no job is left."""
    return not any(client.get(f"jobs?state={one}")["items"] for one in ("running", "queued"))


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--database", help="an empty database; by default a file")
    parser.add_argument("--restarts", type=int, default=50)
    parser.add_argument("--kill", action="store_true", help="kill the server in place of a stop")
    arguments = parser.parse_args()
    acknowledged: list[tuple[int, str]] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        database = arguments.database or f"sqlite:///{folder / 'flexsid.db'}"
        ask_command(folder, database, "migrate")
        record, mapping = write_record(folder, simulate_doublet())
        ask_command(folder, database, "import", str(record), "--mapping", str(mapping))
        named = {"headers": {"X-Flexsid-Analyst": "Ann"}}
        for number in range(arguments.restarts):
            with serving_installed(folder, database, FLEXSID_WORKERS="1") as server:
                client = server.connect(**named)
                if number % 10 == 0:
                    request_jobs(client, number)
                wait_until(lambda client=client: is_computing(client) or has_ended(client))
                write_notes(client, number, acknowledged)
                if arguments.kill:
                    server.process.kill()
        with serving_installed(folder, database) as server:
            client = server.connect(**named)
            wait_until(lambda: has_ended(client), "the end of all jobs")
            states = Counter(one["state"] for one in client.get("jobs?limit=200")["items"])
            notes = client.get("notes?maneuver_id=1")["items"]
        checked = ask_command(folder, database, "check")
    stored = Counter((one["id"], one["text"]) for one in notes)
    texts = Counter(one["text"] for one in notes)
    result = {
        "name": "kills" if arguments.kill else "planned_restarts",
        "restarts": arguments.restarts,
        "jobs": states,
        "acknowledged": len(acknowledged),
        "lost": sum(one not in stored for one in acknowledged),
        "doubled": sum(count > 1 for count in texts.values()),
        "ids_given_twice": len(acknowledged) - len({number for number, _ in acknowledged}),
        "sound": checked["sound"],
    }
    print(json.dumps(result))
    is_good = checked["sound"] and set(states) == {"succeeded"}
    sys.exit(not is_good or any(result[key] for key in ("lost", "doubled", "ids_given_twice")))


if __name__ == "__main__":
    main()
