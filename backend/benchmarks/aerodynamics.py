"""Speed and memory of unsteady aerodynamics: ``python backend/benchmarks/aerodynamics.py``.

``aic_vs_panelaero`` needs ``pip install panelaero==2025.8``. Ratios are of one process, in which
both sides take turns; each side is the fastest of its repetitions. Prints one JSON line per figure.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import importlib
import json
import multiprocessing
import resource
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from estimation import gauss_newton_step, make_problem

from flexsid.cli.models import read_planform
from flexsid.demo.flex28 import load_truth
from flexsid.sysid.aerodynamics.boxes import Boxes, Panel, mesh_panels
from flexsid.sysid.aerodynamics.coefficients import compute_coefficients
from flexsid.sysid.aerodynamics.doublet_lattice import Symmetry, compute_influence
from flexsid.sysid.aerodynamics.splines import BoxShapes, Reference
from flexsid.sysid.model.frequency_shape import build_frequency_shape

PLANFORM = Path(__file__).parents[2] / "examples" / "flex28" / "planform.toml"
MM = 1000.0  # of a metre: PanelAero omits bound vortices nearer than 1e-5 in any unit
MACH, WAVE_NUMBER = 0.1, 0.3 / (0.558 * MM)  # omega/V of k = 0.3 on FLEX-28 [1/mm]
AGREEMENT = 1e-9
LARGE_MESH = 11, 3  # boxes along the chord, and factor on the strips: 1320 boxes


def print_figure(name: str, **values: Any) -> None:
    print(json.dumps({"figure": name, **values}), flush=True)


def mesh(chordwise: int, along: int) -> Boxes:
    """FLEX-28 in mm with so many boxes along the chord, and its strips divided by a factor."""
    panels = [
        Panel(
            one.left,
            one.left_chord,
            one.right,
            one.right_chord,
            np.linspace(0.0, 1.0, chordwise + 1),
            np.linspace(0.0, 1.0, one.spanwise * along + 1),
        ).scale(MM)
        for one in read_planform(PLANFORM).panels
    ]
    return mesh_panels(panels)


def time_in_turns(*calls: Callable[[], Any], repetitions: int = 3) -> list[float]:
    """Shortest processor time of each call; they take turns."""
    times = np.full(len(calls), np.inf)
    for _ in range(repetitions):
        for index, call in enumerate(calls):
            begun = time.process_time()
            call()
            times[index] = min(times[index], time.process_time() - begun)
    return times.tolist()


def build_grid(half: Boxes) -> dict[str, Any]:
    """The whole aircraft in the form of PanelAero; first the left half, from tip to root."""
    other = half.mirrored()
    corners = np.concatenate([half.corners, other.corners])
    boxes = Boxes(corners, np.tile(half.panel, 2), np.concatenate([half.strip, half.strip + 1000]))
    chord = corners[:, [1, 2]].mean(axis=1) - corners[:, [0, 3]].mean(axis=1)
    return {
        "n": len(boxes),
        "A": boxes.chord * boxes.span,
        "l": chord[:, 0],
        "N": boxes.normal,
        "offset_l": boxes.load,
        "offset_j": boxes.control,
        "offset_k": corners.mean(axis=1),
        "offset_P1": boxes.vortex_left,
        "offset_P3": boxes.vortex_right,
        "r": 0.5 * (boxes.vortex_right - boxes.vortex_left),
    }


def compare_with_panelaero() -> None:
    try:
        DLM, VLM = (importlib.import_module(f"panelaero.{name}") for name in ("DLM", "VLM"))
    except ImportError:
        print_figure("aic_vs_panelaero", skipped="pip install panelaero==2025.8")
        return
    half = mesh(8, 1)
    grid, n = build_grid(half), len(half)

    def compute_own() -> list[np.ndarray]:
        return [
            compute_influence(half, MACH, WAVE_NUMBER, one)
            for one in (Symmetry.SYMMETRIC, Symmetry.ANTISYMMETRIC)
        ]

    def compute_other() -> np.ndarray:
        unsteady = DLM.calc_Ajj(grid, MACH, WAVE_NUMBER)
        # VLM.calc_Ajj stretches its arguments in place.
        copied = {name: np.copy(value) for name, value in grid.items()}
        return -(VLM.calc_Ajj(copied, MACH)[0] + unsteady)

    whole = compute_other()
    expected = whole[:n, :n] + whole[:n, n:]
    own = compute_own()
    difference = float(np.abs(own[0] - expected).max() / np.abs(expected).max())
    one, both, theirs = time_in_turns(
        lambda: compute_influence(half, MACH, WAVE_NUMBER, Symmetry.SYMMETRIC),
        compute_own,
        compute_other,
    )
    print_figure(
        "aic_vs_panelaero",
        boxes_of_half=n,
        ratio=round(theirs / one, 2),
        ratio_both_symmetries=round(theirs / both, 2),
        difference=difference,
        same=difference < AGREEMENT,
        bar=5.0,
    )


def measure_large_mesh(n_k: int = 12) -> None:
    """Time and peak memory of a process that computes coefficients of a large mesh."""
    boxes = mesh(*LARGE_MESH)
    k = np.linspace(0.0, 1.1, n_k)
    reference = Reference(8.24 * MM**2, 1.117 * MM, 8.5 * MM, np.array([1.5 * MM, 0.0, 0.0]))
    shapes = BoxShapes(*(np.zeros((0, len(boxes))) for _ in range(3)))
    begun = time.process_time()
    compute_coefficients(boxes, shapes, [], reference, mach=MACH, symmetry=Symmetry.SYMMETRIC, k=k)
    print_figure(
        "large_mesh",
        boxes_of_half=len(boxes),
        reduced_frequencies=n_k,
        seconds=round(time.process_time() - begun, 1),
        memory_mb=round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0),
        bar_seconds=120,
        bar_mb=1000,
    )


def compare_iterations() -> None:
    """One Gauss-Newton iteration with a frequency shape against one without."""
    truth = load_truth()
    for n_modes, n_frequencies in ((2, 325), (4, 650)):
        problem, table = make_problem(truth, n_modes, n_frequencies)
        model = problem.model
        k = np.linspace(0.0, 2.0, 20)
        lag = 1.0 - 0.3j * k / (1j * k + 0.3)
        predicted = dict.fromkeys(model.derivative_names, lag)
        shape = build_frequency_shape(table.modes, model.inputs, k, predicted, 0.15)
        shaped = replace(problem, model=replace(model, shape=shape))
        steps = gauss_newton_step(problem), gauss_newton_step(shaped)
        quasi_steady_s, shaped_s = time_in_turns(*steps, repetitions=15)
        print_figure(
            "shaped_iteration",
            modes=n_modes,
            frequencies=n_frequencies,
            ratio=round(shaped_s / quasi_steady_s, 2),
            bar=2.0,
        )


if __name__ == "__main__":
    compare_with_panelaero()
    compare_iterations()
    process = multiprocessing.get_context("spawn").Process(target=measure_large_mesh)
    process.start()
    process.join()
