"""Table: a TOML table with checked keys; messages name the invalid key."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from flexsid import units
from flexsid.errors import BadInput
from flexsid.importers.quantity import MappedQuantity, refuse
from flexsid.text import LONGEST_FIELD, LONGEST_NAME, LONGEST_NOTE, check_line, check_lines

_LARGEST_INTEGER = 2**31 - 1
"""Largest integer of both databases."""


@dataclass(frozen=True, slots=True)
class Guessed:
    """A key of a mapping that was proposed and is not confirmed."""

    path: str
    value: object


class MappingTable:
    """Checked access to the keys of a table; ``close`` rejects unknown keys.

    Any table may list, as ``guessed = ["unit"]``, keys that a program proposed: they are
    collected in ``guesses`` of the outermost table.
    """

    def __init__(
        self, values: Mapping[str, object], path: str = "", guesses: list[Guessed] | None = None
    ) -> None:
        self._values = values
        self._path = path
        self._asked: set[str] = set()
        self.guesses: list[Guessed] = [] if guesses is None else guesses

    def path(self, key: str) -> str:
        """Return the dotted path of a key."""
        return f"{self._path}.{key}" if self._path else key

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def _get(self, key: str, expected: str) -> object:
        self._asked.add(key)
        if key not in self._values:
            raise refuse(self.path(key), f"is missing; {expected} is expected.")
        return self._values[key]

    def text(self, key: str, default: str | None = None) -> str:
        """Read a text."""
        if default is not None and key not in self._values:
            return default
        value = self._get(key, "a text")
        if not isinstance(value, str) or not value.strip():
            raise refuse(self.path(key), f"must be a text, found {str(value)[:40]!r}.")
        return self._checked(key, value, check_line, LONGEST_FIELD)

    def label(self, key: str, default: str | None = None) -> str:
        """Read a name that is stored."""
        return self._checked(key, self.text(key, default), check_line, LONGEST_NAME)

    def note(self, key: str) -> str:
        """Read an optional text of several lines."""
        value = self._values.get(key, "")
        self._asked.add(key)
        if not isinstance(value, str):
            raise refuse(self.path(key), f"must be a text, found {str(value)[:40]!r}.")
        return self._checked(key, value.strip(), check_lines, LONGEST_NOTE)

    def optional_text(self, key: str) -> str | None:
        """Read an optional text."""
        return self.text(key) if key in self._values else None

    def choice(self, key: str, allowed: tuple[str, ...], default: str | None = None) -> str:
        """Read one of the allowed words."""
        value = self.text(key, default)
        if value not in allowed:
            raise refuse(self.path(key), f"must be one of {', '.join(allowed)}; found '{value}'.")
        return value

    def integer(self, key: str, default: int | None = None) -> int:
        """Read a whole number."""
        if default is not None and key not in self._values:
            return default
        value = self._get(key, "a whole number")
        if isinstance(value, bool) or not isinstance(value, int) or abs(value) > _LARGEST_INTEGER:
            raise refuse(
                self.path(key),
                f"must be a whole number of at most {_LARGEST_INTEGER}, found {str(value)[:40]}.",
            )
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """Read a finite number."""
        if default is not None and key not in self._values:
            return default
        return _finite(self._get(key, "a number"), self.path(key))

    def optional_number(self, key: str) -> float | None:
        """Read an optional finite number."""
        return self.number(key) if key in self._values else None

    def numbers(self, key: str) -> tuple[float, ...]:
        """Read a list of finite numbers."""
        return tuple(
            _finite(value, self.path(key)) for value in self._list(key, "a list of numbers")
        )

    def integers(self, key: str) -> tuple[int, ...]:
        """Read a list of whole numbers."""
        values = self._list(key, "a list of whole numbers")
        if any(
            isinstance(value, bool) or not isinstance(value, int) or abs(value) > _LARGEST_INTEGER
            for value in values
        ):
            raise refuse(
                self.path(key), f"must hold whole numbers of at most {_LARGEST_INTEGER} only."
            )
        return tuple(cast("list[int]", values))

    def texts(self, key: str) -> tuple[str, ...]:
        """Read a list of texts."""
        values = self._list(key, "a list of texts")
        if any(not isinstance(value, str) for value in values):
            raise refuse(self.path(key), "must hold texts only.")
        texts = cast("list[str]", values)
        return tuple(self._checked(key, text, check_line, LONGEST_FIELD) for text in texts)

    def flags(self, key: str) -> tuple[bool, ...]:
        """Read a list of true and false."""
        values = self._list(key, "a list of true and false")
        if any(not isinstance(value, bool) for value in values):
            raise refuse(self.path(key), "must hold true and false only.")
        return tuple(cast("list[bool]", values))

    def table(self, key: str) -> MappingTable:
        """Read a table below this one."""
        value = self._get(key, "a table")
        if not isinstance(value, dict):
            raise refuse(self.path(key), f"must be a table, found {value!r}.")
        return MappingTable(cast("dict[str, object]", value), self.path(key), self.guesses)

    def tables(self, key: str) -> tuple[MappingTable, ...]:
        """Read an optional array of tables."""
        if key not in self._values:
            return ()
        values = self._list(key, "an array of tables")
        if any(not isinstance(value, dict) for value in values):
            raise refuse(self.path(key), "must be an array of tables, written [[...]].")
        rows = cast("list[dict[str, object]]", values)
        return tuple(
            MappingTable(row, f"{self.path(key)}[{number}]", self.guesses)
            for number, row in enumerate(rows, 1)
        )

    def names(self) -> tuple[str, ...]:
        """Give all keys, for tables whose keys are names."""
        self._asked.update(self._values)
        return tuple(
            self._checked(name[:40], name, check_line, LONGEST_FIELD) for name in self._values
        )

    def is_table(self, key: str) -> bool:
        """Return whether the key holds a table."""
        return isinstance(self._values.get(key), dict)

    def quantity(self, key: str, dimension: str) -> MappedQuantity:
        """Read ``{value, unit}``, ``{values, unit}`` or ``{field, unit}``."""
        table = self.table(key)
        unit = table.text("unit", "1" if dimension == "number" else None)
        try:
            found = units.dimension(unit)
        except BadInput as error:
            raise BadInput(
                f"Mapping: '{table.path('unit')}': {error.message}",
                code=error.code,
                key=table.path("unit"),
            ) from error
        if found != dimension:
            raise refuse(
                table.path("unit"), f"measures {found}, but {dimension} is expected: '{unit}'."
            )
        if "field" in table:
            quantity = MappedQuantity(
                unit=unit, field=table.text("field"), path=table.path("field")
            )
        elif "values" in table:
            quantity = MappedQuantity(
                unit=unit, values=table.numbers("values"), path=table.path("values")
            )
        else:
            quantity = MappedQuantity(
                unit=unit, values=(table.number("value"),), path=table.path("value")
            )
        table.close()
        for value in np.atleast_1d(units.to_si(quantity.values, unit)).tolist():
            try:
                units.check_size(value, dimension)
            except BadInput as error:
                raise refuse(quantity.path, f"holds {error.message}") from error
        return quantity

    def optional_quantity(self, key: str, dimension: str) -> MappedQuantity | None:
        """Read an optional quantity."""
        return self.quantity(key, dimension) if key in self._values else None

    def si(self, key: str, dimension: str) -> tuple[float, ...]:
        """Read literal numbers with a unit, converted to SI."""
        quantity = self.quantity(key, dimension)
        if quantity.field is not None:
            raise refuse(
                quantity.path, "cannot be a field of the file here; write value or values."
            )
        return tuple(float(value) for value in units.to_si(quantity.values, quantity.unit))

    def si_scalar(self, key: str, dimension: str) -> float:
        """Read one literal number with a unit, converted to SI."""
        values = self.si(key, dimension)
        if len(values) != 1:
            raise refuse(self.path(key), f"must be one number, found {len(values)}.")
        return values[0]

    def close(self) -> None:
        """Reject keys that were not read: a misspelt key must not be ignored."""
        for name in self.texts("guessed") if "guessed" in self._values else ():
            if name not in self._values or name == "guessed":
                raise refuse(
                    self.path("guessed"), f"names '{name}', which is not a key of its table."
                )
            self.guesses.append(Guessed(self.path(name), self._values[name]))
        for key in self._values:
            if key not in self._asked:
                close = difflib.get_close_matches(key, sorted(self._asked), n=1)
                hint = (
                    f"did you mean '{close[0]}'?"
                    if close
                    else f"known: {', '.join(sorted(self._asked))}."
                )
                raise refuse(self.path(key), f"is not a key of this table; {hint}")

    def _checked(self, key: str, value: str, check: Callable[[str, int], str], longest: int) -> str:
        try:
            return check(value, longest)
        except ValueError as error:
            raise BadInput(
                f"Mapping: '{self.path(key)}' {error}.", code="bad-text", key=self.path(key)
            ) from error

    def _list(self, key: str, expected: str) -> list[object]:
        value = self._get(key, expected)
        if not isinstance(value, list):
            raise refuse(self.path(key), f"must be {expected}, found {value!r}.")
        return cast("list[object]", value)


def _finite(value: object, path: str) -> float:
    if (
        isinstance(value, bool)
        or not isinstance(value, (int, float))
        or not abs(value) <= units.LARGEST["number"]
    ):
        largest = units.LARGEST["number"]
        found = str(value)[:40]
        raise refuse(path, f"must be a finite number of at most {largest:g}, found {found}.")
    return float(value)
