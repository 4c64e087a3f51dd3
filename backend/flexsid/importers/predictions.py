"""The ``[[predictions]]`` part of a mapping: derivatives from arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.quantity import refuse
from flexsid.importers.source import Sources
from flexsid.importers.table import MappingTable


@dataclass(frozen=True, slots=True, kw_only=True)
class TermPart:
    """One array of derivatives: a row per coefficient, a column per variable.

    An empty variable skips its column. ``reference_length_m`` is the length L
    of a source that normalises rates as q L / V; None means half the chord.
    """

    field: str
    coefficients: tuple[str, ...]
    variables: tuple[str, ...]
    reference_length_m: float | None
    factor: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictionPart:
    """One source of derivatives."""

    source: str
    kind: str
    fuel: float
    terms: tuple[TermPart, ...]
    note: str


@dataclass(frozen=True, slots=True, kw_only=True)
class RawPrediction:
    """Derivatives by name, nondimensional with half the chord; ``values`` is (1, n_names)."""

    source: str
    kind: str
    fuel: tuple[float, ...]
    names: tuple[str, ...]
    values: np.ndarray
    note: str


def read_prediction(table: MappingTable) -> PredictionPart:
    """Read one ``[[predictions]]`` entry with its ``terms``."""
    part = PredictionPart(
        source=table.label("source"),
        kind=table.choice(
            "kind", ("panel code", "wind tunnel", "simulation", "flight"), "panel code"
        ),
        fuel=table.number("fuel", 0.0),
        terms=tuple(_read_term(row) for row in table.tables("terms")),
        note=table.note("note"),
    )
    table.close()
    if not part.terms:
        raise refuse(table.path("terms"), "is missing; it defines the arrays of the derivatives.")
    return part


def _read_term(table: MappingTable) -> TermPart:
    term = TermPart(
        field=table.text("field"),
        coefficients=table.texts("coefficients"),
        variables=table.texts("variables"),
        reference_length_m=(
            table.si_scalar("reference_length", "length") if "reference_length" in table else None
        ),
        factor=table.number("factor", 1.0),
    )
    table.close()
    if term.reference_length_m is not None:
        rates = ("q", "etadot")
        if not all(name.startswith(rates) or not name for name in term.variables):
            raise refuse(table.path("reference_length"), "applies only to the rates q and etadot.")
        if term.reference_length_m <= 0:
            raise refuse(table.path("reference_length"), "must be positive.")
    return term


def extract_prediction(part: PredictionPart, sources: Sources, chord_m: float) -> RawPrediction:
    """Extract derivatives from their files.

    A derivative with respect to q L / V is multiplied by 2 L / chord to refer
    to q chord / (2 V), the convention of Eq. 12.

    Parameters
    ----------
    part
        The entry of the mapping.
    sources
        Files of the import.
    chord_m
        Reference chord of the aircraft. [m]
    """
    found: dict[str, float] = {}
    for term in part.terms:
        scale = term.factor
        if term.reference_length_m is not None:
            scale *= 2.0 * term.reference_length_m / chord_m
        values = scale * _matrix(term, sources)
        for row, coefficient in enumerate(term.coefficients):
            for column, variable in enumerate(term.variables):
                if not variable:
                    continue
                name = f"{coefficient}_{variable}"
                if name in found:
                    raise BadInput(
                        f"Prediction '{part.source}' gives '{name}' twice (field '{term.field}').",
                        code="duplicate-derivative",
                        column=term.field,
                    )
                found[name] = float(values[row, column])
    return RawPrediction(
        source=part.source,
        kind=part.kind,
        fuel=(part.fuel,),
        names=tuple(found),
        values=np.array([list(found.values())]),
        note=part.note,
    )


def _matrix(term: TermPart, sources: Sources) -> np.ndarray:
    expected = (len(term.coefficients), len(term.variables))
    values = np.asarray(sources.numbers(term.field), dtype=np.float64)
    if 1 in expected and values.size == expected[0] * expected[1]:
        values = values.reshape(expected)
    if values.shape != expected:
        raise BadInput(
            f"Field '{term.field}' has shape {values.shape}; {expected[0]} coefficients by "
            f"{expected[1]} variables are expected.",
            code="unequal-lengths",
            column=term.field,
        )
    if not np.isfinite(values).all():
        raise BadInput(f"Field '{term.field}' is not finite.", code="not-finite", column=term.field)
    return values
