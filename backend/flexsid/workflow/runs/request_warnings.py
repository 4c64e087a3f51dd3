"""Doubts: what a method cannot be asked for, and what its result should be read with."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun, Method
from flexsid.workflow.modal_data.aligned_modes import AircraftModes
from flexsid.workflow.runs.computation import ManeuverTask


def check_extras(method: Method, extras: Iterable[str]) -> None:
    """Refuse to estimate by equation error what it does not hold.

    Raises
    ------
    BadInput
        If something else than a derivative is named.
    """
    for name in extras:
        if method is Method.EE:
            raise BadInput(
                f"equation error estimates derivatives only; '{name}' needs OE or FRE",
                code="not-in-method",
                name=name,
            )


def doubts(
    run: EstimationRun, maneuver: Maneuver, flown: ManeuverTask, modes: AircraftModes
) -> list[str]:
    """Say what to read a result with: modes that the lines do not reach, inputs left out."""
    numbers = flown.model.modes.numbers
    held = run.method is Method.EE and run.structure.free_delays
    return [
        *_out_of_band(flown, modes),
        *(
            f"{modes.names[number]} is antisymmetric: in symmetric motion nothing tells of it."
            for number in numbers
            if not modes.symmetric[number]
        ),
        *(() if run.method is Method.FRE else _left_out(maneuver, flown.model.inputs)),
        *(["Equation error holds the delays; OE and FRE estimate them."] if held else []),
    ]


def _out_of_band(flown: ManeuverTask, modes: AircraftModes) -> tuple[str, ...]:
    highest = flown.measurement.highest
    return tuple(
        f"{modes.names[number]} ({omega / 2 / np.pi:.3g} Hz in vacuo) lies above the highest line "
        f"({highest / 2 / np.pi:.3g} Hz): the data hold little of its dynamics, and standard "
        "errors of its derivatives may be too small. A prior at the prediction keeps them."
        for number, omega in zip(flown.model.modes.numbers, flown.model.modes.omega, strict=True)
        if omega > highest
    )


def _left_out(maneuver: Maneuver, inputs: tuple[str, ...]) -> tuple[str, ...]:
    excited = () if maneuver.excitation is None else maneuver.excitation.harmonics
    missing = [name for name in excited if name not in inputs]
    if not missing:
        return ()
    what = "is excited too and is" if len(missing) == 1 else "are excited too and are"
    return (
        f"{', '.join(missing)} {what} no input of the model: that motion counts as noise, or goes "
        "into the derivatives of the others.",
    )
