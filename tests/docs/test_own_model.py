"""The page about a model of one's own is a program, and its file has at most 15 lines."""

from __future__ import annotations

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "own-model.md"


def test_the_program_of_the_page_runs(capsys) -> None:
    file, program = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(), re.M | re.S)
    assert len([line for line in file.splitlines() if line]) <= 15
    found: dict[str, object] = {}
    exec(file + program, found)
    printed = capsys.readouterr().out
    values = re.findall(r"^(\w+) = (-?[\d.]+) ± ([\d.]+)$", printed, re.M)
    assert [name for name, _, _ in values] == ["L_p", "L_da", "servo"]
    for (_, value, std), truth in zip(values, (-3.2, 14.0, 18.0), strict=True):
        assert abs(float(value) - truth) < 4.0 * float(std) < 0.2 * abs(truth)
