"""Command ``flexsid modal-data``: import, identification, correlation and files of modal data."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from flexsid.cli.administration import open_store
from flexsid.cli.output import parse_list, print_result, print_written_file, write_file
from flexsid.errors import BadInput
from flexsid.figures.mode_shapes import draw_shape_picture
from flexsid.importers.modal_data import (
    MassOptions,
    ModalDataOptions,
    extract_mass_table,
    extract_modal_data,
    inspect_modal_data,
)
from flexsid.importers.modal_files import FORMS, write_archive, write_modes
from flexsid.importers.responses import AveragingOptions, ResponseOptions, extract_responses
from flexsid.importers.sandbox import read_all
from flexsid.importers.source import Sources
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.settings import Settings
from flexsid.storage.store import Store
from flexsid.workflow.aircraft.derivative_predictions import set_mass_table
from flexsid.workflow.modal_data.ground_vibration_test import (
    ModeSearch,
    find_modes,
    prepare_mode_search,
    store_found_modes,
    store_responses,
)
from flexsid.workflow.modal_data.modal_import import store_modal_data
from flexsid.workflow.modal_data.modal_tables import (
    format_title,
    gather_modes,
    gather_modes_over_fuel,
)
from flexsid.workflow.modal_data.model_updating import update_modal_table
from flexsid.workflow.modal_data.orthogonality import (
    OrthogonalityQuery,
    compute_orthogonality,
    prepare_orthogonality,
)
from flexsid.workflow.views.modal_assurance import correlate
from flexsid.workflow.views.modes import list_modes_at, read_shape


def run_action(settings: Settings, arguments: argparse.Namespace) -> int:
    """Run one of the actions on modal data."""
    with open_store(settings) as store:
        ACTIONS[arguments.action](store, arguments)
    return 0


def _read(files: Sequence[str]) -> Sources:
    if not files:
        raise BadInput("no file was given")
    paths = [Path(file) for file in files]
    return read_all(paths, [path.name for path in paths])


def _parse_ids(arguments: argparse.Namespace, count: int) -> list[int]:
    """Parse the ids of modal tables with which the items begin."""
    try:
        return [int(item) for item in arguments.items[:count]] + [0] * (
            count - len(arguments.items)
        )
    except ValueError as error:
        raise BadInput(f"{error}; expected the id of a modal table") from error


def _parse_fuel(text: str | None, files: Sequence[str]) -> dict[str, float]:
    """Parse ``empty.op2=0,full.op2=1``, or one fuel fraction for all files."""
    if text is None:
        return {}
    found = {}
    for part in text.split(","):
        name, equals, value = part.rpartition("=")
        try:
            names = [name] if equals else [Path(file).name for file in files]
            found |= dict.fromkeys(names, float(value))
        except ValueError as error:
            raise BadInput(f"--fuel is {text!r}; expected 0.5 or FILE=0.5,FILE=1") from error
    return found


def _parse_one_fuel(arguments: argparse.Namespace) -> float:
    try:
        return 0.5 if arguments.fuel is None else float(arguments.fuel)
    except ValueError as error:
        raise BadInput(f"--fuel is {arguments.fuel!r}; expected a fraction") from error


def _inspect(store: Store, arguments: argparse.Namespace) -> None:
    found = inspect_modal_data(_read(arguments.items))
    lines = [f"{file.name}: {', '.join(file.holds)}" for file in found.files]
    lines += [f"{file.name}: not used: {text}" for file in found.files for text in file.refused]
    lines += [f"needed: {one.text} ({', '.join(one.choices)})" for one in found.queries]
    print_result(lines, found, as_json=arguments.json)


def _import(store: Store, arguments: argparse.Namespace) -> None:
    options = ModalDataOptions(
        name=arguments.name or Path(arguments.items[0] if arguments.items else "modes").stem,
        kind=ModalKind(arguments.kind),
        length_unit=arguments.length,
        mass_unit=arguments.mass,
        generalized_mass=arguments.generalized_mass,
        axes=arguments.axes,
        fuel=_parse_fuel(arguments.fuel, arguments.items),
        analyses=dict(part.partition("=")[::2] for part in arguments.analysis),
        rigid_modes=arguments.rigid_modes,
    )
    aircraft = store.aircraft.get(arguments.aircraft)
    table = store_modal_data(store, aircraft, extract_modal_data(_read(arguments.items), options))
    _print_table(table, arguments)


def _print_table(table: ModalTable, arguments: argparse.Namespace) -> None:
    head = f"modal table {table.id}: {format_title(table)}, {len(table.numbers)} modes"
    print_result([head, *(f"  {note}" for note in table.notes)], table, as_json=arguments.json)


def _list(store: Store, arguments: argparse.Namespace) -> None:
    tables = store.modal_tables.find()
    lines = [
        f"{table.id:>5} {table.kind:4} {format_title(table)}, {len(table.numbers)} modes, "
        f"{len(table.fuel)} fuel weights"
        for table in tables
    ]
    print_result(lines or ["no modal tables"], tables, as_json=arguments.json)


def _modes(store: Store, arguments: argparse.Namespace) -> None:
    number, fuel = _parse_ids(arguments, 1)[0], _parse_one_fuel(arguments)
    found = list_modes_at(store, number, fuel)
    lines = [
        f"{mode.number:>5} {mode.name:12}{_show(mode.frequency_hz, 4)} Hz"
        f"{_show(mode.damping, 5)}  {mode.reason}"
        for mode in found
    ]
    print_result(lines, found, as_json=arguments.json)


def _show(value: float | None, digits: int) -> str:
    return f"{'–':>12}" if value is None else f"{value:>12.{digits}f}"


def _correlate(store: Store, arguments: argparse.Namespace) -> None:
    one, other = _parse_ids(arguments, 2)
    fuel = _parse_one_fuel(arguments)
    at_other = fuel if arguments.other_fuel is None else arguments.other_fuel
    found = correlate(store, one, fuel, other, at_other)
    lines = [
        f"{pair.name:12}{pair.other_name:12} MAC {pair.mac:.3f}"
        f"{_show(pair.cross_orthogonality, 3)}{_show(pair.frequency_hz, 3)} Hz"
        f"{_show(pair.other_hz, 3)} Hz{100.0 * pair.frequency_change:>9.2f} %"
        for pair in found.pairs
    ]
    print_result([*lines, *found.notes], found, as_json=arguments.json)


def _orthogonality(store: Store, arguments: argparse.Namespace) -> None:
    if arguments.matrix is None:
        raise BadInput("give the name of the mass matrix, e.g. --matrix MAAX")
    query = OrthogonalityQuery(
        modal_table_id=_parse_ids(arguments, 1)[0],
        mass=arguments.matrix,
        fuel=_parse_one_fuel(arguments),
        other_id=arguments.other,
        other_fuel=arguments.other_fuel,
        stiffness=arguments.stiffness,
        length_unit=arguments.length,
        axes=arguments.axes,
    )
    sources = _read(arguments.items[1:])
    found = compute_orthogonality(prepare_orthogonality(store, sources, query))
    lines = ["".join([" " * 12, *(f"{name:>9.9}" for name in found.other_names)])]
    lines += [
        "".join([f"{name:12.12}", *(f"{value:9.3f}" for value in row)])
        for name, row in zip(found.names, found.values, strict=True)
    ]
    lines += [f"pairs at least {found.least_pair:.3f}, others at most {found.worst:.3f}"]
    print_result([*lines, *found.notes], found, as_json=arguments.json)


def _update(store: Store, arguments: argparse.Namespace) -> None:
    tests, runs = (
        parse_list(text, int, option)
        for text, option in ((arguments.tests, "--tests"), (arguments.runs, "--runs"))
    )
    number = _parse_ids(arguments, 1)[0]
    name = arguments.name or f"{store.modal_tables.get(number).name} updated"
    _print_table(update_modal_table(store, number, name, tests, runs), arguments)


def _export(store: Store, arguments: argparse.Namespace) -> None:
    number, output = _parse_ids(arguments, 1)[0], arguments.output
    if output is None:
        raise BadInput("give the file, e.g. --output modes.uff")
    write_file(output, b"".join(_encode(store, number, Path(output).suffix[1:], arguments)))
    result = {"modal_table": number, "file": output}
    print_written_file(f"wrote modal table {number} to {output}", result, as_json=arguments.json)


def _encode(
    store: Store, number: int, suffix: str, arguments: argparse.Namespace
) -> Iterable[bytes]:
    """Return the content of a file: modes, an archive of all fuel weights or a picture."""
    fuel = _parse_one_fuel(arguments)
    if suffix == "svg":
        if arguments.mode is None:
            raise BadInput("give the number of the mode, e.g. --mode 7")
        shape = read_shape(store, number, arguments.mode, fuel)
        return [part.encode() for part in draw_shape_picture(shape, moving=arguments.moving)]
    form = arguments.form or ("uff" if suffix == "zip" else suffix)
    if form not in FORMS or (suffix != "zip" and form.partition("-")[0] != suffix):
        expected = ", ".join(FORMS)
        raise BadInput(
            f"{arguments.output} of form {form!r} is not written; expected a file .uff, .csv, "
            f".mat, .op4, .zip or .svg, of one of the forms {expected}"
        )
    if suffix != "zip":
        return write_modes(gather_modes(store, number, fuel), form)
    return write_archive(
        (
            f"fuel-{modes.fuel:g}.{form.partition('-')[0]}",
            write_modes(modes, form),
        )
        for modes in gather_modes_over_fuel(store, number, store.modal_tables.get(number).fuel)
    )


def _set_mass(store: Store, arguments: argparse.Namespace) -> None:
    if arguments.length is None or arguments.mass is None:
        raise BadInput("give the units of the printouts, e.g. --length in --mass slinch")
    options = MassOptions(
        length_unit=arguments.length,
        mass_unit=arguments.mass,
        axes=arguments.axes,
        fuel=_parse_fuel(arguments.fuel, arguments.items),
    )
    table = extract_mass_table(_read(arguments.items), options)
    mass = set_mass_table(store, arguments.aircraft, table).mass
    lines = [
        f"fuel {fuel:g}: {mass.mass_kg[row]:.4g} kg, x c.g. {mass.x_cg_m[row]:.4g} m, pitch "
        f"inertia {mass.pitch_inertia_kg_m2[row]:.4g} kg m2"
        for row, fuel in enumerate(mass.fuel)
    ]
    print_result(lines, mass, as_json=arguments.json)


def _responses(store: Store, arguments: argparse.Namespace) -> None:
    options = ResponseOptions(
        name=arguments.name or Path(arguments.items[0] if arguments.items else "responses").stem,
        response_unit=arguments.response_unit,
        force_unit=arguments.force_unit,
        frequency_unit=arguments.frequency_unit,
        phase_unit=arguments.phase_unit,
        time_unit=arguments.time_unit,
        fuel=0.0 if arguments.fuel is None else _parse_one_fuel(arguments),
        length_unit=arguments.length,
        axes=arguments.axes,
    )
    averaging = None
    if arguments.averages is not None:
        averaging = AveragingOptions(
            averages=arguments.averages,
            estimator=arguments.estimator,
            overlap=arguments.overlap,
            window=arguments.window,
        )
    aircraft = store.aircraft.get(arguments.aircraft)
    raw = extract_responses(_read(arguments.items), options, averaging)
    stored = store_responses(store, aircraft, raw)
    head = (
        f"measured responses {stored.id}: {stored.name}, {len(stored.outputs)} points, "
        f"{len(stored.references)} references"
    )
    print_result([head, *(f"  {note}" for note in stored.notes)], stored, as_json=arguments.json)


def _identify(store: Store, arguments: argparse.Namespace) -> None:
    search = ModeSearch(
        responses_id=_parse_ids(arguments, 1)[0],
        low_hz=arguments.low,
        high_hz=arguments.high,
        order=arguments.order,
        poles=parse_list(arguments.poles, int, "--poles"),
    )
    identified = find_modes(prepare_mode_search(store, search))
    if arguments.name:
        _print_table(store_found_modes(store, identified, arguments.name), arguments)
        return
    found = identified.found
    lines = [
        f"{mode.frequency_hz:>10.4f} ± {2.0 * mode.std_hz:.4f} Hz {100.0 * mode.damping:>8.3f} ± "
        f"{200.0 * mode.std_damping:.3f} %"
        for mode in found.items
    ]
    lines.append("  Values ±2σ.")
    print_result(lines, found, as_json=arguments.json)


ACTIONS: dict[str, Callable[[Store, argparse.Namespace], Any]] = {
    "inspect": _inspect,
    "import": _import,
    "list": _list,
    "modes": _modes,
    "correlate": _correlate,
    "orthogonality": _orthogonality,
    "update": _update,
    "export": _export,
    "mass": _set_mass,
    "responses": _responses,
    "identify": _identify,
}
