"""Simulation of one maneuver of FLEX-28 with its recorded channels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from flexsid.demo.aircraft import build_anti_alias_filter, describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.demo.recorder import LOW, FlownChannel, Recorder, condition_channels
from flexsid.demo.surface_faults import SurfaceFault
from flexsid.demo.truth_flight import RATE_HZ, fly_truth
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Condition, Excitation, Maneuver, Role
from flexsid.sysid.excitation.catalogue import CATALOGUE
from flexsid.sysid.excitation.multisine import Multisine, assign_harmonics, design_multisine
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.simulation.turbulence import Turbulence, generate_gust
from flexsid.units import factor, to_si
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.importing.flight_import import compute_largest_correlation

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
