"""Estimation: a run from request to result.

``prepare`` reads everything a run needs, ``compute_run`` is a pure function for any
process, ``store_result`` stores the result.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.decision import Structure
from flexsid.records.maneuver import COMBINED, Condition, Maneuver, Role
from flexsid.records.run import (
    Aerodynamics,
    EstimationRun,
    Fit,
    FitBlock,
    Method,
    NuisanceParameter,
    OutOfBandModes,
    OutputQuality,
    ParameterEstimate,
    Pole,
    Provenance,
    RetainedModes,
    RunPosterior,
    RunResult,
    RunSettings,
    Start,
)
from flexsid.storage.arrays import describe_array
from flexsid.storage.jobs import queue
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import (
    Estimate,
    compute_output_fit,
    compute_parameter_quality,
)
from flexsid.sysid.estimation.experiment import SHAPE_ERROR, select_parameters
from flexsid.sysid.estimation.nuisance import list_shape_errors
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.reduction import compute_modal_errors
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.modes.shapes import StructuralModes
from flexsid.workflow.aircraft.aircraft_models import (
    OutputDefinition,
    build_model,
    compute_shape_sizes,
    define_outputs,
    list_default_outputs,
)
from flexsid.workflow.aircraft.axes import (
    find_body,
    find_other,
    list_axis_surfaces,
    list_opposed_surfaces,
    pair_parts,
    require_axis,
    require_axis_inputs,
)
from flexsid.workflow.aircraft.derivative_predictions import (
    load_frequency_shape,
    select_prediction,
    select_shaped_prediction,
)
from flexsid.workflow.aircraft.flight_condition import list_wrong_conditions
from flexsid.workflow.comparison.error_causes import store_error_causes
from flexsid.workflow.fits.computation import ComputedRun, compute_run
from flexsid.workflow.fits.estimation_task import (
    ComputedRetainedModes,
    EstimationTask,
    ManeuverTask,
)
from flexsid.workflow.fits.run_warnings import (
    check_extras,
    list_request_warnings,
    warn_of_unknown_modes,
)
from flexsid.workflow.measurements.flight_records import read_flight_record
from flexsid.workflow.measurements.maneuver_spectra import (
    read_measurement,
    warn_of_air_data,
    warn_of_airspeed_drift,
    widen_by_spread,
)
from flexsid.workflow.measurements.measured_axis import require_own_motion
from flexsid.workflow.measurements.recording import select_frequencies
from flexsid.workflow.measurements.sensor_faults import RecordedSensors
from flexsid.workflow.modal_data.modal_tables import (
    AircraftModes,
    load_modes_of_model,
    select_out_of_band_modes,
)
from flexsid.workflow.model_structures.model_structures import resolve_structure
from flexsid.workflow.runs.run_identity import hash_provenance, hash_request
from flexsid.workflow.runs.starts import (
    build_predicted_tables,
    build_written_prior,
    collect_priors,
    describe_write_backs,
    extend_table,
    is_residualized,
    list_candidates,
    select_nuisance,
    select_starting_tables,
    select_widest_prediction,
)

__all__ = ["compute_run", "prepare", "store_result"]


@dataclass(frozen=True, slots=True)
class _Prepared:
    """Task of a request by any method, the records that it was read from, and its warnings."""

    task: EstimationTask
    aircraft_id: int
    used: dict[str, tuple[int | None, ...]]
    list_warnings: Callable[[Method], tuple[str, ...]]


_MOST_PREPARED = 4  # a proposal, the check of a request and its runs prepare the same data
_LARGEST_PREPARED = 16 * 1024**2  # bytes of samples; longer records are read again

_prepared: OrderedDict[str, _Prepared] = OrderedDict()
_preparing = threading.Lock()


def prepare(store: Store, run: EstimationRun, condition: Condition | None = None) -> EstimationTask:
    """Read everything that a run needs.

    The provenance of a run that has a result is not hashed again. Equal records are read once for
    the proposal of a run, the check of its request and its methods.

    Parameters
    ----------
    store
        The campaign.
    run
        Maneuvers, model structure and settings.
    condition
        Flight condition for which model, start and priors are built; those of the maneuvers
        by default.

    Raises
    ------
    BadInput
        If the model structure does not fit the maneuver: unknown modes, inputs or
        outputs, a band without frequencies, a sensor without mode shape.
    """
    check_extras(run.method, run.structure.extra_parameters)
    with store.reading():
        found = _prepare_once(store, run, condition)
        if run.result is None:
            provenance = hash_provenance(store, run, found.aircraft_id, found.used)
        else:
            provenance = Provenance(
                rests_on=run.rests_on or {}, data_hash=run.data_hash, input_hash=run.input_hash
            )
        return found.task.for_request(run.method, found.list_warnings(run.method), provenance)


def _prepare_once(store: Store, run: EstimationRun, condition: Condition | None) -> _Prepared:
    """Prepare a run, or return what was prepared from the same records.

    A run that rests on others is prepared anew: its hash names them.
    """
    rests_on_runs = run.result is not None or run.settings.start_run_id is not None
    if condition is not None or rests_on_runs or run.structure.fixed_to:
        return _prepare(store, run, condition)
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    maneuvers = [store.maneuvers.get(number) for number in ids]
    run = hash_request(store, run)  # with the modal tables that it uses
    used = run.data_hash, run.modal_table_id, run.damping_table_id, run.prediction_id
    # Of this database: samples of another one, as of a capsule, are read and checked themselves.
    key = repr((store.database.url, maneuvers, used, run.structure, run.settings))
    with _preparing:
        if key in _prepared:
            _prepared.move_to_end(key)
            return _prepared[key]
    found = _prepare(store, run, None)
    recordings = [one.measurement.recording for one in found.task.maneuver_tasks]
    if sum(samples.nbytes for one in recordings for _, samples in one.channels) < _LARGEST_PREPARED:
        with _preparing:
            _prepared[key] = found
            while len(_prepared) > _MOST_PREPARED:
                _prepared.popitem(last=False)
    return found


def _prepare(store: Store, run: EstimationRun, condition: Condition | None) -> _Prepared:
    settings = run.settings
    ids = tuple(dict.fromkeys((run.maneuver_id, *settings.additional_maneuver_ids)))
    maneuvers = [store.maneuvers.get(number) for number in ids]
    if condition is not None:
        maneuvers = [replace(maneuver, condition=condition) for maneuver in maneuvers]
    first = maneuvers[0]
    body = find_body(run.structure.axis)
    require_axis(body, maneuvers)
    aircraft = store.aircraft.get(first.aircraft_id)
    for other in maneuvers[1:]:
        if other.aircraft_id != first.aircraft_id:
            raise BadInput(
                f"maneuver {other.id} is of another aircraft than maneuver {first.id}",
                code="wrong-aircraft",
            )
    structure, aircraft = resolve_structure(store, run.structure, aircraft, first)
    if run.result is not None and run.prediction_id is None:  # as it was estimated
        run = replace(run, prediction_id=run.result.prediction_id)
    candidates = list_candidates(store, run, first.aircraft_id)
    modes, table_ids = load_modes_of_model(
        *(store, first.aircraft_id, run.modal_table_id, run.damping_table_id),
        *(structure.modes, ids),
    )
    inputs, outputs = select_inputs_and_outputs(store, first, aircraft, structure)
    is_shaped = settings.aerodynamics.is_shaped
    prediction = (select_shaped_prediction if is_shaped else select_prediction)(
        store, first.aircraft_id, run.prediction_id, structure.modes, inputs, body, candidates
    )
    if is_shaped and prediction is not None:
        run = replace(run, prediction_id=prediction.id)
    nuisance, retained, widest = None, (), prediction
    prediction_ids = [None if prediction is None else prediction.id]
    if settings.out_of_band_modes is OutOfBandModes.RETAINED:
        nuisance = select_nuisance(store, run, first, structure.modes, modes, inputs, body)
        if nuisance is not None:
            retained = nuisance.mean.modes[len(structure.modes) :]
            widest = select_widest_prediction(
                *(store, run.prediction_id, first.aircraft_id, modes, structure.modes, inputs),
                *(body, candidates),
            )
            prediction_ids.append(None if widest is None else widest.id)
    data = tuple(
        _prepare_maneuver(
            store,
            maneuver,
            aircraft,
            structure,
            modes,
            inputs,
            outputs,
            settings,
            retained,
            with_opposed=True,
        )
        for maneuver in maneuvers
    )
    if is_shaped and prediction is not None:
        data = tuple(
            _shape(store, prediction, settings.aerodynamics, maneuver, one)
            for maneuver, one in zip(maneuvers, data, strict=True)
        )
    predicted = build_predicted_tables(store, prediction, run, first, aircraft, modes, inputs, body)
    if nuisance is not None and settings.start is not Start.RESIDUALIZED_PREDICTION:
        # The retained modes have their static response themselves.
        predicted = {name: t for name, t in predicted.items() if not is_residualized(name)}
    starts = select_starting_tables(store, run, predicted, inputs, body)
    own_model = data[0].model.with_modes(len(structure.modes))
    free = _check_names(own_model, starts, structure, settings)
    modal_errors = _compute_modal_errors([task.model for task in data], modes, free)
    modal_std = {name: std for name, std in modal_errors.named().items() if std > 0.0}
    priors = {
        name: (mean, float(np.hypot(std, modal_std.get(name, 0.0))))
        for name, (mean, std) in collect_priors(predicted, free, settings).items()
    }
    if nuisance is not None:
        nuisance = replace(nuisance, modal_std=modal_errors.values)
        starts = {name: extend_table(table, nuisance.mean) for name, table in starts.items()}
        predicted = {name: extend_table(t, nuisance.mean) for name, t in predicted.items()}
    assumed = modes.warnings if structure.modes else ()
    written = None
    if settings.out_of_band_modes is OutOfBandModes.RETAINED and not is_shaped:
        numbers, every = data[0].model.modes.numbers, modal_errors.named()
        written = build_written_prior(store, widest, first, table_ids[0], numbers, every)
    if written is not None:
        written = replace(written, joint=written.joint.drop(settings.priors))
    write_backs = describe_write_backs(
        store, run, first.aircraft_id, None if written is None else widest
    )
    shape_errors = _list_shape_errors(aircraft, first, data[0].model, outputs, modes, structure)
    drifts = tuple(text for one in maneuvers for text in warn_of_airspeed_drift(store, one))
    air_data = tuple(text for one in maneuvers for text in warn_of_air_data(store, one))

    def list_warnings(method: Method) -> tuple[str, ...]:
        max_omega = data[0].measurement.max_omega
        of_request = list_request_warnings(
            method, structure, first, aircraft, own_model, max_omega, modes.names, modes.symmetric
        )
        unknown = warn_of_unknown_modes(settings, nuisance, is_rigid=not modes.names)
        return (*assumed, *of_request, *unknown, *drifts, *air_data, *write_backs)

    task = EstimationTask(
        method=run.method,
        settings=settings,
        structure=structure,
        maneuver_tasks=data,
        mode_names=(
            *(modes.names[number] for number in structure.modes),
            *(f"retained mode {number}" for number in retained),  # names of modes may be equal
        ),
        starts=starts,
        predicted=next(iter(predicted.values()), None),
        priors=priors,
        modal_std=modal_std,
        try_equation_error=settings.start in (Start.BEST, Start.EQUATION_ERROR),
        residualized=None
        if retained
        else next((t.named() for n, t in predicted.items() if is_residualized(n)), None),
        nuisance=nuisance,
        shape_errors=shape_errors,
        drifts=drifts,
        assumed=frozenset(
            name
            for name in shape_errors
            if int(name.rpartition("_")[2]) not in modes.shape_std
            and (written is None or name not in written.joint.names)
        ),
        written=written,
        shape_spread=modes.assumed_shape_std,
        prediction_id=None if prediction is None else prediction.id,
        warnings=(),  # and provenance are those of each request
        provenance=Provenance(rests_on={}, data_hash=None, input_hash=None),
    )
    used = {"modal table": table_ids, "prediction": tuple(prediction_ids)}
    return _Prepared(task, first.aircraft_id, used, list_warnings)


def select_inputs_and_outputs(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, structure: Structure
) -> tuple[tuple[str, ...], tuple[OutputDefinition, ...]]:
    """Select the inputs and outputs of the model structure, by default all of the axis.

    Recorded surfaces that excite the other axis only are excluded by default, and so are inputs
    that are no surfaces of the aircraft where any is.
    """
    body = find_body(structure.axis)
    channels = {c.name: c.role for c in store.channels.find(maneuver_id=maneuver.id)}
    recorded = tuple(name for name, role in channels.items() if role is Role.INPUT)
    surfaces = {surface.name for surface in aircraft.surfaces}
    recorded = tuple(name for name in recorded if name in surfaces) or recorded
    inputs = structure.inputs or list_axis_surfaces(aircraft, body, recorded) or recorded
    require_axis_inputs(aircraft, inputs, body)
    separated = bool(list_opposed_surfaces(maneuver, aircraft, inputs, body))
    names = structure.outputs or list_default_outputs(aircraft, channels, body, separated=separated)
    return inputs, define_outputs(aircraft, names)


def store_result(
    store: Store, run_id: int, attempt: int, computed: ComputedRun, worker: str = ""
) -> EstimationRun:
    """Store a result in one transaction, unless the attempt was superseded."""
    estimate = computed.estimate
    retained = computed.retained
    whole = estimate if retained is None else retained.estimate
    bulk = [
        describe_array(estimate.corrected_covariance),
        describe_array(whole.corrected_covariance),
    ]
    for block in estimate.lines:
        bulk += [
            describe_array(block.omega, "rad/s"),
            describe_array(block.measured),
            describe_array(block.fitted),
        ]
    with store.transaction():
        covariance, whole_covariance, *names = store.arrays.put_many(bulk)
        run = store.runs.get(run_id)
        posterior = _store_posterior(store, run, computed)
        maneuver_ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
        blocks = tuple(
            FitBlock(
                name=block.name,
                outputs=block.outputs,
                arrays=dict(
                    zip(("omega", "measured", "fitted"), names[3 * k : 3 * k + 3], strict=True)
                ),
            )
            for k, block in enumerate(estimate.lines)
        )
        result = RunResult(
            parameters=_build_parameters(computed),
            covariance=covariance,
            fit=_build_fit(computed),
            poles=tuple(
                Pole(
                    real=pole.value.real,
                    imag=pole.value.imag,
                    name=pole.name,
                    real_std=finite_or_none(pole.real_std),
                    imag_std=finite_or_none(pole.imag_std),
                    frequency=pole.frequency,
                    frequency_std=finite_or_none(pole.frequency_std),
                    damping=pole.damping,
                    damping_std=finite_or_none(pole.damping_std),
                )
                for pole in computed.poles
            ),
            blocks=blocks,
            residualized_prediction=computed.residualized,
            prediction_id=computed.prediction_id,
            held=computed.held,
            retained=None
            if retained is None
            else _describe_retained_modes(retained, whole_covariance),
            adequacy=computed.adequacy,
            symmetry=computed.symmetry,
            error_causes=store_error_causes(store, estimate.components, maneuver_ids),
            shape_spread=computed.shape_spread,
            posterior=posterior,
        )
        return queue.finish(
            store, run_id, attempt, result, computed.versions, worker, computed.provenance
        )


def _store_posterior(
    store: Store, run: EstimationRun, computed: ComputedRun
) -> RunPosterior | None:
    found, retained = computed.posterior, computed.retained
    if found is None:
        return None
    return RunPosterior(
        names=found.names,
        values=tuple(found.values.tolist()),
        covariance=store.arrays.put(found.corrected_covariance),
        modes=(*run.structure.modes, *(() if retained is None else retained.modes)),
    )


def _describe_retained_modes(found: ComputedRetainedModes, covariance: str) -> RetainedModes:
    estimate = found.estimate
    rows = zip(estimate.names, estimate.values, estimate.std_errors, strict=True)
    return RetainedModes(
        modes=found.modes,
        spread=found.spread,
        parameters=tuple(
            NuisanceParameter(
                name=name,
                value=float(value),
                std_error=finite_or_none(std_error),
                prior=found.priors[name][0],
                prior_std=found.priors[name][1],
            )
            for name, value, std_error in rows
            if name in estimate.nuisance
        ),
        covariance=covariance,
        noise_share=found.noise_share,
    )


def _prepare_maneuver(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    structure: Structure,
    modes: AircraftModes,
    inputs: tuple[str, ...],
    outputs: tuple[OutputDefinition, ...],
    settings: RunSettings,
    retained: tuple[int, ...],
    *,
    with_opposed: bool,
) -> ManeuverTask:
    own, body = structure.modes, find_body(structure.axis)
    require_own_motion(store, maneuver, aircraft, inputs, outputs, body)
    # A frequency shape has lags, whose states at the ends are not modelled.
    free_ends = not settings.aerodynamics.is_shaped
    measurement = read_measurement(
        store, maneuver, aircraft, inputs, outputs, settings.band_hz, body, free_ends=free_ends
    )
    fuel = maneuver.condition.fuel_fraction
    opposed, pairs = None, {}
    if maneuver.axis == COMBINED and with_opposed:
        opposed = _prepare_opposed_axis(store, maneuver, aircraft, modes, body, settings)
        if opposed is not None and opposed.measurement.max_omega != measurement.max_omega:
            opposed = None  # recorded over another window, and thus at other frequencies
        pairs = {} if opposed is None else pair_parts(aircraft, inputs, opposed.model.inputs)

    def build_wrong_models(shapes: StructuralModes) -> dict[str, AeroelasticModel]:
        wrong_conditions = list_wrong_conditions(*widen_by_spread(store, aircraft, maneuver))
        return {
            cause: build_model(aircraft, condition, shapes, inputs, outputs, body)
            for cause, condition in wrong_conditions.items()
        }

    if retained:
        shapes = modes.table.at(fuel).select((*own, *retained))
        model = build_model(aircraft, maneuver.condition, shapes, inputs, outputs, body)
        wrong = build_wrong_models(shapes)
        return ManeuverTask(
            label=maneuver.label,
            model=model,
            extended_model=model,
            pairs=pairs,
            wrong_models=wrong,
            measurement=measurement,
            opposed=opposed,
        )
    out_of_band = select_out_of_band_modes(
        modes, fuel, own, measurement.max_omega, len(outputs), body
    )
    shapes = modes.table.at(fuel).select((*own, *out_of_band))
    extended = build_model(aircraft, maneuver.condition, shapes, inputs, outputs, body)
    own_model = extended.with_modes(len(own))
    wrong = build_wrong_models(modes.table.at(fuel).select(own))
    is_compared = with_opposed and not modes.names
    sensors = _read_sensors(store, maneuver) if is_compared else None
    return ManeuverTask(
        label=maneuver.label,
        model=own_model,
        extended_model=extended,
        pairs=pairs,
        wrong_models=wrong,
        measurement=measurement,
        opposed=opposed,
        sensors=sensors,
    )


def _read_sensors(store: Store, maneuver: Maneuver) -> RecordedSensors | None:
    """Read the sensors of a rigid aircraft that kinematics compare; None where there are none."""
    try:
        return read_flight_record(store, maneuver)
    except BadInput:
        return None


def _prepare_opposed_axis(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    modes: AircraftModes,
    body: RigidBody,
    settings: RunSettings,
) -> ManeuverTask | None:
    """Read the motion of the other axis of a combined maneuver, with the modes in the band.

    None where no sensors measure it.
    """
    other = find_other(body)
    structure = Structure(fixed={}, axis=other.axis)
    inputs, outputs = select_inputs_and_outputs(store, maneuver, aircraft, structure)
    if not outputs:
        return None
    frequencies = select_frequencies(maneuver, settings.band_hz)
    fuel, top = maneuver.condition.fuel_fraction, float(frequencies.omega[-1])
    at_fuel = modes.table.at(fuel)
    near = select_out_of_band_modes(modes, fuel, (), top, len(outputs), other)
    omega = dict(zip(at_fuel.numbers, at_fuel.omega.tolist(), strict=True))
    structure = replace(structure, modes=tuple(n for n in near if omega[n] < top))
    return _prepare_maneuver(
        store, maneuver, aircraft, structure, modes, inputs, outputs, settings, (),
        with_opposed=False,
    )  # fmt: skip


def _compute_modal_errors(
    models: Sequence[AeroelasticModel], modes: AircraftModes, free: tuple[str, ...]
) -> DerivativeTable:
    """Compute the errors of derivatives due to the modal table, averaged over maneuvers.

    A frequency or damping that is estimated has no error of the table.
    """
    numbers = models[0].modes.numbers

    def collect(kind: str, std: Mapping[int, float]) -> np.ndarray:
        return np.array([0.0 if f"{kind}_{n}" in free else std[n] for n in numbers])

    frequency = collect("omega", modes.frequency_std)
    damping = collect("zeta", modes.damping_std)
    tables = [compute_modal_errors(model, frequency, damping) for model in models]
    return replace(tables[0], values=np.mean([table.values for table in tables], axis=0))


def _list_shape_errors(
    aircraft: Aircraft,
    maneuver: Maneuver,
    model: AeroelasticModel,
    outputs: tuple[OutputDefinition, ...],
    modes: AircraftModes,
    structure: Structure,
) -> dict[str, float]:
    """List the standard deviations of the errors of mode shapes; free shapes have none.

    Those of shapes of which the table states none are for a spread of one.
    """
    if not model.modes.numbers:
        return {}
    condition = maneuver.condition
    shapes = modes.table.at(condition.fuel_fraction).select(model.modes.numbers)
    sizes = compute_shape_sizes(aircraft, condition, shapes, outputs, model.body)
    std = {number: modes.shape_std.get(number, 1.0) for number in model.modes.numbers}
    found = list_shape_errors(model, sizes, std)
    free = {name.replace("shape", SHAPE_ERROR, 1) for name in structure.extra_parameters}
    return {name: std for name, std in found.items() if name not in free}


def _shape(
    store: Store,
    prediction: DerivativePrediction,
    aerodynamics: Aerodynamics,
    maneuver: Maneuver,
    task: ManeuverTask,
) -> ManeuverTask:
    """Give the models of a maneuver the frequency shape of a prediction."""
    coarse_mesh = aerodynamics is Aerodynamics.SHAPED_COARSE_MESH

    def shape(model: AeroelasticModel) -> AeroelasticModel:
        fuel = maneuver.condition.fuel_fraction
        numbers = model.modes.numbers
        found = load_frequency_shape(
            store,
            prediction,
            fuel,
            numbers,
            model.inputs,
            model.body,
            coarse_mesh=coarse_mesh,
        )
        found.at(np.array([task.measurement.max_omega * model.condition.rate_factor]))
        return replace(model, shape=found)

    own, wrong = shape(task.model), task.wrong_models
    return replace(
        task,
        model=own,
        extended_model=shape(task.extended_model),
        wrong_models={cause: replace(model, shape=own.shape) for cause, model in wrong.items()},
    )


def _check_names(
    model: AeroelasticModel,
    starts: dict[str, DerivativeTable],
    structure: Structure,
    settings: RunSettings,
) -> tuple[str, ...]:
    """Return the names of the free parameters; a prior without a free parameter is refused."""
    empty = model.fill_table({})
    delays = tuple(f"delay_{name}" for name in model.outputs) if structure.free_delays else ()
    extras = tuple(dict.fromkeys((*delays, *structure.extra_parameters)))
    start = next(iter(starts.values()), empty)
    parameters = select_parameters(start, structure.free, model.outputs, extras, structure.fixed)
    for name in settings.priors:
        if name not in parameters.names:
            raise BadInput(
                f"the prior of '{name}' has no free parameter; free it or remove the prior",
                code="unknown-parameter",
                name=name,
            )
    return parameters.names


def _build_parameters(computed: ComputedRun) -> tuple[ParameterEstimate, ...]:
    estimate = computed.estimate

    def explain_missing_error(name: str, error: float) -> str | None:
        if np.isfinite(error):
            return None
        if name in computed.moved:
            return "moved by the cause"
        if name in computed.at_limit:
            return "at its limit"
        return "not identifiable" if estimate.outcome.is_optimum else "not converged"

    return tuple(
        ParameterEstimate(
            name=quality.name,
            value=float(value),
            std_error=finite_or_none(
                np.sqrt(quality.std_error**2 + modal_std**2 + condition_std**2)
            ),
            modal_std=modal_std or None,
            condition_std=condition_std or None,
            shares=computed.shares.get(quality.name),
            start=float(start),
            cramer_rao=finite_or_none(quality.cramer_rao),
            insensitivity=finite_or_none(quality.insensitivity),
            no_error=explain_missing_error(quality.name, quality.std_error),
        )
        for quality, value, start in zip(
            compute_parameter_quality(estimate), estimate.values, estimate.start, strict=True
        )
        for modal_std in [computed.modal_std.get(quality.name, 0.0)]
        for condition_std in [computed.condition_std.get(quality.name, 0.0)]
    )


def _build_fit(computed: ComputedRun) -> Fit:
    estimate = computed.estimate
    return Fit(
        outcome=estimate.outcome.value,
        message=estimate.message,
        iterations=tuple(
            replace(step, step=finite_or_none(step.step) or 0.0) for step in estimate.steps
        ),
        cost=estimate.steps[-1].cost if estimate.steps else None,
        r_squared=_compute_r_squared(estimate),
        n_lines=sum(block.omega.size for block in estimate.lines),
        n_parameters=len(estimate.names),
        noise="" if estimate.noise is None else estimate.noise.description,
        noise_degrees_of_freedom=None
        if estimate.noise is None
        else estimate.noise.degrees_of_freedom,
        seconds=computed.seconds,
        start=computed.start,
        warnings=computed.warnings,
        quality=tuple(
            OutputQuality(block=block.name, **asdict(quality))
            for block in estimate.lines
            for quality in compute_output_fit(block)
        ),
    )


def _compute_r_squared(estimate: Estimate) -> dict[str, float]:
    """Compute R^2 per output over the frequencies of all blocks."""
    error: dict[str, float] = {}
    power: dict[str, float] = {}
    for block in estimate.lines:
        for column, output in enumerate(block.outputs):
            z, y = block.measured[:, column], block.fitted[:, column]
            error[output] = error.get(output, 0.0) + float(np.sum(np.abs(z - y) ** 2))
            power[output] = power.get(output, 0.0) + float(np.sum(np.abs(z) ** 2))
    return {name: 1.0 - error[name] / power[name] for name in power if power[name] > 0}
