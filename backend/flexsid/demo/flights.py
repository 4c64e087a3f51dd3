"""Simulation of one maneuver of FLEX-28 with its recorded channels, and of a whole flight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import date
from functools import cache

import numpy as np

from flexsid.demo.aircraft import build_anti_alias_filter, describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.demo.truth_flight import (
    LOW,
    RATE_HZ,
    FlownChannel,
    Recorder,
    SurfaceFault,
    condition_channels,
    fly_truth,
)
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Condition, Excitation, Flight, FlightChannel, Maneuver, Role
from flexsid.storage.store import Store
from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.multisine import Multisine, assign_harmonics, design_multisine
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.preparation.resampling import resample
from flexsid.sysid.simulation.turbulence import Turbulence, generate_gust
from flexsid.units import factor, to_si
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.importing.flight_import import compute_largest_correlation

# --- Simulation of one maneuver of FLEX-28 with its recorded channels -----------------------------

TRIM_S = 2.0
SETTLE_S = 4.0
ALTITUDE_M = 1524.0
_LEAD_S = 10.0  # in turbulence before the record: the aircraft is in motion at its start
_GUST = 797  # separates the seed of the turbulence from that of the noise


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FlownManeuver:
    """A recorded maneuver before storage, with the true derivatives."""

    maneuver: Maneuver  # its aircraft and flight are set when it is stored
    channels: tuple[FlownChannel, ...]
    truth: DerivativeTable


def fly(
    *,
    airspeed_ratio: float = 0.65,
    fuel: float = 0.5,
    fta: int = 506,
    peak_deg: float = 2.0,
    modes_in_truth: int = 8,
    seed: int | tuple[int, ...] = 0,
    noise: bool = True,
    start_s: float = 0.0,
    label: str | None = None,
    n_periods: int = 1,
    absent: tuple[str, ...] = (),
    turbulence: Turbulence = Turbulence.NONE,
    fault: SurfaceFault | None = None,
    unsteady: bool = False,
    multisine: Multisine | None = None,
) -> FlownManeuver:
    """Simulate a flight test aid in closed loop from trim and record all channels.

    Parameters
    ----------
    airspeed_ratio
        Airspeed over open-loop flutter speed at this fuel. [1]
    fuel
        Fuel fraction. [1]
    fta
        Number of the flight test aid, 503 or 506.
    peak_deg
        Largest excitation of the body flaps; the others follow in proportion. [deg]
    modes_in_truth
        Number of symmetric modes in the simulation, at most eight.
    seed
        Seed of the noise.
    noise
        False gives noise-free channels.
    start_s
        Flight time at which the record starts. [s]
    label
        Label of the maneuver; derived from the condition by default.
    n_periods
        Number of consecutive periods of the excitation.
    absent
        Derivatives that are zero in the simulated aircraft, e.g. ``Cm_etadot9``.
    turbulence
        Intensity of the turbulence, in which the aircraft flies before the record too.
    fault
        Fault of a surface, None for none.
    unsteady
        True flies FLEX-28U, whose air forces lag the motion.
    multisine
        Excitation of all symmetric surfaces in any order, instead of that of ``fta``.
    """
    truth = load_truth(unsteady=unsteady).without(absent)
    aircraft = describe_aircraft(truth)
    if multisine is None:
        multisine = design_fta(fta, peak_deg)
    # The columns of the simulation are the surfaces of the aircraft, in their order.
    tones = {surface.name: multisine.tones[surface.name] for surface in aircraft.surfaces}
    multisine = replace(multisine, tones=tones)
    excitation, during = sample_excitation(multisine, n_periods)
    duration_s = len(excitation) / RATE_HZ

    airspeed = airspeed_ratio * truth.flutter_speed_at(fuel)
    gust, lead = _generate_gust(turbulence, airspeed, len(excitation), seed)
    ordered = np.vstack([np.zeros((lead, excitation.shape[1])), excitation])
    flight = fly_truth(
        truth,
        aircraft.sensors,
        airspeed,
        fuel,
        modes_in_truth,
        ordered if fault is None else fault.apply(ordered, multisine.inputs, RATE_HZ),
        gust,
        fault,
    )
    generator = np.random.default_rng(seed) if noise else None
    recorder = Recorder(aircraft, build_anti_alias_filter(truth.source), generator)
    surfaces = recorder.surfaces(flight.motion.surfaces, lead)
    states = condition_channels(
        flight.condition,
        fuel,
        ALTITUDE_M,
        duration_s,
        truth.source["noise_sigma"]["airspeed_ft_s"] * factor("ft/s", "speed"),
        generator,
    )
    condition = average_condition(aircraft, states)
    assert condition.flutter_speed_m_s is not None
    return FlownManeuver(
        maneuver=Maneuver(
            aircraft_id=0,
            flight_id=0,
            label=label or f"FTA {fta} at {airspeed_ratio:.2f} V_f, fuel {fuel:.2f}",
            fta=fta,
            start_s=start_s,
            duration_s=duration_s,
            condition=condition,
            airspeed_ratio=condition.airspeed_m_s / condition.flutter_speed_m_s,
            excitation=describe_excitation(multisine, start_s, n_periods),
            max_input_correlation=compute_largest_correlation(
                [c.samples[during] for c in surfaces]
            ),
            note=f"{modes_in_truth} symmetric modes in the truth"
            + ("" if gust is None else f", {turbulence} turbulence")
            + ("" if fault is None else f", {fault.surface} {fault.kind}"),
        ),
        channels=(
            *surfaces,
            *recorder.sensors(aircraft.sensors, flight.felt, flight.condition, lead),
            *recorder.commands(multisine.inputs, excitation),
            *states,
        ),
        truth=flight.derivatives,
    )


@cache
def design_fta(fta: int, peak_deg: float) -> Multisine:
    """Design a flight test aid for the five symmetric surfaces of FLEX-28."""
    layout = load_truth().source["multisine"]
    order = [f"{name}s" for name in layout["order"]]
    assigned = assign_harmonics(order, CATALOGUE[fta].harmonics_per_input, layout["k0"])
    peaks = {f"{n}s": float(np.radians(peak_deg)) * scale for n, scale in layout["scale"].items()}
    return design_multisine({name: assigned[name] for name in peaks}, layout["T_s"], peaks)


def sample_excitation(multisine: Multisine, n_periods: int = 1) -> tuple[np.ndarray, slice]:
    """Return the excitation between trim and rest, (n_samples, n_u), and the samples it acts in."""
    excited_s = n_periods * multisine.period_s
    first, count = round(TRIM_S * RATE_HZ), round(excited_s * RATE_HZ)
    excitation = np.zeros((round((TRIM_S + excited_s + SETTLE_S) * RATE_HZ), len(multisine.inputs)))
    during = slice(first, first + count)
    excitation[during] = multisine.sample(np.arange(count) / RATE_HZ)
    return excitation, during


def describe_excitation(multisine: Multisine, start_s: float, n_periods: int = 1) -> Excitation:
    """Return the excitation of a record that starts at ``start_s``."""
    return Excitation(
        period_s=multisine.period_s,
        harmonics=multisine.harmonics(),
        start_s=start_s + TRIM_S,
        n_periods=n_periods,
    )


def _generate_gust(
    turbulence: Turbulence, airspeed: float, n_samples: int, seed: int | tuple[int, ...]
) -> tuple[np.ndarray | None, int]:
    """Return the gust (None in still air) and the number of samples before the record."""
    if turbulence is Turbulence.NONE:
        return None, 0
    lead = round(_LEAD_S * RATE_HZ)
    generator = np.random.default_rng((*np.atleast_1d(seed).tolist(), _GUST))
    return generate_gust(turbulence, airspeed, lead + n_samples, RATE_HZ, generator), lead


def average_condition(aircraft: Aircraft, states: list[FlownChannel]) -> Condition:
    """Return the average recorded condition, with the mass properties at its fuel."""
    assert all(channel.role is Role.CONDITION and channel.rate_hz == LOW for channel in states)
    mean = {
        channel.name: float(to_si(channel.samples.mean(dtype=np.float64), channel.unit))
        for channel in states
    }
    alpha = mean.pop("alpha_trim")
    del mean["altitude"]  # the density was recorded
    exact = dict.fromkeys(("airspeed_std", "density_std"), 0.0)  # recorded as flown
    return complete_condition(aircraft, mean | {"alpha": alpha} | exact)


# --- A whole flight as one recording: maneuvers separated by steady flight, not cut yet -----------

PAUSE_S = 20.0
"""Steady flight before the first maneuver, between two, and after the last."""

_NUMBER = 4
_START_S = 480.0
_CARDS = ((0.65, 0.60, 506), (0.72, 0.57, 503))  # V/V_f, fuel, FTA
_LATE, _LATE_S = "az_mar", 0.009
_SPIKED, _SPIKES_S = "az_cf", (35.0, 88.0, 88.4)


def record_flight(
    flown: Sequence[FlownManeuver], pause_s: float = PAUSE_S
) -> tuple[FlownChannel, ...]:
    """Return one recording of maneuvers with the same channels, and steady flight about them."""
    joined = []
    for columns in zip(*(one.channels for one in flown), strict=True):
        pieces = [_build_pause(columns[0], pause_s)]
        for column, following in zip(columns, (*columns[1:], columns[-1]), strict=True):
            pieces += [column.samples, _build_transition(column, following, pause_s)]
        samples = np.concatenate(pieces).astype(columns[0].samples.dtype)
        joined.append(replace(columns[0], samples=samples))
    return tuple(joined)


def add_recording(
    store: Store, channels: Sequence[FlownChannel], flight: Flight, start_s: float = 0.0
) -> None:
    """Store a recording as the channels of a flight."""
    assert flight.id is not None
    with store.transaction():
        for channel in channels:
            fields = channel.save(store.arrays.put)
            store.flight_channels.add(FlightChannel(flight_id=flight.id, start_s=start_s, **fields))


def _build_pause(channel: FlownChannel, pause_s: float) -> np.ndarray:
    """Return steady flight: the trim of a maneuver, repeated forwards and backwards."""
    count = round(pause_s * channel.rate_hz)
    trim = channel.samples[: max(2, round(0.9 * TRIM_S * channel.rate_hz))]
    there_and_back = np.concatenate([trim[::-1], trim])
    return np.tile(there_and_back, -(-count // there_and_back.size))[-count:]


def _build_transition(channel: FlownChannel, following: FlownChannel, pause_s: float) -> np.ndarray:
    """Return the transition to the next maneuver: slow change of trim, zero commands."""
    steady = _build_pause(following, pause_s)
    if channel.role is Role.COMMAND:
        return steady
    last = float(channel.samples[-max(1, round(0.2 * channel.rate_hz)) :].mean())
    change = last - float(steady.mean())
    ramp = 0.5 * (1.0 + np.cos(np.pi * np.arange(steady.size) / steady.size))
    return steady + change * ramp


def add_uncut_flight(store: Store, aircraft: Aircraft, seed: int) -> None:
    """Simulate and store an uncut flight, if missing.

    Two of its channels are faulty, as test of the quality page: one accelerometer is
    delayed, another has spikes.
    """
    assert aircraft.id is not None
    if store.flights.find(aircraft_id=aircraft.id, number=_NUMBER):
        return
    flown = [
        fly(airspeed_ratio=ratio, fuel=fuel, fta=fta, seed=(seed, _NUMBER, index))
        for index, (ratio, fuel, fta) in enumerate(_CARDS)
    ]
    channels = tuple(_add_fault(channel) for channel in record_flight(flown))
    with store.transaction():
        flight = store.flights.add(
            Flight(
                aircraft_id=aircraft.id,
                number=_NUMBER,
                flown_on=date(2025, 5, 27),
                description="Recorded whole: its maneuvers wait to be cut",
            )
        )
        add_recording(store, channels, flight, _START_S)


def _add_fault(channel: FlownChannel) -> FlownChannel:
    samples = channel.samples.astype(float)
    if channel.name == _LATE:
        rate_hz = channel.rate_hz
        band = (0.0, 0.625 * rate_hz)
        samples = resample(samples, rate_hz, 0.0, rate_hz, -_LATE_S, samples.size, None, band)
    elif channel.name == _SPIKED:
        samples[np.round(np.array(_SPIKES_S) * channel.rate_hz).astype(int)] += 2.5
    else:
        return channel
    return replace(channel, samples=samples.astype(channel.samples.dtype))
