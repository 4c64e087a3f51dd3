"""Commands for flight test planning: multisine designs and flutter prediction."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.cli.database import open_store
from flexsid.cli.output import print_result, write_file
from flexsid.cli.runs import parse_list
from flexsid.errors import BadInput
from flexsid.importers import sandbox
from flexsid.records.excitation import ExcitationDesign
from flexsid.settings import Settings
from flexsid.sysid.excitation import designer
from flexsid.workflow.excitation.excitation_designs import (
    MEDIA,
    check_amplitudes,
    export_design,
    find_flight_test_aid,
    specify_design,
)
from flexsid.workflow.excitation.imported_multisines import recognise_inputs, save_designs
from flexsid.workflow.excitation.target_modes import find_band
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, UnmodelledModes, analyse_flutter

_T_S = 24.0  # period of the rows of one T
_LEVELS = (0.5, 1.0, 2.0)  # of the medium amplitude


def design(arguments: argparse.Namespace) -> int:
    """Design the multisine of a row of Table 1 and write it at medium amplitude."""
    output = Path(arguments.output)
    form = output.suffix.removeprefix(".")
    if form not in MEDIA:
        raise BadInput(
            f"--output ends in '{output.suffix}'; expected one of "
            f"{', '.join(f'.{ending}' for ending in MEDIA)}"
        )
    low, medium, high = (float(np.deg2rad(level * arguments.peak_deg)) for level in _LEVELS)
    specification = specify_design(
        arguments.fta,
        arguments.duration or _T_S * find_flight_test_aid(arguments.fta).periods,
        arguments.rate,
        arguments.first_harmonic,
        (low, medium, high),
        arguments.effort,
        arguments.seed,
    )
    check_amplitudes(specification)
    multisine = designer.design(specification, _show_progress)
    excitation = ExcitationDesign(
        name=f"FTA {arguments.fta}",
        specification=specification,
        phases={name: tuple(tones.phases.tolist()) for name, tones in multisine.tones.items()},
        peak_factors=designer.compute_peak_factors(multisine),
        fta=arguments.fta,
    )
    write_file(output, export_design(excitation, form, 1))
    band, targets = find_band(specification), find_flight_test_aid(arguments.fta).targets
    lines = [
        f"{name:<10} relative peak factor {one:.4f}"
        for name, one in excitation.peak_factors.items()
    ]
    lines.append(f"harmonics from {band[0]:.3g} to {band[1]:.4g} Hz for {targets}")
    result = {"file": arguments.output, "peak_factors": excitation.peak_factors, "band_hz": band}
    print_result(lines, result, as_json=arguments.json)
    return 0


def import_flown(settings: Settings, arguments: argparse.Namespace) -> int:
    """Identify flown multisines, store them as designs, and print them."""
    paths = [Path(name) for name in arguments.files]
    inputs = recognise_inputs(sandbox.read_all(paths), arguments.unit)
    with open_store(settings) as store:
        designs = save_designs(
            store,
            inputs,
            arguments.name or paths[0].stem,
            arguments.rate,
            separate=arguments.separate,
        )
    print_result(
        (line for one in designs for line in _describe_design(one)), designs, as_json=arguments.json
    )
    return 0


def _describe_design(design: ExcitationDesign) -> Iterator[str]:
    specification = design.specification
    yield (
        f"design {design.id}: {design.name}, {specification.duration_s:g} s"
        f" at {specification.rate_hz:g} Hz"
    )
    for own in specification.inputs:
        hz = np.array(own.harmonics) / specification.duration_s
        yield (
            f"  {own.name:<20} {len(own.harmonics):3d} harmonics, {hz.min():.3g} to"
            f" {hz.max():.3g} Hz, relative peak factor {design.peak_factors[own.name]:.4f}"
        )


def print_flutter_prediction(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the predicted flutter speed and the margin of the next test point."""
    if arguments.next is not None and not arguments.next > 0.0:
        raise BadInput(f"--next is {arguments.next:g}; expected an airspeed above zero [m/s]")
    query = FlutterQuery(
        run_ids=tuple(parse_list(arguments.runs, int, "RUNS")),
        fuel=arguments.fuel,
        altitude_m=arguments.altitude,
        next_m_s=arguments.next,
        unmodelled_modes=UnmodelledModes(arguments.others),
    )
    with open_store(settings) as store:
        prediction = analyse_flutter(store, query)
    lines = [prediction.test_point_margin, prediction.sentence]
    for structure in prediction.structures:
        lines.append(f"modes {' '.join(map(str, structure.modes))}: {structure.sentence}")
    print_result(lines, prediction, as_json=arguments.json)
    return 0


def _show_progress(name: str, best: float, fraction: float) -> None:
    if sys.stderr.isatty():
        print(f"\r{100 * fraction:3.0f}% {name} at {best:.4f}", end="", file=sys.stderr, flush=True)
