"""Controllers: import of state-space matrices or transfer functions, interpolation in airspeed."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from flexsid.errors import BadInput
from flexsid.importers.source import Sources
from flexsid.records.aircraft import Aircraft, get_symmetry, list_surface_parts
from flexsid.records.flutter import ControlLaw, Controller, Matrix
from flexsid.records.views import ControlLoopDiagram
from flexsid.storage.store import Store
from flexsid.sysid.model.aeroelastic import StateSpace
from flexsid.sysid.model.laws import Law, check_laws, realise_transfer_functions, schedule_law
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.workflow.aircraft.aircraft_models import define_outputs
from flexsid.workflow.aircraft.axes import find_other, reads_own_motion_only

_CANCELLED = 1e-9  # of the largest gain: left and right ones that cancel but for rounding
_MATRICES = ("A", "B", "C", "D")
_EXAMPLE = (
    'expected {"reads": ["q"], "drives": ["wf4s"], "laws": [{"airspeed_m_s": 30, "A": [[...]], '
    '"B": ..., "C": ..., "D": ...}]} or {"reads", "drives", "transfer": {"wf4s": {"q": {"num": '
    '[...], "den": [...]}}}}; with a mixer of commands to surfaces "drives" is replaced by '
    '"commands": ["pitch"], "mixer": {"wf4s": {"pitch": 0.5}}, and laws compute the commands'
)


def add_controller(store: Store, controller: Controller) -> Controller:
    """Store a controller after checking its matrices.

    Raises
    ------
    BadInput
        If a matrix has a wrong shape, or the aircraft lacks a surface.
    """
    check_laws(_laws(controller), controller.reads, controller.commands or controller.drives)
    if controller.mixer and (
        np.shape(controller.mixer) != (len(controller.drives), len(controller.commands))
        or not np.all(np.isfinite(controller.mixer))
    ):
        raise BadInput(
            f"the mixer must have finite numbers in {len(controller.drives)} rows (surfaces) of"
            f" {len(controller.commands)} (commands)",
            code="wrong-shape",
            matrix="mixer",
        )
    limit = controller.rate_limit_rad_s
    if limit is not None and not 0.0 < limit < np.inf:
        raise BadInput(f"the rate limit is {limit:g} rad/s; expected a positive number, or none")
    aircraft = store.aircraft.get(controller.aircraft_id)
    surfaces = [surface.name for surface in aircraft.surfaces]
    for name in controller.drives:
        if name not in surfaces:
            raise BadInput(
                f"the controller drives '{name}', not a surface of {aircraft.name}; it has"
                f" {', '.join(surfaces)}",
                code="unknown-input",
                input=name,
            )
    for name in controller.commands:
        if name in surfaces:
            raise BadInput(
                f"the command '{name}' of the controller has the name of a surface; rename it, so"
                " that it is known whether excitation enters before the mixer or behind it",
                code="name-of-surface",
                input=name,
            )
    if not 0.0 <= controller.delay_s < 1.0:
        raise BadInput(
            f"the delay is {controller.delay_s:g} s; expected at least 0 and less than 1 s"
        )
    return store.controllers.add(replace(controller, id=None))


def select_axis_of_controller(
    controller: Controller, aircraft: Aircraft, inputs: Sequence[str], body: RigidBody
) -> Controller:
    """Select what a controller does to the motion of one axis.

    What it reads of the other motion only is zero in this one. Left and right surfaces that it
    drives singly move the inputs of the model that combine them; surfaces of the other symmetry,
    and inputs whose gains cancel, are omitted. A controller of one axis stays as it is.

    Raises
    ------
    BadInput
        If it does not act on the motion of this axis.
    """
    other = find_other(body)
    parts = {p: dict(terms) for p, terms in list_surface_parts(aircraft).items() if p in inputs}
    sides = {side for terms in parts.values() for side in terms}
    own = [name for name in controller.drives if name in inputs or name not in sides]
    direct = [n for n in own if n in inputs or get_symmetry(aircraft, n) != other.symmetry]
    combined = [p for p, terms in parts.items() if set(terms) & set(controller.drives) - set(own)]
    weights = np.array(
        [
            *([float(row == name) for name in controller.drives] for row in direct),
            *([parts[row].get(name, 0.0) for name in controller.drives] for row in combined),
        ]
    )
    read = [
        k for k, name in enumerate(controller.reads) if not _measures_only(aircraft, name, other)
    ]
    drives = (*direct, *combined)
    if drives == controller.drives and len(read) == len(controller.reads):
        return controller
    if not drives or not read:
        raise _refuse_other_axis(controller, body)
    outputs = (
        [np.array(controller.mixer)]
        if controller.mixer
        else [
            np.hstack([_reshape_output_matrix(law, controller), np.array(law.D)[:, read]])
            for law in controller.laws
        ]
    )
    sizes = np.abs(weights @ np.hstack(outputs)).max(axis=1)
    moved = np.flatnonzero(sizes > _CANCELLED * sizes.max()).tolist()
    if not moved:
        raise _refuse_other_axis(controller, body)
    weights = weights[moved]
    mixer = controller.mixer and _to_rows(weights @ np.array(controller.mixer))
    through = np.eye(len(controller.commands)) if controller.mixer else weights
    return replace(
        controller,
        reads=tuple(controller.reads[k] for k in read),
        drives=tuple(drives[k] for k in moved),
        mixer=mixer,
        laws=tuple(
            replace(
                law,
                B=_to_rows(np.reshape(law.B, (len(law.A), len(controller.reads)))[:, read]),
                C=_to_rows(through @ _reshape_output_matrix(law, controller)),
                D=_to_rows(through @ np.array(law.D)[:, read]),
            )
            for law in controller.laws
        ),
    )


def _reshape_output_matrix(law: ControlLaw, controller: Controller) -> np.ndarray:
    """Return C with its shape, which laws without states do not have."""
    return np.reshape(law.C, (len(controller.commands or controller.drives), len(law.A)))


def _refuse_other_axis(controller: Controller, body: RigidBody) -> BadInput:
    return BadInput(
        f"the controller '{controller.name}' does not act on {body.axis} motion: it reads"
        f" {', '.join(controller.reads)} and drives {', '.join(controller.drives)}; select a"
        " controller of this axis, or none",
        code="controller-of-other-axis",
    )


def _measures_only(aircraft: Aircraft, name: str, body: RigidBody) -> bool:
    """Whether a signal is free of the motion of the other axis than this one."""
    try:
        (output,) = define_outputs(aircraft, (name,))
    except BadInput:  # refused where the loop is closed
        return False
    return reads_own_motion_only(output.terms, body)


def _to_rows(matrix: np.ndarray) -> Matrix:
    return tuple(tuple(row) for row in matrix.tolist())


def interpolate_controller(controller: Controller, airspeed_m_s: float) -> StateSpace:
    """Interpolate the matrices of a controller at an airspeed, mixer included, without its delay.

    Rate limits are no part of it: they act in simulations only.
    """
    if not controller.mixer:
        return schedule_law(_laws(controller), airspeed_m_s, controller.reads, controller.drives)
    law = schedule_law(_laws(controller), airspeed_m_s, controller.reads, controller.commands)
    mixer = np.array(controller.mixer)
    return replace(law, C=mixer @ law.C, D=mixer @ law.D, outputs=controller.drives)


def enters_before_mixer(controller: Controller, inputs: Sequence[str]) -> bool:
    """Whether excitation with these inputs enters before the mixer: they are its commands."""
    return bool(controller.mixer) and set(inputs) <= set(controller.commands)


def describe_loop(
    store: Store, controller_id: int, design_id: int | None = None
) -> ControlLoopDiagram:
    """Describe the loop of a controller, and where the excitation of a design enters it."""
    controller = store.controllers.get(controller_id)
    inputs: tuple[str, ...] = ()
    if design_id is not None:
        design = store.designs.get(design_id)
        inputs = tuple(own.name for own in design.specification.inputs)
    return ControlLoopDiagram(
        reads=controller.reads,
        commands=controller.commands,
        drives=controller.drives,
        airspeeds_m_s=tuple(sorted(law.airspeed_m_s for law in controller.laws)),
        delay_s=controller.delay_s,
        rate_limit_rad_s=controller.rate_limit_rad_s,
        excitation=inputs,
        is_before_mixer=enters_before_mixer(controller, inputs),
    )


def read_controller(text: str, aircraft_id: int, name: str) -> Controller:
    """Read a controller from JSON.

    Raises
    ------
    BadInput
        If the text is not JSON, or of neither form.
    """
    try:
        content = json.loads(text)
    except ValueError as error:
        raise BadInput(f"the controller is not valid JSON: {error}; {_EXAMPLE}") from error
    if not isinstance(content, dict):
        raise BadInput(f"the controller is not a JSON object; {_EXAMPLE}")
    reads = _names(content, "reads")
    commands: tuple[str, ...] = ()
    mixer: Matrix = ()
    if "mixer" in content:
        commands = _names(content, "commands")
        drives, mixer = _from_mixer(content, commands)
    else:
        drives = _names(content, "drives")
    computed = commands or drives
    if "transfer" in content:
        laws = (_from_transfer(content["transfer"], reads, computed),)
    elif "laws" in content:
        listed = content["laws"]
        if not isinstance(listed, list):
            raise BadInput(f"'laws' must be a list; {_EXAMPLE}")
        laws = tuple(_from_matrices(one, reads, computed) for one in listed)
    else:
        laws = (_from_matrices(content, reads, computed),)
    limit = content.get("rate_limit_rad_s")
    return Controller(
        aircraft_id=aircraft_id,
        name=str(content.get("name", name)) or name,
        reads=reads,
        drives=drives,
        laws=laws,
        delay_s=_number(content.get("delay_s", 0.0), "delay_s"),
        note=str(content.get("note", "")),
        commands=commands,
        mixer=mixer,
        rate_limit_rad_s=None if limit is None else _number(limit, "rate_limit_rad_s"),
    )


def read_matrices(
    sources: Sources, aircraft_id: int, name: str, reads: Sequence[str], drives: Sequence[str]
) -> Controller:
    """Read a controller from the matrices A, B, C, D of a MATLAB file."""
    found = {}
    for matrix in _MATRICES:
        if not sources.has(matrix):
            if matrix == "D":
                raise BadInput("the file has no matrix D; save A, B, C and D as variables")
            continue
        _, values = sources.find(matrix)
        found[matrix] = np.atleast_2d(np.asarray(values, dtype=float)).tolist()
    law = _from_matrices(found, tuple(reads), tuple(drives))
    return Controller(
        aircraft_id=aircraft_id, name=name, reads=tuple(reads), drives=tuple(drives), laws=(law,)
    )


def _from_matrices(content: object, reads: tuple[str, ...], drives: tuple[str, ...]) -> ControlLaw:
    if not isinstance(content, Mapping) or "D" not in content:
        raise BadInput(f"a control law has no matrix D; {_EXAMPLE}")
    A = _matrix(content.get("A", []), "A", None)
    n = A.shape[0]
    shapes = {"B": (n, len(reads)), "C": (len(drives), n), "D": (len(drives), len(reads))}
    B, C, D = (
        _matrix(content.get(key, []), key, shape if 0 in shape else None)
        for key, shape in shapes.items()
    )
    speed = _number(content.get("airspeed_m_s", 0.0), "airspeed_m_s")
    return _record(Law(speed, (A, B, C, D)))


def _from_mixer(
    content: Mapping[str, Any], commands: tuple[str, ...]
) -> tuple[tuple[str, ...], Matrix]:
    """Read the surfaces that a mixer drives, and its weights by surface and command."""
    rows = content["mixer"]
    if not isinstance(rows, Mapping) or not rows:
        raise BadInput(f"'mixer' must have weights by surface and command; {_EXAMPLE}")
    drives = tuple(str(surface) for surface in rows)
    if "drives" in content and set(_names(content, "drives")) != set(drives):
        raise BadInput("'drives' and the surfaces of 'mixer' differ; omit 'drives'")
    for surface, weights in rows.items():
        foreign = [name for name in weights if name not in commands] if weights else [surface]
        if not isinstance(weights, Mapping) or foreign:
            raise BadInput(
                f"the mixer of '{surface}' must have weights of {', '.join(commands)}; {_EXAMPLE}"
            )
    return drives, tuple(
        tuple(_number(rows[surface].get(name, 0.0), f"mixer.{surface}.{name}") for name in commands)
        for surface in drives
    )


def _from_transfer(content: object, reads: tuple[str, ...], drives: tuple[str, ...]) -> ControlLaw:
    if not isinstance(content, Mapping):
        raise BadInput(f"'transfer' must have transfer functions by surface and signal; {_EXAMPLE}")
    elements = {}
    for surface, by_signal in content.items():
        if surface not in drives or not isinstance(by_signal, Mapping):
            raise BadInput(f"'transfer' names '{surface}', which 'drives' does not; {_EXAMPLE}")
        for signal, function in by_signal.items():
            if signal not in reads or not isinstance(function, Mapping):
                raise BadInput(f"'transfer' names '{signal}', which 'reads' does not; {_EXAMPLE}")
            where = drives.index(surface), reads.index(signal)
            parts = [
                _matrix(function.get(key, []), f"{surface}.{signal}.{key}", None).ravel().tolist()
                for key in ("num", "den")
            ]
            elements[where] = parts[0], parts[1]
    return _record(Law(0.0, realise_transfer_functions(elements, len(drives), len(reads))))


def _matrix(content: object, name: str, shape: tuple[int, int] | None) -> np.ndarray:
    if shape is not None:
        return np.zeros(shape)
    try:
        values = np.asarray(content, dtype=float)
    except (TypeError, ValueError) as error:
        raise BadInput(f"{name} is not a numeric matrix; {_EXAMPLE}") from error
    if values.size == 0:
        return np.zeros((0, 0))
    return np.atleast_2d(values)


def _number(content: object, name: str) -> float:
    if not isinstance(content, int | float) or not np.isfinite(content):
        raise BadInput(f"{name} must be a finite number, not {content!r}")
    return float(content)


def _names(content: Mapping[str, Any], key: str) -> tuple[str, ...]:
    listed = content.get(key)
    if not isinstance(listed, list) or not listed or not all(isinstance(x, str) for x in listed):
        raise BadInput(f"'{key}' must list names; {_EXAMPLE}")
    if len(set(listed)) < len(listed):
        raise BadInput(f"'{key}' has duplicate names: {', '.join(listed)}")
    return tuple(listed)


def _laws(controller: Controller) -> list[Law]:
    n_read, n_driven = len(controller.reads), len(controller.commands or controller.drives)
    laws = []
    for law in controller.laws:
        n = len(law.A)
        laws.append(
            Law(
                law.airspeed_m_s,
                (
                    np.array(law.A, dtype=float).reshape(n, -1) if n else np.zeros((0, 0)),
                    np.array(law.B, dtype=float) if n else np.zeros((0, n_read)),
                    np.array(law.C, dtype=float) if n else np.zeros((n_driven, 0)),
                    np.array(law.D, dtype=float),
                ),
            )
        )
    return laws


def _record(law: Law) -> ControlLaw:
    A, B, C, D = (tuple(tuple(row) for row in matrix.tolist()) for matrix in law.matrices)
    return ControlLaw(airspeed_m_s=law.airspeed, A=A, B=B, C=C, D=D)
