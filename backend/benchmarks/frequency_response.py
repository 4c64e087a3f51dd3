"""Quality and speed of frequency responses: ``python backend/benchmarks/frequency_response.py``.

Flies FLEX-28 without noise and compares the bare-airframe responses of all outputs at
all own harmonics with the equations it was flown by; then with noise, for the share of
points within two standard errors; then times the transform against a plain loop.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from flexsid.demo.flights import fly
from flexsid.storage.migrate import upgrade
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.fourier import compute_harmonic_frequencies, finite_fourier_transform

sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "aircraft"))
from true_responses import (
    compute_open_loop_ratios,
    compute_relative_errors,
    save_and_measure,
)

N_CHANNELS, N_SAMPLES, N_FREQUENCIES, RATE_HZ = 80, 6000, 65, 200.0


def coverage(responses: dict[str, FrequencyResponse], ratio: float) -> float:
    """Share of magnitudes within two standard errors of the truth."""
    error = compute_relative_errors(responses, ratio)
    relative = [
        (r.std / np.abs(r.values))[:, :, 0].ravel() for r in responses.values() if r.std is not None
    ]
    sigma = np.concatenate(relative) * np.abs(1.0 + error) / np.sqrt(2.0)
    return float(np.mean(np.abs(np.abs(1.0 + error) - 1.0) <= 2.0 * sigma))


def best_time(work: Callable[[], object], repeats: int = 7) -> float:
    """Shortest of several times. [s]"""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def transform_times() -> tuple[float, float]:
    """Ours, and a plain loop over the frequencies. [s]"""
    samples = np.random.default_rng(0).standard_normal((N_SAMPLES, N_CHANNELS))
    omega = compute_harmonic_frequencies(np.arange(6, 6 + N_FREQUENCIES), N_SAMPLES / RATE_HZ)
    time_s = np.arange(N_SAMPLES) / RATE_HZ

    def plain_loop() -> np.ndarray:
        return np.stack([np.exp(-1j * w * time_s) @ samples / RATE_HZ for w in omega])

    found = finite_fourier_transform(samples, RATE_HZ, omega)
    assert np.allclose(found, plain_loop(), atol=1e-9)
    ours = best_time(lambda: finite_fourier_transform(samples, RATE_HZ, omega))
    return ours, best_time(plain_loop, 3)


def main() -> None:
    """Print one figure per line."""
    with TemporaryDirectory() as folder:
        address = f"sqlite:///{folder}/benchmark.db"
        upgrade(address)
        store = Store.open(address)
        for ratio, peak_deg in ((0.65, 2.0), (1.09, 1.2)):
            quiet = fly(airspeed_ratio=ratio, peak_deg=peak_deg, noise=False)
            measured = save_and_measure(store, quiet)
            found = np.median(np.abs(compute_relative_errors(measured.responses, ratio)))
            own = compute_open_loop_ratios(measured)
            naive = np.median(np.abs(compute_relative_errors(own, ratio)))
            noisy = save_and_measure(store, fly(airspeed_ratio=ratio, peak_deg=peak_deg, seed=1))
            report_result(f"median_error_{ratio:.2f}", found, outputs=len(measured.outputs.names))
            report_result(f"own_harmonics_ratio_{ratio:.2f}", naive, times_as_much=naive / found)
            report_result(f"coverage_{ratio:.2f}", coverage(noisy.responses, ratio))
        store.close()
    ours, loop = transform_times()
    size = f"{N_CHANNELS} channels, {N_SAMPLES} samples, {N_FREQUENCIES} frequencies"
    line = {
        "name": "transform_vs_loop",
        "ratio": loop / ours,
        "baseline": f"one frequency at a time; {size}",
    }
    print(json.dumps({**line, "ours_ms": 1e3 * ours, "baseline_ms": 1e3 * loop}))


def report_result(name: str, value: float, **more: float) -> None:
    """One JSON line."""
    print(json.dumps({"name": name, "value": float(f"{value:.4g}"), **more}))


if __name__ == "__main__":
    main()
