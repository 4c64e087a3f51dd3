"""Modal tables: modes tracked over fuel, with corrected names and measured damping."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from flexsid.errors import BadInput
from flexsid.importers.modal_data.options import TO_BODY
from flexsid.importers.modal_files import WrittenModes
from flexsid.records.modal_data import ModalKind, ModalTable
from flexsid.storage.repository import read_once
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import RIGID_BODIES
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.reduction import (
    ASSUMED_DAMPING_ERROR,
    FEM_FREQUENCY,
    GVT_DAMPING,
    GVT_FREQUENCY,
)
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.modes import ModeTable
from flexsid.sysid.modes.assurance import compute_mac
from flexsid.sysid.modes.shapes import may_be
from flexsid.sysid.modes.table import (
    Tracking,
    align_modes,
    compute_fuel_weights,
    make_identity_tracking,
    sum_weighted_rows,
    track_modes,
)
from flexsid.sysid.signals import interpolate
from flexsid.workflow.aircraft.derivative_predictions import list_predicted_modes, select_by_id
from flexsid.workflow.aircraft.written_back import read_written_versions

ASSUMED_DAMPING = 0.02

ALIKE = 0.7
"""MAC from which two shapes are the same mode."""

UNLIKE = 0.3
"""MAC below which two shapes are different modes, even with the same name."""

SAME_FREQUENCY = 0.05
"""Largest relative difference in frequency of modes with the same number and no name."""

FREQUENCY_STD = {ModalKind.FEM: FEM_FREQUENCY, ModalKind.GVT: GVT_FREQUENCY}
"""Relative standard deviation of the frequencies of a modal table."""

SHAPE_STD = {ModalKind.FEM: 0.1, ModalKind.GVT: 0.03}
"""Standard deviation of the shapes of a modal table that states none, relative to their rms.

A MAC of 0.99 and 0.999: of finite element models 0.90 to 0.99 is usual."""

_LEAST_COMPONENTS = 6
"""Measured components from which shapes at sensor points can be compared."""

DEVIATIONS = ("omega_std", "zeta_std", "shape_std")
"""Arrays with standard deviations of frequencies, damping and shapes."""

TO_STRUCTURE = np.tile(TO_BODY, 2)
"""Shapes with rotations from body to structural axes: a half turn about y, its own inverse."""


def apply_corrections(store: Store, table: ModalTable) -> ModalTable:
    """Return a table with corrected mode names and symmetries."""
    names, symmetric, reasons = list(table.names), list(table.symmetric), list(table.reasons)
    reasons += [""] * (len(names) - len(reasons))
    for correction in store.mode_corrections.find(modal_table_id=table.id):
        if correction.number in table.numbers:
            index = table.numbers.index(correction.number)
            names[index], symmetric[index] = correction.name, correction.symmetric
            by = f", by {correction.author}" if correction.author else ""
            reasons[index] = f"{correction.reason} (corrected{by})"
    return replace(table, names=tuple(names), symmetric=tuple(symmetric), reasons=tuple(reasons))


def list_corrections(store: Store, table_ids: Iterable[int]) -> list[list[Any]]:
    """List what the corrections of modes say, in the order in which they apply."""
    found = [
        one
        for number in dict.fromkeys(table_ids)
        for one in store.mode_corrections.find(modal_table_id=number)
    ]
    return [[one.modal_table_id, one.number, one.name, one.symmetric] for one in found]


def format_title(table: ModalTable) -> str:
    """Return the name of a table with its version."""
    return table.name if table.version == 1 else f"{table.name} (version {table.version})"


def list_mode_names(table: ModalTable) -> tuple[str, ...]:
    """List the names of the modes of a table; by number without name."""
    named = zip(table.names, table.numbers, strict=True)
    return tuple(name or f"mode {number}" for name, number in named)


@dataclass(frozen=True, slots=True)
class AircraftModes:
    """Modes against fuel with their names; ``warnings`` list assumptions.

    ``frequency_std`` and ``damping_std`` are relative standard deviations of the frequencies
    and of the damping ratio of each mode, by number; ``shape_std`` those of the shapes that the
    table states, relative to their rms, ``assumed_shape_std`` that of the others.
    """

    table: ModeTable
    names: dict[int, str]
    symmetric: dict[int, bool | None]
    warnings: tuple[str, ...]
    frequency_std: dict[int, float]
    damping_std: dict[int, float]
    shape_std: dict[int, float]
    assumed_shape_std: float

    def belongs_to(self, number: int, body: RigidBody) -> bool:
        """Whether a mode may have the symmetry of the motion of an axis."""
        return may_be(self.symmetric[number], body.symmetry == "symmetric")


NO_MODES = AircraftModes(
    table=ModeTable(
        fuel=np.zeros(1),
        numbers=(),
        omega=np.zeros((1, 0)),
        zeta=np.zeros((1, 0)),
        mass=np.zeros((1, 0)),
        points=(),
        shape=np.zeros((1, 0, 0, 6)),
        gauges=(),
        strain=np.zeros((1, 0, 0)),
    ),
    names={},
    symmetric={},
    warnings=(),
    frequency_std={},
    damping_std={},
    shape_std={},
    assumed_shape_std=0.0,
)
"""Modes of an aircraft without modal table, which is identified as a rigid one."""


def find_modal_tables(
    store: Store,
    aircraft_id: int,
    modal_table_id: int | None = None,
    damping_table_id: int | None = None,
    maneuver_ids: Sequence[int] = (),
) -> tuple[ModalTable, ModalTable | None]:
    """Find the requested tables, or the latest FEM with predicted modes and the latest GVT.

    Versions that were undone, or contain the data of these maneuvers, are not found by default.

    Raises
    ------
    BadInput
        If the aircraft has no table with frequencies, or the table belongs to another one.
    """
    tables = store.modal_tables.find(aircraft_id=aircraft_id)
    proposed = tables
    if modal_table_id is None:
        written = read_written_versions(store, aircraft_id, maneuver_ids)
        proposed = _select_predicted(store, written.list_defaults(tables))
    modal = _select(proposed, modal_table_id, ModalKind.FEM, "omega")
    if modal is None:
        raise BadInput(
            "the aircraft has no modal table with frequencies and shapes; import one first",
            code="no-modal-table",
        )
    if damping_table_id is None:  # damping of another model is not measured
        tables = [table for table in tables if table.kind is ModalKind.GVT]
    return modal, _select(tables, damping_table_id, ModalKind.GVT, "zeta")


def load_modes(store: Store, modal: ModalTable, damping: ModalTable | None) -> AircraftModes:
    """Read a modal table, align it over fuel and give it the damping of the GVT."""
    modal = apply_corrections(store, modal)
    aligned = _read_aligned(store, modal)
    zeta, measured, warnings = _find_damping(store, modal, damping, aligned)
    if "mass" not in modal.arrays:
        warnings = (*warnings, "Generalised masses are not in the table: 1 kg m2 assumed.")
    opened = open_modes(store, modal)
    return AircraftModes(
        table=replace(aligned, zeta=zeta),
        names=dict(zip(modal.numbers, list_mode_names(modal), strict=True)),
        symmetric=dict(zip(modal.numbers, modal.symmetric, strict=True)),
        warnings=warnings,
        frequency_std=compute_frequency_std(opened),
        damping_std={
            number: GVT_DAMPING if number in measured else ASSUMED_DAMPING_ERROR
            for number in modal.numbers
        },
        shape_std=_collect_shape_std(opened),
        assumed_shape_std=SHAPE_STD[modal.kind],
    )


def _collect_shape_std(modes: Modes) -> dict[int, float]:
    """Collect the stated relative standard deviation of the shape of each mode, by number.

    The largest of all fuels; zero states that shapes are exact.
    """
    if modes.shape_std is None:
        return {}
    stated = np.fmax.reduce(modes.shape_std, axis=0).tolist()
    return {n: std for n, std in zip(modes.table.numbers, stated, strict=True) if not np.isnan(std)}


def compute_frequency_std(modes: Modes) -> dict[int, float]:
    """Compute the relative standard deviation of the frequency of each mode, by number.

    That of the kind of table; of a measured frequency, also in an updated model, that of a test and
    the standard deviation that its source states.
    """
    of_kind = FREQUENCY_STD[modes.table.kind]
    if modes.omega_std is None:
        return dict.fromkeys(modes.table.numbers, of_kind)
    stated = np.hypot(GVT_FREQUENCY, modes.omega_std / modes.omega).max(axis=0)
    std = np.where(np.isfinite(stated), stated, of_kind)
    return dict(zip(modes.table.numbers, std.tolist(), strict=True))


def load_modes_of_model(
    store: Store,
    aircraft_id: int,
    modal_table_id: int | None,
    damping_table_id: int | None,
    numbers: tuple[int, ...],
    maneuver_ids: Sequence[int] = (),
) -> tuple[AircraftModes, tuple[int | None, int | None]]:
    """Load the modes for a model with some of them, and the ids of their tables.

    A rigid model of an aircraft without modal table has no modes and no tables.

    Raises
    ------
    BadInput
        As ``find_modal_tables``.
    """
    if not numbers and modal_table_id is None:
        known = store.modal_tables.find(aircraft_id=aircraft_id)
        if not any("omega" in table.arrays for table in known):
            return NO_MODES, (None, None)
    modal, damping = find_modal_tables(
        store, aircraft_id, modal_table_id, damping_table_id, maneuver_ids
    )
    ids = modal.id, None if damping is None else damping.id
    return read_once(("modes", *ids), lambda: load_modes(store, modal, damping)), ids


def select_out_of_band_modes(
    modes: AircraftModes,
    fuel: float,
    modes_of_model: tuple[int, ...],
    highest: float,
    n_outputs: int,
    body: RigidBody = LONGITUDINAL,
) -> tuple[int, ...]:
    """Select out-of-band modes of an axis with static response within the band.

    Parameters
    ----------
    modes, fuel
        Table and where to read it.
    modes_of_model
        Modes of the model.
    highest
        Highest frequency of the band; modes up to three times as high are included. [rad/s]
    n_outputs
        Number of outputs; at least 1.5 outputs are required per motion.
    """
    omega = modes.table.at(fuel).omega
    near = [
        number
        for frequency, number in sorted(zip(omega, modes.table.numbers, strict=True))
        if modes.belongs_to(number, body)
        and number not in modes_of_model
        and frequency <= 3.0 * highest
    ]
    room = int(n_outputs / 1.5) - body.size - len(modes_of_model)
    return tuple(near[: max(0, room)])


def _select(
    tables: list[ModalTable], table_id: int | None, kind: ModalKind, array: str
) -> ModalTable | None:
    if table_id is not None:
        return select_by_id(tables, table_id, "modal table", code="wrong-modal-table")
    usable = [table for table in tables if array in table.arrays]
    of_kind = [table for table in usable if table.kind is kind]
    return (of_kind or usable or [None])[-1]


def _select_predicted(store: Store, tables: list[ModalTable]) -> list[ModalTable]:
    """Select tables with most modes of one prediction; all without prediction.

    Modal data imported under another name, with other modes, do not replace those for which
    derivatives are predicted.
    """
    usable = [table for table in tables if "omega" in table.arrays]
    fem = [table for table in usable if table.kind is ModalKind.FEM] or usable
    if not fem:
        return tables
    predictions = store.predictions.find(aircraft_id=fem[0].aircraft_id)

    def count_predicted(table: ModalTable) -> tuple[int, ...]:
        return tuple(
            max((len(list_predicted_modes(p, table.numbers, body)) for p in predictions), default=0)
            for body in RIGID_BODIES.values()
        )

    most = max(count_predicted(table) for table in fem)
    return [table for table in fem if count_predicted(table) == most]


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """Frequencies, damping and mass of a table in tracked order, (F, n).

    ``omega_std`` and ``zeta_std`` are standard deviations, ``shape_std`` those of the shapes
    relative to their rms; None where the table has none, NaN where a mode has none.
    ``collinearity`` is the modal phase collinearity of complex shapes.
    """

    table: ModalTable
    fuel: np.ndarray
    omega: np.ndarray
    zeta: np.ndarray | None
    mass: np.ndarray | None
    tracking: Tracking
    omega_std: np.ndarray | None = None
    zeta_std: np.ndarray | None = None
    shape_std: np.ndarray | None = None
    collinearity: np.ndarray | None = None


def open_modes(store: Store, table: ModalTable) -> Modes:
    """Read the modes of a table in tracked order.

    Raises
    ------
    BadInput
        If the table has no frequencies.
    """
    table = apply_corrections(store, table)
    if "omega" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no frequencies", code="no-frequencies")
    arrays = _read_arrays(store, table, ("omega", "zeta", "mass", "collinearity", *DEVIATIONS))
    tracking = _read_tracking(store, table) or _track_shapes(store, table, arrays["omega"])
    sorted_arrays = {name: tracking.sort(values) for name, values in arrays.items()}
    return Modes(
        table=table,
        fuel=np.array(table.fuel),
        omega=sorted_arrays["omega"],
        zeta=sorted_arrays.get("zeta"),
        mass=sorted_arrays.get("mass"),
        tracking=tracking,
        collinearity=sorted_arrays.get("collinearity"),
        **{name: sorted_arrays.get(name) for name in DEVIATIONS},
    )


def _track_shapes(store: Store, table: ModalTable, omega: np.ndarray) -> Tracking:
    """Track modes by their shapes at all nodes, else at the sensor points, else not."""
    name = "node_shape" if "node_shape" in table.arrays else "shape"
    shape = _read_arrays(store, table, (name,)).get(name)
    if shape is None or not shape.shape[2]:
        return make_identity_tracking(*omega.shape)
    return track_modes(shape[..., :3].reshape(*omega.shape, -1), omega)


def interpolate_shape(
    store: Store, modes: Modes, mode: int, fuel: float, whole: np.ndarray | None = None
) -> np.ndarray:
    """Interpolate the shape of a mode at all nodes, (n_nodes, 6) in body axes per unit eta.

    ``whole`` is the array of all shapes, if the table has one and it has been read.

    Raises
    ------
    BadInput
        If the table has none.
    """
    table = modes.table
    assert table.id is not None
    weights = compute_fuel_weights(modes.fuel, fuel, modes.tracking.mixed[:, mode])
    order, sign = modes.tracking.order, modes.tracking.sign
    if "node_shape" in table.arrays:
        if whole is None:
            whole = store.arrays.get(table.arrays["node_shape"])
        parts = {row: whole[row, order[row, mode]] for row in weights}
    else:
        places = {row: (row, int(order[row, mode])) for row in weights}
        found = store.modal_shapes.get(table.id, list(places.values()))
        if len(found) < len(places):
            raise BadInput(f"table '{table.name}' has no shapes at nodes", code="no-nodes")
        parts = {row: found[place] for row, place in places.items()}
    total = np.zeros(next(iter(parts.values())).shape)
    for row, weight in weights.items():
        total += weight * sign[row, mode] * parts[row]
    return total


def interpolate_quadrature(store: Store, modes: Modes, fuel: float) -> np.ndarray | None:
    """Interpolate the quadrature parts of complex shapes, (n_modes, n_nodes, 6) in body axes."""
    name = modes.table.arrays.get("quadrature")
    if name is None:
        return None
    aligned = modes.tracking.align(np.asarray(store.arrays.get(name), dtype=float))
    return sum_weighted_rows(compute_fuel_weights(modes.fuel, fuel), aligned)


def read_nodes(store: Store, table: ModalTable) -> np.ndarray:
    """Read the nodes of a table, (n_nodes, 3) in structural axes. [m]

    Raises
    ------
    BadInput
        If the table has none.
    """
    if "nodes" not in table.arrays:
        raise BadInput(f"table '{table.name}' has no shapes at nodes", code="no-nodes")
    return np.asarray(store.arrays.get(table.arrays["nodes"]), dtype=float)


def interpolate_shapes(store: Store, modes: Modes, fuel: float) -> np.ndarray:
    """Interpolate the shapes of all modes, (n_modes, n_nodes, 6); see ``interpolate_shape``."""
    (shapes,) = _interpolate_shapes(store, modes, (fuel,))
    return shapes


def _interpolate_shapes(store: Store, modes: Modes, fuels: Iterable[float]) -> Iterator[np.ndarray]:
    name = modes.table.arrays.get("node_shape")
    whole = None if name is None else store.arrays.get(name)
    places = range(len(modes.table.numbers))
    for fuel in fuels:
        yield np.stack([interpolate_shape(store, modes, mode, fuel, whole) for mode in places])


def interpolate_deviation(modes: Modes, name: str, fuel: float) -> np.ndarray:
    """Interpolate one of ``DEVIATIONS``, or the collinearity; NaN where it is not known."""
    values = getattr(modes, name)
    if values is None:
        return np.full(len(modes.table.numbers), np.nan)
    return np.asarray(interpolate(modes.fuel, values, fuel))


def gather_modes(store: Store, modal_table_id: int, fuel: float) -> WrittenModes:
    """Gather the modes of a table at a fuel fraction, at all its nodes.

    Raises
    ------
    BadInput
        If the table has no shapes at nodes.
    """
    (gathered,) = gather_modes_over_fuel(store, modal_table_id, (fuel,))
    return gathered


def gather_modes_over_fuel(
    store: Store, modal_table_id: int, fuels: Sequence[float]
) -> Iterator[WrittenModes]:
    """Gather the modes of a table at each of several fuel fractions, as ``gather_modes``."""
    modes = open_modes(store, store.modal_tables.get(modal_table_id))
    table = modes.table
    nodes = read_nodes(store, table)
    ids, lines = table.arrays.get("node_ids"), table.arrays.get("lines")
    node_ids = np.arange(1, nodes.shape[0] + 1) if ids is None else store.arrays.get(ids)
    drawn = np.empty((0, 2), dtype=int) if lines is None else store.arrays.get(lines)
    unknown = np.full(len(table.numbers), np.nan)
    for fuel, shapes in zip(fuels, _interpolate_shapes(store, modes, fuels), strict=True):
        yield WrittenModes(
            title=format_title(table),
            fuel=fuel,
            numbers=table.numbers,
            names=table.names,
            frequency_hz=sum_weighted_rows(compute_fuel_weights(modes.fuel, fuel), modes.omega)
            / (2.0 * np.pi),
            damping=unknown if modes.zeta is None else interpolate(modes.fuel, modes.zeta, fuel),
            frequency_std_hz=interpolate_deviation(modes, "omega_std", fuel) / (2.0 * np.pi),
            damping_std=interpolate_deviation(modes, "zeta_std", fuel),
            mass=unknown if modes.mass is None else interpolate(modes.fuel, modes.mass, fuel),
            node_ids=node_ids,
            nodes=nodes,
            shapes=shapes * TO_STRUCTURE,
            quadrature=None
            if (quadrature := interpolate_quadrature(store, modes, fuel)) is None
            else quadrature * TO_STRUCTURE,
            lines=drawn,
        )


def _read_arrays(store: Store, table: ModalTable, names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Read those of the named arrays that a table has."""
    known = {name: table.arrays[name] for name in names if name in table.arrays}
    arrays = store.arrays.get_many(known.values())
    return {name: np.asarray(arrays[key], dtype=float) for name, key in known.items()}


def _read_tracking(store: Store, table: ModalTable) -> Tracking | None:
    """Read the tracking found from all nodes when the table was imported, if it was."""
    arrays = _read_arrays(store, table, ("order", "sign", "assurance", "mixed"))
    if "order" not in arrays:
        return None
    order, mixed = arrays["order"].astype(np.intp), arrays.get("mixed")
    blurred = np.zeros(order.shape, dtype=bool) if mixed is None else mixed.astype(bool)
    return Tracking(order, arrays["sign"], arrays["assurance"], blurred)


def _read_aligned(store: Store, table: ModalTable, tracking: Tracking | None = None) -> ModeTable:
    """Read the modes of a table, tracked over fuel; unknown frequencies and damping are NaN."""
    arrays = _read_arrays(store, table, ("omega", "zeta", "mass", "shape", "strain"))
    size = (len(table.fuel), len(table.numbers))
    has_shape, has_strain = "shape" in arrays, "strain" in arrays
    modes = ModeTable(
        fuel=np.array(table.fuel, dtype=float),
        numbers=table.numbers,
        omega=arrays.get("omega", np.full(size, np.nan)),
        zeta=arrays.get("zeta", np.full(size, np.nan)),
        mass=arrays.get("mass", np.ones(size)),
        points=table.points if has_shape else (),
        shape=arrays["shape"] if has_shape else np.zeros((*size, 0, 6)),
        gauges=table.gauges if has_strain else (),
        strain=arrays["strain"] if has_strain else np.zeros((*size, 0)),
    )
    tracking = tracking or _read_tracking(store, table)
    if tracking is None and "omega" not in arrays:
        return modes
    return align_modes(modes, tracking)


def interpolate_damping(store: Store, modes: Modes, fuel: float | np.ndarray) -> np.ndarray:
    """Interpolate damping at fuel fractions: of the table, else of the aircraft's GVT."""
    return interpolate(modes.fuel, _read_damping(store, modes), fuel)


def _read_damping(store: Store, modes: Modes) -> np.ndarray:
    """Read damping at the fuel fractions of a table, (F, n); NaN where not measured."""
    if modes.zeta is not None:
        return modes.zeta
    tested = [
        table
        for table in store.modal_tables.find(aircraft_id=modes.table.aircraft_id)
        if table.kind is ModalKind.GVT and "zeta" in table.arrays
    ]
    if not tested:
        return np.full(modes.omega.shape, np.nan)
    aligned = _read_aligned(store, modes.table, modes.tracking)
    return match_test_damping(store, modes.table, tested[-1], aligned)[0]


def match_test_damping(
    store: Store, modal: ModalTable, test: ModalTable, model: ModeTable
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Match damping of a test to the modes of a model; NaN where not measured.

    Parameters
    ----------
    store, modal, test
        Table of the model, corrected, and of the test.
    model
        Modes of the model, tracked over fuel.

    Returns
    -------
    (F, n) damping at the fuel weights of the model, and warnings on the match.
    """
    test = apply_corrections(store, test)
    measured = _read_aligned(store, test)
    pairs, warnings = _match(modal, test, model, measured)
    over_fuel = np.stack([interpolate(measured.fuel, measured.zeta, f) for f in model.fuel])
    found = np.full(model.omega.shape, np.nan)
    for mode, other in pairs.items():
        found[:, mode] = over_fuel[:, other]
    return found, warnings


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
        pairs |= _match_by_number(modal, test, model, measured, taken)
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
        if {test.symmetric[other], modal.symmetric[mode]} >= {True, False}:
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


def _find_written_damping(store: Store, modal: ModalTable, zeta: np.ndarray) -> np.ndarray:
    """Find the modes (F, n) whose damping was written back from flight, in tracked order."""
    if not store.write_backs.find(modal_table_id=modal.id):
        return np.zeros(zeta.shape, dtype=bool)
    std = open_modes(store, modal).zeta_std
    return np.zeros(zeta.shape, dtype=bool) if std is None else np.isfinite(std)


def _find_damping(
    store: Store, modal: ModalTable, damping: ModalTable | None, aligned: ModeTable
) -> tuple[np.ndarray, frozenset[int], tuple[str, ...]]:
    """Return damping in tracked order: of the test, else of the table; and measured modes."""
    zeta = aligned.zeta.copy()
    warnings: tuple[str, ...] = ()
    # Damping that was written back from flight is later than any ground test.
    flown = _find_written_damping(store, modal, zeta)
    measured = np.isfinite(zeta) & (flown | (modal.kind is ModalKind.GVT))
    if damping is not None and damping.id != modal.id and "zeta" in damping.arrays:
        tested, warnings = match_test_damping(store, modal, damping, aligned)
        zeta = np.where(np.isfinite(tested) & ~flown, tested, zeta)
        measured |= np.isfinite(tested)
    missing = [
        number
        for number, column in zip(modal.numbers, zeta.T, strict=True)
        if np.isnan(column).any()
    ]
    zeta[np.isnan(zeta)] = ASSUMED_DAMPING
    if missing:
        warnings = (
            *warnings,
            f"No damping is known for modes {', '.join(map(str, missing))}: "
            f"{ASSUMED_DAMPING:g} assumed.",
        )
    known = zip(modal.numbers, np.all(measured, axis=0).tolist(), strict=True)
    return zeta, frozenset(number for number, every in known if every), warnings
