"""Value classes of different packages do not repeat each other's fields."""

from __future__ import annotations

import ast
from itertools import combinations
from pathlib import Path

_SOURCE = Path(__file__).parents[2] / "backend" / "flexsid"


def _list_fields() -> dict[tuple[str, str], frozenset[str]]:
    found: dict[tuple[str, str], frozenset[str]] = {}
    for path in sorted(_SOURCE.rglob("*.py")):
        package = path.relative_to(_SOURCE).parts[0]
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef):
                names = frozenset(
                    one.target.id
                    for one in node.body
                    if isinstance(one, ast.AnnAssign) and isinstance(one.target, ast.Name)
                )
                if len(names) >= 3:
                    found[package, f"{path.stem}.{node.name}"] = names
    return found


def test_a_request_is_declared_once():
    twins = [
        f"{first[1]} and {second[1]}"
        for (first, own), (second, other) in combinations(_list_fields().items(), 2)
        if first[0] != second[0]
        and len(own & other) >= 0.8 * min(len(own), len(other))
        and len(own & other) >= 0.6 * max(len(own), len(other))
    ]
    assert not twins, "derive one from the other (flexsid.request_models):\n" + "\n".join(twins)
