"""Mini-GVT: the records on the runway around one flight, compared (Fig. 10)."""

from __future__ import annotations

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import SensorKind
from flexsid.records.axes import symmetry_of
from flexsid.records.flight import Flight
from flexsid.records.ground_test import GroundTest, GroundTestVerdict, PeakChange
from flexsid.records.maneuver import GROUND, Maneuver, Role
from flexsid.records.views import GroundSpectra, ModeMarker
from flexsid.storage.store import Store
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.spectra.peaks import (
    Peak,
    RatioLines,
    find_peaks,
    fit_peak,
    smooth_power,
    typical_size,
)
from flexsid.workflow.aircraft.longitudinal import LATERAL, AxisNotSupported
from flexsid.workflow.measurements.recording import maneuver_lines
from flexsid.workflow.measurements.transforms import spectra_of
from flexsid.workflow.modal_data.aligned_modes import AircraftModes, find_modal_tables, load_modes

_SAME_PEAK = 0.12  # of the frequency: farther apart it is another mode's
_TREND_ERROR = 0.003  # how well tables tell a frequency's change with fuel, gear included
_AMPLITUDE_ERROR = 0.10  # the same of an amplitude
_SIGMAS = 3.0


def ground_tests(store: Store, aircraft_id: int | None = None) -> list[GroundTest]:
    """Compare the records of every flight that has a pair in which something can be followed."""
    chosen = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    found = []
    for flight in store.flights.find(**chosen):
        if flight.id is None or _pair(store, flight) is None:
            continue
        try:
            found.append(ground_test(store, flight.id))
        except (Conflict, AxisNotSupported):  # its own page says why
            continue
    return found


def ground_test(store: Store, flight_id: int) -> GroundTest:
    """Judge what changed between take-off and landing.

    Raises
    ------
    Conflict
        If the flight lacks a record before or after, or nothing stands out in it.
    AxisNotSupported
        If symmetric and antisymmetric modes were excited together.
    """
    flight = store.flights.get(flight_id)
    before, after = _required(store, flight)
    known = load_modes(store, *find_modal_tables(store, flight.aircraft_id, None, None))
    modes = tuple(known.table.at(m.condition.fuel_fraction) for m in (before, after))
    ratios = tuple(_ratios(store, maneuver) for maneuver in (before, after))
    excited = _excited_modes(store, before, modes[0], known)
    found = _matched(find_peaks(ratios[0]), modes[0], excited)
    if not found:
        raise Conflict(
            f"no peak of the record before flight {flight.number} belongs to a mode of the "
            "modal table; nothing can be followed",
            code="no-peak",
        )
    later = find_peaks(ratios[1])
    sizes = typical_size(ratios[0])
    peaks = tuple(
        _change(place, near_hz, later, ratios, sizes, modes, known)
        for place, near_hz in sorted(found.items())
    )
    worst = max((p.verdict for p in peaks), key=list(GroundTestVerdict).index)
    return GroundTest(
        flight_id=flight_id,
        flight_number=flight.number,
        before_id=before.id or 0,
        after_id=after.id or 0,
        fuel_before=before.condition.fuel_fraction,
        fuel_after=after.condition.fuel_fraction,
        peaks=peaks,
        verdict=worst,
        message=_message(flight, worst, peaks),
    )


def ground_spectra(store: Store, flight_id: int) -> GroundSpectra:
    """Read the spectra of the pair, and where fuel alone would have brought the peaks."""
    test = ground_test(store, flight_id)
    before, after = (store.maneuvers.get(number) for number in (test.before_id, test.after_id))
    return GroundSpectra(
        flight_number=test.flight_number,
        before=smooth_power(_ratios(store, before)),
        after=smooth_power(_ratios(store, after)),
        expected=tuple(
            ModeMarker(
                name=f"{peak.name} expected", frequency_hz=peak.before_hz * (1.0 + peak.explained)
            )
            for peak in test.peaks
        ),
    )


def _pair(store: Store, flight: Flight) -> tuple[Maneuver, Maneuver] | None:
    """First and last record on the ground, if maneuvers lie between them."""
    on_ground = store.maneuvers.find(flight_id=flight.id, axis=GROUND, deleted_at=None)
    if len(on_ground) < 2:  # most flights have none: their maneuvers need not be read
        return None
    on_ground.sort(key=lambda m: m.start_s)
    records = store.maneuvers.find(flight_id=flight.id, deleted_at=None)
    flown = [m.start_s for m in records if m.axis != GROUND]
    first, last = on_ground[0], on_ground[-1]
    if flown and not first.start_s < min(flown) <= max(flown) < last.start_s:
        return None
    return first, last


def _required(store: Store, flight: Flight) -> tuple[Maneuver, Maneuver]:
    pair = _pair(store, flight)
    if pair is None:
        raise Conflict(
            f"flight {flight.number} has no record on the ground both before its first and after "
            "its last maneuver; import them with axis 'ground'",
            code="no-ground-records",
            flight_id=flight.id,
        )
    return pair


def _ratios(store: Store, maneuver: Maneuver) -> list[RatioLines]:
    """Strain and acceleration over the excitation of each input, at its own lines."""
    if maneuver.excitation is None:
        raise BadInput(
            f"the excitation of maneuver {maneuver.id} is not known", code="no-excitation"
        )
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    kinds = {sensor.name: sensor.kind for sensor in aircraft.sensors}
    channels = store.channels.find(maneuver_id=maneuver.id)
    seen = (SensorKind.STRAIN, SensorKind.ACCELEROMETER)
    outputs = [c.name for c in channels if c.role is Role.OUTPUT and kinds.get(c.name) in seen]
    recorded = {c.name for c in channels}
    lines = maneuver_lines(maneuver)
    commands = [f"{n}_command" if f"{n}_command" in recorded else n for n in lines.inputs]
    data = spectra_of(store, maneuver, aircraft, (*outputs, *commands), lines).values
    n_y = len(outputs)
    return [
        RatioLines(lines.omega[own], data[own, :n_y] / data[own, n_y + index][:, None])
        for index in range(len(lines.inputs))
        if (own := np.flatnonzero(lines.owner == index)).size
    ]


def _excited_modes(
    store: Store, maneuver: Maneuver, modes: StructuralModes, known: AircraftModes
) -> np.ndarray:
    """Which modes of the table the surfaces of a record excite.

    Raises
    ------
    AxisNotSupported
        If surfaces of several symmetries moved: a peak may then be of a symmetric mode or of
        an antisymmetric one beside it.
    """
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    names = () if maneuver.excitation is None else tuple(maneuver.excitation.harmonics)
    moved = {symmetry_of(aircraft, name) for name in names}
    if moved > {"antisymmetric"} or "single" in moved:
        raise AxisNotSupported(
            f"{', '.join(names)} of maneuver {maneuver.id} excite symmetric and antisymmetric "
            "modes, and a peak cannot be given to one of them; excite pairs alike, or all against "
            "each other",
            maneuver_id=maneuver.id,
            axis=LATERAL,
        )
    antisymmetric = moved == {"antisymmetric"}
    return np.array([known.symmetric[number] != antisymmetric for number in modes.numbers])


def _matched(
    peaks_hz: list[float], modes: StructuralModes, excited: np.ndarray
) -> dict[int, float]:
    """Peak of every mode that has one: place in the table to frequency [Hz], highest first."""
    found: dict[int, float] = {}
    frequency = modes.omega / (2.0 * np.pi)
    for peak_hz in peaks_hz:
        distance = np.where(excited, np.abs(frequency / peak_hz - 1.0), np.inf)
        nearest = int(np.argmin(distance))
        if distance[nearest] < _SAME_PEAK:
            found.setdefault(nearest, peak_hz)
    return found


def _change(
    place: int,
    near_hz: float,
    later_hz: list[float],
    ratios: tuple[list[RatioLines], ...],
    sizes: np.ndarray,
    modes: tuple[StructuralModes, ...],
    known: AircraftModes,
) -> PeakChange:
    number = modes[0].numbers[place]
    first = fit_peak(ratios[0], near_hz, sizes)
    explained = float(modes[1].omega[place] / modes[0].omega[place]) - 1.0
    louder = float(modes[0].zeta[place] / modes[1].zeta[place]) - 1.0
    expected_hz = first.frequency_hz * (1.0 + explained)
    second = next(
        (
            fit_peak(ratios[1], peak_hz, sizes)
            for peak_hz in later_hz
            if abs(peak_hz / expected_hz - 1.0) < _SAME_PEAK
        ),
        None,
    )
    if second is None:
        return _described(number, known, first, None, explained, louder, None, None)
    change = second.frequency_hz / first.frequency_hz - 1.0
    std = float(
        np.hypot(
            first.frequency_std_hz / first.frequency_hz,
            second.frequency_std_hz / second.frequency_hz,
        )
    )
    return _described(number, known, first, second, explained, louder, change, std)


def _described(
    number: int,
    known: AircraftModes,
    first: Peak,
    second: Peak | None,
    explained: float,
    louder: float,
    change: float | None,
    std: float | None,
) -> PeakChange:
    left = total = amplitude = spread = None
    verdict = GroundTestVerdict.ALARM  # a peak that is gone
    if second is not None and change is not None and std is not None:
        left = (1.0 + change) / (1.0 + explained) - 1.0
        total = float(np.hypot(std, _TREND_ERROR))
        amplitude = second.amplitude / first.amplitude - 1.0
        spread = float(
            np.hypot(first.amplitude_std / first.amplitude, second.amplitude_std / second.amplitude)
        )
        off = abs((1.0 + amplitude) / (1.0 + louder) - 1.0)
        verdict = GroundTestVerdict.HEALTHY
        if off > _SIGMAS * np.hypot(spread, _AMPLITUDE_ERROR):
            verdict = GroundTestVerdict.WATCH
        if abs(left) > _SIGMAS * total:
            verdict = GroundTestVerdict.ALARM
    return PeakChange(
        mode=number,
        name=known.names[number],
        before_hz=first.frequency_hz,
        before_std_hz=first.frequency_std_hz,
        after_hz=None if second is None else second.frequency_hz,
        after_std_hz=None if second is None else second.frequency_std_hz,
        change=change,
        explained=explained,
        unexplained=left,
        unexplained_std=total,
        amplitude_change=amplitude,
        amplitude_explained=louder,
        amplitude_std=spread,
        verdict=verdict,
    )


def _message(flight: Flight, verdict: GroundTestVerdict, peaks: tuple[PeakChange, ...]) -> str:
    worst = next(peak for peak in peaks if peak.verdict is verdict)
    if worst.unexplained is None or worst.unexplained_std is None:
        return (
            f"{worst.name} stood at {worst.before_hz:.2f} Hz before flight {flight.number} and is "
            "not found after it. Inspect the structure before the next flight."
        )
    left = f"{worst.unexplained:+.1%} ± {2.0 * worst.unexplained_std:.1%}"
    if verdict is GroundTestVerdict.ALARM:
        return (
            f"{worst.name} changed by {left} beyond what the fuel burnt in flight {flight.number} "
            "explains. Inspect the structure before the next flight."
        )
    if verdict is GroundTestVerdict.WATCH:
        return (
            f"The amplitude of {worst.name} changed in flight {flight.number} by "
            f"{worst.amplitude_change:+.0%}, its frequency did not; repeat the record."
        )
    followed = ", ".join(peak.name for peak in peaks)
    return f"Fuel explains what changed ({followed}); of {worst.name} {left} is left over."
