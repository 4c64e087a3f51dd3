"""Search for a model's terms from the command line, and print what was found."""

from __future__ import annotations

import argparse

from flexsid.cli.opening import opened
from flexsid.cli.runs import numbers, read_band, show
from flexsid.cli.saying import complain, say
from flexsid.records.model_structure import Structure
from flexsid.records.run import Method, RunState
from flexsid.records.search import (
    Algorithm,
    SearchSettings,
    SearchStart,
    StructureSearch,
)
from flexsid.settings import Settings
from flexsid.workflow.structure_determination import searches


def search(settings: Settings, chosen: argparse.Namespace) -> int:
    """Search at once, keep and print what was found; return 0 unless it failed."""
    maneuvers = tuple(numbers(chosen.maneuvers, int, "MANEUVERS"))
    with opened(settings) as store:
        aircraft = store.maneuvers.get(maneuvers[0]).aircraft_id if maneuvers else 0
        wanted = StructureSearch(
            aircraft_id=aircraft,
            maneuver_ids=maneuvers,
            method=Method(chosen.method),
            structure=Structure(
                modes=tuple(numbers(chosen.modes, int, "--modes")),
                inputs=tuple(numbers(chosen.inputs, str, "--inputs")),
                outputs=tuple(numbers(chosen.outputs, str, "--outputs")),
                free=None if chosen.free is None else tuple(numbers(chosen.free, str, "--free")),
                fixed={},
                free_delays=chosen.free_delays,
            ),
            settings=SearchSettings(
                algorithm=Algorithm(chosen.algorithm),
                begin=SearchStart(chosen.begin),
                f_in=chosen.f_in,
                f_out=chosen.f_in if chosen.f_out is None else chosen.f_out,
                draws=chosen.draws,
                validate_on=tuple(numbers(chosen.validate_on, int, "--validate-on")),
                band_hz=read_band(chosen.band),
            ),
        )
        kept = searches.add_search(store, wanted)
        assert kept.id is not None
        kept = searches.carry_out_search(store, kept.id, lambda task: searches.search(task, show))
    say(_lines(kept) if kept.error is None else (), kept, as_json=chosen.json)
    if kept.error is not None:
        message = f"search {kept.id} failed: {kept.error['message']}"
        complain(message, kept.error["code"], as_json=chosen.json)
    return 0 if kept.state is RunState.SUCCEEDED else 1


def _lines(found: StructureSearch) -> list[str]:
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
            mark = " " if term.chosen else "×"
            lines.append(f"{mark} {term.name:<16}{value:>12}{error:>12}{term.f:>10.4g}{stable:>8}")
        for one in group.dependencies:
            said = ", ".join(f"{name} {share:.2f}" for name, share in one.shares.items())
            lines.append(f"  condition index {one.condition_index:.0f}: {said}")
    lines += ["", "candidates, by how they predict lines they did not see:"]
    for place, one in enumerate(result.candidates):
        cost = "-" if one.predictive_cost is None else f"{one.predictive_cost:.1f}"
        mark = "*" if one.proposed else " "
        lines.append(f"{mark} {place} {one.name}: cost {cost}, {one.n_terms} terms. {one.flutter}")
    return lines + [f"note: {warning}" for warning in result.warnings]
