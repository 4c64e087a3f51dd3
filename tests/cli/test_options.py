"""Options of a command are those that the class of its request states."""

from __future__ import annotations

import pytest

from flexsid.cli.main import build_parser
from flexsid.cli.options import read_options
from flexsid.errors import BadInput
from flexsid.records.search import Algorithm, SearchSettings
from flexsid.workflow.flutter.flutter_analysis import FlutterQuery, Variation
from flexsid.workflow.global_model.estimates import GlobalModelQuery, LimitedQuantity


def read(request: type, *given: str) -> dict[str, object]:
    return read_options(request, build_parser(given[0]).parse_args(given))


def test_without_options_a_request_has_the_defaults_of_its_class():
    assert read(FlutterQuery, "flutter", "1") == {}
    assert read(SearchSettings, "search", "1") == {}
    assert read(GlobalModelQuery, "global-model", "1") == {}


def test_options_are_values_of_the_types_of_the_fields():
    given = ["--fuel", "0.5", "--next", "45", "--variation", "linear"]
    assert read(FlutterQuery, "flutter", "1", *given) == {
        "fuel": 0.5,
        "next_m_s": 45.0,
        "variation": Variation.LINEAR,
    }
    given = ["--validate-on", "4, 5", "--algorithm", "orthogonal functions"]
    assert read(SearchSettings, "search", "1", *given) == {
        "validate_on": (4, 5),
        "algorithm": Algorithm.ORTHOGONAL_FUNCTIONS,
    }
    given = ["--variables", "alpha_rad", "fuel_fraction", "--prediction", "2"]
    assert read(GlobalModelQuery, "global-model", "1", *given) == {
        "variables": (LimitedQuantity.ALPHA, LimitedQuantity.FUEL),
        "prediction_id": 2,
    }


def test_values_of_another_type_are_refused_by_name():
    for option, value in (("--variation", "cubic"), ("--fuel", "half")):
        with pytest.raises(BadInput, match=f"{option}.*{value}"):
            read(FlutterQuery, "flutter", "1", option, value)
    with pytest.raises(BadInput, match="--validate-on is '4,x'; expected numbers"):
        read(SearchSettings, "search", "1", "--validate-on", "4,x")


def test_help_states_meaning_and_default_of_the_class(capsys):
    with pytest.raises(SystemExit):
        build_parser("search").parse_args(["search", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    assert "number of resamplings of the frequencies; default: 30" in text
