"""Workbench client for scripts and notebooks."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexsid.client.connection import (
    Connection,
    ProgressLine,
    RunFailed,
    describe_failure,
    join_samples,
    matrix,
    poll_until_ended,
    read_csv,
    table,
    tabulate_comparison,
)
from flexsid.client.live import Live
from flexsid.client.modal_data import ModalData
from flexsid.errors import BadInput

if TYPE_CHECKING:
    import control
    import pandas
    from plotly.graph_objects import Figure

_STRUCTURE = frozenset(
    {
        *("inputs", "outputs", "free", "fixed", "fixed_to", "absent", "axis"),
        *("free_delays", "extra_parameters", "delays", "instruments"),
    }
)
_REQUEST = frozenset(
    {
        *("modal_table_id", "damping_table_id", "prediction_id"),
        *("structure_id", "structure_version", "author", "priority", "limits"),
        "run_template_id",
    }
)
_PAGE = 1000  # most items of one response
_AT_ONCE = 500  # most ids in one URL


class Workbench:
    """Client of a running workbench.

    Parameters
    ----------
    url
        Address of the server.
    analyst
        Name of the analyst, stored with every request; proposals and comments require it.
    token
        API token of an account, for servers with log-in; by default the environment variable
        ``FLEXSID_TOKEN``.
    timeout_s
        Timeout of one response. [s]

    Examples
    --------
    >>> from flexsid.client import Workbench
    >>> workbench = Workbench("http://127.0.0.1:8000")  # doctest: +SKIP
    >>> run = workbench.submit(1, "OE", modes=[7, 9])  # doctest: +SKIP
    >>> workbench.wait(run)  # doctest: +SKIP
    >>> workbench.parameters(run)  # doctest: +SKIP
    """

    def __init__(
        self,
        url: str = "http://127.0.0.1:8000",
        *,
        analyst: str = "",
        token: str | None = None,
        timeout_s: float = 60.0,
    ) -> None:
        token = os.environ.get("FLEXSID_TOKEN") if token is None else token
        self._connection = Connection(url, timeout_s, analyst, token)

    def __repr__(self) -> str:
        return f"Workbench({self._connection.url!r})"

    @property
    def modal_data(self) -> ModalData:
        """Import, correlation, updating and files of modal data."""
        return ModalData(self)

    @property
    def live(self) -> Live:
        """Streams of samples while an aircraft flies."""
        return Live(self)

    # --- plain responses ---

    def get(self, path: str, **query: Any) -> Any:
        """Return the response of any route below ``/api/v1``; lists are sent with commas.

        Parameters
        ----------
        path
            E.g. ``flutter``.
        **query
            Query parameters of the route, e.g. ``run_ids=[1, 2]``.

        Raises
        ------
        RequestRefused
            If the workbench refuses the request; the message states the reason.
        Unreachable
            If no workbench responds.
        """
        return json.loads(self._connection.get(path, query))

    def post(self, path: str, body: Any, **query: Any) -> Any:
        """Return the response of any route below ``/api/v1`` to a JSON body and a query."""
        return json.loads(self._connection.post(path, body, query))

    def get_bytes(self, path: str, **query: Any) -> bytes:
        """Return the content of a file of the workbench."""
        return self._connection.get(path, query)

    def send_bytes(self, path: str, content: bytes) -> Any:
        """Return the response of a route to the content of a file."""
        return json.loads(self._connection.post_bytes(path, content))

    def send_files(self, path: str, files: Mapping[str, Iterable[Path]], **fields: Any) -> bytes:
        """Return the response of a route to files and fields of a form."""
        return self._connection.send_files(path, files, **fields)

    def items(self, path: str, limit: int | None = None, **query: Any) -> list[dict[str, Any]]:
        """Return all items of a list, at most ``limit``, read page by page."""
        response = self.get(path, **query)
        found: list[dict[str, Any]] = response["items"]
        # Only a list that continues has pages, and accepts a page size.
        while response.get("next") is not None and (limit is None or len(found) < limit):
            size = _PAGE if limit is None else min(_PAGE, limit - len(found))
            response = self.get(path, **query, limit=size, after=response["next"])
            found += response["items"]
        return found[:limit]

    # --- lists ---

    def table(self, path: str, limit: int | None = None, **query: Any) -> pandas.DataFrame:
        """Return any list of the interface as a table, one row per item by id."""
        return table(self.items(path, limit, **query))

    def aircraft(self) -> pandas.DataFrame:
        """Return all aircraft."""
        return self.table("aircraft")

    def flights(self, **query: Any) -> pandas.DataFrame:
        """Return flights; filter by ``aircraft_id``."""
        return self.table("flights", **query)

    def maneuvers(self, limit: int | None = None, **query: Any) -> pandas.DataFrame:
        """Return maneuvers with their condition and newest runs.

        ``fta``, ``min_airspeed_ratio``, ``max_fuel``, ``search``, ``method``, ``state``,
        ``sort`` and so on filter and sort the list as on the page.
        """
        return self.table("maneuvers", limit, **query)

    def samples(
        self, maneuver_id: int, channels: Iterable[str], **interval: float
    ) -> pandas.DataFrame:
        """Return samples as runs use them: in SI units, with corrections, by time in s.

        ``start_s`` and ``stop_s`` select an interval. ``attrs["units"]`` has the units; channels
        with other times than the first have missing values between theirs.
        """
        address = f"maneuvers/{maneuver_id}/samples"
        return join_samples(self.get(address, channels=list(channels), **interval))

    def runs(self, limit: int | None = None, **query: Any) -> pandas.DataFrame:
        """Return runs, newest first; filter by ``maneuver_id``, ``method`` or ``state``."""
        return self.table("runs", limit, **query)

    def predictions(self, **query: Any) -> pandas.DataFrame:
        """Return predictions; filter by ``aircraft_id``."""
        return self.table("predictions", **query)

    def modal_tables(self, **query: Any) -> pandas.DataFrame:
        """Return modal tables; ``kind`` is FEM or GVT."""
        return self.table("modal-tables", **query)

    # --- data ---

    def add_aircraft(self, file: str | Path) -> int:
        """Add the aircraft that a TOML file defines, before its first flight; return its id.

        Parameters
        ----------
        file
            The ``[aircraft]`` part of a mapping.

        Raises
        ------
        RequestRefused
            Naming the key that is missing or wrong, or if there is an aircraft of this name.
        """
        return self.post("aircraft", {"text": Path(file).read_text(encoding="utf-8")})["id"]

    def import_maneuver(
        self,
        *files: str | Path,
        mapping: str | Path | None = None,
        aircraft_id: int | None = None,
        confirmed: bool = False,
    ) -> int:
        """Import a maneuver from files on this computer; return its id.

        Parameters
        ----------
        *files
            Recorder files and tables of one maneuver.
        mapping
            TOML file that describes them; not needed for recognised formats.
        aircraft_id
            Aircraft, if the mapping names none.
        confirmed
            Whether the values that the mapping marks as guessed are confirmed.

        Raises
        ------
        RequestRefused
            If the files contradict the mapping, or guessed values are not confirmed. Nothing is
            stored then.
        """
        sent = {"files": [Path(file) for file in files]}
        if mapping is not None:
            sent["mapping"] = [Path(mapping)]
        response = self._connection.send_files(
            "maneuvers", sent, aircraft_id=aircraft_id, confirmed="true" if confirmed else None
        )
        return json.loads(response)["id"]

    # --- runs ---

    def submit(
        self, maneuver_id: int, method: str, modes: Iterable[int] | None = None, **options: Any
    ) -> int:
        """Queue a run and return its id.

        Parameters
        ----------
        maneuver_id
            Id of the maneuver.
        method
            OE, FRE or EE.
        modes
            Numbers of the structural modes in the model; ``[]`` for none. Without a described
            structure, the run uses ``structure_id``, else the structure proposed for the
            maneuver (approved, saved for its FTA, or the modes in its band).
        **options
            Fields of the structure (``inputs``, ``outputs``, ``free``, ``fixed``, ``absent``,
            ``free_delays``, ``extra_parameters`` ...), of the settings (``start``, ``band_hz``,
            ``noise``, ``priors``, ``prior_spread`` ...) and of the request (``structure_id``,
            ``modal_table_id``, ``prediction_id``, ``run_template_id``, ``priority`` ...) of the
            interface.

        Raises
        ------
        RequestRefused
            If the run cannot be estimated, or an option is unknown.
        """
        structure = {name: options.pop(name) for name in _STRUCTURE & options.keys()}
        request = {name: options.pop(name) for name in _REQUEST & options.keys()}
        if modes is not None:
            structure["modes"] = list(modes)
        body = {
            "maneuver_id": maneuver_id,
            "method": method,
            "structure": structure or None,
            "settings": options or None,
            **request,
        }
        return self.post("runs", body)["id"]

    def run_templates(self, **query: Any) -> pandas.DataFrame:
        """Return templates of runs in their newest revision; filter by ``aircraft_id``."""
        return self.table("run-templates", **query)

    def save_run_template(self, run_id: int, name: str, note: str = "") -> int:
        """Save method and settings of a run as a template of its campaign; return its id.

        Additional maneuvers, the run to start from and priors by value are not part of it.

        Raises
        ------
        RequestRefused
            If the campaign has a template of this name.
        """
        body = {"run_id": run_id, "name": name, "note": note}
        return self.post("run-templates", body)["id"]

    def revise_run_template(self, template_id: int, run_id: int, note: str = "") -> int:
        """Save method and settings of a run as the next revision; return its number."""
        path = f"run-templates/{template_id}"
        body = {"run_id": run_id, "revision": self.get(path)["revision"], "note": note}
        return json.loads(self._connection.put(path, body))["revision"]

    def wait(
        self, *run_ids: int, timeout_s: float | None = None, show_progress: bool = True
    ) -> None:
        """Wait until runs have ended, with a progress bar on a terminal or in a notebook.

        Raises
        ------
        RunFailed
            If a run did not succeed, after all have ended; the message states the reason.
        TimeoutError
            If the runs have not ended within ``timeout_s``.
        """
        line = ProgressLine(show_progress)
        try:
            runs = poll_until_ended(self._fetch_jobs, run_ids, timeout_s, line)
        finally:
            line.end()
        unsuccessful = [run for run in runs if run["state"] != "succeeded"]
        if unsuccessful:
            raise RunFailed("; ".join(map(describe_failure, unsuccessful)))

    def _fetch_jobs(self, run_ids: Sequence[int]) -> list[dict[str, Any]]:
        """Return the states of runs, in requests of limited URL length."""
        found: dict[int, dict[str, Any]] = {}
        for first in range(0, len(run_ids), _AT_ONCE):
            part = run_ids[first : first + _AT_ONCE]
            items = self.get("jobs", ids=part, limit=_AT_ONCE)["items"]
            found |= {job["id"]: job for job in items}
        # A missing run is requested by itself, so that the error names it.
        return [found.get(number) or self.run(number) for number in run_ids]

    def cancel(self, run_id: int) -> None:
        """Cancel a run."""
        self.post(f"jobs/{run_id}/cancel", None)

    def run(self, run_id: int) -> dict[str, Any]:
        """Return one run: state, structure, settings, fit, poles."""
        return self.get(f"runs/{run_id}")

    def parameters(self, run_id: int) -> pandas.DataFrame:
        """Return the estimates of a run by name, with standard error and starting value."""
        return table(self.run(run_id)["parameters"], index="name")

    def covariance(self, run_id: int) -> pandas.DataFrame:
        """Return the covariance matrix of the estimates of a run, with names.

        Modal table and flight condition are held: standard errors also contain ``modal_std`` and
        ``condition_std`` of ``run``.
        """
        exported = self.get(f"runs/{run_id}/export")
        result = exported["run"]["result"]
        if result is None:
            raise RunFailed(describe_failure(exported["run"]))
        return matrix(exported["covariance"], [part["name"] for part in result["parameters"]])

    def comparison(
        self, run_ids: Iterable[int], prediction_ids: Iterable[int] = ()
    ) -> pandas.DataFrame:
        """Return derivatives of runs and predictions: value and standard error per source.

        Columns are pairs (source, ``value`` or ``std_error``); predictions also have
        ``difference_sigma``, their largest difference from a run in combined standard errors.
        The last column, ``max_difference_sigma``, is the largest difference between two runs.
        """
        predictions = list(prediction_ids) or None
        response = self.get("comparisons", run_ids=run_ids, prediction_ids=predictions)
        return tabulate_comparison(response)

    def identified_derivatives(self, aircraft_id: int) -> pandas.DataFrame:
        """Return the derivatives of a campaign: in how many cells of the envelope, how accurate.

        ``n_accurate`` counts standard errors of at most 20 % of the estimate by runs that are not
        suspect, ``best.run_id`` is the run of the smallest. The whole dashboard, with open
        warnings, is ``get("aircraft/1/dashboard")``.
        """
        return table(self.get(f"aircraft/{aircraft_id}/dashboard")["derivatives"], "name")

    def compute_prediction(self, **planform: Any) -> int:
        """Compute derivatives from a planform, wait, and return the id of the prediction.

        Parameters
        ----------
        **planform
            ``aircraft_id``, ``source``, ``panels`` (or ``deck``), ``surfaces``, ``mach`` and
            ``reference_k``, as the interface names them.
        """
        job_id = self.post("predictions", planform)["id"]
        self.wait(job_id)
        return self.get(f"jobs/{job_id}")["result"]["prediction_id"]

    def flutter(self, run_ids: Iterable[int] | None = None, **query: Any) -> dict[str, Any]:
        """Return the flutter prediction of runs and the margin of the next test point.

        Parameters
        ----------
        run_ids
            Runs that succeeded, best over several airspeeds; by default those of the approved
            global model, with ``variation="global-model"``.
        **query
            ``fuel`` as a fraction, ``altitude_m``, ``next_m_s``, ``unmodelled_modes`` and
            ``variation`` (``linear`` or ``global-model``), as the interface names them.
        """
        return self.compute("flutter", **(self._select_runs(run_ids) | query))

    def _select_runs(self, run_ids: Iterable[int] | None) -> dict[str, Any]:
        """Return the query of runs, by default those of the newest approved global model."""
        if run_ids is not None:
            return {"run_ids": list(run_ids)}
        known = self.items("global-models/versions")
        approved = [one for one in known if one["state"] == "approved"]
        if not approved:
            raise ValueError("no global model is approved; give run_ids")
        runs = [run["run_id"] for run in approved[0]["runs"] if not run["is_outlying"]]
        return {"run_ids": runs, "variation": "global-model"}

    def predicted_flutter(self, prediction_id: int, **query: Any) -> dict[str, Any]:
        """Return the flutter speed of a prediction alone, by p-k and by rational functions.

        Parameters
        ----------
        prediction_id
            Prediction with derivatives of modes.
        **query
            ``fuel`` as a fraction, ``density_kg_m3``, ``from_m_s`` and ``to_m_s``, as the
            interface names them.
        """
        return self.compute("flutter/predicted", prediction_id=prediction_id, **query)

    def closed_loop(
        self, run_ids: Iterable[int] | None, controller_id: int, **query: Any
    ) -> dict[str, Any]:
        """Return the stability margins of a controller around identified models.

        With ``run_ids`` None they are those of the approved global model, as in ``flutter``.
        """
        query = self._select_runs(run_ids) | query
        return self.compute("closed-loop", controller_id=controller_id, **query)

    def global_model(self, run_ids: Iterable[int], **query: Any) -> dict[str, Any]:
        """Return the derivatives of all runs over the envelope, with the outlying runs.

        ``numbers("global-slice", run_ids=..., name="Cm_alpha")`` returns a slice of it.

        Parameters
        ----------
        run_ids
            Runs that succeeded, of one model structure.
        **query
            ``variables``, e.g. ``["dynamic_pressure_pa", "fuel_fraction"]``, and
            ``prediction_id``.
        """
        return self.compute("global-models", run_ids=list(run_ids), **query)

    def global_models(self, **query: Any) -> pandas.DataFrame:
        """Return the stored versions of global models and the state of their review."""
        return self.table("global-models/versions", **query)

    def save_global_model(
        self, run_ids: Iterable[int], label: str, note: str = "", **query: Any
    ) -> int:
        """Store a computed global model as the next version, and return its id.

        Parameters
        ----------
        run_ids, **query
            As of ``global_model``, which must have been computed.
        label, note
            Of the version.
        """
        query["run_ids"] = list(run_ids)
        return self.post("global-models/versions", {"label": label, "note": note}, **query)["id"]

    def propose_write_back(self, run_id: int) -> dict[str, Any]:
        """Return what a write-back of a run would write: every parameter before and after."""
        return self.get("write-backs/proposal", run_id=run_id)

    def write_back(self, run_id: int, reason: str) -> dict[str, Any]:
        """Write the posterior of a run back, as new versions of its modal table and prediction.

        Parameters
        ----------
        run_id
            A succeeded run with its retained modes.
        reason
            Of the decision.

        Returns
        -------
        dict
            The write-back, with the ids of both versions and of the former ones.
        """
        return self.post("write-backs", {"run_id": run_id, "reason": reason})

    def write_backs(self, aircraft_id: int | None = None) -> list[dict[str, Any]]:
        """Return the write-backs, including undone ones, newest first."""
        query = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
        return self.get("write-backs", **query)["items"]

    def undo_write_back(self, write_back_id: int) -> None:
        """Undo a write-back: the former versions are the default again."""
        self._connection.delete(f"write-backs/{write_back_id}")

    def save_global_prediction(
        self,
        run_ids: Iterable[int],
        source: str,
        condition: Iterable[float] = (),
        **query: Any,
    ) -> int:
        """Store a global model at one condition as a prediction, and return its id.

        Parameters
        ----------
        run_ids, **query
            As of ``global_model``, which must have been computed.
        source
            Name of the prediction.
        condition
            Value of every variable, in SI; by default the mean condition of the runs.
        """
        body = {"source": source, "condition": list(condition)}
        query["run_ids"] = list(run_ids)
        return self.post("global-models/predictions", body, **query)["id"]

    def optimal_design(
        self, design_id: int, run_id: int, objective: str = "flutter", **query: Any
    ) -> dict[str, Any]:
        """Store the design that is optimal for an objective, and return its gain over another.

        Parameters
        ----------
        design_id
            Standard design, whose harmonics and limits the optimal one has by default.
        run_id
            Output-error run with model and noise.
        objective
            ``flutter``, ``derivatives``, ``damping`` or ``structures``.
        **query
            ``derivatives``, ``mode`` or ``other_run_id`` of the objective; the limits
            ``deflection`` [rad], ``rate`` [rad/s] and ``load_factor`` [g]; ``level``, ``spread``
            and ``after_run``.
        """
        path = f"designs/{design_id}/optimal-design"
        return self.compute(path, run_id=run_id, objective=objective, **query)

    def compare_aerodynamics(self, run_id: int) -> dict[str, Any]:
        """Return the verdict between quasi-steady and shaped derivatives for the data of a run."""
        return self.compute("aerodynamics-comparisons", run_id=run_id)

    def check_posterior(self, run_id: int) -> dict[str, Any]:
        """Return the posterior of an output-error run, sampled, against its standard errors."""
        return self.compute("posterior-checks", run_id=run_id)

    def compare_amplitudes(self, run_ids: Iterable[int]) -> dict[str, Any]:
        """Return tests of equal linear models at several amplitudes, by output-error runs."""
        return self.compute("amplitude-comparisons", run_ids=run_ids)

    def repeated_levels(self, aircraft_id: int) -> list[dict[str, Any]]:
        """Return maneuvers of one condition and multisine at several amplitudes, with runs."""
        return self.get(f"aircraft/{aircraft_id}/repeated-levels")["items"]

    def transfer_function(
        self,
        maneuver_id: int,
        input: str,
        output: str,
        **options: Any,
    ) -> dict[str, Any]:
        """Return the transfer function of an output over an input, with standard errors.

        Parameters
        ----------
        maneuver_id
            Maneuver.
        input
            A surface (``wf4s``), or its recorded command (``wf4s_command``).
        output
            A sensor or combination.
        options
            Orders ``zeros``, ``poles`` and ``integrators``, those usual for the output by
            default; ``delay=False``; limits ``low_hz`` and ``high_hz`` of the band.
        """
        return self.compute(
            "transfer-functions", maneuver_id=maneuver_id, input=input, output=output, **options
        )

    def identify_output_only(self, maneuver_id: int, **options: Any) -> dict[str, Any]:
        """Return the modes of a record from its outputs alone, with standard errors.

        Parameters
        ----------
        maneuver_id
            Maneuver.
        options
            Limits ``low_hz`` and ``high_hz`` of the band, ``start_s`` and ``stop_s`` of the used
            part, and ``outputs``, all of one clock by default.
        """
        return self.compute("output-only-modes", maneuver_id=maneuver_id, **options)

    def fit_grey_box(
        self,
        maneuver_id: int,
        model: str | Path,
        *,
        method: str = "OE",
        band_hz: tuple[float, float] | None = None,
    ) -> dict[str, Any]:
        """Fit a model of one's own to a maneuver; return its parameters with standard errors.

        Parameters
        ----------
        maneuver_id
            Maneuver, whose channels have the names of the model's inputs and outputs.
        model
            File that defines a ``GreyBox`` (in personal mode), or the name of an installed model.
        method
            ``OE`` or ``FRE``.
        band_hz
            Limits of the band, the excited one by default. [Hz]

        Returns
        -------
        dict
            The fit, with the ``id`` of its job.

        Raises
        ------
        RunFailed
            If the model fails, or the data do not determine its parameters; the message states
            the line of the file, or the reason.
        """
        file = Path(model)
        body: dict[str, Any] = {"maneuver_id": maneuver_id, "model": str(model), "method": method}
        if file.suffix == ".py":
            body |= {"model": file.name, "source": file.read_text(encoding="utf-8")}
        if band_hz is not None:
            body |= {"low_hz": band_hz[0], "high_hz": band_hz[1]}
        job = self.post("grey-box-fits", body)
        self.wait(job["id"])
        return {"id": job["id"], **self.get(f"grey-box-fits/{job['id']}")}

    def grey_box(self, fit_id: int) -> control.StateSpace:
        """Return the model of a fit with its fitted parameters, for python-control.

        ``fit_id`` is that of its job, ``fit_grey_box(...)["id"]``.
        """
        return _build_state_space(self.get(f"grey-box-fits/{fit_id}"))

    def check_compatibility(self, maneuver_ids: Iterable[int]) -> dict[str, Any]:
        """Compare the sensors of maneuvers by kinematics; return their faults with corrections.

        Parameters
        ----------
        maneuver_ids
            Maneuvers of one aircraft and recorder; a fault is common to all.
        """
        return self.compute("compatibility", maneuver_ids=list(maneuver_ids))

    def correct_cause(self, run_id: int) -> list[dict[str, Any]]:
        """Take the corrections of the causes that a rejected run names; estimate again after it.

        Parameters
        ----------
        run_id
            A run that its tests reject.

        Returns
        -------
        list of dict
            The steps, as stored with the maneuver of the run.
        """
        return self.post(f"runs/{run_id}/corrections", None)["items"]

    def cross_predict(
        self, run_ids: Iterable[int], maneuver_ids: Iterable[int] = ()
    ) -> pandas.DataFrame:
        """Predict outputs of maneuvers by the models of runs, from the measured inputs.

        Parameters
        ----------
        run_ids
            Runs that succeeded.
        maneuver_ids
            Maneuvers; by default those of the runs.

        Returns
        -------
        pandas.DataFrame
            Mean R2 over the outputs, one row per run and one column per maneuver; NaN where a
            maneuver cannot be predicted.
        """
        import pandas  # takes a second to load

        query: dict[str, Any] = {"run_ids": list(run_ids)}
        if others := list(maneuver_ids):
            query["maneuver_ids"] = others
        cells = self.compute("cross-predictions", **query)["predictions"]
        found = pandas.DataFrame(cells, columns=["run_id", "maneuver_id", "r_squared"])
        return found.pivot(index="run_id", columns="maneuver_id", values="r_squared").astype(float)

    def cross_validate(
        self, run_id: int, partition: str = "folds", folds: int = 5
    ) -> dict[str, Any]:
        """Fit a run again without held-out data, and return how well it predicts these.

        Parameters
        ----------
        run_id
            Run that succeeded.
        partition
            ``folds`` of the frequencies, ``frequencies`` of the first fold only, or ``periods``.
        folds
            Number of folds.
        """
        return self.compute("cross-validations", run_id=run_id, partition=partition, folds=folds)

    def compute(self, path: str, **query: Any) -> dict[str, Any]:
        """Request the result of any analysis, wait for its job and return it.

        An equal request is one job. ``compute("posterior-checks", run_id=1)`` is the result of
        ``GET /posterior-checks``, whose parameters are those of the interface.
        """
        self.wait(self.post(f"{path}/results", None, **query)["id"])
        return self.get(path, **query)

    # --- models and figures ---

    def model(self, run_id: int) -> control.StateSpace:
        """Return the identified model at the condition of its maneuver, for python-control.

        Delays and scale factors of the outputs are not included; ``get("runs/1/model")``
        returns them with the units.
        """
        return _build_state_space(self.get(f"runs/{run_id}/model"))

    def save_model(self, run_id: int, file: str | Path) -> None:
        """Write an identified model to a ``.mat``, ``.json`` or ``.fmu`` file (FMI 2.0)."""
        form = Path(file).suffix.removeprefix(".")
        if form == "fmu":
            Path(file).write_bytes(self._connection.get(f"runs/{run_id}/fmu", {}))
            return
        if form not in ("mat", "json"):
            raise BadInput(f"{file} ends in '.{form}'; expected .mat, .json or .fmu")
        Path(file).write_bytes(self._connection.get(f"runs/{run_id}/model", {"format": form}))

    def save_jsbsim(self, run_id: int, file: str | Path, other_run_id: int | None = None) -> None:
        """Write the identified rigid aircraft for JSBSim, with a run of the other axis if given."""
        query = {} if other_run_id is None else {"other_run_id": other_run_id}
        Path(file).write_bytes(self._connection.get(f"runs/{run_id}/jsbsim", query))

    def save_capsule(self, run_id: int, file: str | Path) -> None:
        """Save a run with its data, settings and results as an RO-Crate.

        ``flexsid recompute FILE`` computes it again in another installation.
        """
        Path(file).write_bytes(self._connection.get(f"runs/{run_id}/capsule", {}))

    def save_report(
        self, file: str | Path, kind: str, number: int | None = None, **query: Any
    ) -> None:
        """Write a report to a ``.html`` or ``.pdf`` file; a PDF is printed by a job.

        Parameters
        ----------
        file
            File name; the suffix selects the format.
        kind
            ``run``, ``comparison``, ``flutter``, ``closed-loop``, ``decision``,
            ``global-model`` or ``campaign``.
        number
            Id of the run, decision or version of a global model.
        **query
            ``units`` and ``frequency_unit``; ``run_ids`` and ``prediction_ids`` of a comparison;
            ``run_ids`` of a stored flutter prediction or closed-loop analysis, ``controller_id``
            of the latter; filters of a campaign.
        """
        form = Path(file).suffix.removeprefix(".")
        if form not in ("html", "pdf"):
            raise BadInput(f"{file} ends in '.{form}'; expected .html or .pdf")
        path = f"reports/{kind}" if number is None else f"reports/{kind}/{number}"
        if form == "pdf":
            printed = self.post(path, None, **query)["id"]
            self.wait(printed)
            path, query = f"reports/files/{printed}", {}
        Path(file).write_bytes(self._connection.get(path, query))

    def notes(self, **query: Any) -> pandas.DataFrame:
        """Return the notes of a campaign, maneuver or run.

        Parameters
        ----------
        **query
            One of ``aircraft_id``, ``maneuver_id`` and ``run_id``.
        """
        return self.table("notes", **query)

    def add_note(self, subject: str, key: str | int, text: str, **more: Any) -> int:
        """Add a note in Markdown; return its id.

        Parameters
        ----------
        subject
            ``maneuver``, ``run``, ``mode`` or ``derivative``.
        key
            Id of the maneuver or run, number of the mode or name of the derivative.
        text
            Markdown.
        **more
            ``aircraft_id`` of a mode or derivative.
        """
        body = {"subject": subject, "key": str(key), "text": text, **more}
        return int(self.post("notes", body)["id"])

    def figure(self, kind: str, **query: Any) -> Figure:
        """Return a figure of the page, e.g. ``figure("bode", maneuver_id=1, output="q")``."""
        from plotly.graph_objects import Figure  # takes a while to load

        return Figure(self.get(f"figures/{kind}", **query))

    def numbers(self, kind: str, **query: Any) -> pandas.DataFrame:
        """Return the data of a figure: one row per point with curve, axes, x, y and error."""
        return read_csv(self._connection.get(f"figures/{kind}", {**query, "format": "csv"}))


def _build_state_space(found: dict[str, Any]) -> control.StateSpace:
    """Build a model of the interface for python-control, with the names of its signals."""
    import control  # takes seconds to load

    return control.StateSpace(
        *(found[name] for name in "ABCD"),
        states=list(found["states"]),
        inputs=list(found["inputs"]),
        outputs=list(found["outputs"]),
    )
