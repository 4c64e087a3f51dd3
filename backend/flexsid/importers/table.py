"""Table: base of the models of a mapping file, the types of its keys, and its errors.

pydantic checks a mapping; what it cannot check raises ``InvalidValue``. ``read_table`` turns the
first error of either kind into an error that names the key.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from typing import Annotated, Any, Self, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    ModelWrapValidatorHandler,
    PrivateAttr,
    Strict,
    Tag,
    ValidationError,
    ValidationInfo,
    model_validator,
)
from pydantic_core import CoreSchema, ErrorDetails, core_schema

from flexsid import units
from flexsid.errors import BadInput
from flexsid.text import LONGEST_FIELD, check_line, check_lines, one_line

_LARGEST_INTEGER = 2**31 - 1
"""Largest integer of both databases."""

_LARGEST_NUMBER = units.LARGEST["number"]
_NUMBER = f"must be a finite number of at most {_LARGEST_NUMBER:g}"
_PROBLEMS = {
    "string_type": "must be a text",
    "int_type": f"must be a whole number of at most {_LARGEST_INTEGER}",
    "float_type": _NUMBER,
    "float_parsing": _NUMBER,
    "finite_number": _NUMBER,
    "bool_type": "must be true or false",
    "tuple_type": "must be a list",
    "dict_type": "must be a table",
    "enum": "must be {expected}",
    "literal_error": "must be {expected}",
    "union_tag_invalid": "must be {expected_tags}",
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be at least {ge:.10g}",
    "less_than_equal": "must be at most {le:.10g}",
    "too_short": "must have at least {min_length} entries",
    "too_long": "must have at most {max_length} entries",
}
"""Text of the errors of pydantic by their type."""


class InvalidValue(ValueError):
    """A value that is not valid; ``key`` is its key in the table that raises it."""

    def __init__(
        self, problem: str, key: str = "", code: str = "bad-mapping", **context: object
    ) -> None:
        super().__init__(problem)
        self.key, self.code, self.context = key, code, context


def refuse(path: str, problem: str) -> BadInput:
    """Build the error for one key of a mapping."""
    return BadInput(f"Mapping: '{path}' {problem}", code="bad-mapping", key=path)


@dataclass(frozen=True, slots=True)
class Guessed:
    """A key of a mapping that was proposed and is not confirmed."""

    path: str
    value: object


def key(meaning: str, default: Any = ..., **options: Any) -> Any:
    """Define a key of a table: its meaning, its default unless required, options of ``Field``."""
    return Field(default, description=meaning, **options)


class MappingTable(BaseModel):
    """A table of a mapping file; an unknown key is an error, as it may be misspelt."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    proposed: tuple[str, ...] = key("keys that a program proposed, to confirm", (), alias="guessed")
    _path: str = PrivateAttr("")
    _guessed: tuple[Guessed, ...] = PrivateAttr(())

    @property
    def guessed(self) -> tuple[Guessed, ...]:
        """Unconfirmed keys of the whole file, known to its outermost table."""
        return self._guessed

    def path(self, key: str) -> str:
        """Return the path of a key in the file, such as ``channels[2].unit``."""
        return _join(self._path, key)

    def entries(self) -> dict[str, Any]:
        """Return the values by their names."""
        return {name: value for name, value in self if name != "proposed"}

    @model_validator(mode="wrap")
    @classmethod
    def _check_keys(
        cls, values: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo
    ) -> Self:
        if not isinstance(values, dict):
            raise InvalidValue(f"must be a table, found {values!r:.60}.")
        fields = {field.alias or name: field for name, field in cls.model_fields.items()}
        for name in values:
            if name not in fields:
                close = difflib.get_close_matches(name, fields, n=1)
                known = f"known: {', '.join(sorted(fields.keys() - {'guessed'}))}."
                hint = f"did you mean '{close[0]}'?" if close else known
                raise InvalidValue(f"is not a key of this table; {hint}", name)
        for name, field in fields.items():
            if field.is_required() and name not in values:
                raise InvalidValue(f"is missing; expected {field.description}.", name)
        table = handler(values)
        table._path = getattr(values, "path", "")
        for name in table.proposed:
            if name not in values or name == "guessed":
                raise InvalidValue(f"names '{name}', which is not a key of its table.", "guessed")
            if info.context is not None:
                info.context.append(Guessed(table.path(name), values[name]))
        return table


_Table = TypeVar("_Table", bound=MappingTable)


def read_table(model: type[_Table], content: dict[str, Any]) -> _Table:
    """Check a mapping, or a table of it.

    Raises
    ------
    BadInput
        Naming the first key that is missing, misspelt or of the wrong kind.
    """
    guessed: list[Guessed] = []
    try:
        table = model.model_validate(_locate(content), context=guessed)
    except ValidationError as error:
        raise _translate(error.errors(include_url=False)[0]) from error
    table._guessed = tuple(guessed)
    return table


class _LocatedTable(dict[str, Any]):
    """A table as written in the file, with its path."""

    path = ""


def _locate(value: Any, path: str = "") -> Any:
    if isinstance(value, dict):
        table = _LocatedTable({key: _locate(own, _join(path, key)) for key, own in value.items()})
        table.path = path
        return table
    if isinstance(value, list):
        return [_locate(own, f"{path}[{place}]") for place, own in enumerate(value, start=1)]
    return value


def _join(*keys: str) -> str:
    return ".".join(filter(None, keys))


def _translate(found: ErrorDetails) -> BadInput:
    """Return the error of the project for an error of pydantic."""
    context = found.get("ctx", {})
    cause = context.get("error")
    path = ""
    for part in found["loc"]:
        if isinstance(part, int):
            path += f"[{part + 1}]"
        elif part != "[key]" and not part.startswith("<"):  # neither a name nor a form
            path = _join(path, one_line(part)[:80])
    if isinstance(cause, InvalidValue):
        path = _join(path, cause.key)
        return BadInput(f"Mapping: '{path}' {cause}", code=cause.code, key=path, **cause.context)
    if cause is not None:  # of a text
        return BadInput(f"Mapping: '{path}' {cause}.", code="bad-text", key=path)
    problem = _PROBLEMS.get(found["type"], found["msg"]).format(**context)
    if found["type"] == "tuple_type" and isinstance(found["input"], dict):
        problem = f"must be an array of tables, written [[{path}]]"
    problem = problem.replace(">', '<", " or ").replace("'<", "").replace(">'", "")
    return refuse(path, f"{problem}, found {found['input']!r:.60}.")


def _get_form(value: object) -> str:
    forms: dict[type, str] = {
        str: "<a text>",
        int: "<a whole number>",
        list: "<a list>",
        _LocatedTable: "<a table>",
    }
    return forms.get(type(value), "<another value>")


BY_FORM = Discriminator(_get_form)
"""Annotation of a key with values of several forms; each has one of these tags."""

TEXT, WHOLE_NUMBER = Tag("<a text>"), Tag("<a whole number>")
LIST, TABLE = Tag("<a list>"), Tag("<a table>")


class FromTable:
    """Annotation of a key whose table becomes the annotated type, by ``build`` of its model."""

    def __init__(self, model: Any) -> None:
        self._model = model

    def __get_pydantic_core_schema__(
        self, record: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        build = getattr(self._model, "build", lambda table: record(**table.entries()))
        schema = handler.generate_schema(self._model)
        return core_schema.no_info_after_validator_function(build, schema)


def _check_text(text: str) -> str:
    if not text.strip():
        raise InvalidValue(f"must be a text, found {text[:40]!r}.")
    return check_line(text, LONGEST_FIELD)


def check_unit(unit: str, dimensions: tuple[str, ...] = (), name: str = "") -> str:
    """Return a known unit, of one of these dimensions if any is given.

    Raises
    ------
    InvalidValue
        At the key ``name`` of the table.
    """
    try:
        found = units.dimension(_check_text(unit))
    except BadInput as error:
        problem = f"is not valid. {error.message}"
        raise InvalidValue(problem, name, code=error.code, unit=unit[:40]) from error
    if dimensions and found not in dimensions:
        expected = " or ".join(dimensions)
        raise InvalidValue(f"measures {found}, but {expected} is expected: '{unit}'.", name)
    return unit


Text = Annotated[str, AfterValidator(_check_text)]
Line = Annotated[str, AfterValidator(lambda text: check_line(text, LONGEST_FIELD))]
Name = Annotated[Text, AfterValidator(lambda text: check_line(text))]
Note = Annotated[str, AfterValidator(lambda text: check_lines(text.strip()))]
Unit = Annotated[str, AfterValidator(lambda unit: check_unit(unit))]
LengthUnit = Annotated[str, AfterValidator(lambda unit: check_unit(unit, ("length",)))]
TimeUnit = Annotated[str, AfterValidator(lambda unit: check_unit(unit, ("time",)))]
Integer = Annotated[int, Strict(), Field(ge=-_LARGEST_INTEGER, le=_LARGEST_INTEGER)]
Number = Annotated[
    float, Strict(), Field(ge=-_LARGEST_NUMBER, le=_LARGEST_NUMBER, allow_inf_nan=False)
]
Texts = tuple[Line, ...]
Numbers = tuple[Number, ...]
Integers = tuple[Integer, ...]
