"""Before the next flight, from the command line: design an excitation, foretell flutter."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.cli.opening import opened
from flexsid.cli.runs import numbers
from flexsid.cli.saying import say, write_file
from flexsid.errors import BadInput
from flexsid.importers import confined
from flexsid.records.excitation import ExcitationDesign
from flexsid.settings import Settings
from flexsid.sysid.excitation import designer
from flexsid.workflow.excitation.excitation_designs import (
    MEDIA,
    check_amplitudes,
    export_design,
    row_of,
    wish_for,
)
from flexsid.workflow.excitation.imported_multisines import flown_inputs
from flexsid.workflow.excitation.imported_multisines import keep_flown as keep_flown_inputs
from flexsid.workflow.excitation.target_modes import band_of
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, Others, flutter

_T_S = 24.0  # period of the rows of one T
_LEVELS = (0.5, 1.0, 2.0)  # of the medium amplitude


def design(chosen: argparse.Namespace) -> int:
    """Design a row of Table 1 and write its medium amplitude; the ending says the form."""
    output = Path(chosen.output)
    form = output.suffix.removeprefix(".")
    if form not in MEDIA:
        raise BadInput(
            f"--output ends in '{output.suffix}'; expected one of "
            f"{', '.join(f'.{ending}' for ending in MEDIA)}"
        )
    low, medium, high = (float(np.deg2rad(level * chosen.peak_deg)) for level in _LEVELS)
    wish = wish_for(
        chosen.fta,
        chosen.duration or _T_S * row_of(chosen.fta).periods,
        chosen.rate,
        chosen.first_harmonic,
        (low, medium, high),
        chosen.effort,
        chosen.seed,
    )
    check_amplitudes(wish)
    made = designer.design(wish, _show)
    kept = ExcitationDesign(
        name=f"FTA {chosen.fta}",
        wish=wish,
        phases={name: tuple(tones.phases.tolist()) for name, tones in made.tones.items()},
        peak_factors=designer.peak_factors(made),
        fta=chosen.fta,
    )
    write_file(output, export_design(kept, form, 1))
    band, targets = band_of(wish), row_of(chosen.fta).targets
    lines = [
        f"{name:<10} relative peak factor {one:.4f}" for name, one in kept.peak_factors.items()
    ]
    lines.append(f"harmonics from {band[0]:.3g} to {band[1]:.4g} Hz for {targets}")
    result = {"file": chosen.output, "peak_factors": kept.peak_factors, "band_hz": band}
    say(lines, result, as_json=chosen.json)
    return 0


def keep_flown(settings: Settings, chosen: argparse.Namespace) -> int:
    """Recognise multisines that were flown, keep them, and print what they are."""
    paths = [Path(name) for name in chosen.files]
    inputs = flown_inputs(confined.read_all(paths), chosen.unit)
    with opened(settings) as store:
        kept = keep_flown_inputs(
            store, inputs, chosen.name or paths[0].stem, chosen.rate, apart=chosen.apart
        )
    say((line for one in kept for line in _described(one)), kept, as_json=chosen.json)
    return 0


def _described(design: ExcitationDesign) -> Iterator[str]:
    wish = design.wish
    yield f"design {design.id}: {design.name}, {wish.duration_s:g} s at {wish.rate_hz:g} Hz"
    for own in wish.inputs:
        hz = np.array(own.harmonics) / wish.duration_s
        yield (
            f"  {own.name:<20} {len(own.harmonics):3d} harmonics, {hz.min():.3g} to"
            f" {hz.max():.3g} Hz, relative peak factor {design.peak_factors[own.name]:.4f}"
        )


def foretell(settings: Settings, chosen: argparse.Namespace) -> int:
    """Print where runs see the aircraft lose stability."""
    if chosen.next is not None and not chosen.next > 0.0:
        raise BadInput(f"--next is {chosen.next:g}; expected an airspeed above zero [m/s]")
    question = FlutterQuery(
        run_ids=tuple(numbers(chosen.runs, int, "RUNS")),
        fuel=chosen.fuel,
        altitude_m=chosen.altitude,
        next_m_s=chosen.next,
        others=Others(chosen.others),
    )
    with opened(settings) as store:
        answer = flutter(store, question)
    lines = [answer.next_point, answer.sentence]
    for structure in answer.structures:
        lines.append(f"modes {' '.join(map(str, structure.modes))}: {structure.sentence}")
    say(lines, answer, as_json=chosen.json)
    return 0


def _show(name: str, best: float, fraction: float) -> None:
    if sys.stderr.isatty():
        print(f"\r{100 * fraction:3.0f}% {name} at {best:.4f}", end="", file=sys.stderr, flush=True)
