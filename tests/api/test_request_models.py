"""One class says a request: its parameters, its body and its check are derived from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated

import pytest
from pydantic import ValidationError

from flexsid.allowed import Allowed, Fuel, Name, RequiredText, RunIds
from flexsid.errors import BadInput
from flexsid.jobs.kind import build_job
from flexsid.jobs.kinds import FLUTTER
from flexsid.request_models import (
    RequestBody,
    body_of,
    build_request,
    check_request,
    derive_parameters,
)
from flexsid.workflow.flutter.flutter_models import FlutterQuery


class Colour(StrEnum):
    RED = "red"
    BLUE = "blue"


@dataclass(frozen=True, slots=True, kw_only=True)
class Inner:
    run_ids: RunIds
    fuel: Fuel | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Outer:
    inner: Inner
    colours: Annotated[tuple[Colour, ...], Allowed(text="Colours.")] = (Colour.RED,)
    names: tuple[Name, ...] = ()
    unit: Annotated[str | None, Allowed(choices=("m", "ft"))] = None
    factors: dict[Name, Fuel] = field(default_factory=dict[str, float])


@body_of(Outer)
class OuterRequest(RequestBody):
    """An outer request."""


def test_lists_in_a_query_are_separated_by_commas_and_nested_fields_are_parameters():
    model = derive_parameters(Outer, ("factors",))
    given = model.model_validate(
        {"run_ids": "3,1", "fuel": "0.5", "colours": "blue,red", "names": "a, b"}
    )
    made = build_request(Outer, dict(given))
    assert made == Outer(
        inner=Inner(run_ids=(3, 1), fuel=0.5), colours=(Colour.BLUE, Colour.RED), names=("a", "b")
    )
    schema = model.model_json_schema()["properties"]
    assert schema["colours"]["default"] == "red"
    assert schema["run_ids"]["description"] == "Ids of succeeded runs, separated by commas."


@pytest.mark.parametrize(
    ("text", "code"), [("green", "unknown-colour"), ("red,green", "unknown-colour")]
)
def test_an_unknown_item_is_refused_with_those_known(text: str, code: str):
    with pytest.raises(BadInput, match="expected red, blue") as refused:
        derive_parameters(Outer, ("factors",)).model_validate({"run_ids": "1", "colours": text})
    assert refused.value.code == code


@pytest.mark.parametrize(
    "wrong",
    [
        {"inner": {"run_ids": [True]}},
        {"inner": {"run_ids": [0]}},
        {"inner": {"run_ids": [1], "fuel": 1.5}},
        {"inner": {"run_ids": [1]}, "unit": "inch"},
        {"inner": {"run_ids": [1]}, "names": ["\u202e"]},
        {"inner": {"run_ids": [1]}, "factors": {"a": 2.0}},
        {"inner": {"run_ids": [1]}, "more": 1},
    ],
)
def test_a_body_is_strict_and_its_ranges_are_those_of_the_class(wrong: dict[str, object]):
    OuterRequest.model_validate({"inner": {"run_ids": [1]}, "factors": None})
    with pytest.raises(ValidationError):
        OuterRequest.model_validate(wrong)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (Outer(inner=Inner(run_ids=(0,))), "run_ids is 0; expected 1 to"),
        (Outer(inner=Inner(run_ids=(1,), fuel=float("nan"))), "fuel is nan; expected 0 to 1"),
        (Outer(inner=Inner(run_ids=(1,)), unit="inch"), "unit is 'inch'; expected one of m, ft"),
        (Outer(inner=Inner(run_ids=(1,)), factors={"a": 2.0}), "factors is 2.0; expected 0 to 1"),
    ],
)
def test_a_request_that_no_door_has_checked_is_refused(wrong: Outer, said: str):
    with pytest.raises(BadInput) as refused:
        check_request(wrong)
    assert refused.value.message.startswith(said)
    assert refused.value.code == "out-of-range"


@dataclass(frozen=True, slots=True, kw_only=True)
class Reasoned:
    reason: RequiredText


@body_of(Reasoned)
class ReasonedRequest(RequestBody):
    """A request with a reason."""


def test_blanks_around_a_required_text_are_removed_and_it_is_not_blank():
    assert ReasonedRequest.model_validate({"reason": " Low SNR.\n"}).model_dump() == {
        "reason": "Low SNR."
    }
    with pytest.raises(ValidationError):
        ReasonedRequest.model_validate({"reason": " \n"})


def test_every_job_is_checked_before_it_is_queued(store):
    with pytest.raises(BadInput, match="fuel is 50; expected 0 to 1"):
        build_job(store, FLUTTER, FlutterQuery(run_ids=(1,), fuel=50))


def test_ids_have_one_range():
    assert derive_parameters(FlutterQuery).model_json_schema()["properties"].keys() == {
        *("run_ids", "fuel", "altitude_m", "next_m_s", "unmodelled_modes", "variation")
    }
    with pytest.raises(BadInput, match="expected 1 to"):
        check_request(FlutterQuery(run_ids=(2**31,)))
