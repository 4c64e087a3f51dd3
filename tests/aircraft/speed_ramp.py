"""A flight whose airspeed rises during the excitation, so that a mode becomes unstable."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid.demo.aircraft import build_anti_alias_filter, describe_aircraft
from flexsid.demo.flex28 import load_truth
from flexsid.demo.flights import FlownManeuver, design_fta, fly, sample_excitation
from flexsid.demo.truth_flight import RATE_HZ, Recorder, sensor_rows
from flexsid.sysid.model.laws import discretise
from flexsid.sysid.simulation.airframe import Airframe, assemble_airframe

FTA, PEAK_DEG, FUEL, MODES = 506, 1.2, 0.5, 2
SPEEDS = (1.0, 1.065)
"""Airspeed over the flutter speed of all modes; two modes alone are stable at the first."""

_PIECES = 60  # of constant airspeed


def fly_speed_ramp(seed: int) -> FlownManeuver:
    """Simulate the open loop of the bare airframe with two modes; the wing's becomes unstable.

    Damping ratio of the first bending mode from about +2 to about -2 %.
    """
    truth = load_truth()
    aircraft = describe_aircraft(truth)
    multisine = design_fta(FTA, PEAK_DEG)
    excitation, during = sample_excitation(multisine)
    edges = np.linspace(during.start, during.stop, _PIECES + 1).astype(int)
    edges[0], edges[-1] = 0, len(excitation)
    airframes = [build_airframe(ratio) for ratio in np.linspace(*SPEEDS, _PIECES)]
    x = np.zeros(airframes[0].n_x)
    felt = []
    for airframe, first, stop in zip(airframes, edges[:-1], edges[1:], strict=True):
        transition, entry = discretise(airframe.state_matrix, airframe.input_matrix, 1.0 / RATE_HZ)
        states = np.zeros((stop - first, x.size))
        for k in range(first, stop):
            states[k - first] = x
            x = transition @ x + entry @ excitation[k]
        motion = np.hstack([states, excitation[first:stop]])
        felt.append(motion @ sensor_rows(truth, airframe, aircraft.sensors).T)
    noise = np.random.default_rng(seed)
    recorder = Recorder(aircraft, build_anti_alias_filter(truth.source), noise)
    middle = airframes[_PIECES // 2]
    flown = (
        *recorder.surfaces(excitation),
        *recorder.sensors(aircraft.sensors, np.vstack(felt), middle.condition),
    )
    steady = fly(
        airspeed_ratio=float(np.mean(SPEEDS)),
        fuel=FUEL,
        fta=FTA,
        peak_deg=PEAK_DEG,
        modes_in_truth=MODES,
        seed=seed,
    )
    names = {channel.name for channel in flown}
    others = (channel for channel in steady.channels if channel.name not in names)
    return replace(steady, channels=(*flown, *others))


def build_airframe(ratio: float) -> Airframe:
    """Build the airframe with two modes at an airspeed over the flutter speed of all modes."""
    truth = load_truth()
    condition = truth.condition_at(ratio * truth.flutter_speed_at(FUEL), FUEL)
    modes, derivatives = truth.modes_at(FUEL, MODES), truth.derivatives_at(FUEL, MODES)
    return assemble_airframe(condition, modes, derivatives)


def find_doubling_s(begun_s: float, excited_s: float) -> float:
    """Find the time at which the free motion of the mode has doubled since it was smallest. [s]

    Its amplitude grows by exp(integral of the real part of its pole).
    """
    times = np.linspace(0.0, excited_s, 400)
    ratios = np.interp(times, [0.0, excited_s], SPEEDS)
    rates = []
    for ratio in ratios:
        poles = np.linalg.eigvals(build_airframe(float(ratio)).state_matrix)
        rates.append(min(poles[poles.imag > 1.0], key=lambda p: -p.real).real)
    growth = np.cumsum(rates) * (times[1] - times[0])
    doubled = np.flatnonzero(growth - np.minimum.accumulate(growth) >= np.log(2.0))
    return begun_s + float(times[doubled[0]])
