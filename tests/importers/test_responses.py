"""Frequency responses and time data of a ground vibration test in CSV, MATLAB and HDF5 files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy import io

from flexsid.errors import BadInput
from flexsid.importers.formats.readers import read_file
from flexsid.importers.modal_data import inspect_modal_data
from flexsid.importers.responses import (
    AveragingOptions,
    RawResponses,
    ResponseOptions,
    extract_responses,
)
from flexsid.importers.source import SourceFile, Sources
from flexsid.sysid.modes.measured_modes import compute_stabilisation, find_columns, identify_modes

HERTZ = np.arange(2.0, 12.0, 0.05)
OUTPUTS, REFERENCES = ("1+z", "2+z", "3+z", "4+x"), ("1+z", "3+z")
MODES_HZ, DAMPING = np.array([4.0, 6.5, 9.0]), np.array([0.012, 0.01, 0.02])
SHAPES = np.array([[1.0, 0.6, -0.8, 0.3], [1.0, -1.0, 0.5, -0.4], [0.5, 0.8, 1.0, 0.9]])
GIVEN = ResponseOptions(name="GVT", response_unit="m/s2", force_unit="N", length_unit="m")
NODES = "node,x [mm],y [mm],z [mm]\n" + "".join(f"{n},{100 * n},{200 * n},0\n" for n in range(1, 5))


def respond(hertz: np.ndarray) -> np.ndarray:
    """Accelerations per force (M, outputs, references) of three modes of unit mass."""
    s = 2j * np.pi * hertz[:, None]
    omega = 2.0 * np.pi * MODES_HZ
    gain = s**2 / (s**2 + 2.0 * DAMPING * omega * s + omega**2)
    return np.einsum("wm,mo,mr->wor", gain, SHAPES, SHAPES[:, [0, 2]])


VALUES = respond(HERTZ)


def read(folder: Path, **files: Any) -> Sources:
    """Write files by their suffix and read them."""
    found = []
    for name, content in files.items():
        path = folder / name.replace("_", ".")
        if path.suffix == ".mat":
            io.savemat(path, content)
        elif path.suffix == ".npz":
            np.savez(path, **content)
        elif path.suffix == ".h5":
            with h5py.File(path, "w") as file:
                for key, (values, unit) in content.items():
                    file[key] = values
                    if unit:
                        file[key].attrs["units"] = unit
        else:
            path.write_text(content)
        fields = list(read_file(path, path.name))
        found.append(
            SourceFile(
                name=path.name,
                sha256="",
                first_row=fields[0].first_row,
                arrays={field.path: field.samples for field in fields},
                units={field.path: field.unit for field in fields if field.unit},
            )
        )
    return Sources(tuple(found))


def write_columns(parts: dict[str, np.ndarray], head: str, values: np.ndarray = HERTZ) -> str:
    rows = np.column_stack([values, *parts.values()])
    lines = [",".join(repr(float(x)) for x in row) for row in rows]
    return "\n".join([",".join([head, *parts]), *lines]) + "\n"


def tabulate(polar: bool = False, unit: str = " [(m/s2)/N]", angle: str = " [deg]") -> str:
    parts = {}
    for o, output in enumerate(OUTPUTS):
        for r, reference in enumerate(REFERENCES):
            one, name = VALUES[:, o, r], f"{output}/{reference}"
            if polar:
                parts[f"{name} magnitude{unit}"] = np.abs(one)
                parts[f"{name} phase{angle}"] = np.degrees(np.angle(one))
            else:
                parts[f"{name} real{unit}"], parts[f"{name} imag{unit}"] = (
                    np.real(one),
                    np.imag(one),
                )
    return write_columns(parts, "frequency [Hz]")


DOFS = {"responses": np.array(OUTPUTS), "references": np.array(REFERENCES)}
UNITS = {"response_unit": "m/s2", "force_unit": "N", "frequency_unit": "Hz"}
MATLAB = {"f": HERTZ, "H": VALUES, **{k: v.astype(object) for k, v in DOFS.items()}, **UNITS}
PAIR = {"H_real": np.real(VALUES).transpose(1, 2, 0), "H_imag": np.imag(VALUES).transpose(1, 2, 0)}
HDF5 = {
    "frequency": (HERTZ, "Hz"),
    "frf": (VALUES, "m/s2/N"),
    "responses": (list(OUTPUTS), ""),
    "references": (list(REFERENCES), ""),
}
DOORS = {
    "gvt_csv": tabulate(),
    "polar_csv": tabulate(polar=True),
    "gvt_mat": MATLAB,
    "gvt_h5": HDF5,
    "gvt_npz": {"frequency_hz": HERTZ, **PAIR, **DOFS, "response_unit": "m/s2", "force_unit": "N"},
}


@pytest.mark.parametrize("name", DOORS)
def test_every_file_gives_the_same_responses(tmp_path: Path, name: str) -> None:
    """Units are stated by the files, so that none is given."""
    found = extract_responses(
        read(tmp_path, **{name: DOORS[name], "nodes_csv": NODES}), ResponseOptions(name="GVT")
    )
    assert (found.outputs, found.references) == (OUTPUTS, REFERENCES)
    assert np.allclose(found.frequency_hz, HERTZ)
    assert np.allclose(found.values, VALUES, atol=1e-12)
    assert found.quantity == "acceleration"
    assert found.nodes is not None
    assert found.nodes[1] == pytest.approx([0.2, 0.4, 0.0])


def test_a_matlab_file_of_version_7_3_has_complex_arrays_and_cells(tmp_path: Path) -> None:
    """Columns first, complex as a pair of parts, and texts as references to their characters."""
    path = tmp_path / "gvt.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["f"] = HERTZ[None]
        pair = np.empty(VALUES.T.shape, dtype=[("real", "f8"), ("imag", "f8")])
        pair["real"], pair["imag"] = np.real(VALUES.T), np.imag(VALUES.T)
        file["H"] = pair
        for name, texts in (*DOFS.items(), *((k, [v]) for k, v in UNITS.items())):
            cells = []
            for number, text in enumerate(texts):
                cell = file.create_dataset(
                    f"#refs#/{name}{number}", data=np.array([[ord(c)] for c in text], dtype="u2")
                )
                cell.attrs["MATLAB_class"] = np.bytes_("char")
                cells.append(cell.ref)
            file[name] = np.array([cells], dtype=h5py.ref_dtype)
            file[name].attrs["MATLAB_class"] = np.bytes_("cell")
    fields = {field.path: field.samples for field in read_file(path, path.name)}
    source = SourceFile(name=path.name, sha256="", arrays=fields)
    found = extract_responses(Sources((source,)), ResponseOptions(name="GVT"))
    assert (found.outputs, found.references) == (OUTPUTS, REFERENCES)
    assert np.allclose(found.values, VALUES)


def test_units_and_signs_of_the_file_are_converted(tmp_path: Path) -> None:
    text = write_columns(
        {
            "1+z/1-z re [g/lbf]": np.real(VALUES[:, 0, 0]),
            "1+z/1-z im [g/lbf]": np.imag(VALUES[:, 0, 0]),
        },
        "omega [rad/s]",
        2.0 * np.pi * HERTZ,
    )
    found = extract_responses(read(tmp_path, gvt_csv=text), ResponseOptions(name="GVT"))
    assert np.allclose(found.values[:, 0, 0], -VALUES[:, 0, 0] * 9.80665 / 4.4482216152605)
    assert np.allclose(found.frequency_hz, HERTZ)


def test_units_that_no_file_states_are_asked_for(tmp_path: Path) -> None:
    text = tabulate(True, "", "").replace("frequency [Hz]", "frequency")
    sources = read(tmp_path, gvt_csv=text)
    queries = inspect_modal_data(sources).response_queries
    names = ["response_unit", "force_unit", "frequency_unit", "phase_unit"]
    assert [query.field for query in queries] == names
    given: dict[str, Any] = {
        "response_unit": "g",
        "force_unit": "N",
        "frequency_unit": "Hz",
        "phase_unit": "deg",
    }
    for name in names:
        options = ResponseOptions(name="GVT", **{n: u for n, u in given.items() if n != name})
        with pytest.raises(BadInput) as caught:
            extract_responses(sources, options)
        assert caught.value.code == "unit-needed"
        assert caught.value.context["field"] == name
    found = extract_responses(sources, ResponseOptions(name="GVT", **given))
    assert np.allclose(found.values, 9.80665 * VALUES)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"a_csv": tabulate(unit="").replace(" imag", " magnitude")}, "real and magnitude"),
        ({"a_csv": tabulate(unit="").replace("1+z/1+z imag", "q")}, "the file has real"),
        (
            {"a_csv": tabulate(unit="").replace("1+z/1+z real", "1+z/1+z")},
            "does not state its part",
        ),
        ({"a_csv": tabulate(unit="").replace("frequency [Hz]", "x")}, "no fields of frequency"),
        ({"a_csv": tabulate(True, " [dB]")}, "whose reference is not stated"),
        ({"a_csv": tabulate(unit=" [m/s2]")}, "not one of a response per force"),
        ({"a_csv": tabulate(unit=" [g/N]")}, "states the response unit g, m/s2 was given"),
        ({"a_mat": MATLAB | {"G": VALUES}}, "G, H may all be frequency responses"),
        ({"a_mat": MATLAB | {"H": VALUES[:-1]}}, "has no axis of the frequencies"),
        ({"a_mat": MATLAB | {"H": np.zeros((200, 2, 200), complex)}}, "is ambiguous"),
        ({"a_mat": MATLAB | {"references": "1+z"}}, "no text names the 2 references"),
        ({"a_mat": MATLAB | {"f": -HERTZ}}, "do not increase"),
        ({"a_csv": tabulate(unit="").replace(repr(float(VALUES[3, 0, 0].real)), "nan")}, "row 5"),
    ],
)
def test_incomplete_and_ambiguous_files_are_refused(
    tmp_path: Path, files: dict[str, Any], message: str
) -> None:
    with pytest.raises(Exception, match=message):
        extract_responses(read(tmp_path, **files), GIVEN)


# --- time data -------------------------------------------------------------

RATE, PERIOD = 32.0, 1280


def simulate(seed: int, noise: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Two periods of random forces (N, 2), and accelerations (N, 4) in steady state."""
    rng = np.random.default_rng(seed)
    hertz = np.fft.rfftfreq(PERIOD, 1.0 / RATE)
    forces = rng.normal(size=(hertz.size, 2)) + 1j * rng.normal(size=(hertz.size, 2))
    responses = np.einsum("wor,wr->wo", respond(hertz), forces)
    f, x = (np.tile(np.fft.irfft(one, PERIOD, axis=0), (2, 1)) for one in (forces, responses))
    return f, x + noise * x.std(axis=0) * rng.normal(size=x.shape)


def tabulate_record(seed: int, noise: float = 0.0, force_unit: str = " [N]") -> str:
    forces, responses = simulate(seed, noise)
    columns = {f"force {REFERENCES[k]}{force_unit}": forces[:, k] for k in range(2)}
    columns |= {f"acceleration {OUTPUTS[k]} [m/s2]": responses[:, k] for k in range(4)}
    return write_columns(columns, "time [s]", np.arange(2 * PERIOD) / RATE)


def store_record(seed: int) -> dict[str, Any]:
    forces, responses = simulate(seed)
    return {"time_s": np.arange(2 * PERIOD) / RATE, "force": forces, "acceleration": responses}


NAMES = {"force_dofs": np.array(REFERENCES), "acceleration_dofs": np.array(OUTPUTS)}
SI = {"response_unit": "m/s2", "force_unit": "N"}
PERIODIC = AveragingOptions(averages=8, overlap=0.0, window="rectangular")
RECORDS = {
    "csv": lambda seed: tabulate_record(seed),
    "mat": lambda seed: store_record(seed) | {k: v.astype(object) for k, v in NAMES.items()} | SI,
    "npz": lambda seed: store_record(seed) | NAMES | SI,
    "h5": lambda seed: {
        "rate": (RATE, "Hz"),
        "force": (store_record(seed)["force"], "N"),
        "response": (store_record(seed)["acceleration"], "m/s2"),
        "force_dofs": (list(REFERENCES), ""),
        "response_dofs": (list(OUTPUTS), ""),
    },
}


def identify(found: RawResponses) -> tuple[np.ndarray, np.ndarray]:
    inside = (found.frequency_hz > 2.0) & (found.frequency_hz < 12.0)
    omega, values = 2.0 * np.pi * found.frequency_hz[inside], found.values[inside]
    columns = find_columns(compute_stabilisation(omega, values, 20))
    std = found.errors["std"][inside] if found.errors else None
    modes = identify_modes(omega, values, columns, found.quantity, std=std)
    return modes.omega / 2.0 / np.pi, modes.damping


@pytest.mark.parametrize("kind", RECORDS)
def test_time_data_of_every_file_give_the_responses_of_the_structure(
    tmp_path: Path, kind: str
) -> None:
    """Four records of two periods each; blocks of one period have no leakage."""
    sources = read(tmp_path, **{f"run{k}_{kind}": RECORDS[kind](k) for k in range(4)})
    holds = inspect_modal_data(sources)
    assert all(file.has_records for file in holds.files)
    assert not holds.response_queries
    found = extract_responses(sources, ResponseOptions(name="GVT"), PERIODIC)
    assert (found.outputs, found.references) == (OUTPUTS, REFERENCES)
    assert np.allclose(found.values, respond(found.frequency_hz), rtol=1e-6, atol=1e-9)
    assert found.errors["std"].shape == found.values.shape
    assert found.errors["multiple_coherence"].min() > 1.0 - 1e-9
    assert found.averaging is not None
    assert (found.averaging.averages, found.averaging.block_s) == (8, PERIOD / RATE)


def test_modes_of_all_doors_are_those_of_the_structure(tmp_path: Path) -> None:
    records = {f"run{k}_csv": tabulate_record(k, noise=0.02) for k in range(4)}
    measured = extract_responses(read(tmp_path, **records), ResponseOptions(name="GVT"), PERIODIC)
    tabulated = extract_responses(read(tmp_path, gvt_csv=tabulate()), ResponseOptions(name="GVT"))
    for found, tolerance in ((measured, 2e-3), (tabulated, 1e-6)):
        hertz, damping = identify(found)
        assert hertz == pytest.approx(MODES_HZ, rel=0.1 * tolerance)
        assert damping == pytest.approx(DAMPING, rel=5 * tolerance)


def test_conjugated_responses_contradict_causality(tmp_path: Path) -> None:
    found = extract_responses(read(tmp_path, gvt_csv=tabulate()), ResponseOptions(name="GVT"))
    with pytest.raises(BadInput, match="contradicts causality"):
        identify(replace(found, values=found.values.conj()))


@pytest.mark.parametrize(
    ("text", "averaging", "message"),
    [
        (tabulate_record(0), None, "holds forces and responses over time"),
        (tabulate(), PERIODIC, "hold no forces and responses"),
        (tabulate_record(0, force_unit=""), PERIODIC, "does not state the force unit"),
        (tabulate_record(0, force_unit=" [g]"), PERIODIC, "force by its name and in g"),
        (tabulate_record(0, force_unit=" [Pa]"), PERIODIC, "a unit of pressure"),
        (tabulate_record(0).replace("time [s]", "time"), PERIODIC, "time has no unit"),
        (tabulate_record(0).replace("time [s]", "q"), PERIODIC, "no fields of time"),
        (tabulate_record(0).replace("force 3+z", "force 1-z"), PERIODIC, "same degree of freedom"),
        (tabulate_record(0).replace("\n0.03125,", "\n0.04,"), PERIODIC, "not evenly sampled"),
        (tabulate_record(0), replace(PERIODIC, averages=2), "cannot resolve 2 forces"),
        (tabulate_record(0), AveragingOptions(averages=8, estimator="H2"), "defined for one force"),
    ],
)
def test_incomplete_time_data_are_refused(
    tmp_path: Path, text: str, averaging: AveragingOptions | None, message: str
) -> None:
    with pytest.raises(BadInput, match=message):
        extract_responses(read(tmp_path, run_csv=text), ResponseOptions(name="GVT"), averaging)


def test_tests_of_several_sensor_positions_have_one_block_length(tmp_path: Path) -> None:
    """The first sensor stays; records of the second position are longer, with rounded times."""

    def tabulate_position(seed: int, outputs: tuple[int, ...], n: int, noise: float) -> str:
        forces, responses = simulate(seed, noise)
        forces, responses = np.tile(forces, (2, 1))[:n], np.tile(responses, (2, 1))[:n]
        columns = {f"force {REFERENCES[k]} [N]": forces[:, k] for k in range(2)}
        columns |= {f"acceleration {OUTPUTS[k]} [m/s2]": responses[:, k] for k in outputs}
        times = np.arange(n) / RATE
        return write_columns(columns, "time [s]", times if len(outputs) == 2 else times.round(5))

    longer = 3 * PERIOD - 5
    files = {f"a{k}_csv": tabulate_position(k, (0, 1), 2 * PERIOD, 0.0) for k in range(4)}
    files |= {f"b{k}_csv": tabulate_position(9 + k, (0, 2, 3), longer, 1e-3) for k in range(4)}
    found = extract_responses(read(tmp_path, **files), ResponseOptions(name="GVT"), PERIODIC)
    assert found.outputs == OUTPUTS
    assert found.averaging is not None
    assert found.averaging.block_s == PERIOD / RATE
    assert np.allclose(found.values[:, :2], respond(found.frequency_hz)[:, :2], rtol=1e-6)
    error = np.abs(found.values - respond(found.frequency_hz))[:, 2:]
    assert np.sqrt(np.mean(error**2 / found.errors["std"][:, 2:] ** 2)) == pytest.approx(1, abs=0.3)
    assert "2 responses were measured in several tests" in " ".join(found.notes)
