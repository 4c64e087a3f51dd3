"""Command that fits transfer functions of one input and output."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

from flexsid.cli.arguments import parse_band, parse_list
from flexsid.cli.database import open_store
from flexsid.cli.output import print_next_result
from flexsid.cli.runs import report_progress
from flexsid.jobs.inline import execute_request
from flexsid.jobs.kind import get_result
from flexsid.jobs.kinds import TRANSFER_FUNCTION
from flexsid.records.transfer_function import TransferFunction
from flexsid.settings import Settings
from flexsid.sysid.stability.transfer_function import TransferFunctionRoot
from flexsid.workflow.measurements.transfer_functions import TransferFunctionQuery


def fit_transfer_functions(settings: Settings, arguments: argparse.Namespace) -> int:
    """Print the transfer function of an output over an input, of each maneuver."""
    low_hz, high_hz = parse_band(arguments.band) or (None, None)
    with open_store(settings) as store:
        for number in parse_list(arguments.maneuver, int, "--maneuver"):
            query = TransferFunctionQuery(
                maneuver_id=number,
                input=arguments.input,
                output=arguments.output,
                zeros=arguments.zeros,
                poles=arguments.poles,
                integrators=arguments.integrators,
                delay=not arguments.no_delay,
                low_hz=low_hz,
                high_hz=high_hz,
            )
            execute_request(store, TRANSFER_FUNCTION, query, report_progress)
            found = get_result(store, TRANSFER_FUNCTION, query).function
            print_next_result("\n".join(_format_function(found)), found, as_json=arguments.json)
    return 0


def _format_function(found: TransferFunction) -> Iterator[str]:
    yield f"maneuver {found.maneuver_id}, {found.band_hz[0]:.3g} to {found.band_hz[1]:.3g} Hz"
    yield f"  {found.sentence}"
    yield f"  {'gain':<24}{found.gain:>12.5g} ± {found.gain_std:.2g}"
    if found.has_delay:
        yield f"  {'equivalent delay [s]':<24}{found.delay_s:>12.5g} ± {found.delay_std_s:.2g}"
    yield from _format_roots("zero", found.zeros)
    yield from _format_roots("pole", found.poles)
    for warning in found.warnings:
        yield f"  Warning: {warning}"


def _format_roots(kind: str, roots: Sequence[TransferFunctionRoot]) -> Iterator[str]:
    for root in roots:
        is_real = root.imag_rad_s == 0.0
        value = root.real_rad_s if is_real else root.frequency_rad_s
        label = f"{kind}, {'1/T' if is_real else 'ω'} [rad/s]"
        shown = -value if is_real else value
        yield f"  {label:<24}{shown:>12.5g} ± {root.frequency_std_rad_s:.2g}"
        if not is_real:
            yield f"  {'      ζ':<24}{root.damping:>12.5g} ± {root.damping_std:.2g}"
