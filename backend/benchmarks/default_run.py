"""How much of a default run is its maximisation: ``python backend/benchmarks/default_run.py``.

Five maneuvers of FLEX-28 (FTA 506 at 0.56 to 1.09 of the flutter speed) are estimated by every
method with two and four free modes and default settings. One JSON line per method and number of
modes: the processor time of a run, from its request through its preparation to its stored result,
over that of the maximisations of the likelihood by output error of the same maneuver and modes, or
by frequency-response error for its own runs. Then all methods of one maneuver, requested one after
the other, over the one of output error. One BLAS thread, one process; medians of five maneuvers.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from estimation import report_result

from flexsid.demo.campaign import add_aircraft, add_maneuver
from flexsid.demo.flights import fly
from flexsid.jobs.dispatcher import execute_run
from flexsid.jobs.kinds import RUN
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Flight
from flexsid.records.run import EstimationRun, Method, RunSettings
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.estimation import likelihood
from flexsid.workflow.runs.run_proposal import attach_proposal_basis

CONDITIONS = ((0.56, 0.86), (0.65, 0.74), (0.80, 0.50), (0.95, 0.12), (1.09, 0.50))
"""Airspeed over that of flutter, and fuel fraction."""

MODES = ((7, 9), (7, 9, 11, 12))


class Stopwatch:
    """Processor time of all calls of a function. [s]"""

    def __init__(self) -> None:
        self.seconds = 0.0

    @contextmanager
    def timing(self, owner: Any, name: str) -> Iterator[None]:
        """Add the time of the calls of a function of ``owner`` within the context."""
        whole: Callable[..., Any] = getattr(owner, name)

        def timed(*args: Any, **options: Any) -> Any:
            began = time.process_time()
            try:
                return whole(*args, **options)
            finally:
                self.seconds += time.process_time() - began

        setattr(owner, name, timed)
        try:
            yield
        finally:
            setattr(owner, name, whole)


def execute(
    store: Store, maneuver_id: int, method: Method, modes: tuple[int, ...]
) -> tuple[float, float]:
    """Execute a default run; return the time of the whole and of its maximisations. [s]"""
    requested = EstimationRun(
        maneuver_id=maneuver_id,
        method=method,
        structure=Structure(modes=modes, fixed={}),
        settings=RunSettings(),
    )
    stopwatch = Stopwatch()
    with stopwatch.timing(likelihood._Problem, "run"):
        began = time.process_time()
        run = execute_run(store, attach_proposal_basis(store, requested), RUN, lambda _: None)
        whole = time.process_time() - began
    assert run.result is not None, run.error
    return whole, stopwatch.seconds


def main() -> None:
    """Measure and print everything."""
    with TemporaryDirectory() as folder:
        url = f"sqlite:///{Path(folder) / 'runs.db'}"
        upgrade(url)
        store = Store.open(url)
        aircraft = add_aircraft(store)
        flight = store.flights.add(Flight(aircraft_id=aircraft.id or 0, number=1))
        maneuvers = []
        for number, (ratio, fuel) in enumerate(CONDITIONS):
            flown = fly(
                airspeed_ratio=ratio, fuel=fuel, seed=(5, number), label=f"{ratio:.2f} of flutter"
            )
            maneuvers.append(add_maneuver(store, flown, flight.id or 0).id or 0)
        execute(store, maneuvers[0], Method.FRE, MODES[0])  # loads what every run needs
        for modes in MODES:
            print_runs(store, maneuvers, modes)
        store.close()


def print_runs(store: Store, maneuvers: list[int], modes: tuple[int, ...]) -> None:
    """Print the ratios of all methods with these modes."""
    times = {
        method: [execute(store, maneuver, method, modes) for maneuver in maneuvers]
        for method in (Method.OE, Method.FRE, Method.EE)
    }
    for method, runs in times.items():
        of_likelihood = times[Method.OE if method is Method.EE else method]
        pairs = list(zip(runs, of_likelihood, strict=True))
        report_result(
            f"default_{method.value.lower()}_run_{len(modes)}_modes",
            statistics.median(whole / own for (whole, _), (_, own) in pairs),
            "the maximisations of its likelihood",
            largest=max(whole / own for (whole, _), (_, own) in pairs),
            run_s=statistics.median(whole for whole, _ in runs),
            maximisations_s=statistics.median(own for _, (_, own) in pairs),
        )
    sums = [sum(run[0] for run in each) for each in zip(*times.values(), strict=True)]
    report_result(
        f"three_methods_{len(modes)}_modes",
        statistics.median(
            all_of_them / one for all_of_them, (one, _) in zip(sums, times[Method.OE], strict=True)
        ),
        "one run of output error",
        run_s=statistics.median(sums),
    )


if __name__ == "__main__":
    main()
