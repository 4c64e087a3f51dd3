"""The table of figures fits together: parameters, numbers and drawing of each."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

import pytest

from flexsid import figures
from flexsid.figure_table import FIGURES, FigureKind


@pytest.mark.parametrize("kind", FIGURES.values(), ids=list(FIGURES))
def test_numbers_and_drawing_take_the_parameters(kind: FigureKind):
    names = set(kind.parameters.model_fields)
    assert names >= set(kind.drawing)
    store, numbers = object(), object()
    inspect.signature(kind.numbers).bind(store, **dict.fromkeys(names - set(kind.drawing)))
    if kind.name != "frozen":  # drawn already
        inspect.signature(kind.draw).bind(numbers, **dict.fromkeys(kind.drawing))


def test_every_figure_has_a_name_for_addresses_and_a_description():
    for kind in FIGURES.values():
        assert re.fullmatch("[a-z]+(-[a-z]+)*", kind.name)
        assert kind.description.startswith("Draw ")


def test_figures_name_no_unit_that_a_user_may_change():
    folder = Path(figures.__file__).parent
    for file in folder.glob("*.py"):
        fixed = re.findall(r"(?:\[|\} )(?:Hz|m/s|Pa|kPa|kg)\b.?", file.read_text())
        assert not fixed, (file.name, fixed)


def test_lists_are_separated_by_commas_and_empty_by_default():
    parameters = FIGURES["bode"].parameters
    given = parameters.model_validate({"maneuver_id": "1", "output": "q, az", "run_id": "3,4"})
    assert dict(given)["outputs"] == ("q", "az")
    assert dict(given)["run_ids"] == (3, 4)
    assert dict(given)["inputs"] == ()
