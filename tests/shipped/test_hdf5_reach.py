"""Whoever uploads an HDF5 or MATLAB 7.3 file reads nothing but that file."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest
from shipped import Client, serving

SECRET = "top-secret-0123456789"
MAPPING = """
flight = { number = 1 }
time = { rate = { value = 50, unit = "Hz" } }
[maneuver]
label = "reach"
axis = "longitudinal"
condition.airspeed = { value = 27, unit = "m/s" }
condition.density = { value = 1.2, unit = "kg/m3" }
condition.fuel_fraction = { value = 0, unit = "%" }
[aircraft]
name = "Reach"
surfaces = [{ name = "elevator" }]
sensors = [{ name = "q", kind = "gyro" }]
geometry.area = { value = 0.8, unit = "m2" }
geometry.chord = { value = 0.3, unit = "m" }
geometry.span = { value = 2.6, unit = "m" }
mass.fuel = [0]
mass.mass = { values = [10], unit = "kg" }
mass.pitch_inertia = { values = [1.2], unit = "kg*m2" }
mass.x_cg = { values = [0], unit = "m" }
[[channels]]
column = "q"
name = "q"
unit = "deg/s"
role = "output"
"""
TABLE = MAPPING.replace('column = "q"\nname = "q"', 'array = "X"\nlabels = "names"')


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("server")
    with serving(folder, f"sqlite:///{folder / 'flexsid.db'}") as server:
        yield server.connect()


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """A file of the server that no upload may show: a text, and a data set."""
    file = tmp_path / "secret.h5"
    with h5py.File(file, "w", userblock_size=512) as other:
        other["codes"] = np.frombuffer(SECRET.encode(), "u1").astype("u2")
        other["numbers"] = np.frombuffer(SECRET.encode(), "u1").astype(float)
    with file.open("r+b") as begin:
        begin.write(SECRET.encode())
    return file


def make_external(group: h5py.Group, name: str, secret: Path) -> h5py.Dataset:
    return group.create_dataset(name, (1, len(SECRET)), "u1", external=[(str(secret), 0, 64)])


def make_virtual(group: h5py.Group, name: str, secret: Path) -> h5py.Dataset:
    layout = h5py.VirtualLayout((1, len(SECRET)), "u2")
    layout[0] = h5py.VirtualSource(str(secret), "codes", (len(SECRET),))
    return group.create_virtual_dataset(name, layout)


Make = Callable[[h5py.Group, str, Path], h5py.Dataset]


def fill(file: h5py.File) -> None:
    rows = np.stack([np.arange(40.0), np.sin(np.arange(40.0))])
    for name, values in (("X", rows), ("q", rows[1:])):
        file[name] = values
        file[name].attrs["MATLAB_class"] = np.bytes_("double")


def store_as_cell(file: h5py.File, target: h5py.Dataset) -> None:
    target.attrs["MATLAB_class"] = np.bytes_("char")
    cells = file.create_dataset("names", (2, 1), h5py.ref_dtype)
    cells[:, 0] = [target.ref, target.ref]
    cells.attrs["MATLAB_class"] = np.bytes_("cell")


@pytest.mark.parametrize(
    ("suffix", "place"),
    [
        *(("h5", "variable"), ("h5", "group"), ("mat", "variable"), ("mat", "group")),
        *(("mat", "cell"), ("mat", "cell in #refs#")),
    ],
)
@pytest.mark.parametrize("make", [make_external, make_virtual])
def test_a_data_set_in_another_file_is_refused(
    client: Client, secret: Path, tmp_path: Path, suffix: str, place: str, make: Make
) -> None:
    path = tmp_path / f"flight.{suffix}"
    with h5py.File(path, "w", userblock_size=512 if suffix == "mat" else 0) as file:
        fill(file)
        if place == "variable":
            make(file, "names", secret).attrs["MATLAB_class"] = np.bytes_("char")
        elif place == "group":
            make(file.create_group("run"), "names", secret)
        else:
            group = file.create_group("#refs#") if "#refs#" in place else file
            store_as_cell(file, make(group, "a", secret))
    check_refused(client, path)


@pytest.mark.parametrize("suffix", ["h5", "mat"])
@pytest.mark.parametrize("kind", ["external", "soft"])
def test_a_link_is_refused(
    client: Client, secret: Path, tmp_path: Path, suffix: str, kind: str
) -> None:
    path = tmp_path / f"flight.{suffix}"
    with h5py.File(path, "w", userblock_size=512 if suffix == "mat" else 0) as file:
        fill(file)
        file["names"] = (
            h5py.ExternalLink(str(secret), "codes") if kind == "external" else h5py.SoftLink("/X")
        )
    check_refused(client, path)


def check_refused(client: Client, path: Path) -> None:
    """Whatever is asked about the file, it is refused, and the secret is in no response."""
    response = client.request("post", "uploads", files=[("files", (path.name, path.read_bytes()))])
    responses = [response]
    if response.is_success:
        upload = f"uploads/{response.json()['upload']['id']}"
        for mapping in (MAPPING, TABLE):
            body = {"mapping": mapping}
            preview = {**body, "channels": ["q"], "width_px": 400}
            responses += [
                client.request("post", f"{upload}/check", body),
                client.request("post", f"{upload}/preview", preview),
                client.request("post", f"{upload}/import", {**body, "confirmed": True}),
            ]
    for one in responses:
        assert SECRET not in one.text
    assert response.status_code == 422, response.text
    assert "only data in the file are read" in response.text or "is a link" in response.text


def test_names_of_channels_in_cells_of_the_file_are_read(client: Client, tmp_path: Path) -> None:
    path = tmp_path / "flight.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
        codes = np.array([[ord(one)] for one in "q_bias"], "u2")
        store_as_cell(file, file.create_dataset("a", data=codes))
    upload = client.upload(path)["upload"]["id"]
    refused = client.request("post", f"uploads/{upload}/check", {"mapping": TABLE})
    assert "q_bias" in refused.text
