"""How fast the estimators are, as ratios measured in one run.

    python backend/benchmarks/estimation.py

prints one JSON line per figure. One BLAS thread, one process.
"""

from __future__ import annotations

import os

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import json
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from baselines import Problem, by_least_squares, toolbox, toolbox_iteration
from scipy.linalg import lapack

from flexsid.demo.aircraft import describe_aircraft
from flexsid.demo.flex28 import INPUTS, Truth, load_truth
from flexsid.records.maneuver import Condition
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment, Parameters, select_parameters
from flexsid.sysid.estimation.frequency_domain_model import FrequencyDomainModel
from flexsid.sysid.estimation.frequency_response_error import frequency_response_error
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import FitSettings, maximize
from flexsid.sysid.estimation.linear_algebra import regress_many
from flexsid.sysid.estimation.noise import compute_group_powers, compute_residual_density
from flexsid.sysid.estimation.nuisance import build_nuisance_prior
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.condition import FlightCondition
from flexsid.sysid.model.derivatives import DerivativeTable, list_derivative_names
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.rigid_body import Mounting, SensorRows, body_axes, stack_rows, strain_row
from flexsid.sysid.model.sensor_models import ACCELEROMETER, STRAIN, load_sensor_models
from flexsid.sysid.modes import StructuralModes
from flexsid.sysid.regression.equation_error import equation_error
from flexsid.sysid.regression.least_squares import regress
from flexsid.sysid.regression.reconstruction import reconstruct_motion
from flexsid.sysid.regression.starting_values import estimate_delays
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.fourier import compute_harmonic_frequencies, finite_fourier_transform
from flexsid.sysid.spectra.response import estimate_bare_airframe_responses
from flexsid.workflow.aircraft.aircraft_models import (
    build_model,
    define_outputs,
    list_default_outputs,
)

Result = TypeVar("Result")
RNG = np.random.default_rng(7)
PERIOD_S = 24.0
N_HARMONICS = 325  # of FTA 506, five inputs
N_OUTPUTS = 20
N_COMBINED = 660  # of a 4T design with ten inputs


def main() -> None:
    """Measure and print everything."""
    truth = load_truth()
    print_fits(truth)
    print_iteration(truth)
    print_growth(truth)
    print_nuisance(truth)
    print_combined(truth)
    print_batch()
    print_fleet(truth)


def print_fits(truth: Truth) -> None:
    problem, table = make_problem(truth, n_modes=4, n_frequencies=65)
    parameters = free_all(problem, problem.start)
    ours, seconds = timed(lambda: fit(problem, parameters), repeat=21)
    plain, toolbox_s = timed(lambda: toolbox(problem), repeat=1)
    scipy_fit, scipy_s = timed(lambda: by_least_squares(problem), repeat=3)
    sigma = np.sqrt(np.diag(ours.covariance))
    report_result(
        "oe_fit_vs_toolbox",
        toolbox_s / seconds,
        "central differences, a solve per frequency, alternating S",
        ours_ms=1e3 * seconds,
        baseline_ms=1e3 * toolbox_s,
        iterations=len(ours.steps) - 1,
        baseline_iterations=plain.iterations,
        parameters=table.values.size,
        largest_difference_sigma=float(np.max(np.abs(ours.values - plain.theta) / sigma)),
    )
    report_result(
        "oe_fit_vs_least_squares",
        scipy_s / seconds,
        "scipy.optimize.least_squares, 2-point, model vectorised over frequencies",
        ours_ms=1e3 * seconds,
        baseline_ms=1e3 * scipy_s,
        largest_difference_sigma=float(np.max(np.abs(ours.values - scipy_fit.theta) / sigma)),
    )


def print_combined(truth: Truth) -> None:
    """Ten independent surfaces: both axes at all harmonics, by the parts of the surfaces."""
    symmetric, _ = make_problem(truth, n_modes=4, n_frequencies=N_COMBINED)
    lateral = make_lateral_problem(truth, symmetric)
    rng = np.random.default_rng(3)
    start = lateral.derivatives * (1.0 + 0.4 * rng.uniform(-1, 1, lateral.derivatives.shape))
    table = DerivativeTable(lateral.model.modes.numbers, lateral.model.inputs, start, LATERAL)
    free = select_parameters(table, None, lateral.model.outputs)
    _, five_s = timed(lambda: fit(symmetric, free_all(symmetric, symmetric.start)), repeat=7)
    both, ten_s = timed(
        lambda: (
            fit(symmetric, free_all(symmetric, symmetric.start)),
            maximize([lateral.experiment], free, FitSettings()),
        ),
        repeat=7,
    )
    report_result(
        "ten_inputs_vs_five",
        ten_s / five_s,
        "output error of five symmetric inputs at as many frequencies",
        combined_ms=1e3 * ten_s,
        baseline_ms=1e3 * five_s,
        iterations=[len(one.steps) - 1 for one in both],
        parameters=[one.values.size for one in both],
    )


def print_iteration(truth: Truth) -> None:
    problem, table = make_problem(truth, n_modes=4, n_frequencies=650)
    step = gauss_newton_step(problem)
    _, seconds = timed(step, repeat=21)
    _, toolbox_s = timed(lambda: toolbox_iteration(problem, problem.start), repeat=1)
    report_result(
        "gn_iteration_vs_toolbox",
        toolbox_s / seconds,
        "one Gauss-Newton iteration, central differences, a solve per frequency",
        ours_ms=1e3 * seconds,
        baseline_ms=1e3 * toolbox_s,
        parameters=table.values.size,
    )


def print_growth(truth: Truth) -> None:
    """Exponents of the time of one iteration in modes, frequencies and outputs."""
    exponents = {}
    for name, values in (
        ("modes", (2, 4, 8)),
        ("frequencies", (65, 260, 1040)),
        ("outputs", (6, 12, 24)),
    ):
        times = []
        for value in values:
            problem, _ = make_problem(
                truth,
                n_modes=value if name == "modes" else 4,
                n_frequencies=value if name == "frequencies" else 260,
                n_outputs=value if name == "outputs" else N_OUTPUTS,
            )
            times.append(timed(gauss_newton_step(problem), repeat=15)[1])
        exponents[name] = float(np.polyfit(np.log(values), np.log(times), 1)[0])
    report_result("oe_iteration_growth", max(exponents.values()), "exponent of time", **exponents)


def print_nuisance(truth: Truth) -> None:
    """Output error of eight modes, four of them as nuisance, against four modes alone."""
    whole, table = make_problem(truth, n_modes=8, n_frequencies=N_HARMONICS)
    predicted = 0.8 * table.values
    prior = build_nuisance_prior(
        table.modes, table.inputs, DerivativeTable(table.modes, table.inputs, predicted).named()
    )
    bare = replace(
        whole,
        model=make_model(truth, 4, N_OUTPUTS),
        start=0.8 * truth.derivatives_at(0.5, 4).values.ravel(),
    )
    own = set(list_derivative_names(table.modes[:4], table.inputs))
    nuisance = tuple(name for name in table.named() if name not in own)
    settings = FitSettings(priors=prior.list_priors(nuisance, 0.3))
    parameters = free_all(whole, predicted.ravel())
    fitted, seconds = timed(lambda: maximize([as_experiment(whole)], parameters, settings), 5)
    alone = free_all(bare, bare.start)
    omitted, bare_s = timed(lambda: fit(bare, alone), 5)
    report_result(
        "nuisance_vs_bare",
        seconds / bare_s,
        "output error of four modes alone",
        ours_ms=1e3 * seconds,
        baseline_ms=1e3 * bare_s,
        parameters=len(fitted.names),
        iterations=len(fitted.steps),
        baseline_iterations=len(omitted.steps),
    )


def print_batch() -> None:
    n_maneuvers, n_frequencies, n_terms, n_coefficients = 1000, 65, 15, 6
    shape = (n_maneuvers, n_frequencies, n_terms)
    X = RNG.normal(size=shape) + 1j * RNG.normal(size=shape)
    theta = RNG.normal(size=(n_maneuvers, n_terms, n_coefficients))
    z = X @ theta + 0.01 * RNG.normal(size=(n_maneuvers, n_frequencies, n_coefficients))
    names = tuple(f"C_{k}" for k in range(n_terms))

    def one_by_one() -> np.ndarray:
        return np.array(
            [
                [regress(X[m], z[m, :, c], names).values for c in range(n_coefficients)]
                for m in range(n_maneuvers)
            ]
        )

    (batched, _), seconds = timed(lambda: regress_many(X, z), repeat=7)
    looped, loop_s = timed(one_by_one, repeat=1)
    report_result(
        "ee_batched_vs_loop",
        loop_s / seconds,
        "the same regressions, one maneuver and coefficient at a time",
        maneuvers_per_s=n_maneuvers / seconds,
        largest_difference=float(np.max(np.abs(batched - looped))),
    )


def print_fleet(truth: Truth) -> None:
    """Transform, EE start, OE with delays, FRE over a sample of maneuvers."""
    sample = [make_record(truth, seed) for seed in range(20)]
    _, seconds = timed(lambda: [estimate_record(*record) for record in sample], repeat=1)
    per_maneuver = seconds / len(sample)
    alone = []
    for seed in range(5):
        problem, _ = make_problem(truth, n_modes=4, n_frequencies=N_HARMONICS, seed=seed)
        alone.append(timed(lambda p=problem: toolbox(p), repeat=1)[1])
    report_result(
        "fleet_vs_toolbox",
        statistics.mean(alone) / per_maneuver,
        "toolbox output error alone, without transform, delays and FRE, on five maneuvers",
        seconds_per_1000=1000.0 * per_maneuver,
        baseline_seconds_per_1000=1000.0 * statistics.mean(alone),
    )


def gauss_newton_step(problem: Problem) -> Callable[[], np.ndarray]:
    """One iteration as the maximisation does it: response, weights, normal matrix, step."""
    parameters = free_all(problem, problem.start)
    experiment = as_experiment(problem)
    model = FrequencyDomainModel(experiment, parameters)
    form = NormalForm(model)
    powers = compute_group_powers(experiment.measured, experiment.group, 1)

    def step() -> np.ndarray:
        response = model.respond(problem.start)
        nu = experiment.measured - response.outputs
        S, _ = compute_residual_density(nu, powers, experiment.group, "diagonal")
        sensitivity = model.sensitivity(problem.start, response)
        N, g = form.equations(sensitivity, nu, S.inverse())
        return lapack.dposv(N, g)[1]

    return step


def make_model(truth: Truth, n_modes: int, n_outputs: int) -> AeroelasticModel:
    """FLEX-28 at 0.65 V_f, half fuel, with its instruments' delays left to the data."""
    aircraft = describe_aircraft(truth)
    fuel = 0.5
    c = truth.condition_at(0.65 * truth.flutter_speed_at(fuel), fuel)
    condition = Condition(
        airspeed_m_s=c.airspeed,
        density_kg_m3=c.density,
        fuel_fraction=fuel,
        mass_kg=c.mass,
        pitch_inertia_kg_m2=c.pitch_inertia,
        x_cg_m=c.x_cg,
        z_cg_m=c.z_cg,
        alpha_rad=c.alpha,
        thrust_n=c.thrust,
    )
    names = list_default_outputs(aircraft, [s.name for s in aircraft.sensors])[:n_outputs]
    outputs = define_outputs(aircraft, names)
    modes = truth.modes_at(fuel, n_modes)
    return build_model(aircraft, condition, modes, INPUTS, outputs)


def make_problem(
    truth: Truth, n_modes: int, n_frequencies: int, n_outputs: int = N_OUTPUTS, seed: int = 7
) -> tuple[Problem, DerivativeTable]:
    """Lines of a maneuver with 1 % noise; the start is off by up to 40 %."""
    rng = np.random.default_rng(seed)
    model = make_model(truth, n_modes, n_outputs)
    table = truth.derivatives_at(0.5, n_modes)
    omega = 2.0 * np.pi * np.linspace(0.25, 13.75, n_frequencies)
    u = rng.normal(size=(n_frequencies, 5)) + 1j * rng.normal(size=(n_frequencies, 5))
    sensor = Problem(
        model,
        omega,
        u,
        np.empty((n_frequencies, n_outputs), dtype=complex),
        natural_frequency=rng.uniform(400.0, 900.0, n_outputs),
        damping=np.full(n_outputs, 0.7),
        delay_s=rng.uniform(0.004, 0.02, n_outputs),
        start=table.values.ravel() * (1.0 + 0.4 * rng.uniform(-1, 1, table.values.size)),
    )
    y = (model.response(table, omega) @ u[:, :, None])[:, :, 0]
    y = y * sensor.instrument(1j * omega[:, None])
    scatter = rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)
    z = y + 0.01 * np.sqrt(np.mean(np.abs(y) ** 2, axis=0)) * scatter / np.sqrt(2.0)
    return replace(sensor, measured=z), table


@dataclass(frozen=True)
class LateralProblem:
    """Lateral half of a maneuver with ten surfaces, and its true derivatives."""

    model: AeroelasticModel
    derivatives: np.ndarray
    experiment: Experiment


def make_lateral_problem(truth: Truth, symmetric: Problem) -> LateralProblem:
    """Antisymmetric modes with drawn derivatives and outputs, at the same frequencies."""
    rng = np.random.default_rng(11)
    numbers = tuple(n for n in truth.modes.numbers if n not in truth.symmetric)[:4]
    modes, omega = truth.modes.at(0.5).select(numbers), symmetric.omega
    condition = symmetric.model.condition
    inertia = condition.pitch_inertia
    condition = replace(
        condition,
        span=truth.span,
        roll_inertia=4.0 * inertia,
        yaw_inertia=5.0 * inertia,
        product_of_inertia=0.1 * inertia,
    )
    sensors = place_lateral_sensors(truth, modes, condition)
    names = sensors.names
    model = AeroelasticModel(condition, modes, INPUTS, sensors, LATERAL)
    values = 0.02 * rng.normal(size=(len(model.coefficients), len(model.variables)))
    values[:3, :3] = ((-0.22, -0.11, 0.08), (-0.08, -0.53, 0.05), (0.024, -0.023, -0.016))
    # Forces on the modes are as those of the symmetric ones.
    values[3:, 3:] = truth.derivatives_at(0.5, len(numbers)).values[2:, 2:]
    table = DerivativeTable(numbers, INPUTS, values, LATERAL)
    u = symmetric.inputs[::-1]
    y = (model.response(table, omega) @ u[:, :, None])[:, :, 0]
    scatter = rng.normal(size=y.shape) + 1j * rng.normal(size=y.shape)
    z = y + 0.01 * np.sqrt(np.mean(np.abs(y) ** 2, axis=0)) * scatter / np.sqrt(2.0)
    spectra = FrequencyData(omega, u, INPUTS), FrequencyData(omega, z, names)
    experiment = output_error(model, *spectra, np.ones_like(z))
    return LateralProblem(model, values, experiment)


def place_lateral_sensors(
    truth: Truth, modes: StructuralModes, condition: FlightCondition
) -> SensorRows:
    """Rates, bank angle, sideslip and lateral acceleration, and the sensors of the right wing."""
    rows = {}
    no_strain = np.zeros(len(modes.numbers))
    at = modes.points.index("egi")
    mounting = Mounting((0.0, 0.0, 0.0), modes.translation[at], modes.rotation[at], no_strain)
    for kind, model in sorted(load_sensor_models().items()):
        for axis in (axis for axis in "xyz" if model.measures_rigid_body(axis, LATERAL)):
            rows[f"{kind} {axis}"] = model.build_row(axis, LATERAL, mounting, condition)
    right = (s for s in describe_aircraft(truth).sensors if s.name.partition("_m")[0][-1] == "r")
    for sensor in right:
        if sensor.kind == STRAIN.kind:
            strain = modes.strain[modes.gauges.index(sensor.point)]
            rows[sensor.name] = strain_row(strain, LATERAL.size)
        elif sensor.axis == "z":
            at = modes.points.index(sensor.point)
            place = body_axes(sensor.location_m, condition)
            mounting = Mounting(place, modes.translation[at], modes.rotation[at], no_strain)
            rows[sensor.name] = ACCELEROMETER.build_row("z", LATERAL, mounting, condition)
    return stack_rows(list(rows)[:N_OUTPUTS], list(rows.values())[:N_OUTPUTS])


def free_all(problem: Problem, start: np.ndarray, extras: tuple[str, ...] = ()) -> Parameters:
    """All derivatives free."""
    model = problem.model
    values = start.reshape(2 + len(model.modes.numbers), -1)
    table = DerivativeTable(model.modes.numbers, model.inputs, values)
    return select_parameters(table, None, model.outputs, extras)


def as_experiment(problem: Problem) -> Experiment:
    """The problem as our estimator takes it."""
    return output_error(
        problem.model,
        FrequencyData(problem.omega, problem.inputs, problem.model.inputs),
        FrequencyData(problem.omega, problem.measured, problem.model.outputs),
        problem.instrument(1j * problem.omega[:, None]),
    )


def fit(problem: Problem, parameters: Parameters) -> Estimate:
    """Our output error."""
    return maximize([as_experiment(problem)], parameters, FitSettings())


def make_record(truth: Truth, seed: int) -> tuple[Any, ...]:
    """A periodic record in time: inputs, outputs, commands, and what to fit."""
    rng = np.random.default_rng(seed)
    model = make_model(truth, 4, N_OUTPUTS)
    table = truth.derivatives_at(0.5, 4)
    harmonics = 6 + np.arange(N_HARMONICS)
    omega = compute_harmonic_frequencies(harmonics, PERIOD_S)
    assigned_input = np.arange(harmonics.size) % 5
    rate = 200.0
    n = round(rate * PERIOD_S)
    command = np.zeros((harmonics.size, 5), dtype=complex)
    phases = np.exp(2j * np.pi * rng.uniform(size=harmonics.size))
    command[np.arange(harmonics.size), assigned_input] = 0.05 * phases
    mixing = np.eye(5) + 0.05 * rng.normal(size=(5, 5))
    u = command @ mixing.T
    delays = rng.uniform(0.0, 0.02, N_OUTPUTS)
    y = (model.response(table, omega) @ u[:, :, None])[:, :, 0]
    y = y * np.exp(-1j * np.outer(omega, delays))

    def in_time(spectrum: np.ndarray) -> np.ndarray:
        full = np.zeros((n // 2 + 1, spectrum.shape[1]), dtype=complex)
        full[harmonics] = spectrum * rate
        return np.fft.irfft(full, n=n, axis=0)

    outputs = in_time(y)
    outputs += 0.02 * outputs.std(axis=0) * rng.normal(size=outputs.shape)
    return model, table, omega, assigned_input, rate, in_time(u), outputs, in_time(command)


def estimate_record(
    model: AeroelasticModel,
    table: DerivativeTable,
    omega: np.ndarray,
    assigned_input: np.ndarray,
    rate: float,
    inputs: np.ndarray,
    outputs: np.ndarray,
    commands: np.ndarray,
) -> tuple[Estimate, Estimate]:
    """Everything an analyst asks of one maneuver."""
    both = finite_fourier_transform(
        np.concatenate([inputs, outputs, commands], axis=1), rate, omega
    )
    u = FrequencyData(omega, both[:, :5], model.inputs)
    z = FrequencyData(omega, both[:, 5:-5], model.outputs)
    r = FrequencyData(omega, both[:, -5:], model.inputs)
    through = np.ones_like(z.values)
    start = select_parameters(table, None, model.outputs)
    found = estimate_delays(model, u, z, through)
    sensed = np.exp(-1j * np.outer(omega, found))
    motion = reconstruct_motion(model, z, sensed)
    ee = equation_error(model, motion, u, start)
    names = tuple(f"delay_{name}" for name in model.outputs)
    warm = select_parameters(start.table(ee.values), None, model.outputs, names)
    warm = replace(warm, start=np.concatenate([ee.values, found]))
    oe = maximize([output_error(model, u, z, through)], warm)
    delayed = np.exp(-1j * np.outer(omega, oe.values[-N_OUTPUTS:]))
    undelayed = replace(z, values=z.values / delayed)
    responses = estimate_bare_airframe_responses(u, undelayed, r, assigned_input)
    again = select_parameters(warm.table(oe.values), None, model.outputs)
    fre = maximize([frequency_response_error(model, responses)], again)
    return oe, fre


def timed(call: Callable[[], Result], repeat: int) -> tuple[Result, float]:
    """Result and median CPU seconds."""
    times, results = [], []
    for _ in range(repeat):
        began = time.process_time()
        results.append(call())
        times.append(time.process_time() - began)
    return results[-1], statistics.median(times)


def report_result(name: str, ratio: float, baseline: str, **more: object) -> None:
    """One JSON line."""
    rounded = {k: float(f"{v:.4g}") if isinstance(v, float) else v for k, v in more.items()}
    print(
        json.dumps({"name": name, "ratio": float(f"{ratio:.4g}"), "baseline": baseline, **rounded})
    )


if __name__ == "__main__":
    main()
