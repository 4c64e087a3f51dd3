"""What earlier versions promised holds, until its time of deprecation has passed."""

from __future__ import annotations

import argparse
import copy
from typing import Any

import pytest
from interface import DESCRIPTION
from promises import (
    POLICY,
    RECORD,
    Promises,
    find_broken,
    list_promises,
    of_command,
    of_object,
    of_rest,
    of_table,
    read_deprecations,
    read_last_promises,
    read_promises,
    write_promises,
)
from pydantic import create_model

from flexsid.importers.mapping import TimeMapping
from flexsid.importers.table import MappingTable


@pytest.fixture(scope="module")
def openapi() -> dict[str, Any]:
    return DESCRIPTION


@pytest.fixture(scope="module")
def present() -> Promises:
    return list_promises()


def test_this_version_keeps_what_the_last_promised(present):
    deprecations = read_deprecations(POLICY.read_text(encoding="utf-8"))
    broken = find_broken(read_last_promises(), present, deprecations)
    assert not broken, (
        f"docs/promises.md states how a promise ends; before the first release, write "
        f"{RECORD.name} again with python {__file__.replace('test_', '')}: {broken}"
    )


def test_a_record_is_read_as_it_was_written(present):
    assert read_promises(write_promises(present)) == present
    groups = ("flexsid.sysid.", "flexsid.client.", "flexsid verify", "mapping [", "entry point ")
    for group in (*groups, "GET /api/v1/", "request ", "response "):
        assert any(name.startswith(group) for name in present), group


def test_a_deprecation_names_a_promise_as_the_check_does(present):
    names = {*present, *read_last_promises()}
    for one in read_deprecations(POLICY.read_text(encoding="utf-8")):
        assert one.promise.partition(": ")[0] in names, one


# --- Arguments ------------------------------------------------------------------------------------


def _fit(model: object, data: object, weights: float = 1.0) -> None: ...


def test_a_renamed_argument_is_found():
    def renamed(model: object, data: object, weighting: float = 1.0) -> None: ...

    broken = find_broken(dict(of_object("fit", _fit)), dict(of_object("fit", renamed)))
    assert "fit: weights" in broken


@pytest.mark.parametrize(
    ("since", "removed", "version", "holds"),
    [
        ("1.1", "1.3", "1.3.0", True),
        ("1.1", "1.3", "1.2.5", False),  # too early
        ("1.1", "1.2", "1.2.0", False),  # one minor version
        ("1.9", "2.0", "2.0.0", True),
    ],
)
def test_a_deprecated_argument_stays_for_two_minor_versions(since, removed, version, holds):
    def without(model: object, data: object) -> None: ...

    table = "".join(
        f"| `fit: {offer}` | {since} | {removed} | |\n"
        for offer in ("weights", "weights = 1.0", "weights at 2")
    )
    broken = find_broken(
        dict(of_object("fit", _fit)),
        dict(of_object("fit", without)),
        read_deprecations(table),
        version,
    )
    assert (not broken) == holds


def test_a_new_argument_that_is_required_is_found_and_one_with_default_is_not():
    def required(model: object, data: object, weights: float = 1.0, *, seed: int) -> None: ...
    def optional(model: object, data: object, weights: float = 1.0, *, seed: int = 0) -> None: ...

    promised = dict(of_object("fit", _fit))
    assert find_broken(promised, dict(of_object("fit", required))) == ["fit: needs seed"]
    assert not find_broken(promised, dict(of_object("fit", optional)))


# --- REST -----------------------------------------------------------------------------------------


def _change(openapi: dict[str, Any], schema: str) -> tuple[dict[str, Any], dict[str, Any]]:
    changed = copy.deepcopy(openapi)
    return changed, changed["components"]["schemas"][schema]


def test_a_renamed_field_of_a_response_is_found(openapi):
    changed, run = _change(openapi, "Run")
    run["properties"]["status"] = run["properties"].pop("state")
    assert "response Run.state" in find_broken(dict(of_rest(openapi)), dict(of_rest(changed)))


def test_a_renamed_field_of_a_request_is_found(openapi):
    changed, request = _change(openapi, "RunRequest")
    request["properties"]["maneuver"] = request["properties"].pop("maneuver_id")
    broken = find_broken(dict(of_rest(openapi)), dict(of_rest(changed)))
    assert "request RunRequest.maneuver_id" in broken


def test_a_response_that_may_lack_a_value_is_found(openapi):
    changed, run = _change(openapi, "Run")
    run["properties"]["state"] = {"anyOf": [run["properties"]["state"], {"type": "null"}]}
    broken = find_broken(dict(of_rest(openapi)), dict(of_rest(changed)))
    assert broken == ["response Run.state: needs null"]


def test_a_removed_operation_and_a_parameter_now_required_are_found(openapi):
    changed = copy.deepcopy(openapi)
    del changed["paths"]["/api/v1/events"]
    (listed,) = (
        p for p in changed["paths"]["/api/v1/runs"]["get"]["parameters"] if p["name"] == "limit"
    )
    listed["required"] = True
    broken = find_broken(dict(of_rest(openapi)), dict(of_rest(changed)))
    assert {"GET /api/v1/events", "GET /api/v1/runs: needs query limit"} <= set(broken)


def test_an_additional_field_breaks_nothing(openapi):
    changed, run = _change(openapi, "Run")
    run["properties"]["colour"] = {"type": "string"}
    assert not find_broken(dict(of_rest(openapi)), dict(of_rest(changed)))


# --- Mappings and commands ------------------------------------------------------------------------


def test_a_dropped_key_of_a_mapping_is_found():
    kept = {
        name: (field.annotation, field)
        for name, field in TimeMapping.model_fields.items()
        if name not in ("proposed", "offset_s")
    }
    dropped = create_model("Dropped", __base__=MappingTable, __doc__=TimeMapping.__doc__, **kept)  # type: ignore[call-overload]
    broken = find_broken(dict(of_table(TimeMapping)), dict(of_table(dropped)))
    assert broken == ["mapping [time] offset"]


def test_a_dropped_option_and_a_dropped_choice_are_found():
    def make(*methods: str, option: str) -> Promises:
        parser = argparse.ArgumentParser()
        parser.add_argument("--method", choices=methods)
        parser.add_argument(option)
        return dict(of_command("flexsid run", parser))

    broken = find_broken(make("OE", "FRE", option="--band"), make("OE", option="--range"))
    assert {"flexsid run: --band", "flexsid run: --method FRE"} <= set(broken)
