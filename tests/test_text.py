"""Checks and conversions of names and notes."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexsid.text import (
    check_line,
    check_lines,
    escape_spreadsheet_cell,
    make_c_identifiers,
    one_line,
)

HOSTILE = [
    "a\x00b",
    "a\nb",
    "\x1b[31m",
    "\u202egpj.exe",
    "a\u2066b",
    "a\u200bb",
    "\ud800",
    "x" * 201,
]


@pytest.mark.parametrize("text", HOSTILE)
def test_invisible_characters_are_refused_in_names(text: str) -> None:
    with pytest.raises(ValueError, match=r"character|blanks"):
        check_line(text)


def test_notes_have_lines_and_names_one_spelling() -> None:
    assert check_lines("first\r\n\tsecond") == "first\n\tsecond"
    assert check_line("Zoe\u0308") == "Zo\u00eb"
    assert (
        check_line("\u0645\u06cc\u200c\u062e\u0648\u0627\u0647\u0645") != ""
    )  # Persian needs a joiner
    with pytest.raises(ValueError, match="blanks"):
        check_line("  ")


@given(st.text(max_size=60))
@settings(max_examples=100)
def test_every_text_is_refused_or_returned_as_one_line(text: str) -> None:
    try:
        checked = check_line(text)
    except ValueError:
        return
    assert check_line(checked) == checked
    assert len(checked.splitlines()) <= 1
    assert checked.encode().decode() == checked


@given(st.lists(st.text(min_size=1, max_size=80), min_size=1, max_size=5, unique=True))
@settings(max_examples=100)
def test_identifiers_are_those_of_c_and_never_shared(names: list[str]) -> None:
    made = make_c_identifiers(tuple(names), longest=25)
    assert len(set(made)) == len(names)
    for own in made:
        assert own.isascii()
        assert own.isidentifier()
        assert len(own) <= 25


@pytest.mark.parametrize("text", ["=cmd|' /C calc'!A0", "+1", "-1", "@x", "\t=1", " =1", "\r=1"])
def test_no_cell_is_a_formula(text: str) -> None:
    assert escape_spreadsheet_cell(text).startswith("'")
    assert escape_spreadsheet_cell("az_nose") == "az_nose"


def test_old_records_leave_as_one_line() -> None:
    assert one_line("a\x00b\nc\u202ed") == "a b c d"
