"""How low and how fast the peak factors of multisines get, against a simplex search.

    python tests/benchmarks/excitation.py

prints one JSON line per figure: all inputs of the 24 designs of Table 1, one
process, one BLAS thread, CPU time. The baseline is scipy's Nelder-Mead from
Schroeder phases with 200 iterations per phase, its peak factor taken from one
real transform per trial on 20 points per shortest period, the paper's ratio of analysis
rate to bandwidth (on 8, as "coarse", it is faster and worse). All results are judged
on 32 points with peaks between them.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import time
from collections.abc import Callable

import numpy as np
from scipy import fft, optimize

from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.extrema import evaluate_peak_factor
from flexsid.sysid.excitation.norms import HarmonicSpectrum
from flexsid.sysid.excitation.peak_factor import schroeder_phases
from flexsid.sysid.excitation.phase_search import PATIENT, QUICK, THOROUGH, Effort, search_phases

FIRST = 6


def build_spectra() -> list[HarmonicSpectrum]:
    """Harmonics of all inputs of the catalogue."""
    return [
        HarmonicSpectrum(own, np.full(own.size, np.sqrt(2.0 / own.size)))
        for aid in CATALOGUE.values()
        for own in aid.harmonics(FIRST).values()
    ]


def nelder_mead(spectrum: HarmonicSpectrum, points: int = 20) -> np.ndarray:
    """Simplex search, as the field does it."""
    n_samples = int(fft.next_fast_len(points * int(spectrum.harmonics.max()), real=True))
    transform = np.zeros(n_samples // 2 + 1, dtype=complex)
    gain = -0.5j * n_samples * spectrum.amplitudes

    def factor(phases: np.ndarray) -> float:
        transform[spectrum.harmonics] = gain * np.exp(1j * phases)
        samples = fft.irfft(transform, n_samples)
        return float(samples.max() - samples.min())

    n = spectrum.harmonics.size
    found = optimize.minimize(
        factor,
        schroeder_phases(spectrum.amplitudes),
        method="Nelder-Mead",
        options={"maxiter": 200 * n, "maxfev": 10**9},
    )
    return found.x


def measure(
    design: Callable[[HarmonicSpectrum], np.ndarray], inputs: list[HarmonicSpectrum]
) -> dict[str, float]:
    """CPU seconds and the mean of the judged peak factors."""
    begin = time.process_time()
    phases = [design(spectrum) for spectrum in inputs]
    seconds = time.process_time() - begin
    factors = [evaluate_peak_factor(*pair) for pair in zip(inputs, phases, strict=True)]
    return {
        "cpu_s": round(seconds, 3),
        "mean_rpf": round(float(np.mean(factors)), 4),
        "max_rpf": round(float(np.max(factors)), 4),
    }


def search(effort: Effort) -> Callable[[HarmonicSpectrum], np.ndarray]:
    """The workbench's search with one effort and one seed."""
    return lambda spectrum: search_phases(spectrum, effort, seed=0).phases


def best_of_65(sequences: int = 10) -> dict[str, object]:
    """Best peak factor of 65 interleaved harmonics in half of Nelder-Mead's time.

    One sequence of seeds may be lucky: each of ten has half of the baseline's time.
    """
    spectrum = HarmonicSpectrum(FIRST + 5 * np.arange(65), np.full(65, np.sqrt(2.0 / 65)))
    simplex = measure(nelder_mead, [spectrum])
    found = [_best_within(spectrum, 0.5 * simplex["cpu_s"], 1000 * k) for k in range(sequences)]
    factors = np.array([factor for factor, _, _ in found])
    return {
        "name": "n65_best",
        "rpf": round(float(np.median(factors)), 5),
        "worst_rpf": round(float(factors.max()), 5),
        "best_rpf": round(float(factors.min()), 5),
        "sequences_within_bar": int(np.sum(factors <= 1.071)),
        "sequences": sequences,
        "searches": round(float(np.mean([searches for _, searches, _ in found])), 1),
        "cpu_s": round(float(np.mean([spent for _, _, spent in found])), 3),
        "ratio": round(simplex["cpu_s"] / float(np.mean([spent for _, _, spent in found])), 2),
        "baseline": simplex,
        "bar": "rpf (median of the sequences) <= 1.071 in half of the baseline's time",
    }


def _best_within(spectrum: HarmonicSpectrum, seconds: float, seed: int) -> tuple[float, int, float]:
    """Best peak factor, searches made and CPU seconds of one sequence of seeds."""
    best, spent, searches = np.inf, 0.0, 0
    while True:
        begin = time.process_time()
        found = search_phases(spectrum, PATIENT, seed + searches)
        took = time.process_time() - begin
        if spent + took > seconds:
            return float(best), searches, spent
        best, spent, searches = min(best, found.peak_factor), spent + took, searches + 1


def main() -> None:
    """Measure and print."""
    inputs = build_spectra()
    quick = measure(search(QUICK), inputs)
    thorough = measure(search(THOROUGH), inputs)
    print(json.dumps({"name": "schroeder", **measure(_schroeder, inputs)}), flush=True)
    simplex = measure(nelder_mead, inputs)
    coarse = measure(lambda spectrum: nelder_mead(spectrum, 8), inputs)
    for name, mine, bar in (
        ("table1_vs_nelder_mead", thorough, "ratio >= 3, mean_rpf <= 1.085"),
        ("quick_vs_nelder_mead", quick, "ratio >= 30 at a lower mean_rpf"),
    ):
        line = {
            "name": name,
            "inputs": len(inputs),
            "ratio": round(simplex["cpu_s"] / mine["cpu_s"], 2),
            **mine,
            "baseline": simplex,
            "coarse_baseline": coarse,
            "bar": bar,
        }
        print(json.dumps(line), flush=True)
    print(json.dumps(best_of_65()), flush=True)


def _schroeder(spectrum: HarmonicSpectrum) -> np.ndarray:
    return schroeder_phases(spectrum.amplitudes)


if __name__ == "__main__":
    main()
