"""Frequency responses and transfer functions of one input and output of a maneuver."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from jaxtyping import Complex, Float

from flexsid.allowed import Allowed, Id
from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.maneuver import Maneuver, Role
from flexsid.records.views import Response, TransferFunction, TransferFunctionResult
from flexsid.storage.store import Store
from flexsid.sysid.model.sensor_models import ATTITUDE, GYRO, VANE
from flexsid.sysid.spectra.measured_spectra import MeasuredSpectra
from flexsid.sysid.spectra.residual_spectrum import (
    count_frequencies,
    estimate_noise_in_motion,
)
from flexsid.sysid.stability.transfer_function import (
    MOST_ORDER,
    TransferFunctionFit,
    TransferFunctionForm,
    fit_transfer_function,
)
from flexsid.units import si_unit
from flexsid.workflow.aircraft.aircraft_models import OutputDefinition, define_outputs
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.measurements.maneuver_spectra import read_measurement, read_recording
from flexsid.workflow.measurements.recording import (
    COMMAND_SUFFIX,
    ManeuverMeasurement,
    select_frequencies,
)
from flexsid.workflow.measurements.sensor_responses import find_excited_band
from flexsid.workflow.modal_data.modal_tables import load_modes_of_model

# --- Frequency response of one output to one input of a maneuver, with its errors -----------------

_QUIET = 0.03  # of the largest deflection: the response at a frequency is noise below
_STILL = 0.1  # of the input's rms amplitude: another surface that moves more is reported
_AT_REST = 1e-6  # of the rms amplitude of another surface: a sum of surfaces that cancel
_LEAST_FREQUENCIES = 4
_TRANSFORMED = (Role.INPUT, Role.OUTPUT, Role.COMMAND)
_BANDS = 4  # of the spectrum of a surface, whose lowest level is that of its noise
_RESOLVED = 0.8  # of the Nyquist frequency: higher is the noise of an anti-alias filter


@dataclass(frozen=True, slots=True)
class SingleResponse:
    """Response of an output to an input, instruments removed.

    ``std`` is the standard deviation of its complex error, None where it is not known,
    ``overlap`` the number of frequencies per resolution 1/T of the record. ``ends`` are the spectra
    of unit impulses at the ends where the record may be in motion, ``others`` those of other
    surfaces that move, and ``input_std`` the standard deviation of the noise of the measured input,
    all over the spectrum of the input.
    """

    omega: Float[np.ndarray, " n_omega"]
    values: Complex[np.ndarray, " n_omega"]
    std: Float[np.ndarray, " n_omega"] | None
    overlap: float
    ends: Complex[np.ndarray, "n_omega n_ends"]
    others: Complex[np.ndarray, "n_omega n_others"] | None = None
    input_std: Float[np.ndarray, " n_omega"] | None = None
    warnings: tuple[str, ...] = ()


def measure_single_response(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    name: str,
    output: OutputDefinition,
    band_hz: tuple[float, float],
) -> SingleResponse:
    """Measure the response of an output to a surface, or to its recorded command.

    Parameters
    ----------
    store, maneuver, aircraft
        Where it is recorded.
    name
        A surface (``wf4s``), or the command of one (``wf4s_command``). With known harmonics the
        response to a surface is that of the bare airframe, and that to a command of the
        augmented aircraft, at the harmonics of this input.
    output
        Sensor or combination.
    band_hz
        Limits of the frequencies.

    Raises
    ------
    BadInput
        If a channel is not recorded, or the input is excited at too few frequencies.
    """
    surface = name.removesuffix(COMMAND_SUFFIX)
    if maneuver.excitation is None:
        return _measure_without_harmonics(store, maneuver, aircraft, name, output, band_hz)
    measurement = read_measurement(store, maneuver, aircraft, (surface,), (output,), band_hz)
    spectra = measurement.transform()
    own = spectra.assigned_input == 0
    if np.count_nonzero(own) < _LEAST_FREQUENCIES:
        raise BadInput(
            f"'{surface}' has fewer than {_LEAST_FREQUENCIES} harmonics in this band; excited are "
            f"{', '.join(maneuver.excitation.harmonics)}",
            code="not-excited",
            input=name,
        )
    overlap = spectra.resolution_overlap
    if name == surface:
        found = spectra.responses[surface]
        noise = _measure_noise(store, maneuver, aircraft, output, Role.INPUT, spectra.omega)
        assert found.noise_gain is not None
        std = None if noise is None else np.sqrt(np.abs(found.noise_gain) ** 2 @ noise**2)
        deflection = spectra.excited.inputs.values[np.isin(spectra.omega, found.omega), 0]
        return SingleResponse(
            omega=found.omega,
            values=found.values[:, 0, 0],
            std=std,
            overlap=overlap,
            ends=_build_ends(spectra, found.omega, deflection),
            input_std=_measure_input_noise(store, maneuver, aircraft, surface) / np.abs(deflection),
        )
    if spectra.commands is None:
        raise BadInput(
            f"the command of {surface} was not recorded in this maneuver; select the surface",
            code="no-command",
            input=name,
        )
    omega, command = spectra.omega[own], spectra.commands.values[own, 0]
    response = spectra.true_outputs().values[own, 0] / command
    noise = _measure_noise(store, maneuver, aircraft, output, Role.COMMAND, omega)
    std = None if noise is None else noise / np.abs(command)
    ends = _build_ends(spectra, omega, command)
    return SingleResponse(omega, response, std, overlap, ends)


def _build_ends(
    spectra: MeasuredSpectra,
    omega: Float[np.ndarray, " n_omega"],
    u: Complex[np.ndarray, " n_omega"],
) -> Complex[np.ndarray, "n_omega n_ends"]:
    """Build the spectra of unit impulses at the ends in motion, over that of the input."""
    return np.exp(-1j * np.outer(omega, spectra.record_ends_s)) / u[:, None]


def _measure_without_harmonics(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    name: str,
    output: OutputDefinition,
    band_hz: tuple[float, float],
) -> SingleResponse:
    """Divide the spectra of output and input where the input has power."""
    surface = name.removesuffix(COMMAND_SUFFIX)
    recorded = [c.name for c in store.channels.find(maneuver_id=maneuver.id, role=Role.INPUT)]
    own = {surface, *(part for part, _ in list_surface_parts(aircraft).get(surface, ()))}
    inputs = (surface, *(one for one in recorded if one != surface))
    measurement = read_measurement(
        store, maneuver, aircraft, inputs, (output,), band_hz, free_ends=True
    )
    spectra = measurement.transform()
    travel = np.sqrt(np.mean(np.abs(spectra.inputs.values) ** 2, axis=0))
    u, z = spectra.inputs.values[:, :1], spectra.true_outputs().values
    if name != surface:
        u = _transform_commands(store, measurement, aircraft, (name,))
    has_power = np.abs(u[:, 0]) > _QUIET * np.abs(u[:, 0]).max()
    if np.count_nonzero(has_power) < _LEAST_FREQUENCIES or travel[0] < _AT_REST * travel.max():
        raise BadInput(
            f"'{name}' has power at fewer than {_LEAST_FREQUENCIES} frequencies of this band; use "
            "a wider band, or another input",
            code="not-excited",
            input=name,
        )
    moving = [
        other
        for other, rms in zip(inputs, travel, strict=True)
        if other not in own and rms > _STILL * travel[0]
    ]
    warnings = (_describe_other_motion(surface, moving),) if moving else ()
    u, z, omega = u[has_power, 0], z[has_power, 0], spectra.omega[has_power]
    role = Role.INPUT if name == surface else Role.COMMAND
    noise = _measure_noise(store, maneuver, aircraft, output, role, omega)
    std = None if noise is None else noise / np.abs(u)
    beside = np.isin(inputs, moving)
    input_std = None
    if name == surface:
        input_std = _measure_input_noise(store, maneuver, aircraft, surface) / np.abs(u)
    return SingleResponse(
        omega=omega,
        values=z / u,
        std=std,
        overlap=spectra.resolution_overlap,
        ends=_build_ends(spectra, omega, u),
        others=spectra.inputs.values[has_power][:, beside] / u[:, None],
        input_std=input_std,
        warnings=warnings,
    )


def _transform_commands(
    store: Store, measurement: ManeuverMeasurement, aircraft: Aircraft, names: tuple[str, ...]
) -> Complex[np.ndarray, "n_omega n_names"]:
    """Transform commands over the window of a measurement."""
    recording = measurement.recording
    commands = read_recording(store, recording.maneuver, aircraft, names)
    commands = replace(commands, window_s=recording.window_s)
    return commands.spectra(names, measurement.frequencies).values


def _measure_noise(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    output: OutputDefinition,
    role: Role,
    omega: Float[np.ndarray, " n_omega"],
) -> Float[np.ndarray, " n_omega"] | None:
    """Measure the standard deviation of the noise of an output's spectrum at frequencies.

    It is the scatter of the output at all multiples of 1/T about its response to all surfaces, or
    all commands, that move, within the band and as far above it as local fits need. None in too
    short a record.
    """
    channels = store.channels.find(maneuver_id=maneuver.id)
    inputs = tuple(c.name for c in channels if c.role is Role.INPUT)
    causes = tuple(c.name for c in channels if c.role is role)
    low_hz, high_hz = omega[0] / (2.0 * np.pi), omega[-1] / (2.0 * np.pi)
    enough_hz = low_hz + count_frequencies(len(causes) + 1) / maneuver.duration_s
    highest_hz = 0.5 * _RESOLVED * min(c.rate_hz for c in channels if c.role in _TRANSFORMED)
    band_hz = low_hz, max(high_hz, min(enough_hz, highest_hz))
    alone = replace(maneuver, excitation=None)
    measurement = read_measurement(
        store, alone, aircraft, inputs, (output,), band_hz, free_ends=True
    )
    spectra = measurement.transform()
    u = spectra.inputs.values
    if role is Role.COMMAND:
        u = _transform_commands(store, measurement, aircraft, causes)
    rms = np.sqrt(np.mean(np.abs(u) ** 2, axis=0))
    impulses = np.exp(-1j * np.outer(spectra.omega, spectra.record_ends_s))
    z = spectra.true_outputs().values
    found = estimate_noise_in_motion(
        spectra.omega, u[:, rms > _QUIET * rms.max()], z, impulses, omega
    )
    if found is None or spectra.window_s is None:
        return None
    window_s = spectra.window_s[1] - spectra.window_s[0]
    return found[:, 0] * np.sqrt(maneuver.transformed_s / window_s)


def _measure_input_noise(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, surface: str
) -> float:
    """Measure the standard deviation of white noise of a surface's spectrum.

    It is the lowest level of a quarter of the spectrum up to nearly the Nyquist frequency, where
    only noise is left: white noise is no larger. The median of an exponential variable is ln 2
    times its mean.
    """
    channels = store.channels.find(maneuver_id=maneuver.id)
    highest_hz = 0.5 * _RESOLVED * min(c.rate_hz for c in channels if c.role in _TRANSFORMED)
    alone = replace(maneuver, excitation=None)
    band_hz = 1.0 / maneuver.duration_s, highest_hz
    spectra = read_measurement(
        store, alone, aircraft, (surface,), (), band_hz, free_ends=True
    ).transform()
    bands = np.array_split(np.abs(spectra.inputs.values[:, 0]) ** 2, _BANDS)
    lowest = min(np.median(power) for power in bands) / np.log(2.0)
    assert spectra.window_s is not None
    window_s = spectra.window_s[1] - spectra.window_s[0]
    return float(np.sqrt(lowest * maneuver.transformed_s / window_s))


def _describe_other_motion(surface: str, moving: Sequence[str]) -> str:
    moves, them = ("moves", "it") if len(moving) == 1 else ("move", "them")
    return (
        f"{', '.join(moving)} also {moves} in this maneuver: the response to {them} is estimated "
        f"too, with the same poles and delay. A part in which {surface} moves alone, or known "
        "harmonics, give smaller errors."
    )


# --- Transfer functions and low-order equivalent systems of one input and output of a maneuver

CLOSE_MATCH = 10.0
"""Mismatch cost beyond noise below which pilots do not distinguish systems (MIL-STD-1797)."""

_BELOW_MODE = 0.6  # of the frequency of a mode: its response is 1.6 times the static one
_CURVE = 200  # points of the fitted response
_USUAL_ORDERS = {
    (GYRO.kind, "x"): (0, 1, 0),  # roll mode
    (GYRO.kind, "y"): (1, 2, 0),  # short period, q
    (GYRO.kind, "z"): (1, 2, 0),
    (ATTITUDE.kind, "x"): (0, 1, 1),
    (ATTITUDE.kind, "y"): (1, 2, 1),  # short period, theta
    (VANE.kind, "y"): (0, 2, 0),
    (VANE.kind, "z"): (0, 2, 0),
}
"""Zeros, poles and integrators of the usual equivalent system, by sensor type and axis."""

_OTHER_ORDERS = (2, 2, 0)  # of accelerometers and others


Order = Annotated[int, Allowed(ge=0, le=MOST_ORDER)]


@dataclass(frozen=True, slots=True, kw_only=True)
class TransferFunctionQuery:
    """Maneuver, input and output, and the orders; those usual for the output by default.

    ``input`` is a surface or its command (``wf4s_command``); the band is the excited one by
    default, below the first mode of the aircraft that the orders do not describe. [Hz]
    """

    maneuver_id: Id
    input: Annotated[str, Allowed(max_length=64, text="A surface, or its command (wf4s_command).")]
    output: Annotated[str, Allowed(max_length=64, text="A sensor or combination.")]
    zeros: Annotated[
        Order | None, Allowed(text="Number of zeros; by default that usual for the output.")
    ] = None
    poles: Annotated[
        Order | None, Allowed(text="Number of poles; by default that usual for the output.")
    ] = None
    integrators: Annotated[
        Order | None, Allowed(text="Number of integrators; by default that usual for the output.")
    ] = None
    delay: Annotated[bool, Allowed(text="Whether it has an equivalent delay.")] = True
    low_hz: Annotated[float | None, Allowed(ge=0.0, le=100_000.0, text="Begin of the band.")] = None
    high_hz: Annotated[float | None, Allowed(gt=0.0, le=100_000.0, text="End of the band.")] = None

    def __post_init__(self) -> None:
        """Refuse half a band.

        Raises
        ------
        BadInput
            If one limit is missing, or they do not rise.
        """
        is_open = self.low_hz is None and self.high_hz is None
        band = self.band_hz
        if not is_open and (band is None or not band[0] < band[1]):
            raise BadInput("give both low_hz and high_hz, rising, or neither", code="bad-band")

    @property
    def band_hz(self) -> tuple[float, float] | None:
        """Limits of the band, None where the excited one is used. [Hz]"""
        if self.low_hz is None or self.high_hz is None:
            return None
        return self.low_hz, self.high_hz


def check_transfer_function(store: Store, query: TransferFunctionQuery) -> None:
    """Refuse orders that are no transfer function, and an unknown output.

    Raises
    ------
    BadInput
        If there is one.
    """
    maneuver = store.maneuvers.get(query.maneuver_id)
    (output,) = define_outputs(store.aircraft.get(maneuver.aircraft_id), (query.output,))
    _select_form(query, output)


def estimate_transfer_function(
    store: Store, query: TransferFunctionQuery
) -> TransferFunctionResult:
    """Fit a transfer function to the measured response of an output to an input.

    Raises
    ------
    BadInput
        If the input was not excited, or the orders are no transfer function.
    NotIdentifiable
        If the response does not determine the orders.
    """
    maneuver = store.maneuvers.get(query.maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    (output,) = define_outputs(aircraft, (query.output,))
    form = _select_form(query, output)
    band_hz = query.band_hz or _find_default_band(store, maneuver, aircraft, output, form)
    measured = measure_single_response(store, maneuver, aircraft, query.input, output, band_hz)
    fit = fit_transfer_function(
        form,
        measured.omega,
        measured.values,
        measured.std,
        measured.overlap,
        measured.ends,
        measured.others,
        measured.input_std,
    )
    units = output.terms[0][0].model.units[0], _find_input_unit(store, maneuver, aircraft, query)
    grid = np.geomspace(measured.omega[0], measured.omega[-1], _CURVE)
    values = measured.values - fit.leakage
    shown = _build_response(query, units, measured.omega, values, measured.std)
    curve = replace(
        _build_response(query, units, grid, fit.response(grid)),
        label="transfer function",
        is_model=True,
    )
    anchor = np.interp(measured.omega[0], grid, curve.phase_rad) - shown.phase_rad[0]
    curve.phase_rad[:] -= 2.0 * np.pi * np.round(anchor / (2.0 * np.pi))
    return TransferFunctionResult(
        function=_describe_fit(query, units, measured, fit), measured=shown, modelled=curve
    )


def _find_default_band(
    store: Store,
    maneuver: Maneuver,
    aircraft: Aircraft,
    output: OutputDefinition,
    form: TransferFunctionForm,
) -> tuple[float, float]:
    """Find the excited band below the first mode that a form does not describe. [Hz]

    Two poles beyond the usual ones describe a mode. The band of the usual ones ends where a mode
    adds about half of its static response; other bands end between the frequencies of the last
    mode that is described and the first that is not.
    """
    body = find_body(maneuver.axis)
    if maneuver.excitation is None:
        low_hz, high_hz = find_excited_band(store, maneuver, aircraft, body)
    else:
        hz = select_frequencies(maneuver).omega / (2.0 * np.pi)
        low_hz, high_hz = float(hz[0]), float(hz[-1])
    table, _ = load_modes_of_model(store, maneuver.aircraft_id, None, None, ())
    shapes = table.table.at(maneuver.condition.fuel_fraction)
    modes_hz = sorted(
        float(omega) / (2.0 * np.pi)
        for omega, number in zip(shapes.omega, shapes.numbers, strict=True)
        if table.belongs_to(number, body)
    )
    described = max(0, (form.poles - _get_usual_orders(output)[1]) // 2)
    if described >= len(modes_hz):
        return low_hz, high_hz
    limit_hz = _BELOW_MODE * modes_hz[described]
    if described > 0:
        limit_hz = max(limit_hz, np.sqrt(modes_hz[described - 1] * modes_hz[described]))
    return low_hz, min(high_hz, limit_hz)


def _get_usual_orders(output: OutputDefinition) -> tuple[int, int, int]:
    sensor = output.terms[0][0]
    return _USUAL_ORDERS.get((sensor.kind, sensor.axis), _OTHER_ORDERS)


def _select_form(query: TransferFunctionQuery, output: OutputDefinition) -> TransferFunctionForm:
    usual = _get_usual_orders(output)
    given = (query.zeros, query.poles, query.integrators)
    orders = (u if g is None else g for u, g in zip(usual, given, strict=True))
    return TransferFunctionForm(*orders, has_delay=query.delay)


def _find_input_unit(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, query: TransferFunctionQuery
) -> str:
    """Return the SI unit of a recorded input, or of the surfaces it is computed from."""
    surface = query.input.removesuffix(COMMAND_SUFFIX)
    names = (
        query.input,
        surface,
        *(part for part, _ in list_surface_parts(aircraft).get(surface, ())),
    )
    units = {c.name: c.unit for c in store.channels.find(maneuver_id=maneuver.id)}
    return next(si_unit(units[name]) for name in names if name in units)


def _compose_gain_unit(units: tuple[str, str], form: TransferFunctionForm) -> str:
    """Compose the unit of K in K (s^m + ...) / (s^i (s^n + ...)) of output and input units."""
    output, input_ = (f"({unit})" if "/" in unit else unit for unit in units)
    excess = form.n_states - form.zeros
    if excess == 0:
        return f"{output}/{input_}"
    return f"{output}/({input_} s{excess if excess > 1 else ''})"


def _describe_fit(
    query: TransferFunctionQuery,
    units: tuple[str, str],
    measured: SingleResponse,
    fit: TransferFunctionFit,
) -> TransferFunction:
    hz = measured.omega / (2.0 * np.pi)
    band_hz = float(hz[0]), float(hz[-1])
    return TransferFunction(
        maneuver_id=query.maneuver_id,
        input=query.input,
        output=query.output,
        n_zeros=fit.form.zeros,
        n_poles=fit.form.poles,
        integrators=fit.form.integrators,
        has_delay=fit.form.has_delay,
        band_hz=band_hz,
        n_frequencies=hz.size,
        gain=fit.gain,
        gain_std=fit.gain_std,
        gain_unit=_compose_gain_unit(units, fit.form),
        delay_s=fit.delay,
        delay_std_s=fit.delay_std,
        numerator=tuple(fit.numerator.tolist()),
        denominator=tuple(fit.denominator.tolist()),
        zeros=fit.zeros,
        poles=fit.poles,
        mismatch=fit.mismatch,
        mismatch_cost=fit.cost,
        cost_beyond_noise=fit.cost_beyond_noise,
        is_close=_is_close(fit),
        sentence=_summarise(query, band_hz, fit),
        warnings=measured.warnings,
    )


def _summarise(
    query: TransferFunctionQuery, band_hz: tuple[float, float], fit: TransferFunctionFit
) -> str:
    match = (
        "a close match" if _is_close(fit) else "no close match: narrow the band or raise the orders"
    )
    return (
        f"{query.output} over {query.input}, {band_hz[0]:.3g} to {band_hz[1]:.3g} Hz: "
        f"mismatch cost {fit.cost:.3g}, "
        f"{fit.cost_beyond_noise:.3g} beyond noise (below {CLOSE_MATCH:g} is close): {match}."
    )


def _is_close(fit: TransferFunctionFit) -> bool:
    return fit.cost_beyond_noise < CLOSE_MATCH


def _build_response(
    query: TransferFunctionQuery,
    units: tuple[str, str],
    omega: np.ndarray,
    values: np.ndarray,
    std: np.ndarray | None = None,
) -> Response:
    return Response(
        output=query.output,
        input=query.input,
        output_unit=units[0],
        input_unit=units[1],
        frequency_hz=omega / (2.0 * np.pi),
        magnitude=np.abs(values),
        phase_rad=np.unwrap(np.angle(values)),
        relative_std=None if std is None else std / np.abs(values) / np.sqrt(2.0),
    )
