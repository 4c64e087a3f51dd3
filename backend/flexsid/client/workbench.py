"""Workbench: everything that the page shows, for scripts and notebooks."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexsid.client.connection import Connection
from flexsid.client.progress import ProgressLine
from flexsid.client.tables import matrix, read_csv, side_by_side, table
from flexsid.client.waiting import RunFailed, until_ended, why
from flexsid.errors import BadInput

if TYPE_CHECKING:
    import control
    import pandas
    from plotly.graph_objects import Figure

_STRUCTURE = frozenset(
    {
        *("inputs", "outputs", "free", "fixed", "fixed_to", "absent", "axis"),
        *("free_delays", "also_free", "delays", "instruments"),
    }
)
_REQUEST = frozenset(
    {
        *("modal_table_id", "damping_table_id", "prediction_id"),
        *("structure_id", "structure_version", "author", "priority", "limits"),
    }
)
_PAGE = 1000  # most items of one answer
_AT_ONCE = 500  # ids in one address


class Workbench:
    """A running workbench.

    Parameters
    ----------
    url
        Address of the server.
    analyst
        Your name. It stands with all you ask for, and proposals and comments need one.
    timeout_s
        Longest wait for one answer. [s]

    Examples
    --------
    >>> from flexsid.client import Workbench
    >>> workbench = Workbench("http://127.0.0.1:8000")  # doctest: +SKIP
    >>> run = workbench.submit(1, "OE", modes=[7, 9])  # doctest: +SKIP
    >>> workbench.wait(run)  # doctest: +SKIP
    >>> workbench.parameters(run)  # doctest: +SKIP
    """

    def __init__(
        self, url: str = "http://127.0.0.1:8000", *, analyst: str = "", timeout_s: float = 60.0
    ) -> None:
        self._connection = Connection(url, timeout_s, analyst)

    def __repr__(self) -> str:
        return f"Workbench({self._connection.url!r})"

    # --- plain answers ---

    def get(self, path: str, **query: Any) -> Any:
        """Answer of any route below ``/api/v1``; lists are written with commas.

        Parameters
        ----------
        path
            E.g. ``flutter``.
        **query
            As the interface names them, e.g. ``run_ids=[1, 2]``.

        Raises
        ------
        RequestRefused
            If the workbench says no; the message says why.
        Unreachable
            If nobody answers.
        """
        return json.loads(self._connection.get(path, query))

    def post(self, path: str, body: Any) -> Any:
        """Send a body as JSON to any route below ``/api/v1``."""
        return json.loads(self._connection.post(path, body))

    def items(self, path: str, limit: int | None = None, **query: Any) -> list[dict[str, Any]]:
        """All items of a list, page by page; at most ``limit`` of them."""
        answer = self.get(path, **query)
        found: list[dict[str, Any]] = answer["items"]
        # Only a list that goes on has pages, and takes the size of one.
        while answer.get("next") is not None and (limit is None or len(found) < limit):
            size = _PAGE if limit is None else min(_PAGE, limit - len(found))
            answer = self.get(path, **query, limit=size, after=answer["next"])
            found += answer["items"]
        return found[:limit]

    # --- lists ---

    def table(self, path: str, limit: int | None = None, **query: Any) -> pandas.DataFrame:
        """A list as a table, one row per item by id; any list of the interface."""
        return table(self.items(path, limit, **query))

    def aircraft(self) -> pandas.DataFrame:
        """All aircraft."""
        return self.table("aircraft")

    def flights(self, **query: Any) -> pandas.DataFrame:
        """Flights, of one aircraft by ``aircraft_id``."""
        return self.table("flights", **query)

    def maneuvers(self, limit: int | None = None, **query: Any) -> pandas.DataFrame:
        """Maneuvers with their condition and newest runs.

        ``fta``, ``min_airspeed_ratio``, ``max_fuel``, ``search``, ``method``, ``state``,
        ``sort`` and the like narrow and order the list as on the page.
        """
        return self.table("maneuvers", limit, **query)

    def runs(self, limit: int | None = None, **query: Any) -> pandas.DataFrame:
        """Runs, newest first; narrowed by ``maneuver_id``, ``method`` or ``state``."""
        return self.table("runs", limit, **query)

    def predictions(self, **query: Any) -> pandas.DataFrame:
        """Predictions, of one aircraft by ``aircraft_id``."""
        return self.table("predictions", **query)

    def modal_tables(self, **query: Any) -> pandas.DataFrame:
        """Modal tables; ``kind`` is FEM or GVT."""
        return self.table("modal-tables", **query)

    # --- data ---

    def bring_in(
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
            TOML file that says what they hold; not for forms that are recognised.
        aircraft_id
            Whose, where the mapping names none.
        confirmed
            Whether what the mapping marks as guessed is right.

        Raises
        ------
        RequestRefused
            If they do not hold what the mapping says, or it guesses something that is not
            confirmed; nothing is kept then.
        """
        sent = {"files": [Path(file) for file in files]}
        if mapping is not None:
            sent["mapping"] = [Path(mapping)]
        answer = self._connection.send_files(
            "maneuvers", sent, aircraft_id=aircraft_id, confirmed="true" if confirmed else None
        )
        return json.loads(answer)["id"]

    # --- runs ---

    def submit(
        self, maneuver_id: int, method: str, modes: Iterable[int] | None = None, **choices: Any
    ) -> int:
        """Ask for a run and return its id at once.

        Parameters
        ----------
        maneuver_id
            Of which maneuver.
        method
            OE, FRE or EE.
        modes
            Numbers of the structural modes in the model; none at all is ``[]``. Where no
            structure is described, it is that of ``structure_id``, else the one that is
            proposed for the maneuver (approved, saved for its FTA, or the modes in its band).
        **choices
            Of the structure (``inputs``, ``outputs``, ``free``, ``fixed``, ``absent``,
            ``free_delays``, ``also_free`` ...), of the settings (``start``, ``band_hz``,
            ``noise``, ``priors``, ``prior_spread`` ...) and of the request (``structure_id``,
            ``modal_table_id``, ``prediction_id``, ``priority`` ...), as the interface names them.

        Raises
        ------
        RequestRefused
            If it cannot be estimated, or a choice is unknown.
        """
        structure = {name: choices.pop(name) for name in _STRUCTURE & choices.keys()}
        request = {name: choices.pop(name) for name in _REQUEST & choices.keys()}
        if modes is not None:
            structure["modes"] = list(modes)
        body = {
            "maneuver_id": maneuver_id,
            "method": method,
            "structure": structure or None,
            "settings": choices or None,
            **request,
        }
        return self.post("runs", body)["id"]

    def wait(
        self, *run_ids: int, timeout_s: float | None = None, show_progress: bool = True
    ) -> None:
        """Wait until runs have ended, with a progress bar on a terminal or in a notebook.

        Raises
        ------
        RunFailed
            If one did not succeed, after all have ended; the message says why.
        TimeoutError
            If they have not ended in time.
        """
        line = ProgressLine(show_progress)
        try:
            runs = until_ended(self._jobs, run_ids, timeout_s, line)
        finally:
            line.end()
        lost = [run for run in runs if run["state"] != "succeeded"]
        if lost:
            raise RunFailed("; ".join(map(why, lost)))

    def _jobs(self, run_ids: Sequence[int]) -> list[dict[str, Any]]:
        """How far runs are, with as few questions as addresses may be long."""
        found: dict[int, dict[str, Any]] = {}
        for first in range(0, len(run_ids), _AT_ONCE):
            part = run_ids[first : first + _AT_ONCE]
            items = self.get("jobs", ids=part, limit=_AT_ONCE)["items"]
            found |= {job["id"]: job for job in items}
        # One that there is not is asked for alone, and refused by its name.
        return [found.get(number) or self.run(number) for number in run_ids]

    def cancel(self, run_id: int) -> None:
        """Stop a run that has not ended."""
        self.post(f"jobs/{run_id}/cancel", None)

    def run(self, run_id: int) -> dict[str, Any]:
        """One run as the interface answers it: state, structure, settings, fit, poles."""
        return self.get(f"runs/{run_id}")

    def parameters(self, run_id: int) -> pandas.DataFrame:
        """Estimates of a run by name, with standard error and start."""
        return table(self.run(run_id)["parameters"], index="name")

    def covariance(self, run_id: int) -> pandas.DataFrame:
        """Covariance of a run's estimates, named on both sides."""
        exported = self.get(f"runs/{run_id}/export")
        result = exported["run"]["result"]
        if result is None:
            raise RunFailed(why(exported["run"]))
        return matrix(exported["covariance"], [part["name"] for part in result["parameters"]])

    def comparison(
        self, run_ids: Iterable[int], prediction_ids: Iterable[int] = ()
    ) -> pandas.DataFrame:
        """Derivatives side by side: a value and a standard error per source.

        Columns are pairs (source, ``value`` or ``std_error``); predictions also have
        ``difference_sigma``, their largest difference from a run in combined standard errors.
        The last column, ``max_difference_sigma``, is the largest difference between two runs.
        """
        predictions = list(prediction_ids) or None
        answer = self.get("comparisons", run_ids=run_ids, prediction_ids=predictions)
        return side_by_side(answer)

    def flutter(self, run_ids: Iterable[int], **query: Any) -> dict[str, Any]:
        """What runs say of the next test point: ``next_point`` and ``sentence`` in words, numbers.

        Parameters
        ----------
        run_ids
            Runs that succeeded, best over several airspeeds.
        **query
            ``fuel`` as a fraction, ``altitude_m``, ``next_m_s``, ``others`` and ``trend``, as the
            interface names them.
        """
        return self.get("flutter", run_ids=run_ids, **query)

    def closed_loop(
        self, run_ids: Iterable[int], controller_id: int, **query: Any
    ) -> dict[str, Any]:
        """Margins of a controller's loops around what runs identified, and where it loses them."""
        return self.get("closed-loop", run_ids=run_ids, controller_id=controller_id, **query)

    # --- models and figures ---

    def model(self, run_id: int) -> control.StateSpace:
        """Identified model at the condition of its maneuver, for python-control.

        Delays and scale factors of the outputs are not part of it; ``get("runs/1/model")``
        answers them with the units.
        """
        import control  # takes seconds to load

        found = self.get(f"runs/{run_id}/model")
        return control.StateSpace(
            *(found[name] for name in "ABCD"),
            states=found["states"],
            inputs=found["inputs"],
            outputs=found["outputs"],
        )

    def save_model(self, run_id: int, file: str | Path) -> None:
        """Write an identified model to a ``.mat`` or ``.json`` file."""
        form = Path(file).suffix.removeprefix(".")
        if form not in ("mat", "json"):
            raise BadInput(f"{file} ends in '.{form}'; expected .mat or .json")
        Path(file).write_bytes(self._connection.get(f"runs/{run_id}/model", {"format": form}))

    def save_report(
        self, file: str | Path, kind: str, number: int | None = None, **query: Any
    ) -> None:
        """Write a report to a ``.html`` or ``.pdf`` file.

        Parameters
        ----------
        file
            Its ending says the form.
        kind
            ``run``, ``comparison``, ``decision`` or ``campaign``.
        number
            Id of the run or decision.
        **query
            ``run_ids`` and ``prediction_ids`` of a comparison; filters of a campaign.
        """
        form = Path(file).suffix.removeprefix(".")
        if form not in ("html", "pdf"):
            raise BadInput(f"{file} ends in '.{form}'; expected .html or .pdf")
        path = f"reports/{kind}" if number is None else f"reports/{kind}/{number}"
        Path(file).write_bytes(self._connection.get(path, {**query, "format": form}))

    def figure(self, kind: str, **query: Any) -> Figure:
        """A figure as the page draws it, e.g. ``figure("bode", maneuver_id=1, output="q")``."""
        from plotly.graph_objects import Figure  # takes a while to load

        return Figure(self.get(f"figures/{kind}", **query))

    def numbers(self, kind: str, **query: Any) -> pandas.DataFrame:
        """Numbers of a figure: a row per point with curve, axes, x, y and error."""
        return read_csv(self._connection.get(f"figures/{kind}", {**query, "format": "csv"}))
