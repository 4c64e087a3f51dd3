"""Commands ``flexsid design``, ``optimal-design`` and ``import-multisine``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexsid.cli.administration import open_store
from flexsid.cli.options import read_options
from flexsid.cli.output import print_result, show_progress, write_file
from flexsid.cli.runs import compute_result
from flexsid.errors import BadInput
from flexsid.importers import sandbox
from flexsid.jobs.kinds import OPTIMAL_DESIGN
from flexsid.records.excitation import ExcitationDesign
from flexsid.settings import Settings
from flexsid.sysid.excitation import designer
from flexsid.workflow.excitation.excitation_designs import (
    MEDIA,
    check_amplitudes,
    export_design,
    find_flight_test_aid,
    recognise_inputs,
    save_designs,
    specify_design,
)
from flexsid.workflow.excitation.optimal_designs import (
    OptimalDesign,
    OptimalDesignQuery,
)
from flexsid.workflow.excitation.target_modes import find_band

# --- Commands ``flexsid design`` and ``flexsid import-multisine`` ---------------------------------

_T_S = 24.0  # period of the rows of one T
_LEVELS = (0.5, 1.0, 2.0)  # of the medium amplitude


def design(_settings: Settings, arguments: argparse.Namespace) -> int:
    """Design the multisine of a row of Table 1 and write it at medium amplitude."""
    output = Path(arguments.output)
    form = output.suffix.removeprefix(".")
    if form not in MEDIA:
        endings = ", ".join(f".{ending}" for ending in MEDIA)
        raise BadInput(f"--output ends in '{output.suffix}'; expected one of {endings}")
    low, medium, high = (float(np.deg2rad(level * arguments.peak_deg)) for level in _LEVELS)
    row, percent = find_flight_test_aid(arguments.fta), arguments.throttle_percent
    specification = specify_design(
        arguments.fta,
        arguments.duration or _T_S * row.periods,
        arguments.rate,
        arguments.first_harmonic,
        (low, medium, high),
        arguments.effort,
        arguments.seed,
        throttle_peak=None if percent is None else percent / 100.0,
    )
    check_amplitudes(specification)
    multisine = designer.design(specification, _report_progress)
    excitation = ExcitationDesign(
        name=f"FTA {arguments.fta}",
        specification=specification,
        phases={name: tuple(tones.phases.tolist()) for name, tones in multisine.tones.items()},
        peak_factors=designer.compute_peak_factors(multisine),
        fta=arguments.fta,
    )
    write_file(output, export_design(excitation, form, 1))
    factors, band = excitation.peak_factors, find_band(specification)
    lines = [f"{name:<10} relative peak factor {one:.4f}" for name, one in factors.items()]
    lines.append(f"harmonics from {band[0]:.3g} to {band[1]:.4g} Hz for {row.targets}")
    result = {"file": arguments.output, "peak_factors": factors, "band_hz": band}
    print_result(lines, result, as_json=arguments.json)
    return 0


def import_multisine(settings: Settings, arguments: argparse.Namespace) -> int:
    """Identify flown multisines, store them as designs, and print them."""
    paths = [Path(name) for name in arguments.files]
    inputs = recognise_inputs(sandbox.read_all(paths), arguments.unit)
    name = arguments.name or paths[0].stem
    with open_store(settings) as store:
        designs = save_designs(store, inputs, name, arguments.rate, separate=arguments.separate)
    lines = (line for one in designs for line in _describe_design(one))
    print_result(lines, designs, as_json=arguments.json)
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


def _report_progress(name: str, best: float, fraction: float) -> None:
    show_progress(f"{fraction:4.0%} {name} at {best:.4f}")


# --- Command ``flexsid optimal-design``: the design that is optimal for an objective within limits


def optimise_design(settings: Settings, arguments: argparse.Namespace) -> int:
    """Store the optimal design and print its gain over the standard design."""

    def to_radians(value: float | None) -> float | None:
        return None if value is None else float(np.deg2rad(value))

    query = OptimalDesignQuery(
        design_id=arguments.design,
        run_id=arguments.run,
        deflection=to_radians(arguments.deflection_deg),
        rate=to_radians(arguments.rate_deg_s),
        **read_options(OptimalDesignQuery, arguments),
    )
    with open_store(settings) as store:
        found = compute_result(store, OPTIMAL_DESIGN, query)
    print_result(_format(found), found, as_json=arguments.json)
    return 0


def _format(found: OptimalDesign) -> list[str]:
    lines = [
        f"design {found.optimal_design_id}: {found.quantity} {found.optimal:.4g} {found.unit};"
        f" standard design {found.standard:.4g} {found.unit}"
    ]
    if found.standard_time_s is not None:
        lines.append(
            f"the standard design would be flown for {found.standard_time_s:.0f} s instead of"
            f" {found.duration_s:.0f} s"
        )
    lines += [
        f"  {row.name:<12} limit {row.limit:.4g}, standard {row.standard:.4g},"
        f" optimal {row.optimal:.4g}"
        for row in found.limits
    ]
    return lines
