"""Edges of elements for drawing, from the entries of a deck or of an output file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

_SHELL4, _SHELL3, _BEAM = slice(2, 6), slice(2, 5), slice(2, 4)
CORNERS = {
    "CQUAD4": _SHELL4, "CQUADR": _SHELL4, "CQUAD8": _SHELL4, "CSHEAR": _SHELL4,
    "CTRIA3": _SHELL3, "CTRIAR": _SHELL3, "CTRIA6": _SHELL3,
    "CBAR": _BEAM, "CBEAM": _BEAM, "CROD": _BEAM, "CTUBE": _BEAM,
    "CONROD": slice(1, 3), "PLOTEL": slice(0, 7), "RBE2": slice(1, None),
}  # fmt: skip
"""Fields of an entry, after its name, with the nodes at its corners; midside nodes are omitted."""


def list_edges(name: str, fields: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Yield the edges of an entry as pairs of nodes, the lower number first.

    Raises
    ------
    ValueError
        If a node is not a number.
    """
    nodes = fields[CORNERS[name]]
    if name == "RBE2":  # independent node, components, dependent nodes, thermal expansion
        pairs = [(int(nodes[0]), int(node)) for node in nodes[2:] if node and "." not in node]
    elif name == "PLOTEL":  # one or two
        pairs = [(int(fields[k]), int(fields[k + 1])) for k in (1, 5) if fields[k - 1]]
    else:
        corners = [int(node) for node in nodes]
        pairs = list(pairwise(corners if len(corners) == 2 else [*corners, corners[0]]))
    yield from ((min(pair), max(pair)) for pair in pairs if pair[0] != pair[1])
