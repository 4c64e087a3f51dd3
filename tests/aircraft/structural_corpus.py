"""A corpus of small structural files, one for each form in which programs write them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from structural_files import (
    OutputFile,
    Structure,
    add_eigenvalues,
    add_geometry,
    add_shapes,
    add_shapes_by_node,
    make_structure,
    print_eigenvalues,
    print_shapes,
    print_shapes_by_node,
    punch_complex_shapes,
    punch_shapes,
    punch_shapes_by_node,
    write_deck,
    write_deck_in,
    write_universal_nodes,
    write_universal_shapes,
)

N_MODES, N_NODES = 3, 20


_FURTHER = make_structure(1000, N_MODES, N_NODES)
"""The modes of a second subcase."""


def _write_output(
    structure: Structure,
    path: Path,
    *,
    order: str = "<",
    size: int = 4,
    doubled: bool = False,
    table: str = "OUGV1",
    polar: bool = False,
    further: bool = False,
) -> None:
    file = OutputFile(order, size)
    add_geometry(file, structure, doubled=doubled)
    tables, shapes = {1: structure}, {(1, ""): structure}
    if further:
        tables[2] = shapes[2, "FREE"] = _FURTHER
    if not np.iscomplexobj(structure.shape):
        add_eigenvalues(file, tables)
    add_shapes(file, shapes, table, polar=polar)
    file.save(path)


def _print(structure: Structure, *, polar: bool = False, rows: int = 50) -> str:
    table = "" if np.iscomplexobj(structure.shape) else print_eigenvalues(structure)
    return table + print_shapes(structure, polar=polar, rows=rows)


def _print_twice(structure: Structure) -> str:
    text = print_eigenvalues(structure) + print_eigenvalues(_FURTHER, "SUBCASE 2")
    return text + print_shapes(structure) + print_shapes(_FURTHER, "SUBCASE 2")


def _punch_twice(structure: Structure) -> str:
    return punch_shapes(structure) + punch_shapes(_FURTHER, 2, "FREE")


def _write_sets(structure: Structure, *, nodes: int, shapes: int, double: bool = False) -> str:
    return write_universal_nodes(structure, nodes) + write_universal_shapes(
        structure, shapes, double=double
    )


_OUTPUTS = {
    "little-endian": {},
    "big-endian": {"order": ">"},
    "64-bit": {"size": 8},
    "64-bit-big-endian": {"order": ">", "size": 8},
    "double-coordinates": {"doubled": True},
    "basic-directions": {"table": "BOPHIG"},
    "patran": {"table": "OUGV1PAT"},
    "ophig": {"table": "OPHIG"},
    "two-subcases": {"further": True},
    "complex": {},
    "complex-polar": {"polar": True},
    "complex-64-bit": {"size": 8},
}
_STYLES = ("small", "large", "free", "free-large", "exponents", "tabs", "lower")

_TEXTS: dict[str, Callable[[Structure], str]] = {
    **{f"{style}.bdf": partial(write_deck, style=style) for style in _STYLES},
    **{f"system-{kind.lower()}.bdf": partial(write_deck_in, kind=kind) for kind in "RCS"},
    "real.f06": _print,
    "pages.f06": partial(_print, rows=7),
    "complex.f06": _print,
    "complex-polar.f06": partial(_print, polar=True),
    "two-subcases.f06": _print_twice,
    "shapes-only.f06": print_shapes,
    "eigenvalues-only.f06": print_eigenvalues,
    "real.pch": punch_shapes,
    "two-subcases.pch": _punch_twice,
    "55-15.uff": partial(_write_sets, nodes=15, shapes=55),
    "55-2411.uff": partial(_write_sets, nodes=2411, shapes=55),
    "55-complex.uff": partial(_write_sets, nodes=15, shapes=55),
    "2414-781.unv": partial(_write_sets, nodes=781, shapes=2414),
    "2414.unv": partial(_write_sets, nodes=2411, shapes=2414),
    "2414-double.unv": partial(_write_sets, nodes=2411, shapes=2414, double=True),
    "2414-complex.unv": partial(_write_sets, nodes=2411, shapes=2414),
    "2414-complex-double.unv": partial(_write_sets, nodes=2411, shapes=2414, double=True),
    "nodes-15.uff": partial(write_universal_nodes, kind=15),
    "nodes-2411.uff": partial(write_universal_nodes, kind=2411),
}


_FURTHER_TEXTS: dict[str, Callable[[Structure], str]] = {
    "sorted-by-node.f06": lambda s: print_eigenvalues(s) + print_shapes_by_node(s),
    "sorted-by-node.pch": punch_shapes_by_node,
    "complex.pch": punch_complex_shapes,
    "complex-polar.pch": partial(punch_complex_shapes, polar=True),
}


def _write_by_node(structure: Structure, path: Path) -> None:
    file = OutputFile()
    add_geometry(file, structure)
    add_shapes_by_node(file, structure)
    add_eigenvalues(file, {1: structure})
    file.save(path)


def _write_text(build: Callable[[Structure], str], structure: Structure, path: Path) -> None:
    path.write_text(build(structure), encoding="latin-1")


_WRITERS: dict[str, Callable[[Structure, Path], None]] = {
    **{f"{name}.op2": partial(_write_output, **how) for name, how in _OUTPUTS.items()},
    **{name: partial(_write_text, build) for name, build in _TEXTS.items()},
    "sorted-by-node.op2": _write_by_node,
    **{name: partial(_write_text, build) for name, build in _FURTHER_TEXTS.items()},
}
"""The seed of a structure is its place, so that further files are added at the end."""

STRUCTURES: dict[str, Structure] = {
    name: make_structure(place, N_MODES, N_NODES, is_complex="complex" in name)
    for place, name in enumerate(_WRITERS)
}
"""The structure of every file of the corpus, by name."""

FILES: dict[str, Callable[[Path], None]] = {
    name: partial(write, STRUCTURES[name]) for name, write in _WRITERS.items()
}
"""Every file of the corpus by name: a function that writes it."""
