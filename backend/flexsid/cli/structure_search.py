"""Command ``flexsid search``: model structure determination."""

from __future__ import annotations

import argparse

from flexsid.cli.arguments import parse_band, parse_list, read_structure, set_axis
from flexsid.cli.database import open_store
from flexsid.cli.output import print_error, print_result
from flexsid.cli.runs import report_progress
from flexsid.jobs.inline import execute_job
from flexsid.jobs.kinds import SEARCH
from flexsid.records.run import Method, RunState
from flexsid.records.search import Algorithm, InitialTerms, SearchSettings, StructureSearch
from flexsid.settings import Settings
from flexsid.workflow.structure_determination import searches


def search(settings: Settings, arguments: argparse.Namespace) -> int:
    """Execute a search, store and print its result; return 0 if it succeeded."""
    maneuvers = parse_list(arguments.maneuvers, int, "MANEUVERS")
    structure = read_structure(arguments)
    with open_store(settings) as store:
        if maneuvers:
            structure = set_axis(store, structure, maneuvers[0], arguments.axis)
        requested = StructureSearch(
            aircraft_id=store.maneuvers.get(maneuvers[0]).aircraft_id if maneuvers else 0,
            maneuver_ids=maneuvers,
            method=Method(arguments.method),
            structure=structure,
            settings=SearchSettings(
                algorithm=Algorithm(arguments.algorithm),
                initial_terms=InitialTerms(arguments.initial_terms),
                f_in=arguments.f_in,
                f_out=arguments.f_in if arguments.f_out is None else arguments.f_out,
                resamplings=arguments.resamplings,
                validate_on=parse_list(arguments.validate_on, int, "--validate-on"),
                band_hz=parse_band(arguments.band),
            ),
        )
        added: list[StructureSearch] = []

        def add() -> int:
            added.append(searches.add_search(store, requested))
            return added[0].job_id or 0

        execute_job(store, SEARCH, add, report_progress)
        stored = store.searches.get(added[0].id or 0)
    lines = _format_result(stored) if stored.error is None else ()
    print_result(lines, stored, as_json=arguments.json)
    if stored.error is not None:
        message = f"search {stored.id} failed: {stored.error['message']}"
        print_error(message, stored.error["code"], as_json=arguments.json)
    return 0 if stored.state is RunState.SUCCEEDED else 1


def _format_result(found: StructureSearch) -> list[str]:
    result = found.result
    if result is None:
        return [f"search {found.id} is {found.state.value}"]
    lines = [f"search {found.id}: {result.sentence}"]
    for group in result.groups:
        fit = "" if group.r_squared is None else f", R² {group.r_squared:.4f}"
        lines += ["", f"{group.name}{fit}"]
        lines += [f"  {'term':<16}{'value':>12}{'std error':>12}{'F':>10}{'stable':>8}"]
        for term in group.terms:
            value = "-" if term.value is None else f"{term.value:.5g}"
            error = "-" if term.std_error is None else f"{term.std_error:.3g}"
            stable = "-" if term.stability is None else f"{term.stability:.0%}"
            mark = " " if term.selected else "×"
            lines.append(f"{mark} {term.name:<16}{value:>12}{error:>12}{term.f:>10.4g}{stable:>8}")
        for one in group.dependencies:
            shares = ", ".join(f"{name} {share:.2f}" for name, share in one.shares.items())
            lines.append(f"  condition index {one.condition_index:.0f}: {shares}")
    lines += ["", "candidates, by prediction of data points not used in the fit:"]
    for number, one in enumerate(result.candidates):
        cost = "-" if one.predictive_cost is None else f"{one.predictive_cost:.1f}"
        mark = "*" if one.proposed else " "
        lines.append(f"{mark} {number} {one.name}: cost {cost}, {one.n_terms} terms. {one.flutter}")
    return lines + [f"note: {warning}" for warning in result.warnings]
