"""Uploads fill no disk: their content is limited by their size, by account, and in all."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
from rigid_record import simulate_doublet, write_record
from scipy.io import savemat
from shipped import Client, serving


def write_unallocated(path: Path) -> Path:
    """A file of 7 kB that states 1.9 GB of zeros."""
    with h5py.File(path, "w") as file:
        for number in range(19):
            file.create_dataset(f"d{number}", (12_500_000,), "f8", chunks=(1_000_000,))
    assert path.stat().st_size < 10_000
    return path


def write_zeros(folder: Path, n_samples: int) -> list[Path]:
    """The same zeros in files of a few kilobytes, each in another form."""
    zeros = np.zeros(n_samples)
    chunks, deflated, archive, matlab = (
        folder / name for name in ("chunks.h5", "deflated.h5", "archive.npz", "matlab.mat")
    )
    with h5py.File(chunks, "w") as file:
        file.create_dataset("q", (n_samples,), "f8", chunks=(n_samples,))
    with h5py.File(deflated, "w") as file:
        file.create_dataset("q", data=zeros, chunks=(n_samples,), compression="gzip")
    np.savez_compressed(archive, q=zeros)
    savemat(matlab, {"q": zeros}, do_compression=True)
    assert all(path.stat().st_size < 10_000 for path in (chunks, deflated, archive, matlab))
    return [chunks, deflated, archive, matlab]


def write_samples(path: Path, n_bytes: int) -> Path:
    np.savez(path, q=np.random.default_rng(1).standard_normal(n_bytes // 8))
    return path


def measure(folder: Path) -> int:
    """Return the size of what the server stores beside its database."""
    return sum(one.stat().st_size for one in folder.glob("flexsid.db-uploads/**/*"))


def send(client: Client, path: Path) -> tuple[int, str, str]:
    """Upload a file; return status, code, and id or detail."""
    response = client.request("post", "uploads", files=[("files", (path.name, path.read_bytes()))])
    body = response.json()
    text = body["upload"]["id"] if response.is_success else body["detail"]
    return response.status_code, body.get("code", ""), text


def test_a_small_file_with_much_content_is_refused(tmp_path: Path) -> None:
    path = write_unallocated(tmp_path / "flight.h5")
    with serving(tmp_path, f"sqlite:///{tmp_path / 'flexsid.db'}") as server:
        client = server.connect()
        status, code, detail = send(client, path)
        files = [("files", (path.name, path.read_bytes()))]
        form = {"name": "flown", "rate_hz": "50"}
        design = client.request("post", "designs/import", files=files, data=form)
    assert (status, code) == (413, "content-too-large")
    assert "more than 1 MB; store it without compression" in detail
    assert (design.status_code, design.json()["code"]) == (413, "content-too-large")
    assert measure(tmp_path) < 10_000


@pytest.mark.parametrize(
    ("variable", "status", "code"),
    [
        ("FLEXSID_ACCOUNT_UPLOAD_GIGABYTES", 413, "uploads-full"),
        pytest.param("FLEXSID_UPLOAD_GIGABYTES", 507, "storage-full", marks=pytest.mark.long),
    ],
)
def test_uploads_beyond_a_quota_are_refused_until_some_are_imported_or_deleted(
    tmp_path: Path, variable: str, status: int, code: str
) -> None:
    record, mapping = write_record(tmp_path, simulate_doublet())
    large = write_samples(tmp_path / "large.npz", 900_000)
    database = f"sqlite:///{tmp_path / 'flexsid.db'}"
    with serving(tmp_path, database, **{variable: "0.001"}) as server:
        client = server.connect()
        first = send(client, large)
        second = send(client, large)
        assert (first[0], second[:2]) == (201, (status, code))
        assert "import or delete some of them" in second[2]
        assert measure(tmp_path) < 1_000_000
        assert [one["id"] for one in client.get("uploads")["items"]] == [first[2]]
        client.send("delete", f"uploads/{first[2]}")

        imported = client.upload(record)["upload"]["id"]
        body = {"mapping": mapping.read_text(), "confirmed": True}
        job = client.send("post", f"uploads/{imported}/import", body)
        assert client.wait_for_end(f"jobs/{job['id']}")["state"] == "succeeded"
        filling = write_samples(tmp_path / "filling.npz", 999_000 - measure(tmp_path) // 2)
        assert send(client, filling)[0] == 201, "what is imported gives way"
        assert client.request("get", f"uploads/{imported}").status_code == 404
        assert client.get("maneuvers")["items"]


@pytest.mark.long
def test_a_thousand_small_files_leave_most_of_the_disk(tmp_path: Path) -> None:
    served = tmp_path / "served"
    served.mkdir()
    paths = [write_unallocated(tmp_path / "flight.h5"), *write_zeros(tmp_path, 120_000)]
    with serving(served, f"sqlite:///{served / 'flexsid.db'}") as server:
        client = server.connect()
        answers = [send(client, paths[k % len(paths)]) for k in range(1_000)]
        size = sum(one.stat().st_size for one in served.rglob("*") if one.is_file())
        assert client.get("maneuvers")["items"] == []
    assert size < 2e9
    assert {one[:2] for one in answers} == {(201, ""), (413, "content-too-large")}
