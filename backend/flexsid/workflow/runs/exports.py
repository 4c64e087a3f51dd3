"""The identified model of a run, and its exports: matrices, data, FMU with source code, JSBSim."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from flexsid.errors import BadInput
from flexsid.nomenclature import describe
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Flight, Maneuver
from flexsid.records.run import EstimationRun, FitBlock, Method, RunResult
from flexsid.storage.repository import read_once
from flexsid.storage.store import Store
from flexsid.sysid.exchange.fmu import (
    FmiVersion,
    FmuModel,
    FmuVariable,
    format_numbers,
    pack_fmu,
)
from flexsid.sysid.exchange.jsbsim import write_jsbsim
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition, compute_standard_altitude
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.reduction import residualize
from flexsid.sysid.model.rigid_body import SensorRows
from flexsid.sysid.signals import FrequencyResponse
from flexsid.workflow.model_structures.model_structures import get_result, refuse_altered
from flexsid.workflow.runs.estimation import prepare

# --- The identified model of a run, rebuilt from its stored result --------------------------------


@dataclass(frozen=True, slots=True)
class IdentifiedModel:
    """A model with its derivatives; ``delays`` [s] and ``scales`` belong to the outputs.

    Its modes have the frequencies and dampings that were estimated. ``priors`` are mean and
    standard deviation of the parameters for which the analyst gave them.
    """

    model: AeroelasticModel
    derivatives: DerivativeTable
    delays: np.ndarray
    scales: np.ndarray
    priors: Mapping[str, tuple[float, float]] = field(
        default_factory=dict[str, tuple[float, float]]
    )

    def select_outputs(self, names: Sequence[str]) -> IdentifiedModel:
        """Return the same model with these of its outputs."""
        places = [self.model.outputs.index(name) for name in names]
        rows = SensorRows(tuple(names), self.model.sensors.polynomial[:, places])
        return replace(
            self,
            model=replace(self.model, sensors=rows),
            delays=self.delays[places],
            scales=self.scales[places],
        )

    def response(self, omega: np.ndarray) -> FrequencyResponse:
        """Compute frequency responses with the estimated delays and scale factors."""
        values = self.model.response(self.derivatives, omega)
        sensed = self.scales * np.exp(-1j * np.outer(omega, self.delays))
        return FrequencyResponse(
            omega, values * sensed[:, :, None], self.model.outputs, self.model.inputs
        )


def load_identified_model(
    store: Store, run: EstimationRun, maneuver_id: int | None = None
) -> IdentifiedModel:
    """Build the identified model of a run at the condition of its maneuver or of another one.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    get_result(run)
    alone = replace(run.settings, additional_maneuver_ids=())
    number = run.maneuver_id if maneuver_id is None else maneuver_id
    asked = replace(run, maneuver_id=number, settings=alone)
    # Runs of several methods often have the same model.
    tables = (run.modal_table_id, run.damping_table_id, run.prediction_id)
    key = ("identified model", number, repr(run.structure), repr(alone), tables)
    task = read_once(key, lambda: prepare(store, asked))
    of_derivatives = task.list_priors().select((*task.priors, *task.nuisance_names))
    return replace(build_identified_model(task.model, run), priors=of_derivatives)


def build_identified_model(model: AeroelasticModel, run: EstimationRun) -> IdentifiedModel:
    """Build the identified model of a run that succeeded from its prepared model."""
    values = collect_values(run)
    return IdentifiedModel(
        model=replace(model, modes=model.modes.tuned(values)),
        derivatives=model.fill_table(values),
        delays=np.array([values.get(f"delay_{name}", 0.0) for name in model.outputs]),
        scales=np.array([values.get(f"scale_{name}", 1.0) for name in model.outputs]),
    )


def collect_values(run: EstimationRun) -> dict[str, float]:
    """Collect all derivatives and other parameters of a run that succeeded, by name."""
    result = get_result(run)
    values = run.structure.fixed | result.held
    values |= {parameter.name: parameter.value for parameter in result.parameters}
    if result.retained is not None:
        values |= {parameter.name: parameter.value for parameter in result.retained.parameters}
    return values


def read_covariance(store: Store, result: RunResult) -> tuple[tuple[str, ...], np.ndarray]:
    """Read the names and the covariance of all parameters, the nuisance parameters included."""
    names = tuple(parameter.name for parameter in result.parameters)
    if result.retained is None:
        return names, np.asarray(store.arrays.get(result.covariance))
    names += tuple(parameter.name for parameter in result.retained.parameters)
    return names, np.asarray(store.arrays.get(result.retained.covariance))


# --- Identified rigid aircraft for JSBSim, from runs of one axis or of both -----------------------


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


# --- The identified model of a run as a functional mock-up unit (FMU) with its source code --------

_AFFINE = 1e-9  # largest deviation from a sum over the derivatives, relative to the entries


@dataclass(frozen=True, slots=True, eq=False)
class _AffineModel:
    """[x'; y] = (M0 + sum of p_k M_k) [x; u]; ``slopes`` (p, n_rows, n_columns) are M_k."""

    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    base: np.ndarray
    derivatives: dict[str, float]
    slopes: np.ndarray


def write_fmu(store: Store, run_id: int, version: FmiVersion) -> bytes:
    """Write the identified model of a run as an FMU for Model Exchange.

    Parameters
    ----------
    store
        Database.
    run_id
        A run that succeeded. A frequency shape of its derivatives is represented by states of
        rational functions.
    version
        Version of FMI.

    Returns
    -------
    bytes
        Archive with the model description and the C sources; importers compile it. Its parameters
        are the derivatives, at their estimates, at the flight condition of the maneuver.

    Raises
    ------
    Conflict
        If the run has no result.
    BadInput
        If the model is not a sum over its derivatives.
    """
    run = store.runs.get(run_id)
    model = _separate_derivatives(load_identified_model(store, run))
    about = (
        f"{run.method.value} estimation, run {run_id} of flexsid: perturbations about trim at the "
        "condition of its maneuver. Outputs are without delays and instruments."
    )
    variables = tuple(_list_variables(model))
    return pack_fmu(variables, FmuModel.LINEAR, _list_numbers(model), about, version)


def _separate_derivatives(found: IdentifiedModel) -> _AffineModel:
    """Separate the part of the system matrices that each derivative contributes.

    Raises
    ------
    BadInput
        If the matrices are not a sum over the derivatives.
    """
    table = found.derivatives
    named = table.named()

    def assemble(values: np.ndarray) -> np.ndarray:
        system = found.model.state_space(replace(table, values=values.reshape(table.values.shape)))
        return np.block([[system.A, system.B], [system.C, system.D]])

    base = assemble(np.zeros(table.values.size))
    slopes = np.array([assemble(unit) - base for unit in np.eye(table.values.size)])
    whole = assemble(table.values)
    rest = np.abs(base + np.tensordot(table.values.ravel(), slopes, axes=1) - whole)
    if np.any(rest > _AFFINE * np.abs(whole).max()):
        raise BadInput(
            "the system matrices are not a sum over the derivatives; export the model for MATLAB",
            code="not-affine",
        )
    used = np.flatnonzero(np.abs(slopes).max(axis=(1, 2)))
    names = [list(named)[k] for k in used]
    system = found.model.state_space(table)
    return _AffineModel(
        states=system.states,
        inputs=system.inputs,
        outputs=system.outputs,
        base=base,
        derivatives={name: named[name] for name in names},
        slopes=slopes[used],
    )


def _list_variables(model: _AffineModel) -> Iterator[FmuVariable]:
    """List the variables in the order of their value references."""
    for name in model.states:
        yield FmuVariable(name=f"state.{name}", symbol=name, causality="local", start=0.0)
    for number, name in enumerate(model.states, start=1):
        yield FmuVariable(
            name=f"der(state.{name})", symbol=name, causality="local", derivative_of=number, unit=""
        )
    for name in model.inputs:
        yield FmuVariable(name=f"input.{name}", symbol=name, causality="input", start=0.0)
    for name in model.outputs:
        yield FmuVariable(name=f"output.{name}", symbol=name, causality="output")
    for name, value in model.derivatives.items():
        yield FmuVariable(
            name=f"derivative.{name}",
            symbol=name,
            causality="parameter",
            variability="tunable",
            start=value,
        )


def _list_numbers(model: _AffineModel) -> dict[str, int | Sequence[str]]:
    """List the numbers of a model by their names in C."""
    slopes = [
        f"{{{k}, {entry}, {float(model.slopes[k].flat[entry])!r}}}"
        for k in range(len(model.slopes))
        for entry in np.flatnonzero(model.slopes[k])
    ]
    return {
        "N_STATES": len(model.states),
        "N_INPUTS": len(model.inputs),
        "N_OUTPUTS": len(model.outputs),
        "N_PARAMETERS": len(model.derivatives),
        "N_SLOPES": len(slopes),
        "double BASE": format_numbers(model.base.ravel().tolist()),
        "double START": format_numbers(list(model.derivatives.values())),
        "Slope SLOPES": slopes,
    }


# --- Export of an identified model: matrices with names, units and provenance ---------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelExport:
    """The model of a run at the condition of its maneuver, in SI units and radians.

    x' = A x + B u, y = C x + D u; a sensor measures ``scales`` times y with a
    delay of ``delays_s``. ``units`` names the unit of every state, input and output. Instruments
    are not part of the model.
    """

    run_id: int
    maneuver_id: int
    method: Method
    airspeed_m_s: float
    dynamic_pressure_pa: float
    fuel_fraction: float
    modes: tuple[int, ...]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    units: dict[str, str]
    A: list[list[float]]
    B: list[list[float]]
    C: list[list[float]]
    D: list[list[float]]
    delays_s: list[float]
    scales: list[float]
    derivatives: dict[str, float]
    versions: dict[str, str] | None


def export_model(store: Store, run_id: int) -> ModelExport:
    """Export the identified model of a run.

    Raises
    ------
    Conflict
        If the run has no result.
    """
    run = store.runs.get(run_id)
    found = load_identified_model(store, run)
    system = found.model.state_space(found.derivatives)
    condition = found.model.condition
    names = (*system.states, *system.inputs, *system.outputs)
    return ModelExport(
        run_id=run_id,
        maneuver_id=run.maneuver_id,
        method=run.method,
        airspeed_m_s=condition.airspeed,
        dynamic_pressure_pa=condition.dynamic_pressure,
        fuel_fraction=store.maneuvers.get(run.maneuver_id).condition.fuel_fraction,
        modes=found.model.modes.numbers,
        states=system.states,
        inputs=system.inputs,
        outputs=system.outputs,
        units={name: describe(name).unit for name in names},
        A=system.A.tolist(),
        B=system.B.tolist(),
        C=system.C.tolist(),
        D=system.D.tolist(),
        delays_s=found.delays.tolist(),
        scales=found.scales.tolist(),
        derivatives=found.derivatives.named(),
        versions=run.versions,
    )


def write_matlab_model(model: ModelExport) -> bytes:
    """Write a MATLAB 5 file with the arguments of ``ss`` of the Control System Toolbox.

    Notes
    -----
    In MATLAB: ``sys = ss(A, B, C, D, 'StateName', states, 'InputName', inputs,
    'OutputName', outputs, 'OutputDelay', delays_s)``.
    """
    from scipy import io as files  # imported for this format only

    content: dict[str, Any] = {
        name: np.array(getattr(model, name), dtype=float)
        for name in ("A", "B", "C", "D", "delays_s", "scales", "modes")
    }
    for name in ("states", "inputs", "outputs"):
        names = getattr(model, name)
        content[name] = np.array(names, dtype=object)
        content[f"{name[:-1]}_units"] = np.array([model.units[n] for n in names], dtype=object)
    for name in ("run_id", "airspeed_m_s", "dynamic_pressure_pa", "fuel_fraction"):
        content[name] = float(getattr(model, name))
    content["derivatives"] = np.array(list(model.derivatives), dtype=object)
    content["values"] = np.array(list(model.derivatives.values()))
    content["method"] = str(model.method)
    out: Any = io.BytesIO()  # the stubs of savemat accept no buffer
    files.savemat(out, content, oned_as="column")
    return out.getvalue()


# --- Export of a run with its maneuver, aircraft, covariance and fitted spectra -------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportedLines:
    """Fitted spectra of one block; rows by frequency, columns by output."""

    name: str
    outputs: tuple[str, ...]
    omega: list[float]  # [rad/s]
    measured_real: list[list[float]]
    measured_imag: list[list[float]]
    fitted_real: list[list[float]]
    fitted_imag: list[list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunExport:
    """A run with its aircraft, flight and maneuver, and the arrays of its result as numbers.

    ``covariance`` is ordered as the parameters; both are None and empty until
    the run has succeeded. ``signature`` is that of the site, written into the file.
    """

    aircraft: Aircraft
    flight: Flight
    maneuver: Maneuver
    run: EstimationRun
    covariance: list[list[float]] | None
    lines: list[ExportedLines]
    signature: str | None = None


def export_run(store: Store, run_id: int) -> RunExport:
    """Export a run with its maneuver, aircraft, covariance and fitted spectra."""
    run = store.runs.get(run_id)
    refuse_altered(run)
    maneuver = store.maneuvers.get(run.maneuver_id)
    result = run.result
    return RunExport(
        aircraft=store.aircraft.get(maneuver.aircraft_id),
        flight=store.flights.get(maneuver.flight_id),
        maneuver=maneuver,
        run=run,
        covariance=None if result is None else store.arrays.get(result.covariance).tolist(),
        lines=[] if result is None else [_export_block(store, block) for block in result.blocks],
    )


def _export_block(store: Store, block: FitBlock) -> ExportedLines:
    arrays = store.arrays.get_many(block.arrays.values())
    measured, fitted = arrays[block.arrays["measured"]], arrays[block.arrays["fitted"]]
    return ExportedLines(
        name=block.name,
        outputs=block.outputs,
        omega=arrays[block.arrays["omega"]].tolist(),
        measured_real=np.real(measured).tolist(),
        measured_imag=np.imag(measured).tolist(),
        fitted_real=np.real(fitted).tolist(),
        fitted_imag=np.imag(fitted).tolist(),
    )
