"""What analysts wait beside clients that send slowly: ``python backend/benchmarks/connections.py``.

Beside 2,000 half-sent requests, 50 slow uploads and 1,000 event streams, all renewed when the
server closes them, reviewers vote and log in through the port of the started command. Prints one
JSON line; a refused vote or log-in, or one above its bar, fails the benchmark.

``--database URL`` is an empty database; by default a file.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import selectors
import socket
import statistics
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from pathlib import Path

for _folder in ("servers", "aircraft"):
    sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / _folder))

from rigid_record import simulate_doublet, write_record
from shipped import PASSWORD, Client, Server, ask_command, invite, serving_installed, set_password

HALF, UPLOADS, STREAMS = 2000, 50, 1000
VOTES, LOGINS = 300, 60
VOTE_S, LOGIN_S = 1.0, 2.0  # the bars: 99 % of votes, and every log-in
HEAD = "{} HTTP/1.1\r\nHost: localhost\r\nSec-Fetch-Site: same-origin\r\n"
BODY = HEAD + "Content-Type: application/json\r\nContent-Length: 1000\r\n\r\n{{"
HALVES = [
    *(
        BODY.format(f"{method} /api/v1{path}")
        for method, path in (
            ("POST", "/notes"),
            ("POST", "/session"),
            ("POST", "/decisions/1/votes"),
            ("PUT", "/aircraft/1"),
            ("DELETE", "/session"),
        )
    ),
    "GET /api/v1/runs HTTP/1.1\r\nHost: loc",
]


class Crowd:
    """Connections that are renewed when the server closes them; those of uploads send on.

    They are those of a process, so that what is measured does not wait for its interpreter.
    """

    def __init__(self, port: int, cookie: str) -> None:
        self._port = port
        file = '--b\r\nContent-Disposition: form-data; name="files"; filename="a.csv"\r\n\r\n'
        form = f"Cookie: {cookie}\r\nContent-Type: multipart/form-data; boundary=b\r\n"
        upload = f"{HEAD.format('POST /api/v1/uploads')}{form}Content-Length: 1000000\r\n\r\n{file}"
        events = f"{HEAD.format('GET /api/v1/events')}Cookie: {cookie}\r\n\r\n"
        self._texts = [HALVES[k % len(HALVES)] for k in range(HALF)]
        self._texts += [upload] * UPLOADS + [events] * STREAMS
        self._selector = selectors.DefaultSelector()
        self.n_renewed = 0
        for text in self._texts:
            self._open(text)

    def _open(self, text: str) -> None:
        connection = socket.create_connection(("127.0.0.1", self._port), 60.0)
        connection.sendall(text.encode())
        connection.setblocking(False)
        self._selector.register(connection, selectors.EVENT_READ, text)

    def run(self, pipe: Connection) -> None:
        """Read what arrives, and send a little of each upload every second, until stopped."""
        pipe.send(0)
        at = time.monotonic()
        while not pipe.poll():
            for key, _ in self._selector.select(0.1):
                assert isinstance(key.fileobj, socket.socket)
                with suppress(OSError):
                    if key.fileobj.recv(65536):
                        continue
                self._selector.unregister(key.fileobj)
                key.fileobj.close()
                self._open(key.data)
                self.n_renewed += 1
            if time.monotonic() > at:
                at += 1.0
                for key in list(self._selector.get_map().values()):
                    if "/uploads" in key.data and isinstance(key.fileobj, socket.socket):
                        with suppress(OSError):
                            key.fileobj.send(b"1,2,3\n" * 200)


def _crowd(port: int, cookie: str, pipe: Connection) -> None:
    crowd = Crowd(port, cookie)
    crowd.run(pipe)
    pipe.send(crowd.n_renewed)


@contextmanager
def hold_connections(server: Server, client: Client) -> Iterator[list[int]]:
    """Hold the connections open during the body; yield where their number of renewals will be."""
    cookie = "; ".join(f"{name}={value}" for name, value in client.http.cookies.items())
    pipe, other = multiprocessing.Pipe()
    process = multiprocessing.Process(target=_crowd, args=(server.port, cookie, other))
    process.start()
    renewed = [pipe.recv()]
    try:
        yield renewed
    finally:
        pipe.send(None)
        renewed[0] = pipe.recv()
        process.join()


def propose(cid: Client) -> int:
    """Propose a model structure; return the decision."""
    run = cid.send("post", "runs", {"maneuver_id": 1, "method": "EE"})["id"]
    assert cid.wait_for_end(f"runs/{run}")["state"] == "succeeded"
    body = {"aircraft_id": 1, "structure": {"modes": []}, "name": "SP"}
    structure = cid.send("post", "model-structures", body)
    proposal = {
        "title": "short period",
        "structure": {"id": structure["id"], "version": 1},
        "reasoning": "no modes in the band",
        "run_ids": [run],
    }
    return cid.send("post", "decisions", proposal)["id"]


def measure(
    server: Server, ben: Client, decision: int, votes: int, logins: int
) -> dict[str, list[float]]:
    """Time votes and, between them, log-ins. [s]"""
    vote = {"revision": 1, "vote": "approve", "text": "agreed", "despite": "known"}
    times: dict[str, list[float]] = {"vote": [], "login": []}
    for k in range(votes):
        since = time.monotonic()
        ben.send("post", f"decisions/{decision}/votes", vote)
        times["vote"].append(time.monotonic() - since)
        if k % (votes // logins) == 0:
            browser = server.connect(headers={"Sec-Fetch-Site": "same-origin"})
            since = time.monotonic()
            browser.send("post", "session", {"name": "Ben", "password": PASSWORD})
            times["login"].append(time.monotonic() - since)
            browser.http.close()
    return times


def find_percentile(times: list[float], fraction: float) -> float:
    """Return the time within which a fraction of the responses came."""
    return sorted(times)[min(len(times) - 1, int(fraction * len(times)))]


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--database", help="an empty database; by default a file")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        database = arguments.database or f"sqlite:///{folder / 'team.db'}"
        ask_command(folder, database, "migrate")
        record, mapping = write_record(folder, simulate_doublet())
        ask_command(folder, database, "import", str(record), "--mapping", str(mapping))
        roles = {"Ann": "admin", "Ben": "reviewer", "Cid": "analyst"}
        codes = [invite(folder, database, name, (role, "all")) for name, role in roles.items()]
        with serving_installed(folder, database, FLEXSID_MODE="team") as server:
            for code in codes:
                set_password(server, code)
            rules = {"quorum": 9, "own_allowed": False, "reason": "many", "version": 0}
            server.log_in("Ann").send("put", "review-rules/1", rules)
            cid, ben = server.log_in("Cid"), server.log_in("Ben")
            decision = propose(cid)
            idle = measure(server, ben, decision, VOTES // 5, LOGINS // 5)
            with hold_connections(server, cid) as renewed:
                found = measure(server, ben, decision, VOTES, LOGINS)
                ready = ben.request("get", "health/ready").status_code
    result = {
        "name": "votes_and_log_ins_beside_half_sent_requests",
        "vote_p99_s": find_percentile(found["vote"], 0.99),
        "vote_median_s": statistics.median(found["vote"]),
        "login_max_s": max(found["login"]),
        "idle_vote_p99_s": find_percentile(idle["vote"], 0.99),
        "idle_login_max_s": max(idle["login"]),
        "connections": HALF + UPLOADS + STREAMS,
        "renewed": renewed[0],
        "ready": ready,
    }
    print(json.dumps({k: round(v, 3) if isinstance(v, float) else v for k, v in result.items()}))
    sys.exit(result["vote_p99_s"] > VOTE_S or result["login_max_s"] > LOGIN_S)


if __name__ == "__main__":
    main()
