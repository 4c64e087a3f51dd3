"""Who does not open the page is told by mail and web hook, once, of what concerns them."""

from __future__ import annotations

import json
import socketserver
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from shipped import Client, Server, invite, run_command, serving, set_password
from waiting import wait_until


class MailServer(socketserver.ThreadingTCPServer):
    """Accepts letters, and says which."""

    daemon_threads = True

    def __init__(self) -> None:
        self.letters: list[str] = []
        super().__init__(("127.0.0.1", 0), _MailConnection)


class _MailConnection(socketserver.StreamRequestHandler):
    server: MailServer  # pyrefly: ignore[bad-override-mutable-attribute]

    def handle(self) -> None:
        self.wfile.write(b"220 here\r\n")
        while line := self.rfile.readline().strip():
            word = line.split()[0].upper()
            self.wfile.write(b"354 go\r\n" if word == b"DATA" else b"250 ok\r\n")
            if word == b"DATA":
                lines: list[bytes] = []
                while (part := self.rfile.readline()) != b".\r\n":
                    lines.append(part)
                self.server.letters.append(b"".join(lines).decode())
                self.wfile.write(b"250 accepted\r\n")
            if word == b"QUIT":
                return


class Hook(ThreadingHTTPServer):
    """A web hook that responds with ``status``, and where it would send callers else."""

    daemon_threads = True

    def __init__(self) -> None:
        self.calls: list[tuple[str, dict[str, Any]]] = []
        self.status = 200
        super().__init__(("127.0.0.1", 0), _HookCall)

    @property
    def accepted(self) -> list[tuple[str, str]]:
        """Whom it was asked to tell what, where it did not refuse."""
        return [(body["person"], body["text"].splitlines()[-1]) for _, body in self.calls]


class _HookCall(BaseHTTPRequestHandler):
    server: Hook  # pyrefly: ignore[bad-override-mutable-attribute]

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["content-length"])))
        self.send_response(self.server.status)
        self.send_header("Location", f"http://127.0.0.1:{self.server.server_port}/elsewhere")
        self.end_headers()
        if self.server.status == 200:
            self.server.calls.append((self.path, body))

    def do_GET(self) -> None:
        self.server.calls.append((self.path, {"person": "a redirection", "text": "followed"}))
        self.send_response(200)
        self.end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing."""


@contextmanager
def listening() -> Iterator[tuple[MailServer, Hook]]:
    with ExitStack() as stack:
        servers = stack.enter_context(MailServer()), stack.enter_context(Hook())
        for server in servers:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            stack.callback(server.shutdown)
        yield servers


def write_file(folder: Path, mail: MailServer, hook: Hook) -> Path:
    file = folder / "notifications.toml"
    file.write_text(
        f"""
[mail]
server = "smtp://127.0.0.1:{mail.server_address[1]}"
from = "flexsid@example.org"
addresses = {{ Ben = "ben@example.org", Cid = "cid@example.org" }}
[hook]
url = "http://127.0.0.1:{hook.server_port}/secret-of-the-hook"
"""
    )
    return file


def propose(cid: Client) -> int:
    structure = cid.send(
        "post", "model-structures", {"aircraft_id": 1, "structure": {"modes": []}, "name": "SP"}
    )
    proposal = {
        "title": "short period",
        "structure": {"id": structure["id"], "version": 1},
        "reasoning": "no modes in the band",
        "run_ids": [1],
    }
    return cid.send("post", "decisions", proposal)["id"]


def read_health(client: Client) -> tuple[str, str]:
    parts = {part["name"]: part for part in client.get("health")["parts"]}
    part = parts.get("notifications", {"state": "none", "text": ""})
    return part["state"], part["text"]


def test_what_concerns_a_person_is_sent_once(flown_url: str, tmp_path: Path) -> None:
    roles = {"Ben": "reviewer", "Cid": "analyst", "Eve": "viewer"}
    codes = [invite(tmp_path, flown_url, name, (role, "all")) for name, role in roles.items()]
    with listening() as (mail, hook):
        file = write_file(tmp_path, mail, hook)
        variables = {"FLEXSID_MODE": "team", "FLEXSID_NOTIFICATIONS": str(file)}
        hook.status = 302
        with serving(tmp_path, flown_url, **variables) as server:
            for code in codes:
                set_password(server, code)
            decision = propose(server.log_in("Cid"))
            wait_until(lambda: mail.letters, "the mail to the reviewer")
            client = server.log_in("Eve")
            wait_until(lambda: read_health(client)[0] == "degraded", "the refusal by the hook")
            assert "by hook to Ben" in read_health(client)[1]
            assert hook.calls == [], "a redirection is not followed"
            hook.status = 200
        with serving(tmp_path, flown_url, **variables) as server:
            wait_until(lambda: hook.calls, "the repeated call of the hook")
            vote = {"revision": 1, "vote": "approve", "text": "agreed", "despite": "known"}
            server.log_in("Ben").send("post", f"decisions/{decision}/votes", vote)
            wait_until(lambda: len(hook.calls) == 2 and len(mail.letters) == 2, "the decision")
            client = server.log_in("Eve")
            wait_until(lambda: read_health(client)[0] == "ok", "the health of notifications")
            check_messages(server, mail, hook, decision)
            assert "secret-of-the-hook" not in server.log.read_text()


def check_messages(server: Server, mail: MailServer, hook: Hook, decision: int) -> None:
    (person, text), (author, decided) = hook.accepted
    assert (person, text) == ("Ben", "Cid: proposed")
    assert (author, decided.partition(": ")[0]) == ("Cid", "Ben")
    assert [path for path, _ in hook.calls] == ["/secret-of-the-hook"] * 2
    assert hook.calls[1][1]["url"] == f"{server.url}/decisions/{decision}"
    to_ben, to_cid = mail.letters
    assert "To: ben@example.org" in to_ben
    assert "Cid: proposed" in to_ben
    assert "To: cid@example.org" in to_cid
    assert "Ben: approve" in to_cid


@pytest.mark.parametrize(
    ("content", "named"),
    [
        ("", "needs tables"),
        ('[hook]\nurl = "http://10.0.0.1/secret"', "without https"),
        ('[hook]\nurl = "https://ann:secret@b.org"', "no address like https"),
        ('[mail]\nserver = "smtp://b"\nfrom = "a"\naddresses = {}', "no address like ann@"),
        ('[mail]\nserver = "smtp://b"\nfrom = "a@b.org"\nuser = "secret"', "user and password"),
    ],
)
def test_a_file_of_something_else_is_refused(tmp_path: Path, content: str, named: str) -> None:
    file, database = tmp_path / "notifications.toml", f"sqlite:///{tmp_path / 'new.db'}"
    file.write_text(content)
    variables = {"FLEXSID_MODE": "team", "FLEXSID_NOTIFICATIONS": str(file)}
    done = run_command(tmp_path, database, "serve", **variables)
    assert done.returncode != 0
    assert named in done.stderr
    assert "secret" not in done.stderr
    assert "Traceback" not in done.stderr
