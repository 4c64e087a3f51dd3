"""Standard errors of transfer functions: ``python backend/benchmarks/transfer_functions.py``.

Known equivalent systems of pitch rate, angle of attack and pitch angle, simulated with scipy, with
every input of ``equivalent_systems``, 10 % noise of the output, and 0 and 10 % of the measured
surface, are imported and fitted with usual orders in the default band. One JSON line for each, and
one for all: how many of the draws hold gain, zero, frequency, damping and delay within two standard
errors, the median error of each over its standard error, and how many fits were refused. An
argument sets the number of draws of each, 200 by default.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "aircraft"))

from equivalent_systems import INPUTS, SYSTEMS, add_noise, fit, simulate

from flexsid.errors import FlexsidError
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store

OUTPUT_NOISE, SURFACE_NOISE = 0.1, (0.0, 0.1)


def main(draws: int) -> None:
    """Measure and print everything."""
    every: dict[str, list[float]] = defaultdict(list)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        url = f"sqlite:///{folder / 'flexsid.db'}"
        upgrade(url)
        store = Store.open(url)
        for system in SYSTEMS:
            for excitation in INPUTS:
                for surface in SURFACE_NOISE:
                    ratios, refused = measure(store, folder, (system, excitation), surface, draws)
                    case = f"{system}, {excitation}, {surface:.0%} of the surface"
                    print(json.dumps({"case": case, "refused": refused} | summarise(ratios)))
                    sys.stdout.flush()
                    for key, values in ratios.items():
                        every[key] += values
        store.close()
    print(json.dumps({"case": "all"} | summarise(every)))


def measure(
    store: Store, folder: Path, case: tuple[str, str], surface: float, draws: int
) -> tuple[dict[str, list[float]], int]:
    """Return errors over their standard errors by parameter, and the number of refused fits."""
    system, excitation = SYSTEMS[case[0]], case[1]
    clean = simulate(system, excitation)
    ratios: dict[str, list[float]] = defaultdict(list)
    refused = 0
    for seed in range(draws):
        columns = add_noise(clean, OUTPUT_NOISE, surface, np.random.default_rng(seed))
        label = f"{case} {surface} {seed}".replace('"', "")
        try:
            pairs = system.pair(fit(store, folder, system, excitation, columns, label))
        except (FlexsidError, ValueError):  # or other roots than those of the system
            refused += 1
            continue
        for key, error, std in pairs:
            ratios[key].append(error / std)
    return ratios, refused


def summarise(ratios: dict[str, list[float]]) -> dict[str, object]:
    """Summarise errors over their standard errors."""
    inside = {key: float(np.mean(np.abs(values) < 2.0)) for key, values in ratios.items()}
    return {
        "inside": round(float(np.mean(list(inside.values()))), 3),
        **{key: round(share, 3) for key, share in inside.items()},
        "median": {key: round(float(np.median(values)), 2) for key, values in ratios.items()},
    }


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
