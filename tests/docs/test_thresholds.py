"""Each threshold of the table has the value of the code."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = tuple(ROOT / "backend" / "flexsid" / name for name in ("sysid", "workflow"))
PAGE = ROOT / "docs" / "theory" / "thresholds.md"
ROW = re.compile(r"^\| `(\w+)` \| `([\w.]+)` \| ([^|]+) \|", re.MULTILINE)
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def list_values(module: Path) -> Iterator[tuple[str, ast.expr]]:
    """Yield the names of constants, fields and arguments with a default, and their values."""
    for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Assign):
            (target, *_) = node.targets
            if isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
                pairs = zip(target.elts, node.value.elts, strict=True)
                yield from ((ast.unparse(name), value) for name, value in pairs)
            yield ast.unparse(target), node.value
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            yield ast.unparse(node.target), node.value
        elif isinstance(node, ast.arguments):
            given = [*node.posonlyargs, *node.args]
            given = given[len(given) - len(node.defaults) :]
            yield from ((one.arg, value) for one, value in zip(given, node.defaults, strict=True))
            by_name = zip(node.kwonlyargs, node.kw_defaults, strict=True)
            yield from ((one.arg, value) for one, value in by_name if value is not None)


def read_numbers(value: ast.expr) -> list[float]:
    """Return the numbers of an expression; of a range or grid its first and last."""
    text = ast.unparse(value)
    if limits := re.fullmatch(r"range\((-?\d+), (\d+)\)", text):
        return [float(limits[1]), float(limits[2]) - 1.0]
    if limits := re.fullmatch(r"np\.linspace\((\S+), (\S+), \d+\)", text):
        return [float(limits[1]), float(limits[2])]
    if re.fullmatch(r"[\d.]+ / [\d.]+", text):
        numerator, denominator = text.split(" / ")
        return [float(numerator) / float(denominator)]
    return [float(one) for one in NUMBER.findall(text)]


def test_each_threshold_of_the_table_has_the_value_of_the_code() -> None:
    rows = ROW.findall(PAGE.read_text(encoding="utf-8"))
    assert len(rows) > 300
    wrong = []
    for name, module, printed in rows:
        found = [
            read_numbers(value)
            for package in PACKAGES
            for file in package.rglob(f"{module.replace('.', '/')}.py")
            for known, value in list_values(file)
            if known == name
        ]
        stated = printed.replace("_", "")
        if re.fullmatch(r"\d+/\d+", stated):
            stated = str(float(stated.split("/")[0]) / float(stated.split("/")[1]))
        if [float(one) for one in NUMBER.findall(stated)] not in found:
            wrong.append(f"{name} of {module}: {printed}, in the code {found}")
    assert not wrong, "\n".join(wrong)
