"""Frequency responses of maneuvers, and measured open-loop responses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import list_surface_parts
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import EstimationRun
from flexsid.records.views import Blanked, Bode, LoopCurve, LoopPlot, NoiseShares, Response
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.response import combine_responses, find_unreliable_points, relative_std
from flexsid.sysid.stability.closed_loop import estimate_loop_gains
from flexsid.workflow.aircraft.aircraft_models import define_outputs, get_servo
from flexsid.workflow.comparison.error_causes import read_noise_shares
from flexsid.workflow.measurements.maneuver_spectra import read_measurement
from flexsid.workflow.measurements.recording import select_frequencies
from flexsid.workflow.runs.exports import IdentifiedModel, load_identified_model
from flexsid.workflow.views.maneuver import (
    MeasuredColumn,
    compute_period_coherence,
    find_sampling,
    list_input_names,
    measure_windows,
)
from flexsid.workflow.views.modes import find_identified_markers, find_mode_markers

# --- Frequency responses of maneuvers: bare airframe, instruments removed, as measured ------------

_GRID = 400  # points of a model's curve
_MARGIN = 1.1  # modes slightly outside the measured band are shown


def compute_bode(
    store: Store,
    maneuver_id: int,
    outputs: Sequence[str],
    inputs: Sequence[str] = (),
    run_ids: Sequence[int] = (),
    overlay: Sequence[int] = (),
    *,
    average: bool = False,
    rigid: bool = False,
    windowed: bool = False,
    selected: str | None = None,
) -> Bode:
    """Read frequency responses of outputs to inputs; to all excited inputs by default.

    Parameters
    ----------
    store, maneuver_id
        Maneuver.
    outputs, inputs
        Names.
    run_ids
        Runs whose models are added, if they have output and input. Inputs of models may combine
        left and right surfaces: each side has its share of their response.
    overlay
        Further maneuvers, as measured.
    average
        One response of all maneuvers, weighted by information.
    rigid
        Also responses of the models with rigid-body sensors (C_e = 0).
    windowed
        From averaged windows, as always without harmonics (sweeps, doublets).
    selected
        Parameter of the runs: also the frequencies on which its estimates rest.

    Raises
    ------
    BadInput
        If an input was not excited, the excitation is not known, or a run did not estimate the
        selected parameter.
    """
    names = tuple(dict.fromkeys(outputs))
    if not names:
        raise BadInput("a frequency response takes at least one output", code="no-output")
    maneuvers = [store.maneuvers.get(number) for number in dict.fromkeys((maneuver_id, *overlay))]
    first = maneuvers[0]
    columns = [_measure_responses(store, m, names, windowed) for m in maneuvers]
    known = list_input_names(store, first)
    chosen = tuple(dict.fromkeys(inputs)) or tuple(name for name in known if name in columns[0])
    for found in columns:
        _check_excited(chosen, found)
    units = {
        name: unit for name, (_, unit) in find_sampling(store, first, [*names, *chosen]).items()
    }
    probabilities: dict[str, float] = {}
    labels = [(m.id, m.label if len(maneuvers) > 1 else "") for m in maneuvers]
    if average and len(maneuvers) > 1:
        together = {
            name: combine_responses([found[name].response for found in columns]) for name in chosen
        }
        probabilities = {name: value.probability for name, value in together.items()}
        columns = [{name: MeasuredColumn(value.response) for name, value in together.items()}]
        labels = [(None, f"average of {len(maneuvers)}")]
    pairs = [(output, name) for output in names for name in chosen]
    measured = tuple(
        replace(_build_response(found[name], output, units), maneuver_id=number, label=label)
        for output, name in pairs
        for found, (number, label) in zip(columns, labels, strict=True)
    )
    anchors = {(r.output, r.input): r for r in reversed(measured)}
    low = min(response.frequency_hz[0] for response in measured)
    high = max(response.frequency_hz[-1] for response in measured)
    band = (low / _MARGIN, high * _MARGIN)
    parts = list_surface_parts(store.aircraft.get(first.aircraft_id))
    runs = [store.runs.get(number) for number in dict.fromkeys(run_ids)]
    models: list[Response] = []
    for run in runs:
        own = load_identified_model(store, run)
        label = f"{run.method.value} {run.id}"
        curves = [(own, label, False)]
        if rigid:
            curves.append((_remove_flexibility(own), f"{label}, C_e = 0", True))
        for model, name, is_rigid in curves:
            for curve in _compute_curves(model, pairs, (low, high), units, parts):
                anchor = anchors[curve.output, curve.input]
                models.append(
                    replace(
                        _align_phase(curve, anchor),
                        run_id=run.id,
                        label=name,
                        is_model=True,
                        rigid=is_rigid,
                    )
                )
    return Bode(
        maneuver_id=maneuver_id,
        inputs=known,
        measured=measured,
        models=tuple(models),
        modes=(
            *find_mode_markers(store, first, band),
            *(mark for run in runs for mark in find_identified_markers(run, band)),
        ),
        agreement=probabilities,
        noise_shares=tuple(_read_noise_shares(store, runs, selected, maneuver_id)),
    )


def _read_noise_shares(
    store: Store, runs: Sequence[EstimationRun], selected: str | None, maneuver_id: int
) -> Iterator[NoiseShares]:
    for run in runs if selected else ():
        found = read_noise_shares(store, run, selected or "", maneuver_id)
        if found is not None:
            yield found


def _measure_responses(
    store: Store, maneuver: Maneuver, outputs: tuple[str, ...], windowed: bool
) -> dict[str, MeasuredColumn]:
    """Estimate responses to every excited input: at its harmonics, else from windows."""
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    definitions = define_outputs(aircraft, outputs)
    if maneuver.excitation is None or windowed:
        return measure_windows(store, maneuver, aircraft, definitions)
    inputs = tuple(maneuver.excitation.harmonics)
    measurement = read_measurement(store, maneuver, aircraft, inputs, definitions)
    frequencies = select_frequencies(maneuver)
    coherence = compute_period_coherence(store, maneuver, outputs, frequencies)
    columns = {}
    for number, (name, response) in enumerate(measurement.transform().responses.items()):
        own = np.isin(frequencies.omega, response.omega) & (frequencies.assigned_input == number)
        columns[name] = MeasuredColumn(response, None if coherence is None else coherence[own])
    return columns


def _check_excited(names: Sequence[str], columns: dict[str, MeasuredColumn]) -> None:
    unknown = [name for name in names if name not in columns]
    if unknown:
        raise BadInput(
            f"'{unknown[0]}' was not excited in this maneuver; select one of {', '.join(columns)}",
            code="not-excited",
            input=unknown[0],
        )


def _remove_flexibility(model: IdentifiedModel) -> IdentifiedModel:
    """Replace sensors by rigid-body sensors (C_e = 0)."""
    sensors = model.model.sensors.rigid_only(model.model.n_rigid)
    return replace(model, model=replace(model.model, sensors=sensors))


def _compute_curves(
    model: IdentifiedModel,
    pairs: Sequence[tuple[str, str]],
    band_hz: tuple[float, float],
    units: dict[str, str],
    parts: Mapping[str, tuple[tuple[str, float], ...]],
) -> list[Response]:
    """Compute responses of an identified model on a fine grid over the measured band."""
    response = model.response(2.0 * np.pi * np.geomspace(*band_hz, _GRID))
    sides = _compute_side_responses(response, parts)
    return [
        _build_response(MeasuredColumn(column), output, units, name)
        for output, name in pairs
        if (column := sides.get(name)) is not None and output in response.outputs
    ]


def _compute_side_responses(
    response: FrequencyResponse, parts: Mapping[str, tuple[tuple[str, float], ...]]
) -> dict[str, FrequencyResponse]:
    """Return the response to each input, and to each single surface that an input combines."""
    weights = {name: np.zeros((len(response.inputs), 1)) for name in response.inputs}
    for column, part in enumerate(response.inputs):
        weights[part][column] = 1.0
        for side, weight in parts.get(part, ()):
            weights.setdefault(side, np.zeros((len(response.inputs), 1)))[column] = weight
    return {
        name: FrequencyResponse(response.omega, response.values @ own, response.outputs, (name,))
        for name, own in weights.items()
    }


def _align_phase(model: Response, data: Response) -> Response:
    """Shift the phase by multiples of 2 pi to the measured one."""
    model_phase = np.interp(data.frequency_hz, model.frequency_hz, model.phase_rad)
    turns = np.round(np.nanmedian(data.phase_rad - model_phase) / (2.0 * np.pi))
    return replace(model, phase_rad=model.phase_rad + 2.0 * np.pi * turns)


def _build_response(
    found: MeasuredColumn, output: str, units: dict[str, str], input_: str | None = None
) -> Response:
    column, row = found.response, found.response.outputs.index(output)
    name = column.inputs[0] if input_ is None else input_
    place = (slice(None), row, column.inputs.index(name))
    values = column.values[place]
    frequency_hz = column.omega / (2.0 * np.pi)
    relative = relative_std(column)
    reasons = {reason: points[place] for reason, points in find_unreliable_points(column).items()}
    blank = np.any(list(reasons.values()), axis=0)
    return Response(
        output=output,
        input=name,
        output_unit=units[output],
        input_unit=units[name],
        frequency_hz=frequency_hz,
        magnitude=np.abs(values),
        phase_rad=_unwrap(values, ~blank),
        # half of the complex error lies along the response, half across it
        relative_std=None if relative is None else relative[place] / np.sqrt(2.0),
        coherence=None if found.coherence is None else found.coherence[:, row],
        blanked=tuple(
            Blanked(frequency_hz=float(frequency_hz[index]), reason=reason)
            for index in np.flatnonzero(blank)
            for reason, points in reasons.items()
            if points[index]
        ),
    )


def _unwrap(values: np.ndarray, reliable: np.ndarray) -> np.ndarray:
    """Unwrap the phase of reliable points; the others are shifted to the nearest turn.

    Otherwise one point of noise would shift all further points by a turn.
    """
    phase = np.angle(values)
    if reliable.sum() < 2:
        return np.unwrap(phase)
    index = np.arange(values.size)
    smooth = np.interp(index, index[reliable], np.unwrap(phase[reliable]))
    return phase + 2.0 * np.pi * np.round((smooth - phase) / (2.0 * np.pi))


# --- Measured open-loop responses of a maneuver with recorded excitation and deflection -----------


def estimate_loops(store: Store, maneuver_id: int) -> LoopPlot:
    """Estimate the loop gain of every excited surface, with margins.

    Raises
    ------
    BadInput
        If the excitation is unknown or was not recorded, or a servo is not defined.
    """
    maneuver = store.maneuvers.get(maneuver_id)
    if maneuver.excitation is None:
        raise BadInput(
            f"the excitation of maneuver {maneuver_id} is unknown, so loops cannot be estimated;"
            " import it with [excitation]",
            code="no-excitation",
        )
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    inputs = tuple(maneuver.excitation.harmonics)
    spectra = read_measurement(store, maneuver, aircraft, inputs, ()).transform()
    if spectra.commands is None:
        raise BadInput(
            "the excitation commands were not recorded; loops need commands and deflections",
            code="no-commands",
        )
    servos = np.stack(
        [get_servo(aircraft, name).response(spectra.omega) for name in inputs], axis=1
    )
    found = estimate_loop_gains(spectra.inputs, spectra.commands, servos, spectra.assigned_input)
    return LoopPlot(
        maneuver_id=maneuver_id,
        curves=tuple(
            LoopCurve(
                surface=loop.surface,
                frequency_hz=loop.omega / (2.0 * np.pi),
                gain=loop.gain,
                std=loop.std,
                gain_up=loop.margins.gain_up,
                phase_rad=loop.margins.phase,
                phase_std_rad=loop.phase_std,
                disk=loop.margins.disk,
                disk_std=loop.disk_std,
            )
            for loop in found
        ),
    )
