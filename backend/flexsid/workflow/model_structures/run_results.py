"""Results: what a run gave, for whoever goes on with it; never one that was altered."""

from __future__ import annotations

from flexsid.errors import Conflict
from flexsid.records.run import EstimationRun, RunResult


def result_of(run: EstimationRun, use: str = "no model") -> RunResult:
    """The result of a run.

    Parameters
    ----------
    run
        As it is kept.
    use
        What a run without a result has not, for the message.

    Raises
    ------
    Conflict
        If it has none, or the one it has is not what the run gave.
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
    """Refuse a run that is not any more what it was when its result was kept.

    Raises
    ------
    Conflict
        Naming the run.
    """
    if run.altered:
        raise Conflict(
            f"the stored result of run {run.id}, or what was asked for, was altered after the run"
            " finished: it does not match the hash that was kept with it. Estimate again, or"
            " restore a backup; `flexsid check` lists all that is damaged",
            code="result-altered",
            run_id=run.id,
        )


def note_changes(run_id: int | None, changed: tuple[str, ...]) -> str | None:
    """Say that data were corrected since a run was computed; None where they were not."""
    if not changed:
        return None
    return (
        f"Data changed since run {run_id} was computed: {', '.join(changed)} (samples, corrections"
        " or what is assumed). Its result is that of the earlier data; estimate again."
    )
