"""Two servers on one database of PostgreSQL, each with a disk of its own, act as one."""

from __future__ import annotations

from pathlib import Path

from postgresql import Cluster
from rigid_record import simulate_doublet, write_record
from shipped import Client, ask_command, serving
from waiting import wait_until

NOWHERE = {"name": "nats", "options": {"server": "nats://127.0.0.1:9", "subject": "samples"}}


def test_a_server_completes_what_another_one_received(
    flown_url: str, postgresql: Cluster, tmp_path: Path
) -> None:
    database = postgresql.url(postgresql.copy("template1"))
    ask_command(tmp_path, database, "restore", flown_url.removeprefix("sqlite:///"))
    folders = tmp_path / "first", tmp_path / "second"
    for folder in folders:
        folder.mkdir()
    with serving(folders[1], database, TMPDIR=str(folders[1])) as second:
        other = second.connect()
        with serving(folders[0], database, TMPDIR=str(folders[0])) as first:
            client = first.connect()
            stop_on_the_other(client, other)
            record, mapping = write_record(tmp_path, simulate_doublet())
            upload = client.upload(record)["upload"]["id"]
            client.send("put", f"uploads/{upload}/draft", {"mapping": "# by the first"})
            first.process.kill()
            first.process.wait()
        assert not list(folders[1].glob(f"*/{upload}"))
        (listed,) = other.get("uploads")["items"]
        assert (listed["id"], listed["files"]) == (upload, ["record.csv"])
        assert other.get(f"uploads/{upload}")["draft"] == "# by the first"
        body = {"mapping": mapping.read_text(), "confirmed": True}
        job = other.send("post", f"uploads/{upload}/import", body)
        ended = other.wait_for_end(f"jobs/{job['id']}")
        assert ended["state"] == "succeeded", ended["error"]
        other.send("delete", f"uploads/{upload}")
        assert other.request("get", f"uploads/{upload}").status_code == 404


def stop_on_the_other(client: Client, other: Client) -> None:
    """Start a stream on a server, and stop it on another one."""
    body = {"run_id": 1, "title": "stream", "receiver": NOWHERE}
    stream = client.send("post", "live/streams", body)["id"]
    other.send("post", f"live/streams/{stream}/stop")

    def is_stopped() -> bool:
        return client.get(f"live/streams/{stream}")["stream"]["status"] == "stopped"

    wait_until(is_stopped, "the stop of the stream")
