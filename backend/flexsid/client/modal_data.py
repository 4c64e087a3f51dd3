"""Modal data by scripts: import, correlation, updating and files of a workbench."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexsid.client.connection import Requests, table
from flexsid.errors import BadInput

if TYPE_CHECKING:
    import pandas

_FORMS = ("uff", "csv", "mat", "op4")


class ModalData:
    """Modal tables and ground vibration tests of a workbench: ``workbench.modal_data``."""

    def __init__(self, workbench: Requests) -> None:
        self._workbench = workbench

    def upload(self, *files: str | Path) -> str:
        """Upload files of one structure, and return the id of the upload."""
        sent = {"files": [Path(file) for file in files]}
        return json.loads(self._workbench.send_files("uploads", sent))["upload"]["id"]

    def inspect(self, *files: str | Path) -> dict[str, Any]:
        """Return the contents of files, and the options that they leave open."""
        return self._workbench.get(f"uploads/{self.upload(*files)}/modal-data")

    def add(self, *files: str | Path, aircraft_id: int, name: str, **options: Any) -> int:
        """Import modes as a modal table, or as a new version of it; return its id.

        Parameters
        ----------
        *files
            Results and decks of one structure; see ``docs/how-to/modes.md``.
        aircraft_id, name
            Aircraft, and name of the table.
        **options
            ``kind`` (FEM or GVT), ``length_unit``, ``mass_unit``, ``generalized_mass``, ``axes``,
            ``origin``, ``fuel`` and ``analyses`` (by file), ``rigid_modes``, ``points``.

        Raises
        ------
        RequestRefused
            Naming the option that no file states, or what contradicts.
        """
        return self._post(files, "modal-data", aircraft_id=aircraft_id, name=name, **options)["id"]

    def add_flutter_summary(
        self, *files: str | Path, aircraft_id: int, name: str, speed_unit: str
    ) -> int:
        """Import the flutter summary of a printout; return its id."""
        body = {"aircraft_id": aircraft_id, "name": name, "speed_unit": speed_unit}
        return self._post(files, "flutter-summary", **body)["id"]

    def set_mass_properties(self, *files: str | Path, **options: Any) -> dict[str, Any]:
        """Set mass properties of an aircraft by printouts (GPWG); return its mass table.

        Parameters
        ----------
        *files
            Printouts, and the deck if they refer to a node.
        **options
            ``aircraft_id``, ``length_unit``, ``mass_unit``, ``axes``, ``origin``, ``fuel`` by file.
        """
        return self._post(files, "mass-properties", **options)["mass"]

    def modes(self, modal_table_id: int, fuel: float = 0.5) -> pandas.DataFrame:
        """Return the modes of a table at a fuel fraction, by number."""
        path = f"modal-tables/{modal_table_id}/modes"
        return table(self._workbench.get(path, fuel=fuel)["items"], index="number")

    def correlation(
        self,
        modal_table_id: int,
        other_id: int,
        fuel: float = 0.5,
        other_fuel: float | None = None,
    ) -> pandas.DataFrame:
        """Return the paired modes of two tables with MAC, cross-orthogonality and differences.

        Notes are in ``attrs["notes"]``.
        """
        query = {"other_id": other_id, "fuel": fuel, "other_fuel": other_fuel}
        found = self._workbench.get(f"modal-tables/{modal_table_id}/correlation", **query)
        pairs = table(found["pairs"], index="number")
        pairs.attrs["notes"] = found["notes"]
        return pairs

    def orthogonality(
        self, *files: str | Path, modal_table_id: int, mass: str, **options: Any
    ) -> pandas.DataFrame:
        """Return the orthogonality of shapes, or of two tables, over a mass matrix of files.

        Parameters
        ----------
        *files
            Matrices (DMIG, ``.op4``, MATLAB, NumPy), and the deck of their nodes.
        modal_table_id, mass
            Table of the shapes, and name of the mass matrix.
        **options
            ``other_id``, ``stiffness`` (for a static condensation), ``length_unit``, ``axes``,
            ``fuel``, ``other_fuel``.

        Returns
        -------
        pandas.DataFrame
            A row for each mode of the table, a column for each of the other; notes, ``least_pair``
            and ``worst`` in ``attrs``.
        """
        import pandas  # takes a second to load

        body = {"modal_table_id": modal_table_id, "mass": mass, **options}
        job = self._post(files, "orthogonality", **body)
        self._workbench.wait(job["id"])
        found = self._workbench.get(f"orthogonality/{job['id']}")
        values = pandas.DataFrame(found["values"], found["names"], found["other_names"])
        values.attrs |= {name: found[name] for name in ("notes", "least_pair", "worst")}
        return values

    def update(
        self,
        modal_table_id: int,
        name: str,
        test_ids: Iterable[int] = (),
        run_ids: Iterable[int] = (),
    ) -> int:
        """Store a table with frequencies and damping from tests and flights; return its id."""
        body = {"name": name, "test_ids": list(test_ids), "run_ids": list(run_ids)}
        return self._workbench.post(f"modal-tables/{modal_table_id}/updates", body)["id"]

    def save(
        self,
        modal_table_id: int,
        file: str | Path,
        fuel: float = 0.5,
        form: str | None = None,
        **query: Any,
    ) -> None:
        """Write modes to a file; its suffix selects what is written.

        Parameters
        ----------
        modal_table_id, file
            Table, and a file that ends in ``.uff``, ``.csv``, ``.mat`` or ``.op4`` (one fuel
            fraction), ``.zip`` (a file for each fuel fraction) or ``.svg`` (a picture).
        fuel
            Fuel fraction.
        form
            ``uff-single`` or ``op4-binary``, or of the files in an archive ``mat`` (default) or
            ``op4-binary``.
        **query
            Of a picture: ``number`` of the mode, ``moving``, ``scale``, ``azimuth``, ``elevation``.
        """
        suffix = Path(file).suffix.removeprefix(".")
        path = f"modal-tables/{modal_table_id}"
        if suffix == "svg":
            content = self._workbench.get_bytes(f"{path}/picture", fuel=fuel, **query)
        elif suffix == "zip":
            content = self._workbench.get_bytes(f"{path}/archive", form=form or "mat")
        elif suffix in _FORMS:
            content = self._workbench.get_bytes(f"{path}/file", form=form or suffix, fuel=fuel)
        else:
            expected = ", ".join(f".{one}" for one in _FORMS)
            raise BadInput(f"{file} ends in '.{suffix}'; expected {expected}, .zip or .svg")
        Path(file).write_bytes(content)

    def add_responses(self, *files: str | Path, **options: Any) -> int:
        """Import measured frequency responses; return their id.

        Parameters
        ----------
        *files
            Universal, CSV, MATLAB or HDF5 files, all of one test; see ``docs/how-to/modes.md``.
        **options
            ``aircraft_id``, ``name``, ``fuel``, ``length_unit``, ``axes``, ``origin``, and units
            that the files do not state: ``response_unit``, ``force_unit``, ``frequency_unit``,
            ``phase_unit``.
        """
        return self._post(files, "responses", **options)["id"]

    def estimate_responses(self, *files: str | Path, averages: int, **options: Any) -> int:
        """Estimate frequency responses from time data, wait, and return their id.

        Parameters
        ----------
        *files
            Forces and responses over time, all of one test.
        averages
            Number of blocks over which the spectra are averaged.
        **options
            ``estimator`` (H1, H2 or Hv), ``overlap``, ``window`` (hann or rectangular),
            ``time_unit``, and those of ``add_responses``.
        """
        job = self._post(files, "response-estimates", averages=averages, **options)
        self._workbench.wait(job["id"])
        return self._workbench.get(f"jobs/{job['id']}")["result"]["responses_id"]

    def response(self, responses_id: int, output: str, reference: str) -> pandas.DataFrame:
        """Return one frequency response over frequency [Hz], in SI, with coherence if estimated.

        Parameters
        ----------
        responses_id, output, reference
            Measured responses, and the degrees of freedom, such as ``12+z``.
        """
        query = {"response_dof": output, "reference_dof": reference}
        found = self._workbench.get(f"measured-responses/{responses_id}/function", **query)
        columns = ("real", "imaginary", "std", "multiple_coherence", "ordinary_coherence")
        import pandas  # takes a second to load

        known = {name: found[name] for name in columns if found[name] is not None}
        return pandas.DataFrame(known, pandas.Index(found["frequency_hz"], name="frequency_hz"))

    def identify(self, responses_id: int, **band: Any) -> pandas.DataFrame:
        """Identify modes from measured responses, and return them with standard deviations.

        Parameters
        ----------
        responses_id
            Measured responses.
        **band
            ``low_hz``, ``high_hz``, ``order``, and ``poles``: numbers of poles of the stabilisation
            diagram that are fitted, as ``"12,57"``; by default the selection is automatic.
        """
        found = self._workbench.compute(f"measured-responses/{responses_id}/modes", **band)
        return table(found["items"], index=None)

    def save_identified(self, responses_id: int, name: str, **options: Any) -> int:
        """Store identified modes as a modal table; return its id.

        Parameters
        ----------
        responses_id, name
            Measured responses, and name of the table.
        **options
            Those of ``identify``; ``selected`` modes by index; ``template_id``, the table whose
            numbers and names are used (MAC).
        """
        body = {"name": name, **options}
        return self._workbench.post(f"measured-responses/{responses_id}/modes", body)["id"]

    def _post(self, files: Iterable[str | Path], what: str, **body: Any) -> Any:
        return self._workbench.post(f"uploads/{self.upload(*files)}/{what}", body)
