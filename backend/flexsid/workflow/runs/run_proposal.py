"""Proposal of a model structure and band for a maneuver, with the reasons."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.decision import Structure
from flexsid.records.maneuver import COMBINED, Maneuver
from flexsid.records.run import (
    EstimationRun,
    Method,
    ModeInBand,
    ProposalBasis,
    ProposalSource,
    RunProposal,
    RunSettings,
    RunState,
)
from flexsid.storage.store import Store
from flexsid.sysid.estimation.experiment import select_parameters
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.rigid_body import RigidBody, SensorRows
from flexsid.sysid.stability.poles import NamedPole, compute_named_poles
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.axes import find_body, list_bodies, require_axis
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_values,
    list_default_predictions,
    list_predicted_modes,
    select_prediction,
)
from flexsid.workflow.measurements.flight_records import list_moving
from flexsid.workflow.measurements.maneuver_spectra import (
    warn_of_air_data,
    warn_of_airspeed_drift,
)
from flexsid.workflow.measurements.recording import SpectrumFrequencies, select_frequencies
from flexsid.workflow.measurements.sensor_responses import find_excited_band
from flexsid.workflow.modal_data.modal_tables import AircraftModes, find_modal_tables, load_modes
from flexsid.workflow.model_structures.baselines import Baseline, find_baseline, require_baseline
from flexsid.workflow.runs.estimation import select_inputs_and_outputs
from flexsid.workflow.runs.resolved_modes import LEAST_DETERMINED, compute_mode_shares

# --- Defaults of a run: the surfaces that move, and the band that was excited ---------------------


def complete_request(store: Store, run: EstimationRun) -> EstimationRun:
    """Return a run with the inputs and the band that it is estimated with, where it has none.

    Surfaces that rest in all of its maneuvers are no inputs: their derivatives would be noise.
    """
    run = set_default_band(store, run)
    if run.structure.inputs or run.structure_id is not None:
        return run
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    first = store.maneuvers.get(run.maneuver_id)
    try:
        aircraft = store.aircraft.get(first.aircraft_id)
        inputs, _ = select_inputs_and_outputs(store, first, aircraft, run.structure)
    except BadInput:  # raised again when the run is prepared
        return run
    moving = _drop_resting(store, ids, inputs)
    if moving == inputs:
        return run
    return replace(run, structure=replace(run.structure, inputs=moving))


def _drop_resting(
    store: Store, maneuver_ids: Sequence[int], inputs: tuple[str, ...]
) -> tuple[str, ...]:
    """Drop inputs that rest in all maneuvers; none where all do."""
    moving: set[str] = set()
    for number in maneuver_ids:
        maneuver = store.maneuvers.get(number)
        aircraft = store.aircraft.get(maneuver.aircraft_id)
        recorded = {c.name for c in store.channels.find(maneuver_id=number)}
        parts = list_surface_parts(aircraft)
        for name in inputs:
            terms = [name] if name in recorded else [t for t, _ in parts.get(name, ())]
            if name not in moving and list_moving(store, number, terms):
                moving.add(name)
    return tuple(name for name in inputs if name in moving) or inputs


def set_default_band(store: Store, run: EstimationRun) -> EstimationRun:
    """Return a run with the band that it is estimated in, where its request has none.

    Every request passes through here before it is stored, so that the band is part of the
    settings of the run. A run of maneuvers with known harmonics has none.

    Raises
    ------
    BadInput
        If no surface was recorded.
    """
    if run.settings.band_hz is not None:
        return run
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    maneuvers = [store.maneuvers.get(number) for number in ids]
    band_hz = find_default_band(store, maneuvers, find_body(run.structure.axis))
    return replace(run, settings=replace(run.settings, band_hz=band_hz))


def find_default_band(
    store: Store, maneuvers: Sequence[Maneuver], body: RigidBody
) -> tuple[float, float] | None:
    """Find the band that covers what was excited for a body in each of the maneuvers. [Hz]

    None where the harmonics of all are known: these are then fitted, whatever the band.
    """
    if all(maneuver.excitation is not None for maneuver in maneuvers):
        return None
    bands = [_find_band(store, maneuver, body) for maneuver in maneuvers]
    return min(low for low, _ in bands), max(high for _, high in bands)


def _find_band(store: Store, maneuver: Maneuver, body: RigidBody) -> tuple[float, float]:
    if maneuver.excitation is None:
        aircraft = store.aircraft.get(maneuver.aircraft_id)
        return find_excited_band(store, maneuver, aircraft, body)
    hz = select_frequencies(maneuver).omega / (2.0 * np.pi)
    return float(hz.min()), float(hz.max())


# --- Proposal of a model structure and band for a maneuver, with the reasons ----------------------

LISTED_BAND_RATIO = 2.5
"""Modes up to this multiple of the highest excited frequency are listed."""

_MIN_FREQUENCIES_PER_PARAMETER = 3.0
"""Excited frequencies per parameter of one equation; fewer raise a warning."""

_MIN_FREQUENCIES_IN_RESONANCE = 2.0
"""Frequencies within the half-power bandwidth of a mode that resolve its damping."""

_SEARCHED_RUNS = 50  # newest runs that are searched for a saved model structure


@dataclass(frozen=True, slots=True)
class _BandAndModes:
    """Excited frequencies of a maneuver and the modes near their band."""

    maneuver: Maneuver
    aircraft: Aircraft
    frequencies: SpectrumFrequencies
    modes: tuple[ModeInBand, ...]

    @property
    def band_hz(self) -> tuple[float, float]:
        hz = self.frequencies.omega / (2.0 * np.pi)
        return float(hz.min()), float(hz.max())

    def describe_band(self) -> str:
        low, high = self.band_hz
        return f"{low:.3g} to {high:.3g} Hz were excited"


@dataclass(frozen=True, slots=True, kw_only=True)
class AssumedRecords:
    """Ids of the modal tables and of the prediction that a run names; by default the latest."""

    modal_table_id: int | None = None
    damping_table_id: int | None = None
    prediction_id: int | None = None


def propose_run(
    store: Store,
    maneuver_ids: Sequence[int],
    band_hz: tuple[float, float] | None = None,
    axis: str | None = None,
    assumed: AssumedRecords = AssumedRecords(),
) -> RunProposal:
    """Propose a run of one maneuver, or of several that are fitted together.

    The model structure is the one approved for the condition; else the saved one that the
    newest successful run of this flight test aid used; else the symmetric modes whose resonance,
    in vacuo or predicted in air, ends below the highest excited frequency, and whose derivatives
    the data are expected to determine better than the prediction. A resonance ends a
    half-power bandwidth above its frequency: with less the data contain only one flank of it.

    Parameters
    ----------
    store, maneuver_ids
        The proposal is for the first maneuver; the others are fitted together with it.
    band_hz
        Limits given by the analyst; the excited band by default. [Hz]
    axis
        Axis of the model; that of the maneuver by default, the longitudinal one of a combined
        maneuver.
    assumed
        Modal tables with the modes that may be proposed, and prediction of their roots in air.

    Raises
    ------
    BadInput
        If maneuvers are of different axes, were not flown, or baselines differ.
    """
    with store.reading():
        return _propose(store, tuple(maneuver_ids), band_hz, axis, assumed)


def _propose(
    store: Store,
    maneuver_ids: tuple[int, ...],
    band_hz: tuple[float, float] | None,
    axis: str | None,
    assumed: AssumedRecords,
) -> RunProposal:
    maneuvers = [store.maneuvers.get(number) for number in maneuver_ids]
    body = find_body(maneuvers[0].axis if axis is None else axis)
    require_axis(body, maneuvers)
    band = find_default_band(store, maneuvers, body) if band_hz is None else band_hz
    # The maneuver with the highest excited frequency determines the modes in the band.
    found = max(
        (_read_band_and_modes(store, maneuver, band, body, assumed) for maneuver in maneuvers),
        key=lambda one: one.band_hz[1],
    )
    first = maneuvers[0]
    settings = RunSettings(band_hz=band if band_hz is None else found.band_hz)
    chosen = _find_chosen_structure(store, maneuver_ids, first, found, body)
    if chosen is None:
        found = _determine_modes(store, maneuver_ids, found, settings, body, assumed)
        chosen = _select_modes(found, body)
    structure, basis = chosen
    inputs, outputs = select_inputs_and_outputs(store, first, found.aircraft, structure)
    if basis.source is ProposalSource.BAND:
        picked = _drop_resting(store, maneuver_ids, _pick_excited(first, inputs))
        if picked != inputs:
            inputs, structure = picked, replace(structure, inputs=picked)
    if not structure.inputs and first.axis == COMBINED:
        structure = replace(structure, inputs=inputs)  # parts of the recorded surfaces
    modes = tuple(replace(m, proposed=m.number in structure.modes) for m in found.modes)
    names = tuple(output.name for output in outputs)
    proposal = _describe_proposal(first, structure, settings, basis, inputs, names, modes, found)
    spread = (
        text
        for one in maneuvers
        for text in (*warn_of_airspeed_drift(store, one), *warn_of_air_data(store, one))
    )
    return replace(proposal, warnings=(*proposal.warnings, *spread))


def _pick_excited(maneuver: Maneuver, inputs: tuple[str, ...]) -> tuple[str, ...]:
    """Pick the inputs with harmonics; all where the harmonics are not known."""
    harmonics = {} if maneuver.excitation is None else maneuver.excitation.harmonics
    return tuple(name for name in inputs if harmonics.get(name)) or inputs


def apply_proposal(store: Store, run: EstimationRun) -> EstimationRun:
    """Replace the model structure of a run, and an open band, by the proposed ones."""
    settings = run.settings
    found = _propose_for(store, run)
    basis = found.basis
    return replace(
        run,
        structure=found.structure,
        settings=replace(settings, band_hz=found.settings.band_hz),
        structure_id=basis.structure_id,
        structure_version=basis.structure_version,
        proposal=basis,
    )


def attach_proposal_basis(store: Store, run: EstimationRun) -> EstimationRun:
    """Complete a request, and add the basis where the model structure equals the proposed one."""
    run = complete_request(store, run)
    try:
        found = _propose_for(store, run)
    except BadInput:  # raised again when the run is prepared, or no proposal is needed
        return run
    same = found.structure == run.structure and found.basis.structure_id == run.structure_id
    return replace(run, proposal=found.basis if same else None)


def _propose_for(store: Store, run: EstimationRun) -> RunProposal:
    """Propose a run of the maneuvers and band of a run, in its axis if one of theirs."""
    ids = (run.maneuver_id, *run.settings.additional_maneuver_ids)
    bodies = list_bodies(store.maneuvers.get(run.maneuver_id).axis)
    axis = run.structure.axis if find_body(run.structure.axis) in bodies else None
    assumed = AssumedRecords(
        modal_table_id=run.modal_table_id,
        damping_table_id=run.damping_table_id,
        prediction_id=run.prediction_id,
    )
    return propose_run(store, ids, run.settings.band_hz, axis, assumed)


def _read_band_and_modes(
    store: Store,
    maneuver: Maneuver,
    band_hz: tuple[float, float] | None,
    body: RigidBody,
    assumed: AssumedRecords,
) -> _BandAndModes:
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    build_flight_condition(aircraft, maneuver.condition)  # refuses ground records
    frequencies = select_frequencies(maneuver, band_hz)
    top_hz = float(frequencies.omega.max()) / (2.0 * np.pi)
    modes = _find_modes_near_band(store, maneuver, aircraft, top_hz, body, assumed)
    return _BandAndModes(maneuver, aircraft, frequencies, modes)


def _find_chosen_structure(
    store: Store,
    maneuver_ids: tuple[int, ...],
    first: Maneuver,
    found: _BandAndModes,
    body: RigidBody,
) -> tuple[Structure, ProposalBasis] | None:
    """Find the approved model structure, or the saved one that was last used; None for neither."""
    excited = found.describe_band()
    baselines = [
        find_baseline(store, store.maneuvers.get(number), body.axis) for number in maneuver_ids
    ]
    if any(one is not None for one in baselines):
        approved: Baseline = require_baseline(store, maneuver_ids, body.axis)
        version = approved.structure
        reasons = (f"'{approved.title}' was approved for this condition.", f"{excited}.")
        return version.structure, ProposalBasis(
            source=ProposalSource.BASELINE,
            reasons=reasons,
            band_hz=found.band_hz,
            decision_id=approved.decision_id,
            structure_id=version.structure_id,
            structure_version=version.version,
        )
    saved = _find_saved_structure(store, first, body)
    if saved is not None:
        structure, basis = saved
        return structure, replace(
            basis, band_hz=found.band_hz, reasons=(*basis.reasons, f"{excited}.")
        )
    return None


def _determine_modes(
    store: Store,
    maneuver_ids: tuple[int, ...],
    found: _BandAndModes,
    settings: RunSettings,
    body: RigidBody,
    assumed: AssumedRecords,
) -> _BandAndModes:
    """Add how far the data are expected to determine each mode in the band."""
    inside = tuple(mode.number for mode in found.modes if mode.in_band)
    if not inside:
        return found
    structure = Structure(modes=inside, fixed={}, axis=body.axis)
    first = store.maneuvers.get(maneuver_ids[0])
    inputs, _ = select_inputs_and_outputs(store, first, found.aircraft, structure)
    excited = _pick_excited(first, inputs)
    if excited != inputs:
        structure = replace(structure, inputs=excited)
    run = EstimationRun(
        maneuver_id=maneuver_ids[0],
        method=Method.OE,
        structure=structure,
        settings=replace(settings, additional_maneuver_ids=maneuver_ids[1:]),
        modal_table_id=assumed.modal_table_id,
        damping_table_id=assumed.damping_table_id,
        prediction_id=assumed.prediction_id,
    )
    shares = compute_mode_shares(store, run)
    modes = tuple(replace(m, determined_share=shares.get(m.number)) for m in found.modes)
    return replace(found, modes=modes)


def _is_result(mode: ModeInBand) -> bool:
    share = mode.determined_share
    return mode.in_band and (share is None or share >= LEAST_DETERMINED)


def _select_modes(found: _BandAndModes, body: RigidBody) -> tuple[Structure, ProposalBasis]:
    """Select the modes in the band that the data determine."""
    excited = found.describe_band()
    inside = [mode for mode in found.modes if _is_result(mode)]
    unseen = [mode for mode in found.modes if mode.in_band and mode not in inside]
    above = next((mode for mode in found.modes if not mode.in_band), None)
    reasons = [
        f"{excited}; "
        + (
            f"{', '.join(_describe_mode(mode) for mode in inside)} "
            f"{'ends' if len(inside) == 1 else 'end'} below its upper limit."
            if inside
            else f"no {body.symmetry} mode {'is determined' if unseen else 'ends'} below its "
            "upper limit: the model is rigid."
        )
    ]
    reasons += [
        f"{_describe_mode(mode)} lies in the band but is retained as a nuisance mode: the data are "
        f"expected to remove {mode.determined_share:.0%} of the prior variances of the derivatives "
        f"of its equation ({LEAST_DETERMINED:.0%} for a result)."
        for mode in unseen
    ]
    if above is not None:
        reasons.append(f"{_describe_mode(above)} lies at that limit or above it and is omitted.")
    numbers = tuple(mode.number for mode in inside)
    return Structure(modes=numbers, fixed={}, axis=body.axis), ProposalBasis(
        source=ProposalSource.BAND, reasons=tuple(reasons), band_hz=found.band_hz
    )


def _describe_mode(mode: ModeInBand) -> str:
    if mode.air_frequency_hz is None:
        return f"{mode.name} ({mode.frequency_hz:.3g} Hz in vacuo)"
    return (
        f"{mode.name} ({mode.frequency_hz:.3g} Hz in vacuo, {mode.air_frequency_hz:.3g} Hz in air)"
    )


def _find_saved_structure(
    store: Store, maneuver: Maneuver, body: RigidBody
) -> tuple[Structure, ProposalBasis] | None:
    """Find the saved model structure of the newest successful run of the same FTA."""
    if maneuver.fta is None:
        return None
    page = store.run_page(
        aircraft_id=maneuver.aircraft_id,
        fta=maneuver.fta,
        state=RunState.SUCCEEDED,
        sort="-id",
        limit=_SEARCHED_RUNS,
        after=None,
    )
    for item in page.items:
        if item.structure_id is not None and item.structure_version is not None:
            run = store.runs.get(item.id)
            if run.structure.axis != body.axis:
                continue
            return run.structure, ProposalBasis(
                source=ProposalSource.SAVED_STRUCTURE,
                reasons=(
                    f"Run {item.id} of FTA {maneuver.fta} used version {item.structure_version} "
                    f"of model structure {item.structure_id}.",
                ),
                band_hz=(0.0, 0.0),
                structure_id=item.structure_id,
                structure_version=item.structure_version,
                run_id=item.id,
            )
    return None


def _find_modes_near_band(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    top_hz: float,
    body: RigidBody,
    assumed: AssumedRecords,
) -> tuple[ModeInBand, ...]:
    """Find modes of the axis in the band and just above it, lowest first; none without a table."""
    named = assumed.modal_table_id, assumed.damping_table_id
    try:
        tables = find_modal_tables(store, maneuver.aircraft_id, *named, (maneuver.id or 0,))
    except BadInput:
        if any(number is not None for number in named):
            raise
        return ()
    known = load_modes(store, *tables)
    at_fuel = known.table.at(maneuver.condition.fuel_fraction)
    air = _compute_poles_in_air(store, maneuver, aircraft, known, body, assumed.prediction_id)
    found = []
    for number, omega, zeta in zip(at_fuel.numbers, at_fuel.omega, at_fuel.zeta, strict=True):
        if not known.belongs_to(number, body):
            continue
        vacuo_hz = float(omega) / (2.0 * np.pi)
        pole = air.get(number)
        air_hz = None if pole is None else pole.frequency / (2.0 * np.pi)
        lowest = vacuo_hz if air_hz is None else min(vacuo_hz, air_hz)
        width = 2.0 * float(zeta) * vacuo_hz
        if pole is not None:
            width = 2.0 * abs(pole.value.real) / (2.0 * np.pi)
        found.append(
            ModeInBand(
                number=number,
                name=known.names[number],
                frequency_hz=vacuo_hz,
                air_frequency_hz=air_hz,
                half_power_hz=width,
                in_band=lowest + width <= top_hz,
                proposed=False,
            )
        )
    found.sort(key=lambda mode: mode.frequency_hz)
    near = [
        mode for mode in found if mode.in_band or mode.frequency_hz <= LISTED_BAND_RATIO * top_hz
    ]
    return tuple(near or found[:1])


def _compute_poles_in_air(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    known: AircraftModes,
    body: RigidBody,
    prediction_id: int | None,
) -> dict[int, NamedPole]:
    """Compute the poles of the modes of the axis that a prediction covers, at the condition."""
    own = tuple(n for n in known.table.numbers if known.belongs_to(n, body))
    candidates = list_default_predictions(store, maneuver.aircraft_id, (maneuver.id or 0,))
    prediction = select_prediction(
        store, maneuver.aircraft_id, prediction_id, own, (), body, candidates
    )
    if prediction is None:
        return {}
    covered = list_predicted_modes(prediction, own, body)
    fuel = maneuver.condition.fuel_fraction
    values = interpolate_values(store, prediction, fuel)
    if not set(list_derivative_names(covered, (), body)) <= set(values):
        return {}
    table = DerivativeTable.from_names(covered, (), values, body)
    blind = SensorRows((), np.zeros((4, 0, body.size + len(covered))))
    condition = build_flight_condition(aircraft, maneuver.condition)
    model = AeroelasticModel(condition, known.table.at(fuel).select(covered), (), blind, body)
    exact = select_parameters(table, model.derivative_names[:1], ())  # its covariance is zero
    numbers = {str(number): number for number in covered}  # names of modes may be equal
    poles = compute_named_poles(model, exact, exact.start, np.zeros((1, 1)), tuple(numbers))
    return {numbers[p.name]: p for p in poles if p.name in numbers and p.value.imag > 0.0}


def _describe_proposal(
    maneuver: Maneuver,
    structure: Structure,
    settings: RunSettings,
    basis: ProposalBasis,
    inputs: tuple[str, ...],
    outputs: tuple[str, ...],
    modes: tuple[ModeInBand, ...],
    found: _BandAndModes,
) -> RunProposal:
    names = list_derivative_names(structure.modes, inputs, find_body(structure.axis))
    held = {*structure.absent, *structure.fixed, *structure.fixed_to}
    free = [n for n in (names if structure.free is None else structure.free) if n not in held]
    n_parameters = len(free) + len(structure.extra_parameters)
    frequencies = found.frequencies
    n_lines = int(frequencies.omega.size)
    widest = max(
        (sum(n.startswith(f"{row}_") for n in free) for row in _list_coefficients(free)), default=0
    )
    per_parameter = n_lines / widest if widest else float(n_lines)
    spacing = np.diff(np.unique(frequencies.omega)) / (2.0 * np.pi)
    resolution = float(np.median(spacing)) if spacing.size else 1.0 / maneuver.duration_s
    assigned_inputs = {
        name: int(np.sum(frequencies.assigned_input == k))
        for k, name in enumerate(frequencies.inputs)
    }
    parts = {
        n: t for n, t in list_surface_parts(found.aircraft).items() if n not in assigned_inputs
    }
    missing = tuple(n for n in structure.modes if not any(m.number == n for m in modes))
    warnings = [
        f"{_describe_mode(mode)} lies above the highest excited frequency ({basis.band_hz[1]:.3g} "
        "Hz): the data contain little of its dynamics."
        for mode in modes
        if mode.proposed and not mode.in_band
    ]
    warnings += [
        f"Mode {number} lies far above the excited band." for number in missing if found.modes
    ]
    if per_parameter < _MIN_FREQUENCIES_PER_PARAMETER:
        warnings.append(
            f"{n_lines} excited frequencies for the {widest} parameters of one equation: omit "
            "inputs or modes, or fit several maneuvers together."
        )
    warnings += [
        f"Frequencies are {resolution:.3g} Hz apart, and {mode.name} is {mode.half_power_hz:.3g} "
        "Hz wide at half power: its damping is determined by few of them."
        for mode in modes
        if mode.proposed and mode.half_power_hz < _MIN_FREQUENCIES_IN_RESONANCE * resolution
    ]
    return RunProposal(
        maneuver_id=maneuver.id or 0,
        basis=basis,
        structure=structure,
        settings=settings,
        inputs=inputs,
        outputs=outputs,
        modes=modes,
        n_parameters=n_parameters,
        n_lines=n_lines,
        lines_per_input={
            name: sum(
                assigned_inputs.get(term, n_lines) for term, _ in parts.get(name, [(name, 1.0)])
            )
            for name in inputs
        },
        lines_per_parameter=per_parameter,
        resolution_hz=resolution,
        warnings=tuple(warnings),
    )


def _list_coefficients(free: Sequence[str]) -> set[str]:
    """List the coefficients that have free derivatives."""
    return {name.split("_", 1)[0] for name in free}
