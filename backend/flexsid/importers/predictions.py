"""The ``[[predictions]]`` part of a mapping: derivatives from arrays."""

from __future__ import annotations

import numpy as np

from flexsid.importers.mapping import PredictionMapping, TermMapping
from flexsid.importers.modal_table import read_layers
from flexsid.importers.source import Sources, refuse_field


def extract_derivatives(
    part: PredictionMapping, sources: Sources, chord_m: float
) -> dict[str, np.ndarray]:
    """Extract derivatives against fuel from their files, nondimensional with half the chord.

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
    found: dict[str, np.ndarray] = {}
    for term in part.terms:
        scale = term.factor
        if term.reference_length_m is not None:
            scale *= 2.0 * term.reference_length_m / chord_m
        values = scale * _layers(term, len(part.fuel), sources)
        for row, coefficient in enumerate(term.coefficients):
            for column, variable in enumerate(term.variables):
                if not variable:
                    continue
                name = f"{coefficient}_{variable}"
                if name in found:
                    problem = f"gives '{name}' of prediction '{part.source}' a second time."
                    raise refuse_field(term.field, problem, "duplicate-derivative")
                found[name] = values[:, row, column]
    return found


def _layers(term: TermMapping, n_fuel: int, sources: Sources) -> np.ndarray:
    """Return the array of a term at every fuel weight, (F, n_coefficients, n_variables)."""
    expected = (len(term.coefficients), len(term.variables))
    layers = []
    for values in read_layers(term.field, n_fuel, sources):
        if 1 in expected and values.size == expected[0] * expected[1]:
            values = values.reshape(expected)
        if values.shape != expected:
            shape = f"{expected[0]} coefficients by {expected[1]} variables"
            problem = f"has shape {values.shape}; {shape} are expected."
            raise refuse_field(term.field, problem, "unequal-lengths")
        if not np.isfinite(values).all():
            raise refuse_field(term.field, "is not finite.", "not-finite")
        layers.append(values)
    return np.array(layers)
