"""Data of FLEX-28 before flight: modal tables, predictions, model structures."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np

from flexsid.demo.flex28 import INPUTS, Truth, UnsteadyTruth, load_nodes
from flexsid.records.aircraft import DerivativePrediction, UnsteadyPrediction
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.records.model_structure import ModelStructure, Structure
from flexsid.sysid.model.derivatives import (
    list_derivative_names,
    parse_derivative,
    variables,
)
from flexsid.workflow.modal_data.computed_predictions import KIND, compute_spread

SaveArray = Callable[[np.ndarray], str]
"""Stores an array and returns its name."""

_NAMES = {7: "SW1B", 8: "AW1B", 9: "SW1T", 10: "AW1T", 11: "SFA", 12: "SWL"}

# Inviscid panel code: surface effectiveness too large, damping too small.
_PANEL_BIAS = {"alpha": 1.08, "q": 0.88, "eta": 1.10, "etadot": 0.90, "surface": 1.18}
_RESIDUAL = 0.003  # of frequencies: of an updated finite element model from those of a test
_REFERENCE_K = 0.15  # of flutter
# A stiff half-span model on a splitter plate, at low Reynolds number.
_TUNNEL_BIAS = {"alpha": 0.95, "surface": 0.86}


def build_modal_tables(
    truth: Truth, aircraft_id: int, save: SaveArray
) -> tuple[ModalTable, ModalTable]:
    """Return the updated finite element model, which is exact, and the ground vibration test."""
    modes = truth.modes
    places, shapes = load_nodes()
    symmetric = tuple(kind == "S" for kind in truth.source["mode_class"])
    names = tuple(
        _NAMES.get(number, f"{kind}{number}")
        for number, kind in zip(modes.numbers, truth.source["mode_class"], strict=True)
    )
    finite_elements = ModalTable(
        aircraft_id=aircraft_id,
        name="FEM",
        kind=ModalKind.FEM,
        fuel=tuple(modes.fuel.tolist()),
        numbers=modes.numbers,
        names=names,
        symmetric=symmetric,
        points=modes.points,
        gauges=modes.gauges,
        arrays={
            "omega": save(modes.omega),
            "omega_std": save(_RESIDUAL * modes.omega),
            "mass": save(modes.mass),
            "shape": save(modes.shape),
            "strain": save(modes.strain),
            "nodes": save(places),
            "node_shape": save(shapes),
        },
        origin=(
            "beam finite element model of FLEX-28, updated from its ground vibration test; 25 modes"
            " at 17 fuel weights"
        ),
    )
    residual = 1.0 + _RESIDUAL * np.random.default_rng(7).standard_normal((2, modes.omega.shape[1]))
    ends = [0, -1]
    ground_test = ModalTable(
        aircraft_id=aircraft_id,
        name="GVT",
        kind=ModalKind.GVT,
        fuel=tuple(modes.fuel[ends].tolist()),
        numbers=modes.numbers,
        names=names,
        symmetric=symmetric,
        arrays={"omega": save(modes.omega[ends] * residual), "zeta": save(modes.zeta[ends])},
        origin="ground vibration test at empty and full fuel",
    )
    return finite_elements, ground_test


def build_predictions(
    truth: Truth, aircraft_id: int, save: SaveArray
) -> tuple[DerivativePrediction, DerivativePrediction]:
    """Return two predictions with typical, reproducible errors of their kind.

    A panel code or, of unsteady aerodynamics, a doublet lattice; and a wind tunnel test.
    """
    names = list_derivative_names(truth.symmetric, INPUTS)
    true = truth.derivatives.reshape(truth.fuel.size, -1)
    noise = np.random.default_rng(28).standard_normal((2, len(names)))
    measured = [
        place
        for place, name in enumerate(names)
        if parse_derivative(name)[0] in ("CZ", "Cm") and _group(name) in _TUNNEL_BIAS
    ]
    own = tuple(names[place] for place in measured)
    tunnel_factor = np.array([_TUNNEL_BIAS[_group(name)] for name in own])
    values = true[:, measured] * (tunnel_factor + 0.03 * noise[1, measured])
    tunnel = DerivativePrediction(
        aircraft_id=aircraft_id,
        source="Wind tunnel, half-span model",
        kind="wind tunnel",
        fuel=tuple(truth.fuel.tolist()),
        names=own,
        values=save(values),
        std_errors=save(0.03 * np.abs(values) + 0.002),
        note="stiff model, moments transferred to the centre of gravity at each fuel weight",
    )
    if truth.unsteady is not None:
        return build_lattice_prediction(truth, truth.unsteady, aircraft_id, save), tunnel
    panel_factor = np.array([_PANEL_BIAS[_group(name)] for name in names]) + 0.08 * noise[0]
    panel = DerivativePrediction(
        aircraft_id=aircraft_id,
        source="Panel code",
        kind="panel code",
        fuel=tuple(truth.fuel.tolist()),
        names=names,
        values=save(true * panel_factor),
        note="inviscid, eight symmetric modes; no error bounds are known",
    )
    return panel, tunnel


def build_lattice_prediction(
    truth: Truth, unsteady: UnsteadyTruth, aircraft_id: int, save: SaveArray
) -> DerivativePrediction:
    """Return the doublet lattice of FLEX-28U as a prediction at the k of flutter."""
    names = list_derivative_names(truth.symmetric, INPUTS)
    at = int(np.searchsorted(unsteady.k, _REFERENCE_K))
    values = np.real(unsteady.predicted[:, at])
    n_fuel, n_k = unsteady.predicted.shape[:2]
    return DerivativePrediction(
        aircraft_id=aircraft_id,
        source="Doublet lattice",
        kind=KIND,
        fuel=tuple(unsteady.fuel.tolist()),
        names=names,
        values=save(values.reshape(n_fuel, -1)),
        std_errors=save(
            compute_spread(values, variables(truth.symmetric, INPUTS)).reshape(n_fuel, -1)
        ),
        note=f"320 boxes on the right half, Mach 0.1, derivatives at k = {_REFERENCE_K:g}",
        unsteady=UnsteadyPrediction(
            k=tuple(unsteady.k.tolist()),
            reference_k=_REFERENCE_K,
            coefficients=save(unsteady.predicted.reshape(n_fuel, n_k, -1)),
            mach=0.1,
            n_boxes=320,
            geometry=hashlib.sha256(truth.name.encode()).hexdigest(),
        ),
    )


def build_model_structures(aircraft_id: int) -> tuple[ModelStructure, ...]:
    """Return the default model structures, with all surfaces and usable sensors."""
    steps = (
        ("SP + SW1B", (7,), "for FTA 503, whose band ends below SW1T"),
        ("SP + SW1B + SW1T", (7, 9), "for FTA 506; SFA and SWL remain as bias"),
        ("SP + four modes", (7, 9, 11, 12), "for FTA 506: SW1B, SW1T, SFA, SWL"),
    )
    return tuple(
        ModelStructure(
            aircraft_id=aircraft_id,
            name=name,
            structure=Structure(modes=modes, fixed={}),
            note=note,
        )
        for name, modes, note in steps
    )


def _group(name: str) -> str:
    variable = parse_derivative(name)[1].rstrip("0123456789")
    return variable if variable in _PANEL_BIAS else "surface"
