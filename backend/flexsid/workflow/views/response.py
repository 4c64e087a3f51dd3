"""Frequency responses of maneuvers: bare airframe, instruments removed, as measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.maneuver import Maneuver
from flexsid.records.views import Blanked, Bode, Response
from flexsid.storage.store import Store
from flexsid.sysid.signals import FrequencyResponse
from flexsid.sysid.spectra.reliability import relative_std, unreliable
from flexsid.sysid.spectra.repeated import combine
from flexsid.workflow.aircraft.aircraft_models import define_outputs
from flexsid.workflow.measurements.maneuver_spectra import measure
from flexsid.workflow.measurements.recording import maneuver_lines
from flexsid.workflow.runs.identified_models import IdentifiedModel, identified
from flexsid.workflow.views.channels import input_names, sampling
from flexsid.workflow.views.modes import identified_markers, mode_markers
from flexsid.workflow.views.repetition import measure_windows, period_coherence

_GRID = 400  # points of a model's curve
_MARGIN = 1.1  # modes a little outside the lines still explain what is seen


def bode(
    store: Store,
    maneuver_id: int,
    outputs: Sequence[str],
    inputs: Sequence[str] = (),
    run_ids: Sequence[int] = (),
    beside: Sequence[int] = (),
    *,
    average: bool = False,
    rigid: bool = False,
    windowed: bool = False,
) -> Bode:
    """Read responses of outputs to inputs; to all that were excited by default.

    Parameters
    ----------
    store, maneuver_id
        What was flown.
    outputs, inputs
        Names.
    run_ids
        Runs whose models come beside them where they have output and input.
    beside
        Further maneuvers, as measured.
    average
        One response of all maneuvers, weighed by what each is worth.
    rigid
        Also what the models' sensors would see if they did not flex (C_e = 0).
    windowed
        From averaged windows, as always where no lines are known (sweeps, doublets).

    Raises
    ------
    BadInput
        If an input was not excited, or the excitation is not known.
    """
    names = tuple(dict.fromkeys(outputs))
    if not names:
        raise BadInput("a frequency response takes at least one output", code="no-output")
    maneuvers = [store.maneuvers.get(number) for number in dict.fromkeys((maneuver_id, *beside))]
    first = maneuvers[0]
    flown = [measured_responses(store, m, names, windowed=windowed) for m in maneuvers]
    columns = [each.columns for each in flown]
    known = input_names(store, first)
    chosen = tuple(dict.fromkeys(inputs)) or tuple(name for name in known if name in columns[0])
    for found in columns:
        _check_excited(chosen, found)
    units = {name: unit for name, (_, unit) in sampling(store, first, [*names, *chosen]).items()}
    probabilities: dict[str, float] = {}
    labels = [(m.id, m.label if len(maneuvers) > 1 else "") for m in maneuvers]
    if average and len(maneuvers) > 1:
        together = {name: combine([found[name] for found in columns]) for name in chosen}
        probabilities = {name: value.probability for name, value in together.items()}
        columns = [{name: value.response for name, value in together.items()}]
        flown = []
        labels = [(None, f"average of {len(maneuvers)}")]
    pairs = [(output, name) for output in names for name in chosen]
    measured = tuple(
        replace(
            _response(found[name], output, units),
            maneuver_id=number,
            label=label,
            coherence=flown[place].coherent(output, name) if flown else None,
        )
        for output, name in pairs
        for place, (found, (number, label)) in enumerate(zip(columns, labels, strict=True))
    )
    anchors = {(r.output, r.input): r for r in reversed(measured)}
    low = min(response.frequency_hz[0] for response in measured)
    high = max(response.frequency_hz[-1] for response in measured)
    band = (low / _MARGIN, high * _MARGIN)
    runs = [store.runs.get(number) for number in dict.fromkeys(run_ids)]
    models: list[Response] = []
    for run in runs:
        own = identified(store, run)
        label = f"{run.method.value} {run.id}"
        curves = [(own, label, False)]
        if rigid:
            curves.append((_blind(own), f"{label}, C_e = 0", True))
        for model, name, is_rigid in curves:
            for curve in _curves(model, pairs, (low, high), units):
                anchor = anchors[curve.output, curve.input]
                models.append(
                    replace(_beside(curve, anchor), run_id=run.id, label=name, rigid=is_rigid)
                )
    return Bode(
        maneuver_id=maneuver_id,
        inputs=known,
        measured=measured,
        models=tuple(models),
        modes=(
            *mode_markers(store, first, band),
            *(mark for run in runs for mark in identified_markers(run, band)),
        ),
        agreement=probabilities,
    )


@dataclass(frozen=True, slots=True)
class MeasuredResponses:
    """Responses by input, and the coherence of every output at the lines of each input."""

    columns: dict[str, FrequencyResponse]
    coherence: dict[str, np.ndarray]

    def coherent(self, output: str, input_: str) -> np.ndarray | None:
        """Coherence of one response, where it is known."""
        if input_ not in self.coherence:
            return None
        return self.coherence[input_][:, self.columns[input_].outputs.index(output)]


def measured_responses(
    store: Store, maneuver: Maneuver, outputs: tuple[str, ...], *, windowed: bool = False
) -> MeasuredResponses:
    """Responses to every excited input: at its own lines, or from windows without lines."""
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    definitions = define_outputs(aircraft, outputs)
    if maneuver.excitation is None or windowed:
        found = measure_windows(store, maneuver, aircraft, definitions)
        return MeasuredResponses(found.columns, dict.fromkeys(found.columns, found.coherence))
    inputs = tuple(maneuver.excitation.harmonics)
    columns = measure(store, maneuver, aircraft, inputs, definitions).responses()
    lines = maneuver_lines(maneuver)
    repeated = period_coherence(store, maneuver, outputs, lines)
    if repeated is None:
        return MeasuredResponses(columns, {})
    return MeasuredResponses(
        columns,
        {
            name: repeated[np.isin(lines.omega, column.omega) & (lines.owner == number)]
            for number, (name, column) in enumerate(columns.items())
        },
    )


def _check_excited(names: Sequence[str], columns: dict[str, FrequencyResponse]) -> None:
    unknown = [name for name in names if name not in columns]
    if unknown:
        raise BadInput(
            f"'{unknown[0]}' was not excited in this maneuver; excited were {', '.join(columns)}",
            code="not-excited",
            input=unknown[0],
        )


def _blind(model: IdentifiedModel) -> IdentifiedModel:
    """The same motion seen by sensors that do not flex."""
    return replace(model, model=replace(model.model, sensors=model.model.sensors.rigid_only()))


def _curves(
    model: IdentifiedModel,
    pairs: Sequence[tuple[str, str]],
    band_hz: tuple[float, float],
    units: dict[str, str],
) -> list[Response]:
    """Responses of an identified model on a fine grid over the measured lines."""
    response = model.response(2.0 * np.pi * np.geomspace(*band_hz, _GRID))
    return [
        _response(response, output, units, name)
        for output, name in pairs
        if output in response.outputs and name in response.inputs
    ]


def _beside(model: Response, data: Response) -> Response:
    """Move a phase by whole turns to where the measured one is."""
    at_lines = np.interp(data.frequency_hz, model.frequency_hz, model.phase_rad)
    turns = np.round(np.nanmedian(data.phase_rad - at_lines) / (2.0 * np.pi))
    return replace(model, phase_rad=model.phase_rad + 2.0 * np.pi * turns)


def _response(
    column: FrequencyResponse, output: str, units: dict[str, str], input_: str | None = None
) -> Response:
    name = column.inputs[0] if input_ is None else input_
    place = (slice(None), column.outputs.index(output), column.inputs.index(name))
    values = column.values[place]
    frequency_hz = column.omega / (2.0 * np.pi)
    relative = relative_std(column)
    reasons = {reason: points[place] for reason, points in unreliable(column).items()}
    blank = np.any(list(reasons.values()), axis=0)
    return Response(
        output=output,
        input=name,
        output_unit=units[output],
        input_unit=units[name],
        frequency_hz=frequency_hz,
        magnitude=np.abs(values),
        phase_rad=_unwrapped(values, ~blank),
        # half of the complex error lies along the response, half across it
        relative_std=None if relative is None else relative[place] / np.sqrt(2.0),
        blanked=tuple(
            Blanked(frequency_hz=float(frequency_hz[index]), reason=reason)
            for index in np.flatnonzero(blank)
            for reason, points in reasons.items()
            if points[index]
        ),
    )


def _unwrapped(values: np.ndarray, reliable: np.ndarray) -> np.ndarray:
    """Continuous phase of the reliable points; the others come to the nearest turn.

    One point of pure noise would otherwise shift everything beyond it by a turn.
    """
    phase = np.angle(values)
    if reliable.sum() < 2:
        return np.unwrap(phase)
    index = np.arange(values.size)
    smooth = np.interp(index, index[reliable], np.unwrap(phase[reliable]))
    return phase + 2.0 * np.pi * np.round((smooth - phase) / (2.0 * np.pi))
