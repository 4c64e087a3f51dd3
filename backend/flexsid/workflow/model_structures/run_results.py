"""Results of runs, refused if they were altered."""

from __future__ import annotations

from flexsid.errors import Conflict
from flexsid.records.run import EstimationRun, RunResult
from flexsid.storage.event_chain import hash_value


def get_result(run: EstimationRun, use: str = "no model") -> RunResult:
    """Return the result of a run.

    Parameters
    ----------
    run
        The stored run.
    use
        What a run without a result lacks, for the message.

    Raises
    ------
    Conflict
        If it has none, or its stored result was altered.
    """
    refuse_altered(run)
    if run.result is None:
        raise Conflict(
            f"run {run.id} is {run.state.value} and has {use}; choose a run that succeeded",
            code="run-without-result",
            run_id=run.id,
        )
    return run.result


def refuse_altered(run: EstimationRun) -> None:
    """Refuse a run whose request or result was altered after it was stored.

    Raises
    ------
    Conflict
        If it was altered.
    """
    if run.altered:
        raise Conflict(
            f"the stored request or result of run {run.id} was altered after the run finished: it"
            " does not match the hash that was stored with it. Estimate again, or"
            " restore a backup; `flexsid check` lists all altered records",
            code="result-altered",
            run_id=run.id,
        )


def hash_run(run: EstimationRun) -> str:
    """Hash the request and the result of a run."""
    return hash_value(
        [run.method, run.maneuver_id, run.structure, run.settings, run.result, run.versions]
    )


def describe_data_changes(run_id: int | None, changed: tuple[str, ...]) -> str | None:
    """Describe changes of the data since a run was computed; None without changes."""
    if not changed:
        return None
    return (
        f"Data changed since run {run_id} was computed: {', '.join(changed)} (samples, corrections"
        " or assumptions). Its result is that of the earlier data; estimate again."
    )
