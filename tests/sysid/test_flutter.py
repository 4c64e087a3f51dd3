"""Flutter: exact on known aircraft, with its standard error, and a sentence without prediction."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from flexsid.demo.flex28 import load_truth
from flexsid.errors import BadInput, NotIdentifiable
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.modes.shapes import StructuralModes
from flexsid.sysid.stability.derivative_fusion import (
    DerivativePrior,
    IdentifiedModes,
    StiffnessError,
    compute_weighted_mean,
    fuse_identified,
    fuse_with_trend,
)
from flexsid.sysid.stability.flutter_extrapolation import (
    FlownPoint,
    extrapolate_damping,
    extrapolate_envelope,
    extrapolate_flutter_margin,
)
from flexsid.sysid.stability.flutter_extrapolation import TestPoint as Point
from flexsid.sysid.stability.flutter_prediction import compute_structure_spread, predict_flutter
from flexsid.sysid.stability.poles import (
    Aeroelastic,
    build_state_family,
    compute_eigenvalue_slopes,
    decompose_states,
)
from flexsid.sysid.stability.root_errors import (
    UncertainDerivatives,
    estimate_crossing_error,
    estimate_root_bands,
    sample_root_bands,
)
from flexsid.sysid.stability.root_tracking import Mechanism, track_roots

FOOT = 0.3048
GERI = Path(__file__).parents[3] / "shared" / "data" / "maewing1" / "geri.json"
SPEEDS = np.linspace(25.0, 95.0, 120)


def flex28(n_modes: int, fuel: float = 0.5) -> Aeroelastic:
    truth = load_truth()
    return Aeroelastic(
        truth.condition_at(40.0, fuel),
        truth.modes_at(fuel, n_modes),
        truth.derivatives_at(fuel, n_modes),
    )


def everything(aircraft: Aeroelastic, share: float) -> UncertainDerivatives:
    """Every derivative known to a share of its value."""
    n = len(aircraft.modes.numbers)
    rows, columns = (x.ravel() for x in np.indices((2 + n, 2 + 2 * n)))
    size = np.maximum(np.abs(aircraft.derivatives.values[rows, columns]), 0.02)
    return UncertainDerivatives(rows, columns, np.diag((share * size) ** 2))


@pytest.mark.parametrize(
    ("fuel", "n_modes", "published_ft_s"),
    [
        (0.0, 8, 199.00),
        (0.25, 8, 196.26),
        (0.5, 8, 194.60),
        (0.75, 8, 193.47),
        (1.0, 8, 192.63),
        (0.5, 4, 194.90),
        (0.5, 2, 200.85),
        (1.0, 2, 199.32),
    ],
)
def test_flutter_speeds_are_those_of_the_design_notes(fuel, n_modes, published_ft_s):
    crossing = track_roots(flex28(n_modes, fuel), SPEEDS).flutter
    assert crossing is not None
    assert crossing.airspeed / FOOT == pytest.approx(published_ft_s, rel=1e-4)
    assert crossing.mechanism is Mechanism.FLUTTER
    assert max(crossing.participation, key=crossing.participation.__getitem__) == "7"


@pytest.mark.parametrize("fuel", np.linspace(0.0, 1.0, 17))
def test_flutter_at_every_fuel_weight_agrees_with_the_state_space(fuel, make_case):
    truth = load_truth()
    found = track_roots(flex28(8, fuel), SPEEDS).flutter
    assert found is not None
    case = make_case(8)

    def growth(speed: float) -> float:
        model = replace(
            case.model, condition=truth.condition_at(speed, fuel), modes=truth.modes_at(fuel, 8)
        )
        A = model.state_space(truth.derivatives_at(fuel, 8)).A
        values = np.linalg.eigvals(A)
        return float(values[np.abs(values) > 5.0].real.max())

    expected = brentq(growth, 50.0, 65.0, xtol=1e-8)
    assert found.airspeed == pytest.approx(expected, rel=1e-6)
    assert found.airspeed == pytest.approx(truth.flutter_speed_at(fuel), rel=1e-5)


def test_roots_retain_their_names_through_a_coalescence():
    locus = track_roots(flex28(4), SPEEDS)
    assert set(locus.names) == {"SP", "7", "9", "11", "12"}
    steps = np.abs(np.diff(locus.roots, axis=0)).max(axis=0)
    assert (steps < 4.0).all(), "a root jumped to another branch"


@pytest.mark.parametrize(
    ("kind", "speed", "frequency"),
    [("NOM", 31.0076, 33.2584), ("PID_updated", 33.2794, 35.3078)],
)
@pytest.mark.skipif(not GERI.is_file(), reason="the data of mAEWing1 are not here")
def test_a_published_aircraft_flutters_where_it_was_published(kind, speed, frequency):
    crossing = track_roots(maewing1(kind), np.linspace(12.0, 40.0, 120)).flutter
    assert crossing is not None
    assert crossing.airspeed == pytest.approx(speed, rel=2e-3)
    assert crossing.frequency == pytest.approx(frequency, rel=2e-3)


def test_slopes_of_roots_equal_differences():
    aircraft = flex28(2)
    V = np.array([30.0, 50.0])
    family = build_state_family(aircraft, V)
    modal = decompose_states(family.A)
    rows, columns = np.array([0, 1, 2, 3, 2]), np.array([0, 1, 2, 5, 7])
    found = compute_eigenvalue_slopes(family, modal, rows, columns)
    for index, (row, column) in enumerate(zip(rows, columns, strict=True)):
        step = 1e-5
        shifted = []
        for sign in (1.0, -1.0):
            values = aircraft.derivatives.values.copy()
            values[row, column] += sign * step
            table = DerivativeTable(aircraft.derivatives.modes, aircraft.derivatives.inputs, values)
            shifted.append(
                decompose_states(
                    build_state_family(replace(aircraft, derivatives=table), V).A
                ).values
            )
        for k in range(V.size):
            for root, value in enumerate(modal.values[k]):
                ends = [s[k][np.argmin(np.abs(s[k] - value))] for s in shifted]
                difference = (ends[0] - ends[1]) / (2 * step)
                assert found[k, root, index] == pytest.approx(difference, rel=1e-4, abs=1e-5)


def test_bands_agree_with_draws():
    aircraft = flex28(4)
    locus = track_roots(aircraft, np.linspace(30.0, 75.0, 12))
    uncertain = everything(aircraft, 0.02)
    bands = estimate_root_bands(aircraft, locus, uncertain)
    drawn = sample_root_bands(aircraft, locus, uncertain)
    clear = ~bands.by_monte_carlo
    assert clear.any()
    for ours, theirs in (
        (bands.real_std, drawn.real_std),
        (bands.imag_std, drawn.imag_std),
        (bands.damping_std, drawn.damping_std),
    ):
        assert np.abs(ours[clear] / theirs[clear] - 1.0).max() < 0.1


def test_where_roots_meet_draws_replace_first_order():
    aircraft = flex28(4)
    locus = track_roots(aircraft, np.linspace(40.0, 56.0, 9))
    uncertain = everything(aircraft, 0.25)
    bands = estimate_root_bands(aircraft, locus, uncertain)
    assert bands.by_monte_carlo.any()
    at = bands.by_monte_carlo
    there = replace(locus, airspeed=locus.airspeed[at], roots=locus.roots[at])
    again = sample_root_bands(aircraft, there, uncertain)
    assert np.array_equal(bands.real_std[at], again.real_std)


def test_where_the_first_derivative_vanishes_draws_replace_it():
    """A covariance that happens not to move a root to first order still moves it."""
    aircraft = flex28(4)
    locus = track_roots(aircraft, np.linspace(50.0, 54.0, 5))
    known = everything(aircraft, 0.02)
    family = build_state_family(aircraft, locus.airspeed)
    modal = decompose_states(family.A)
    root = int(np.argmin(np.abs(modal.values[2] - locus.roots[2, 1])))
    slope = compute_eigenvalue_slopes(family, modal, known.rows, known.columns)[2, root]
    scale = np.sqrt(np.diag(known.covariance))
    q = np.linalg.qr(np.stack([np.real(slope), np.imag(slope)], axis=1) * scale[:, None])[0]
    left = (np.eye(scale.size) - q @ q.T) * np.outer(scale, scale)
    uncertain = replace(known, covariance=left)
    bands = estimate_root_bands(aircraft, locus, uncertain)
    drawn = sample_root_bands(aircraft, locus, uncertain)
    assert bands.by_monte_carlo[2]
    for ours, theirs in ((bands.real_std, drawn.real_std), (bands.imag_std, drawn.imag_std)):
        assert np.abs(ours / theirs - 1.0).max() < 0.1


def test_error_of_the_flutter_speed_is_that_of_draws():
    aircraft = flex28(2)
    uncertain = everything(aircraft, 0.01)
    crossing = track_roots(aircraft, SPEEDS).flutter
    assert crossing is not None
    error = estimate_crossing_error(aircraft, crossing, uncertain)
    near = np.linspace(0.8, 1.2, 12) * crossing.airspeed
    drawn = []
    for values in uncertain.draw(aircraft.derivatives, 150, seed=1):
        table = DerivativeTable(aircraft.derivatives.modes, aircraft.derivatives.inputs, values)
        found = track_roots(replace(aircraft, derivatives=table), near).flutter
        assert found is not None
        drawn.append(found.airspeed)
    assert error == pytest.approx(np.std(drawn), rel=0.2)


def test_no_flutter_is_a_sentence_and_not_a_number():
    found = IdentifiedModes(flex28(4), everything(flex28(4), 0.01))
    calm = predict_flutter(found, (25.0, 45.0))
    assert calm.crossing is None
    assert calm.interval is None
    sure = "Stable up to 45.0 m/s within two standard errors; the least damping is"
    assert sure in calm.sentence
    unsure = predict_flutter(replace(found, uncertain=everything(flex28(4), 0.3)), (25.0, 56.0))
    assert unsure.crossing is None
    up_to = re.match(r"Stable within two standard errors up to ([0-9.]+) m/s only", unsure.sentence)
    assert up_to is not None, unsure.sentence
    assert 40.0 <= float(up_to[1]) < 56.0  # 40 m/s were flown
    exact = everything(flex28(4), 0.3)
    none = UncertainDerivatives(exact.rows[:0], exact.columns[:0], np.zeros((0, 0)))
    alone = predict_flutter(replace(found, uncertain=none), (25.0, 45.0))
    assert "stable up to 45.0 m/s, with unknown error" in alone.sentence
    late = predict_flutter(found, (62.0, 80.0))
    assert "Already unstable at 62.0 m/s" in late.sentence
    with pytest.raises(BadInput, match="not a band"):
        predict_flutter(found, (50.0, 40.0))


def test_an_instability_at_the_lowest_speed_is_reported_before_later_crossings():
    late = predict_flutter(IdentifiedModes(flex28(4), everything(flex28(4), 0.01)), (70.0, 120.0))
    assert late.sentence.startswith("Already unstable at 70.0 m/s in mode 7; look at lower speeds.")
    assert "Flutter of" in late.sentence


def flown_at(
    speed: float, growth: float, std: float, *, root: complex = 18j, hz: float = 20.0, **changes
) -> FlownPoint:
    """A run that identified one root at a speed."""
    band = (0.25 * 2.0 * np.pi, hz * 2.0 * np.pi)
    roots = np.array([growth + root])
    return FlownPoint(speed, roots, np.array([std]), band, "run 7", **changes)


def test_a_crossing_below_a_speed_flown_stable_is_contradicted_and_no_prediction():
    found = IdentifiedModes(flex28(4), everything(flex28(4), 0.01))
    prediction = predict_flutter(found, (25.0, 80.0), flown=[flown_at(62.0, -0.4, 0.05)])
    assert prediction.crossing is None
    assert prediction.interval is None
    assert prediction.sentence.startswith(
        "No flutter speed is predicted. Flutter of mode 7 with the"
    )
    assert "is contradicted by flight: run 7 was flown at 62.0 m/s" in prediction.refusal
    assert "-0.40 ± 0.10 rad/s" in prediction.refusal
    assert "mode 7 and the short period" in prediction.refusal


def test_a_maneuver_flown_in_closed_loop_beyond_flutter_agrees_with_the_crossing():
    found = IdentifiedModes(flex28(4), everything(flex28(4), 0.01))
    alone = predict_flutter(found, (25.0, 80.0))
    prediction = predict_flutter(found, (25.0, 80.0), flown=[flown_at(62.0, 0.5, 0.05)])
    assert prediction.crossing == alone.crossing
    assert "a control loop held it" in prediction.sentence
    before = predict_flutter(found, (25.0, 80.0), flown=[flown_at(50.0, -2.0, 0.05)])
    assert before.sentence == alone.sentence, "it lies ahead of what was flown"


@pytest.mark.parametrize(
    ("point", "words"),
    [
        (flown_at(62.0, 0.1, 0.2), "+0.10 ± 0.40 rad/s, which may be stable"),
        (flown_at(62.0, -0.1, np.nan), "with unknown error"),
        (flown_at(62.0, 1.0, 0.01, hz=4.5, root=200j), "may be stable"),
        (flown_at(62.0, -0.4, 0.01, hz=2.0), "lies outside the band of their data, 0.25 to 2 Hz"),
        (flown_at(50.0, -0.4, 0.01, hz=2.0), "Remove the mode from the model"),
    ],
)
def test_a_root_that_the_data_do_not_determine_is_no_prediction(point: FlownPoint, words: str):
    found = IdentifiedModes(flex28(4), everything(flex28(4), 0.01))
    prediction = predict_flutter(found, (25.0, 80.0), flown=[point])
    assert prediction.crossing is None
    assert words in prediction.refusal


def test_another_fuel_weight_contradicts_nothing():
    found = IdentifiedModes(flex28(4), everything(flex28(4), 0.01))
    prediction = predict_flutter(
        found, (25.0, 80.0), flown=[flown_at(62.0, -0.4, 0.05, comparable=False)]
    )
    assert prediction.crossing is not None
    assert "with another fuel weight" in prediction.sentence


def test_an_error_of_a_modal_frequency_moves_flutter_by_what_the_interval_counts():
    """The derivative makes up for the frequency where it was flown, not where flutter is."""
    aircraft = flex28(4)
    c, modes = aircraft.condition, aircraft.modes
    truth = predict_flutter(IdentifiedModes(aircraft, everything(aircraft, 1e-6)), (25.0, 80.0))
    assert truth.crossing is not None
    share = 1e-3
    relative = np.array([share, 0.0, 0.0, 0.0])
    omega = modes.omega * (1.0 + relative)
    values = aircraft.derivatives.values.copy()
    lift = c.dynamic_pressure * c.area * c.chord
    values[2, 2] += (omega[0] ** 2 - modes.omega[0] ** 2) * modes.mass[0] / lift
    wrong = replace(
        aircraft,
        modes=replace(modes, omega=omega, zeta=modes.zeta * modes.omega / omega),
        derivatives=replace(aircraft.derivatives, values=values),
    )
    found = IdentifiedModes(
        wrong, everything(wrong, 1e-6), StiffnessError(relative, c.dynamic_pressure)
    )
    prediction = predict_flutter(found, (25.0, 80.0))
    assert prediction.crossing is not None
    off = prediction.crossing.airspeed - truth.crossing.airspeed
    assert prediction.modal_std == pytest.approx(abs(off), rel=0.02)
    assert prediction.interval is not None
    assert prediction.interval[0] < truth.crossing.airspeed < prediction.interval[1]
    exact = replace(found, stiffness=None)
    assert predict_flutter(exact, (25.0, 80.0)).modal_std == 0.0


def test_an_error_of_a_damping_ratio_moves_flutter_by_what_the_interval_counts():
    """As of a frequency: what was flown is the sum of structural and aerodynamic damping."""
    aircraft = flex28(4)
    c, modes = aircraft.condition, aircraft.modes
    truth = predict_flutter(IdentifiedModes(aircraft, everything(aircraft, 1e-6)), (25.0, 80.0))
    assert truth.crossing is not None
    relative = np.array([0.02, 0.0, 0.0, 0.0])
    zeta = modes.zeta * (1.0 + relative)
    values = aircraft.derivatives.values.copy()
    per_rate = c.dynamic_pressure * c.area * c.chord / modes.mass[0] * c.chord / (2.0 * c.airspeed)
    values[2, 2 + 4] += 2.0 * modes.omega[0] * (zeta[0] - modes.zeta[0]) / per_rate
    table = replace(aircraft.derivatives, values=values)
    wrong = replace(aircraft, modes=replace(modes, zeta=zeta), derivatives=table)
    error = StiffnessError(
        np.zeros(4), c.dynamic_pressure, damping_std=relative, mass_flow=c.density * c.airspeed
    )
    found = predict_flutter(IdentifiedModes(wrong, everything(wrong, 1e-6), error), (25.0, 80.0))
    assert found.crossing is not None
    off = found.crossing.airspeed - truth.crossing.airspeed
    assert found.modal_std == pytest.approx(abs(off), rel=0.02)


@pytest.mark.parametrize("retained", [0, 2])
@pytest.mark.parametrize("n_runs", [1, 2, 3])
def test_runs_at_several_airspeeds_correct_the_frequencies_of_the_modal_table(
    n_runs: int, retained: int
):
    """Frequencies 3 % wrong: one run compensates them, several separate them from derivatives.

    So are those of retained modes, whose derivatives are nuisance parameters.
    """
    true = flex28(4)
    truth = predict_flutter(IdentifiedModes(true, everything(true, 1e-6)), (25.0, 80.0))
    assert truth.crossing is not None
    relative = 0.03 * np.array([1.0, -1.0, 0.6, -0.3])
    rng = np.random.default_rng(5)
    parts = []
    for share in (1.0, 0.75, 0.6)[:n_runs]:
        at = replace(true.condition, airspeed=share * true.condition.airspeed)
        omega = true.modes.omega * (1.0 + relative)
        wrong = replace(true.modes, omega=omega, zeta=true.modes.zeta / (1.0 + relative))
        lift = at.dynamic_pressure * at.area * at.chord
        slopes = 2.0 * omega**2 * true.modes.mass / lift
        values = true.derivatives.values.copy()
        own = 2 + np.arange(4)
        values[own, own] += (omega**2 - true.modes.omega**2) * true.modes.mass / lift
        known = everything(true, 1e-3)
        scatter = rng.multivariate_normal(np.zeros(known.rows.size), known.covariance)
        values[known.rows, known.columns] += scatter
        table = replace(true.derivatives, values=values)
        aircraft = replace(true, condition=at, modes=wrong, derivatives=table)
        stiffness = StiffnessError(np.full(4, 0.03), at.dynamic_pressure, slopes)
        n = known.rows.size
        prior = DerivativePrior(
            np.zeros(n), np.zeros((n, n)), nuisance=known.rows >= 2 + 4 - retained
        )
        parts.append(IdentifiedModes(aircraft, known, stiffness, prior))
    found = fuse_identified(parts, replace(parts[0].aircraft, condition=true.condition))
    prediction = predict_flutter(found, (25.0, 80.0))
    assert prediction.crossing is not None
    assert prediction.interval is not None
    assert prediction.interval[0] < truth.crossing.airspeed < prediction.interval[1]
    share = prediction.total_std / truth.crossing.airspeed
    assert share > 0.01 if n_runs == 1 else share < 0.004
    if n_runs > 1:
        assert found.aircraft.modes.omega == pytest.approx(true.modes.omega, rel=2e-3)
        alone = fuse_identified(
            # pyrefly: ignore[bad-specialization]
            [replace(p, stiffness=replace(p.stiffness, slopes=None)) for p in parts],
            replace(parts[0].aircraft, condition=true.condition),
        )
        assert predict_flutter(alone, (25.0, 80.0)).total_std > 3.0 * prediction.total_std


def test_runs_at_two_airspeeds_correct_the_damping_of_the_modal_table():
    """Damping ratios 40 % wrong: each run compensates them by C_Q_etadot, by another amount."""
    true = flex28(4)
    truth = track_roots(true, SPEEDS).flutter
    assert truth is not None
    zeta = true.modes.zeta * np.array([1.4, 0.6, 1.3, 0.8])
    parts, rng = [], np.random.default_rng(6)
    for share in (1.0, 0.6):
        at = replace(true.condition, airspeed=share * true.condition.airspeed)
        per_rate = at.dynamic_pressure * at.area * at.chord / true.modes.mass
        per_rate = per_rate * at.chord / (2.0 * at.airspeed)
        slopes = 2.0 * zeta * true.modes.omega / per_rate
        own = 2 + np.arange(4)
        values = true.derivatives.values.copy()
        values[own, own + 4] += 2.0 * (zeta - true.modes.zeta) * true.modes.omega / per_rate
        wrong = replace(true.modes, zeta=zeta)
        derivatives = replace(true.derivatives, values=values)
        run = identify(replace(true, condition=at, modes=wrong, derivatives=derivatives), rng, 1e-3)
        error = StiffnessError(
            np.zeros(4), at.dynamic_pressure, np.zeros(4), np.full(4, 0.5),
            at.density * at.airspeed, slopes,
        )  # fmt: skip
        parts.append(replace(run, stiffness=error))
    to = replace(parts[0].aircraft, condition=true.condition)
    found = fuse_identified(parts, to)
    assert found.aircraft.modes.zeta == pytest.approx(true.modes.zeta, rel=0.05)
    assert max(found.error_ratios) < 1.4
    alone, both = (predict_flutter(one, (25.0, 80.0)) for one in (parts[0], found))
    assert both.total_std < 0.5 * alone.total_std
    assert both.crossing is not None
    assert abs(both.crossing.airspeed - truth.airspeed) < 3.0 * both.total_std


def test_an_error_as_large_as_the_speed_is_called_not_known():
    aircraft = flex28(4)
    blurred = predict_flutter(IdentifiedModes(aircraft, everything(aircraft, 5.0)), (25.0, 80.0))
    assert "not identifiable from these runs" in blurred.sentence
    assert blurred.interval is not None
    assert blurred.interval[0] == 0.0
    known = everything(aircraft, 0.01)
    for wrong in (np.nan, np.inf):
        nowhere = replace(known, covariance=np.full_like(known.covariance, wrong))
        prediction = predict_flutter(IdentifiedModes(aircraft, nowhere), (25.0, 80.0))
        assert prediction.interval is None
        assert "with unknown error" in prediction.sentence


@pytest.mark.parametrize(
    ("speeds", "density", "mass", "words"),
    [
        ([], None, 1.0, "positive"),
        ([60.0, 50.0], None, 1.0, "rise"),
        ([-5.0, 50.0], None, 1.0, "positive"),
        ([40.0, 50.0], 0.0, 1.0, "density of 0"),
        ([40.0, 50.0], None, 0.0, "mode 7 has a generalised mass of 0"),
    ],
)
def test_what_cannot_be_flown_is_refused(speeds, density, mass, words):
    aircraft = flex28(2)
    aircraft = replace(aircraft, modes=replace(aircraft.modes, mass=mass * aircraft.modes.mass))
    with pytest.raises(BadInput, match=words):
        track_roots(aircraft, np.array(speeds), density)


def test_derivatives_that_are_no_numbers_are_refused():
    aircraft = flex28(2)
    table = replace(aircraft.derivatives, values=np.nan * aircraft.derivatives.values)
    with pytest.raises(NotIdentifiable, match="not finite"):
        track_roots(replace(aircraft, derivatives=table), SPEEDS)


@pytest.mark.parametrize("stiffness", [0.05, 0.1, 0.2])
def test_divergence_is_distinguished_from_flutter_and_agrees_with_statics(stiffness):
    """A mode that nothing but its own displacement drives loses its stiffness."""
    aircraft = flex28(1)
    values = aircraft.derivatives.values.copy()
    values[2, 0] = values[0, 2] = values[1, 2] = 0.0
    values[2, 2] = stiffness
    alone = replace(aircraft, derivatives=replace(aircraft.derivatives, values=values))
    c, modes = alone.condition, alone.modes
    pressure = modes.mass[0] * modes.omega[0] ** 2 / (c.area * c.chord * stiffness)
    found = predict_flutter(IdentifiedModes(alone, everything(alone, 0.01)), (20.0, 90.0))
    assert found.crossing is not None
    assert found.crossing.mechanism is Mechanism.DIVERGENCE
    assert found.crossing.airspeed == pytest.approx(np.sqrt(2.0 * pressure / c.density), rel=1e-6)
    assert found.sentence.startswith("Divergence of mode 7")


def test_models_without_prediction_get_a_sentence_or_are_refused():
    aircraft = flex28(2)
    nothing = UncertainDerivatives(np.zeros(0, int), np.zeros(0, int), np.zeros((0, 0)))
    fused = fuse_identified([IdentifiedModes(aircraft, nothing)] * 2, aircraft)
    assert predict_flutter(fused, (30.0, 90.0)).crossing is not None
    table = aircraft.derivatives
    still = replace(aircraft, derivatives=replace(table, values=np.zeros_like(table.values)))
    calm = predict_flutter(IdentifiedModes(still, everything(still, 0.01)), (30.0, 90.0))
    assert calm.crossing is None
    assert "the least damping is 0.0 %" in calm.sentence
    unknown = table.values.copy()
    unknown[2, 2] = np.nan
    broken = replace(aircraft, derivatives=replace(table, values=unknown))
    with pytest.raises(NotIdentifiable, match="not finite"):
        predict_flutter(IdentifiedModes(broken, everything(aircraft, 0.01)), (30.0, 90.0))
    known = everything(aircraft, 0.01)
    lost = replace(known, covariance=np.full_like(known.covariance, np.nan))
    with pytest.raises(NotIdentifiable, match="not finite"):
        fuse_identified([IdentifiedModes(aircraft, lost)], aircraft)


def build_humped(decay: float) -> Aeroelastic:
    """A mode that stiffens with dynamic pressure passes another one, which turns against it.

    With little damping, a decay in 1/s, roots coalesce while the difference of the squared
    frequencies is less than twice the root of the product of the couplings.
    """
    aircraft = flex28(2)
    c, modes = aircraft.condition, aircraft.modes
    first, second = modes.omega**2
    quiet = replace(modes, zeta=decay / modes.omega)  # unequal damping would destabilise
    values = np.zeros_like(aircraft.derivatives.values)
    values[0, 0], values[1, 1] = -4.0, -5.0
    middle = 0.5 * c.density * 50.0**2  # where the squared frequencies are equal
    lift = c.area * c.chord
    values[2, 2] = -(second - first) * modes.mass[0] / (middle * lift)
    coupling = 0.1 * (second - first) / (middle * lift)
    values[2, 3], values[3, 2] = coupling * modes.mass[0], -coupling * modes.mass[1]
    return Aeroelastic(c, quiet, replace(aircraft.derivatives, values=values))


def test_a_hump_is_left_again_where_frequencies_part():
    humped = build_humped(0.02)
    found = predict_flutter(IdentifiedModes(humped, everything(humped, 0.01)), (30.0, 90.0))
    assert found.crossing is not None
    assert found.crossing.mechanism is Mechanism.FLUTTER
    # |1 - p| = 0.2 p for p in units of the middle pressure
    edges = [50.0 * np.sqrt(1.0 / (1.0 + sign * 0.2)) for sign in (1.0, -1.0)]
    assert found.crossing.airspeed == pytest.approx(edges[0], rel=2e-3)
    assert found.crossing.recovers_at == pytest.approx(edges[1], rel=2e-3)
    assert f"stable again from {found.crossing.recovers_at:.2f} m/s" in found.sentence
    passed = predict_flutter(
        IdentifiedModes(humped, everything(humped, 0.01)),
        (30.0, 90.0),
        flown=[flown_at(75.0, -0.5, 0.01)],
    )
    assert passed.crossing is None
    assert not passed.refusal, "nothing that was flown contradicts the model"
    assert "it was passed and is not the flutter speed ahead" in passed.sentence


def test_the_interval_of_a_hump_that_barely_reaches_the_axis_is_that_of_drawn_models():
    """First order divides by a slope that vanishes there; without crossing it had no interval."""
    lows = []
    for decay, crosses in ((2.98, True), (3.0, False)):  # 2.995: the hump touches the axis
        humped = build_humped(decay)
        found = IdentifiedModes(humped, everything(humped, 0.01))
        first = predict_flutter(found, (30.0, 90.0))
        assert (first.crossing is not None) is crosses
        assert first.interval is None or first.interval[1] < 55.0, "as if the hump were certain"
        drawn = predict_flutter(found, (30.0, 90.0), draws=True)
        assert drawn.interval is not None
        assert ("with 95 % probability" in drawn.sentence) is crosses
        assert "some are stable up to 135.0 m/s" in drawn.sentence
        lows.append(drawn.interval[0])
        assert drawn.interval[1] == 1.5 * 90.0, "half of the models have no hump"
    assert lows == pytest.approx([49.9, 49.9], abs=0.5)


def test_a_trend_extrapolates_derivatives_to_the_requested_pressure():
    aircraft = flex28(2)
    rows, columns = np.array([0, 1, 2]), np.array([0, 0, 2])
    rng = np.random.default_rng(1)
    std = np.array([0.01, 0.002, 0.003])
    truth = aircraft.derivatives.values[rows, columns]
    drift = np.array([1.0, -0.5, 0.2])

    def part(speed: float) -> IdentifiedModes:
        condition = replace(aircraft.condition, airspeed=speed)
        values = aircraft.derivatives.values.copy()
        pressure = condition.dynamic_pressure
        values[rows, columns] = truth + drift * pressure / 1000.0 + std * rng.normal(size=3)
        table = replace(aircraft.derivatives, values=values)
        uncertain = UncertainDerivatives(rows, columns, np.diag(std**2))
        return IdentifiedModes(Aeroelastic(condition, aircraft.modes, table), uncertain)

    parts = [part(speed) for speed in (30.0, 35.0, 40.0, 45.0, 50.0)]
    extrapolated = fuse_with_trend(parts, aircraft, 2000.0)
    off = extrapolated.aircraft.derivatives.values[rows, columns] - (truth + 2.0 * drift)
    errors = np.sqrt(np.diag(extrapolated.uncertain.covariance))
    assert (np.abs(off) < 4.0 * errors).all()
    assert (errors > std).all()  # beyond what was flown a line is less sure
    with pytest.raises(BadInput, match="3 dynamic pressures"):
        fuse_with_trend(parts[:2], aircraft, 2000.0)


def test_fusion_weighs_by_information_and_widens_where_runs_disagree():
    rng = np.random.default_rng(2)
    covariances = [np.diag([1.0, 4.0]), np.diag([4.0, 1.0])]
    agreeing = np.array([[1.0, 1.0], [1.2, 0.9]])
    mean, covariance = compute_weighted_mean(agreeing, covariances)
    assert mean == pytest.approx([1.04, 0.92])
    assert np.diag(covariance) == pytest.approx([0.8, 0.8])
    apart = np.array([[0.0, 0.0], [20.0, 20.0]]) + rng.normal(size=(2, 2))
    _, wide = compute_weighted_mean(apart, covariances)
    assert (np.diag(wide) > 10.0).all()
    assert compute_structure_spread([59.0, 61.0], 60.0) == pytest.approx(1.0)
    assert compute_structure_spread([], 60.0) == 0.0


def identify(
    truth: Aeroelastic, rng: np.random.Generator, share: float, errors: float = 1.0
) -> IdentifiedModes:
    """A run whose errors are so many times its standard errors, a share of the derivatives."""
    known = everything(truth, share)
    values = truth.derivatives.values.copy()
    scatter = errors * np.sqrt(np.diag(known.covariance))
    values[known.rows, known.columns] += scatter * rng.standard_normal(scatter.size)
    table = replace(truth.derivatives, values=values)
    return IdentifiedModes(replace(truth, derivatives=table), known)


@pytest.mark.parametrize("seed", range(5))
def test_an_added_run_that_contradicts_the_others_loses_its_weight(seed: int):
    """Its errors are 20 times what it states: the others' interval must not grow by them."""
    truth, rng = flex28(4), np.random.default_rng(seed)
    true = track_roots(truth, SPEEDS).flutter
    assert true is not None
    parts = [identify(truth, rng, 0.01) for _ in range(3)]
    parts.append(identify(truth, rng, 0.01, errors=20.0))
    before, after = (fuse_identified(parts[:n], truth) for n in (3, 4))
    assert max(before.error_ratios) < 1.4
    assert max(after.error_ratios[:3]) < 1.4
    assert after.error_ratios[3] == pytest.approx(20.0, rel=0.3)
    few, many = (predict_flutter(found, (25.0, 80.0)) for found in (before, after))
    assert many.total_std < 1.2 * few.total_std
    assert many.crossing is not None
    assert abs(many.crossing.airspeed - true.airspeed) < 4.0 * many.total_std


def test_runs_that_contradict_each_other_do_not_widen_a_prior():
    """Data scatter by ten standard errors; a derivative that no data know has its prior only."""
    aircraft, rng = flex28(4), np.random.default_rng(4)
    known = everything(aircraft, 0.01)
    place, n = (known.rows, known.columns), known.rows.size
    prior = DerivativePrior(
        aircraft.derivatives.values[place], np.diag(np.eye(n)[-1] * 25.0), np.zeros(n, dtype=bool)
    )
    std = np.sqrt(np.diag(known.covariance))
    std[-1] = 0.2
    parts = []
    for _ in range(2):
        values = aircraft.derivatives.values.copy()
        values[place] += 10.0 * std * rng.standard_normal(n) * (np.arange(n) < n - 1)
        table = replace(aircraft.derivatives, values=values)
        uncertain = UncertainDerivatives(*place, np.diag(std**2))
        parts.append(IdentifiedModes(replace(aircraft, derivatives=table), uncertain, None, prior))
    fused = fuse_identified(parts, aircraft)
    assert min(fused.error_ratios) > 5.0
    assert np.sqrt(fused.uncertain.covariance[-1, -1]) == pytest.approx(0.2, rel=1e-6)


def test_a_prior_that_runs_share_counts_once():
    """Fused posteriors are the posterior of all data; the last derivative is in no data."""
    aircraft, rng = flex28(2), np.random.default_rng(3)
    rows, columns = np.array([0, 1, 2]), np.array([0, 0, 2])
    prior = DerivativePrior(
        np.array([0.0, 0.5, 1.0]),
        np.array([[0.0, 0.0, 0.0], [0.0, 4.0, -3.0], [0.0, -3.0, 25.0]]),
        np.zeros(3, dtype=bool),
    )
    truth = np.array([2.0, 0.4, 1.1])
    information, moment, parts = prior.precision.copy(), prior.precision @ prior.mean, []
    for _ in range(5):
        A = rng.normal(size=(30, 3)) * [1.0, 0.3, 0.0]
        own, data = A.T @ A, A.T @ (A @ truth + rng.normal(size=30))
        information, moment = information + own, moment + data
        covariance = np.linalg.inv(own + prior.precision)
        values = aircraft.derivatives.values.copy()
        values[rows, columns] = covariance @ (data + prior.precision @ prior.mean)
        table = replace(aircraft.derivatives, values=values)
        uncertain = UncertainDerivatives(rows, columns, covariance)
        parts.append(IdentifiedModes(replace(aircraft, derivatives=table), uncertain, None, prior))
    fused = fuse_identified(parts, aircraft)
    found = fused.aircraft.derivatives.values[rows, columns]
    np.testing.assert_allclose(found, np.linalg.solve(information, moment), rtol=1e-9)
    ratio = np.diag(fused.uncertain.covariance) / np.diag(np.linalg.inv(information))
    assert 1.0 - 1e-9 < ratio[2] < 1.8, "the prior counts once, widened by Birge's ratio"
    np.testing.assert_allclose(ratio, ratio[2], rtol=1e-9)


def test_a_mode_that_one_run_retained_and_another_estimated_is_fused():
    """The data of both count, and the prior of the first once; the mode is a result."""
    aircraft = flex28(2)
    place = np.array([0, 1]), np.array([0, 0])
    prior = DerivativePrior(np.array([0.0, 0.5]), np.diag([0.0, 4.0]), np.array([False, True]))
    information = [np.array([[3.0, 1.0], [1.0, 2.0]]), np.array([[5.0, -1.0], [-1.0, 4.0]])]
    means, priors = [np.array([1.0, 0.4]), np.array([1.1, 0.3])], [prior, None]
    parts, total, moment = [], np.diag([0.0, 4.0]), np.array([0.0, 2.0])
    for data, mean, own in zip(information, means, priors, strict=True):
        total, moment = total + data, moment + data @ mean
        weight = np.zeros((2, 2)) if own is None else own.precision
        covariance = np.linalg.inv(data + weight)
        values = aircraft.derivatives.values.copy()
        values[place] = covariance @ (data @ mean + weight @ prior.mean)
        table = replace(aircraft.derivatives, values=values)
        uncertain = UncertainDerivatives(*place, covariance)
        parts.append(IdentifiedModes(replace(aircraft, derivatives=table), uncertain, None, own))
    fused = fuse_identified(parts, aircraft)
    np.testing.assert_allclose(
        fused.aircraft.derivatives.values[place], np.linalg.solve(total, moment)
    )
    np.testing.assert_allclose(fused.uncertain.covariance, np.linalg.inv(total))
    assert fused.places == {(0, 0), (1, 0)}


def test_runs_of_different_structures_are_not_fused():
    two, four = flex28(2), flex28(4)
    parts = [IdentifiedModes(a, everything(a, 0.01)) for a in (two, four)]
    with pytest.raises(BadInput, match="same modes"):
        fuse_identified(parts, four)


def test_classical_trackers_extrapolate_what_two_roots_do():
    points = []
    for speed in (42.0, 45.0, 48.0, 51.0, 54.0):
        locus = track_roots(flex28(1), np.array([0.99, 1.0]) * speed)
        roots = dict(zip(locus.names, locus.roots[-1], strict=True))
        points.append(
            Point(speed, 0.5 * 1.0556 * speed**2, complex(roots["7"]), complex(roots["SP"]))
        )
    truth = track_roots(flex28(1), SPEEDS).flutter
    assert truth is not None
    assert extrapolate_flutter_margin(points) == pytest.approx(truth.airspeed, rel=0.05)
    fading = [
        Point(v, v**2, complex(-0.1 * (60.0 - v), 20.0), complex(-5.0, 8.0))
        for v in (40.0, 45.0, 50.0)
    ]
    assert extrapolate_damping(fading) == pytest.approx(60.0)
    for tracker in (extrapolate_damping, extrapolate_flutter_margin, extrapolate_envelope):
        for few in ([], fading[:2], fading[:2] * 2):
            with pytest.raises(NotIdentifiable, match="three"):
                tracker(few)
    with pytest.raises(NotIdentifiable, match="shape parameter"):
        extrapolate_envelope(points[::-1][:3])


def maewing1(kind: str) -> Aeroelastic:
    """The aircraft of the file; rates of eta and CQ_q are per (.)/V there, without c/2."""
    source = json.loads(GERI.read_text())
    c, size, mass = source[f"coefficients_{kind}"], source["geometry"], source["mass"]
    structure = source["modes"]
    omega = np.array(structure["omega_rad_s"])
    n, per_speed = omega.size, 2.0 / size["cbar_ft"]
    table = np.zeros((2 + n, 2 + 2 * n))
    for row, name in enumerate(("CZ", "Cm")):
        etadot = per_speed * np.array(c[f"{name}_etadt_i"])
        table[row] = [c[f"{name}_alpha"], c[f"{name}_q"], *c[f"{name}_eta_i"], *etadot]
    for i in range(n):
        etadot = per_speed * np.array(c["CQ_etadot_i"][i])
        table[2 + i] = [c["CQ_alpha"][i], per_speed * c["CQ_q"][i], *c["CQ_eta_i"][i], *etadot]
    slug, inertia = 14.593903, 1.3558179
    condition = FlightCondition(
        airspeed=23.0,
        density=source["geometry"]["rho"] * 515.378818,
        mass=mass["m_slug"] * slug,
        pitch_inertia=mass["Iyy"] * inertia,
        area=size["S_ft2"] * FOOT**2,
        chord=size["cbar_ft"] * FOOT,
        alpha=size["alpha0_rad"],
    )
    modes = StructuralModes(
        numbers=tuple(range(1, n + 1)),
        omega=omega,
        zeta=np.array(structure["zeta"]),
        mass=np.full(n, structure["generalized_mass"] * inertia),
        points=(),
        translation=np.zeros((0, 3, n)),
        rotation=np.zeros((0, 3, n)),
        gauges=(),
        strain=np.zeros((0, n)),
    )
    return Aeroelastic(condition, modes, DerivativeTable(modes.numbers, (), table))
