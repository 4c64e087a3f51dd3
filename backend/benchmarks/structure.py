"""How fast structures are searched, as ratios measured in one run.

    python backend/benchmarks/structure.py

prints one JSON line per figure. One BLAS thread, one process.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import time
from dataclasses import replace

import numpy as np
from estimation import as_experiment, fit, free_all, make_problem, report_result, timed

from flexsid.demo.flex28 import load_truth
from flexsid.sysid.estimation.likelihood import maximize
from flexsid.sysid.structure_determination.evidence import (
    SubsetEstimate,
    compute_evidence,
    estimate_subset,
)
from flexsid.sysid.structure_determination.selection import (
    SelectionState,
    Thresholds,
    select_candidates,
    select_terms,
)


def main() -> None:
    """Measure and print everything."""
    print_single_changes()
    print_search()


def print_single_changes() -> None:
    """Every single change of a 90-parameter output-error model, against fits of it."""
    problem, table = make_problem(load_truth(), n_modes=4, n_frequencies=65)
    parameters = free_all(problem, problem.start)
    experiment = as_experiment(problem)
    estimate, fit_s = timed(lambda: fit(problem, parameters), repeat=21)
    everything = np.ones(parameters.start.size, dtype=bool)

    def judge() -> SubsetEstimate:
        n_data = 2.0 * experiment.measured.size
        evidence = compute_evidence(estimate, estimate.names, n_data)
        return estimate_subset(evidence, everything)

    now, seconds = timed(judge, repeat=21)
    partial_f = now.values**2 / now.variance
    began = time.process_time()
    ratios = []
    for term in range(parameters.start.size):
        free = everything.copy()
        free[term] = False
        fewer = maximize([experiment], select_candidates(parameters, free, estimate.values))
        ratios.append(2.0 * (fewer.steps[-1].cost - estimate.steps[-1].cost))
    refits_s = time.process_time() - began
    weak = partial_f < 1e3  # where the choice is made; stronger terms leave the quadratic
    agreement = np.array(ratios)[weak] / now.change[weak]
    report_result(
        "single_changes_vs_fit",
        seconds / fit_s,
        "one converged fit",
        all_changes_ms=1e3 * seconds,
        fit_ms=1e3 * fit_s,
        refitting_each_vs_fit=refits_s / fit_s,
        parameters=table.values.size,
        likelihood_ratio_over_predicted=float(np.median(agreement)),
    )


def print_search() -> None:
    """A whole search from all 90 terms, 30 of them absent, against one fit of all."""
    problem, table = make_problem(load_truth(), n_modes=4, n_frequencies=325)
    rng = np.random.default_rng(3)
    values = table.values.ravel().copy()
    absent = rng.choice(values.size, 30, replace=False)
    values[absent] = 0.0
    truth = free_all(problem, values)
    y = problem.model.response(truth.base, problem.omega) @ problem.inputs[:, :, None]
    y = y[:, :, 0] * problem.instrument(1j * problem.omega[:, None])
    level = 0.01 * np.sqrt(np.mean(np.abs(y) ** 2, axis=0) / 2.0)
    z = y + level * (rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape))
    problem = replace(problem, measured=z)
    parameters = free_all(problem, problem.start)
    _, fit_s = timed(lambda: fit(problem, parameters), repeat=5)
    experiment = as_experiment(problem)

    def search() -> SelectionState:
        full = maximize([experiment], parameters)
        evidence = compute_evidence(full, full.names, 2.0 * experiment.measured.size)
        everything = np.ones(values.size, dtype=bool)
        return select_terms([evidence], SelectionState(everything), Thresholds())

    found, seconds = timed(search, 5)
    expected = {parameters.names[i] for i in range(values.size) if i not in absent}
    report_result(
        "structure_search_vs_fit",
        seconds / fit_s,
        "one converged fit with all terms",
        search_ms=1e3 * seconds,
        fit_ms=1e3 * fit_s,
        wrong_terms=len(expected ^ {parameters.names[k] for k in np.flatnonzero(found.selected)}),
    )


if __name__ == "__main__":
    main()
