"""Simulation of one maneuver of FLEX-28 with its recorded channels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from flexsid.demo.aircraft import build_anti_alias_filter, describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.demo.recorder import LOW, FlownChannel, Recorder, condition_channels
from flexsid.demo.truth_flight import RATE_HZ, fly_truth
from flexsid.records.aircraft import Aircraft
from flexsid.records.maneuver import Condition, Excitation, Role
from flexsid.sysid.excitation.catalogue import design_flight_test_aid
from flexsid.sysid.excitation.multisine import Multisine
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.units import factor, to_si
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.importing.persistence import compute_largest_correlation

TRIM_S = 2.0
SETTLE_S = 4.0
ALTITUDE_M = 1524.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FlownManeuver:
    """A recorded maneuver before storage, with the true derivatives."""

    label: str
    fta: int
    start_s: float
    duration_s: float
    condition: Condition
    airspeed_ratio: float | None
    excitation: Excitation
    max_input_correlation: float
    channels: tuple[FlownChannel, ...]
    truth: DerivativeTable
    note: str = ""
    axis: str = "longitudinal"


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
    """
    truth = load_truth().without(absent)
    aircraft = describe_aircraft(truth)
    multisine = design_fta(fta, peak_deg)
    excited_s = n_periods * multisine.period_s
    duration_s = TRIM_S + excited_s + SETTLE_S
    excitation = np.zeros((round(duration_s * RATE_HZ), len(multisine.inputs)))
    during = _during(excited_s)
    n_excited = during.stop - during.start
    excitation[during] = multisine.sample(np.arange(n_excited) / RATE_HZ)

    airspeed = airspeed_ratio * truth.flutter_speed_at(fuel)
    flight = fly_truth(truth, aircraft.sensors, airspeed, fuel, modes_in_truth, excitation)
    generator = np.random.default_rng(seed) if noise else None
    recorder = Recorder(aircraft, build_anti_alias_filter(truth.source), generator)
    surfaces = recorder.surfaces(aircraft, flight.motion.surfaces)
    states = condition_channels(
        flight.condition,
        fuel,
        ALTITUDE_M,
        duration_s,
        truth.source["noise_sigma"]["airspeed_ft_s"] * factor("ft/s", "speed"),
        generator,
    )
    condition = _average(aircraft, states)
    correlation = compute_largest_correlation([channel.samples[during] for channel in surfaces])
    assert condition.flutter_speed_m_s is not None
    assert correlation is not None
    return FlownManeuver(
        label=label or f"FTA {fta} at {airspeed_ratio:.2f} V_f, fuel {fuel:.2f}",
        fta=fta,
        start_s=start_s,
        duration_s=duration_s,
        condition=condition,
        airspeed_ratio=condition.airspeed_m_s / condition.flutter_speed_m_s,
        excitation=Excitation(
            period_s=multisine.period_s,
            harmonics=multisine.harmonics(),
            start_s=start_s + TRIM_S,
            n_periods=n_periods,
        ),
        max_input_correlation=correlation,
        channels=(
            *surfaces,
            *recorder.sensors(aircraft.sensors, flight.felt, flight.condition),
            *recorder.commands(multisine.inputs, excitation),
            *states,
        ),
        truth=flight.derivatives,
        note=f"{modes_in_truth} symmetric modes in the truth",
    )


@cache
def design_fta(fta: int, peak_deg: float) -> Multisine:
    """Design a flight test aid for the five symmetric surfaces of FLEX-28."""
    layout = load_truth().source["multisine"]
    return design_flight_test_aid(
        fta,
        order=tuple(f"{name}s" for name in layout["order"]),
        relative_peaks={f"{name}s": scale for name, scale in layout["scale"].items()},
        peak=np.radians(peak_deg),
        period_s=layout["T_s"],
        first_harmonic=layout["k0"],
    )


def _during(excited_s: float) -> slice:
    """Return the samples of a fast channel during the excitation."""
    first = round(TRIM_S * RATE_HZ)
    return slice(first, first + round(excited_s * RATE_HZ))


def _average(aircraft: Aircraft, states: list[FlownChannel]) -> Condition:
    """Return the average recorded condition, with the mass properties at its fuel."""
    assert all(channel.role is Role.CONDITION and channel.rate_hz == LOW for channel in states)
    mean = {
        channel.name: float(to_si(channel.samples.mean(dtype=np.float64), channel.unit))
        for channel in states
    }
    alpha = mean.pop("alpha_trim")
    del mean["altitude"]  # the density was recorded
    return complete_condition(aircraft, mean | {"alpha": alpha})
