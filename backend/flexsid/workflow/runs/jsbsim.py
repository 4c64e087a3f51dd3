"""Identified rigid aircraft for JSBSim, from runs of one axis or of both."""

from __future__ import annotations

from flexsid.errors import BadInput
from flexsid.storage.store import Store
from flexsid.sysid.exchange.jsbsim import write_jsbsim
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.model.standard_atmosphere import compute_standard_altitude
from flexsid.workflow.runs.identified_models import IdentifiedModel, load_identified_model


def write_jsbsim_aircraft(store: Store, run_id: int, other_run_id: int | None = None) -> bytes:
    """Write the identified rigid aircraft at the flight condition of the first run.

    Parameters
    ----------
    store
        Database.
    run_id
        A run that succeeded, of the longitudinal or the lateral-directional axis.
    other_run_id
        A run of the other axis, of the same aircraft; by default that axis has no derivatives.

    Returns
    -------
    bytes
        Archive with the aircraft file and its trim. Modes are residualised: the derivatives contain
        their static response at the flight condition, in the other run with its own mode shapes.

    Raises
    ------
    Conflict
        If a run has no result.
    BadInput
        If the runs are of one axis or of two aircraft, of another axis, have a frequency shape, or
        if the standard atmosphere does not have the density.
    """
    ids = [run_id] if other_run_id is None else [run_id, other_run_id]
    runs = [store.runs.get(number) for number in ids]
    maneuvers = [store.maneuvers.get(run.maneuver_id) for run in runs]
    if len({maneuver.aircraft_id for maneuver in maneuvers}) > 1:
        raise BadInput(
            f"run {other_run_id} is of another aircraft than run {run_id}", code="wrong-aircraft"
        )
    models = [load_identified_model(store, run) for run in runs]
    axes = [found.model.body.axis for found in models]
    known = (LONGITUDINAL.axis, LATERAL.axis)
    if unknown := [axis for axis in axes if axis not in known]:
        raise BadInput(
            f"a run of the axis '{unknown[0]}' is not exported for JSBSim; estimate one of "
            f"{' and '.join(known)}",
            code="wrong-axis",
        )
    if len(set(axes)) < len(axes):
        raise BadInput(
            f"runs {run_id} and {other_run_id} are both of the {axes[0]} axis; name one of each",
            code="one-axis",
        )
    condition = models[0].model.condition
    aircraft = store.aircraft.get(maneuvers[0].aircraft_id)
    lacks_inertia = condition.roll_inertia == 0.0 or condition.yaw_inertia == 0.0
    estimated = ", ".join(
        f"{run.method.value} run {run.id} ({axis})" for run, axis in zip(runs, axes, strict=True)
    )
    return write_jsbsim(
        aircraft.name,
        condition,
        compute_standard_altitude(condition.density),
        [_build_rigid_table(found, condition) for found in models],
        f"{estimated} of flexsid at {condition.airspeed:.2f} m/s and "
        f"{condition.density:.4f} kg/m3, fuel {maneuvers[0].condition.fuel_fraction:.0%}; "
        "linear about this trim, modes residualised"
        + ("; inertia in roll and yaw not known, that in pitch instead" if lacks_inertia else ""),
    )


def _build_rigid_table(found: IdentifiedModel, condition: FlightCondition) -> DerivativeTable:
    model = found.model
    if model.shape is not None:
        raise BadInput(
            "JSBSim has derivatives without a frequency shape; estimate a quasi-steady model",
            code="not-with-shape",
        )
    return residualize(found.derivatives, model.modes, condition, ())
