"""Mini-GVT: comparison of the ground records before and after one flight (Fig. 10)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexsid.errors import BadInput, Conflict
from flexsid.records.aircraft import get_symmetry
from flexsid.records.maneuver import GROUND, Flight, Maneuver, Role
from flexsid.records.modal_data import ModalTable
from flexsid.records.quality import GroundTest, GroundTestVerdict, PeakChange
from flexsid.records.views import GroundSpectra, ModeMarker
from flexsid.storage.content import hash_records
from flexsid.storage.store import Store
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.sensor_models import ACCELEROMETER, STRAIN
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.modes.shapes import may_be
from flexsid.sysid.spectra.peaks import (
    InputRatios,
    compute_channel_rms,
    find_peaks,
    fit_peak,
    smooth_power,
)
from flexsid.workflow.aircraft.axes import AxisNotSupported
from flexsid.workflow.measurements.maneuver_spectra import read_spectra
from flexsid.workflow.measurements.recording import list_excitation_names, select_frequencies
from flexsid.workflow.modal_data.modal_tables import AircraftModes, find_modal_tables, load_modes

_SAME_PEAK = 0.12  # of the frequency: largest distance of peaks of one mode
_TREND_ERROR = 0.003  # relative error of the predicted change of frequency with fuel, gear included
_AMPLITUDE_ERROR = 0.10  # relative error of the predicted change of amplitude
_SIGMAS = 3.0
_MOST_TESTS = 2_000

# By a hash of all records that it depends on: pages of the campaign ask for every test at every
# read, and its spectra and fits take 0.1 s.
_tests: dict[tuple[object, ...], GroundTest] = {}


def compare_all_ground_records(store: Store, aircraft_id: int | None = None) -> list[GroundTest]:
    """Compare the ground records of every flight that has a comparable pair."""
    filters = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    found = []
    for flight in store.flights.find(**filters):
        if flight.id is None or _find_pair(store, flight) is None:
            continue
        try:
            found.append(compare_ground_records(store, flight.id))
        except (Conflict, AxisNotSupported):  # reported on the page of the flight
            continue
    return found


def compare_ground_records(store: Store, flight_id: int) -> GroundTest:
    """Assess the change of modes between take-off and landing.

    Raises
    ------
    Conflict
        If the flight has no record before or after, or no peak belongs to a mode.
    AxisNotSupported
        If symmetric and antisymmetric modes were excited together.
    """
    flight = store.flights.get(flight_id)
    pair = _find_pair(store, flight)
    if pair is None:
        raise Conflict(
            f"flight {flight.number} has no record on the ground both before its first and after "
            "its last maneuver; import them with axis 'ground'",
            code="no-ground-records",
            flight_id=flight.id,
        )
    tables = find_modal_tables(store, flight.aircraft_id)
    names = [
        f"aircraft {flight.aircraft_id}",
        *(f"maneuver {maneuver.id}" for maneuver in pair),
        *(f"modal table {table.id}" for table in tables if table is not None),
    ]
    content = hash_records(store.database, names)
    key = (flight_id, flight.number, *sorted(content.items()))
    if key not in _tests:
        test = _compare_pair(store, flight, pair, tables)
        if len(_tests) >= _MOST_TESTS:
            _tests.clear()
        _tests[key] = test
    return _tests[key]


def _compare_pair(
    store: Store,
    flight: Flight,
    pair: tuple[Maneuver, Maneuver],
    tables: tuple[ModalTable, ModalTable | None],
) -> GroundTest:
    before, after = pair
    known = load_modes(store, *tables)
    modes = tuple(known.table.at(m.condition.fuel_fraction) for m in (before, after))
    ratios = tuple(_compute_ratios(store, maneuver) for maneuver in (before, after))
    excited = _find_excited_modes(store, before, modes[0], known)
    found = _match_peaks(find_peaks(ratios[0]), modes[0], excited)
    if not found:
        raise Conflict(
            f"no peak of the record before flight {flight.number} belongs to a mode of the "
            "modal table, so the records cannot be compared",
            code="no-peak",
        )
    later = find_peaks(ratios[1])
    sizes = compute_channel_rms(ratios[0])
    peaks = tuple(
        _compare_peak(index, near_hz, later, ratios, sizes, modes, known)
        for index, near_hz in sorted(found.items())
    )
    worst = max((p.verdict for p in peaks), key=list(GroundTestVerdict).index)
    return GroundTest(
        flight_id=flight.id or 0,
        flight_number=flight.number,
        before_id=before.id or 0,
        after_id=after.id or 0,
        fuel_before=before.condition.fuel_fraction,
        fuel_after=after.condition.fuel_fraction,
        peaks=peaks,
        verdict=worst,
        message=_write_message(flight, worst, peaks),
    )


def read_ground_spectra(store: Store, flight_id: int) -> GroundSpectra:
    """Read the spectra of the pair, and the peaks expected from the change of fuel."""
    test = compare_ground_records(store, flight_id)
    before, after = (store.maneuvers.get(number) for number in (test.before_id, test.after_id))
    return GroundSpectra(
        flight_number=test.flight_number,
        before=smooth_power(_compute_ratios(store, before)),
        after=smooth_power(_compute_ratios(store, after)),
        expected=tuple(
            ModeMarker(
                name=f"{peak.name} expected", frequency_hz=peak.before_hz * (1.0 + peak.explained)
            )
            for peak in test.peaks
        ),
    )


def _find_pair(store: Store, flight: Flight) -> tuple[Maneuver, Maneuver] | None:
    """Find the first and last ground record with maneuvers between them."""
    on_ground = store.maneuvers.find(flight_id=flight.id, axis=GROUND, deleted_at=None)
    if len(on_ground) < 2:  # most flights have none
        return None
    on_ground.sort(key=lambda m: m.start_s)
    records = store.maneuvers.find(flight_id=flight.id, deleted_at=None)
    flown = [m.start_s for m in records if m.axis != GROUND]
    first, last = on_ground[0], on_ground[-1]
    if flown and not first.start_s < min(flown) <= max(flown) < last.start_s:
        return None
    return first, last


def _compute_ratios(store: Store, maneuver: Maneuver) -> list[InputRatios]:
    """Compute strain and acceleration over the excitation of each input, at its harmonics."""
    if maneuver.excitation is None:
        raise BadInput(
            f"the excitation of maneuver {maneuver.id} is not known", code="no-excitation"
        )
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    kinds = {sensor.name: sensor.kind for sensor in aircraft.sensors}
    channels = store.channels.find(maneuver_id=maneuver.id)
    seen = (STRAIN.kind, ACCELEROMETER.kind)
    outputs = [c.name for c in channels if c.role is Role.OUTPUT and kinds.get(c.name) in seen]
    recorded = {c.name for c in channels}
    frequencies = select_frequencies(maneuver)
    commands = list_excitation_names(frequencies.inputs, recorded)
    data = read_spectra(store, maneuver, aircraft, (*outputs, *commands), frequencies).values
    n_y = len(outputs)
    return [
        InputRatios(frequencies.omega[own], data[own, :n_y] / data[own, n_y + k][:, None])
        for k in range(len(frequencies.inputs))
        if (own := np.flatnonzero(frequencies.assigned_input == k)).size
    ]


def _find_excited_modes(
    store: Store, maneuver: Maneuver, modes: StructuralModes, known: AircraftModes
) -> np.ndarray:
    """Find the modes of the table that the surfaces of a record excite.

    Raises
    ------
    AxisNotSupported
        If surfaces of several symmetries moved: a peak may then belong to a symmetric or to
        an antisymmetric mode.
    """
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    names = () if maneuver.excitation is None else tuple(maneuver.excitation.harmonics)
    moved = {get_symmetry(aircraft, name) for name in names}
    if moved > {"antisymmetric"} or "single" in moved:
        raise AxisNotSupported(
            f"{', '.join(names)} of maneuver {maneuver.id} excite symmetric and antisymmetric "
            "modes, so a peak cannot be assigned to a mode; excite all pairs symmetrically, or all "
            "antisymmetrically",
            maneuver_id=maneuver.id,
            axis=LATERAL.axis,
        )
    antisymmetric = moved == {"antisymmetric"}
    return np.array(
        [may_be(known.symmetric[number], not antisymmetric) for number in modes.numbers]
    )


def _match_peaks(
    peaks_hz: list[float], modes: StructuralModes, excited: np.ndarray
) -> dict[int, float]:
    """Match peaks to modes: index in the table to frequency [Hz], highest peak first."""
    found: dict[int, float] = {}
    frequency = modes.omega / (2.0 * np.pi)
    for peak_hz in peaks_hz:
        distance = np.where(excited, np.abs(frequency / peak_hz - 1.0), np.inf)
        nearest = int(np.argmin(distance))
        if distance[nearest] < _SAME_PEAK:
            found.setdefault(nearest, peak_hz)
    return found


def _compare_peak(
    index: int,
    near_hz: float,
    later_hz: list[float],
    ratios: tuple[list[InputRatios], ...],
    sizes: np.ndarray,
    modes: tuple[StructuralModes, ...],
    known: AircraftModes,
) -> PeakChange:
    number = modes[0].numbers[index]
    first = fit_peak(ratios[0], near_hz, sizes)
    explained = float(modes[1].omega[index] / modes[0].omega[index]) - 1.0
    louder = float(modes[0].zeta[index] / modes[1].zeta[index]) - 1.0
    missing = PeakChange(
        mode=number,
        name=known.names[number],
        before_hz=first.frequency_hz,
        before_std_hz=first.frequency_std_hz,
        after_hz=None,
        after_std_hz=None,
        change=None,
        explained=explained,
        unexplained=None,
        unexplained_std=None,
        amplitude_change=None,
        amplitude_explained=louder,
        amplitude_std=None,
        verdict=GroundTestVerdict.ALARM,
    )
    expected_hz = first.frequency_hz * (1.0 + explained)
    near = (peak_hz for peak_hz in later_hz if abs(peak_hz / expected_hz - 1.0) < _SAME_PEAK)
    found_hz = next(near, None)
    if found_hz is None:
        return missing
    second = fit_peak(ratios[1], found_hz, sizes)
    change = second.frequency_hz / first.frequency_hz - 1.0
    std = np.hypot(
        first.frequency_std_hz / first.frequency_hz, second.frequency_std_hz / second.frequency_hz
    )
    unexplained = (1.0 + change) / (1.0 + explained) - 1.0
    total = float(np.hypot(std, _TREND_ERROR))
    amplitude = second.amplitude / first.amplitude - 1.0
    spread = float(
        np.hypot(first.amplitude_std / first.amplitude, second.amplitude_std / second.amplitude)
    )
    off = abs((1.0 + amplitude) / (1.0 + louder) - 1.0)
    verdict = GroundTestVerdict.HEALTHY
    if off > _SIGMAS * np.hypot(spread, _AMPLITUDE_ERROR):
        verdict = GroundTestVerdict.WATCH
    if abs(unexplained) > _SIGMAS * total:
        verdict = GroundTestVerdict.ALARM
    return replace(
        missing,
        after_hz=second.frequency_hz,
        after_std_hz=second.frequency_std_hz,
        change=change,
        unexplained=unexplained,
        unexplained_std=total,
        amplitude_change=amplitude,
        amplitude_std=spread,
        verdict=verdict,
    )


def _write_message(
    flight: Flight, verdict: GroundTestVerdict, peaks: tuple[PeakChange, ...]
) -> str:
    worst = next(peak for peak in peaks if peak.verdict is verdict)
    if worst.unexplained is None or worst.unexplained_std is None:
        return (
            f"{worst.name} was at {worst.before_hz:.2f} Hz before flight {flight.number} and is "
            "not found after it. Inspect the structure before the next flight."
        )
    unexplained = f"{worst.unexplained:+.1%} ± {2.0 * worst.unexplained_std:.1%}"
    if verdict is GroundTestVerdict.ALARM:
        return (
            f"The frequency of {worst.name} changed by {unexplained} in addition to the "
            f"effect of the fuel burnt in flight {flight.number}. Inspect the structure "
            "before the next flight."
        )
    if verdict is GroundTestVerdict.WATCH:
        return (
            f"The amplitude of {worst.name} changed in flight {flight.number} by "
            f"{worst.amplitude_change:+.0%}, its frequency did not change; repeat the record."
        )
    compared = ", ".join(peak.name for peak in peaks)
    return (
        f"The fuel explains the changes ({compared}); the unexplained change of {worst.name} "
        f"is {unexplained}."
    )
