"""Damping of a ground vibration test for the modes of a model, matched by name or shape.

Mode numbers are not comparable between sources.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from flexsid.records.modal_table import ModalTable
from flexsid.storage.store import Store
from flexsid.sysid.modes import ModeTable
from flexsid.sysid.modes.assurance import compute_mac
from flexsid.sysid.modes.table import align_modes, interpolate
from flexsid.sysid.modes.tracking import Tracking
from flexsid.workflow.modal_data.mode_corrections import apply_corrections

ALIKE = 0.7
"""MAC from which two shapes are the same mode."""

UNLIKE = 0.3
"""MAC below which two shapes are different modes, even with the same name."""

SAME_FREQUENCY = 0.05
"""Largest relative difference in frequency of modes with the same number and no name."""

_LEAST_COMPONENTS = 6
"""Measured components from which shapes at sensor points can be compared."""


def match_test_damping(
    store: Store, modal: ModalTable, test: ModalTable, model: ModeTable
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Match damping of a test to the modes of a model; NaN where not measured.

    Parameters
    ----------
    store, modal, test
        Table of the model and of the test.
    model
        Modes of the model, tracked over fuel.

    Returns
    -------
    (F, n) damping at the fuel weights of the model, and warnings on the match.
    """
    modal, test = apply_corrections(store, modal), apply_corrections(store, test)
    measured = _read_test(store, test)
    pairs, warnings = _match(modal, test, model, measured)
    over_fuel = np.stack([interpolate(measured.fuel, measured.zeta, f) for f in model.fuel])
    found = np.full(model.omega.shape, np.nan)
    for mode, other in pairs.items():
        found[:, mode] = over_fuel[:, other]
    return found, warnings


def _read_test(store: Store, test: ModalTable) -> ModeTable:
    """Read the modes of the test, tracked over fuel; unknown frequencies are NaN."""
    zeta = np.asarray(store.arrays.get(test.arrays["zeta"]), dtype=float)

    def read(name: str, empty: np.ndarray) -> np.ndarray:
        if name not in test.arrays:
            return empty
        return np.asarray(store.arrays.get(test.arrays[name]), dtype=float)

    table = ModeTable(
        fuel=np.array(test.fuel, dtype=float),
        numbers=test.numbers,
        omega=read("omega", np.full(zeta.shape, np.nan)),
        zeta=zeta,
        mass=np.ones(zeta.shape),
        points=test.points,
        shape=read("shape", np.zeros((*zeta.shape, 0, 6))),
        gauges=(),
        strain=np.zeros((*zeta.shape, 0)),
    )
    if "order" not in test.arrays:
        return align_modes(table) if test.points and "omega" in test.arrays else table
    order, sign, sure = (read(name, np.empty(0)) for name in ("order", "sign", "assurance"))
    mixed = read("mixed", np.zeros(order.shape)).astype(bool)
    return align_modes(table, Tracking(order.astype(np.intp), sign, sure, mixed))


def _match(
    modal: ModalTable, test: ModalTable, model: ModeTable, measured: ModeTable
) -> tuple[dict[int, int], tuple[str, ...]]:
    """Match columns of the model and of the test."""
    alike = _compute_mac(model, measured)
    pairs: dict[int, int] = {}
    warnings: list[str] = []
    for mode, name in enumerate(modal.names):
        same = [k for k, other in enumerate(test.names) if name and other == name]
        if len(same) != 1 or modal.names.count(name) != 1:
            continue
        if alike is not None and alike[mode, same[0]] < UNLIKE:
            warnings.append(
                f"The damping of {name} in {test.name} is not used: its shape differs "
                f"(MAC {alike[mode, same[0]]:.2f})."
            )
            continue
        pairs[mode] = same[0]
    taken = set(pairs.values())
    if alike is not None:
        for mode, other in zip(*linear_sum_assignment(-alike), strict=True):
            mode, other = int(mode), int(other)
            if mode not in pairs and other not in taken and alike[mode, other] >= ALIKE:
                pairs[mode] = other
                warnings.append(
                    f"The damping of mode {modal.numbers[mode]} is that of mode "
                    f"{test.numbers[other]} of {test.name}, whose shape is similar "
                    f"(MAC {alike[mode, other]:.2f})."
                )
    else:
        pairs |= _match_by_number(modal, test, model, measured, set(pairs.values()))
    return pairs, tuple(warnings)


def _match_by_number(
    modal: ModalTable, test: ModalTable, model: ModeTable, measured: ModeTable, taken: set[int]
) -> dict[int, int]:
    """Match modes without a name by number and frequency."""
    found = {}
    for mode, number in enumerate(modal.numbers):
        if modal.names[mode] or number not in test.numbers:
            continue
        other = test.numbers.index(number)
        if other in taken or test.names[other]:
            continue
        if test.symmetric[other] != modal.symmetric[mode]:
            continue
        at = interpolate(model.fuel, model.omega, float(measured.fuel[0]))[mode]
        if abs(measured.omega[0, other] / at - 1.0) < SAME_FREQUENCY:
            found[mode] = other
    return found


def _compute_mac(model: ModeTable, measured: ModeTable) -> np.ndarray | None:
    """Compute the MAC at common sensor points; None with too few of them."""
    common = [point for point in model.points if point in measured.points]
    if not common:
        return None
    fuel = float(measured.fuel[0])
    one, other = (
        np.moveaxis(table.at(fuel).translation, -1, 0)[
            :, [table.points.index(point) for point in common]
        ].reshape(len(table.numbers), -1)
        for table in (model, replace(measured, zeta=np.nan_to_num(measured.zeta)))
    )
    moved = (np.abs(one).max(axis=0) > 0) & (np.abs(other).max(axis=0) > 0)
    if int(moved.sum()) < _LEAST_COMPONENTS:
        return None
    return np.nan_to_num(compute_mac(one[:, moved], other[:, moved]))
