"""Tests of an identified model for remaining model error, from its residuals and without a refit.

Score (Lagrange multiplier) tests ask whether the likelihood would increase if a quantity that
is held were free: the delay of a channel, the scale factor of a sensor, a lag of the
aerodynamic forces, a derivative, or a further mode. The residual-response test asks whether
residuals are a smooth response to the inputs, whatever its cause, the test of residual power
whether they exceed the noise measured in a band, that of consistency whether the estimate
changes without a sensor by more than noise. Holm's method limits the
probability that any test of a fit rejects a correct model.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from jaxtyping import Bool, Complex, Float
from scipy import linalg, sparse, special

from flexsid.errors import NotIdentifiable
from flexsid.sysid.adequacy.sensor_influence import SensorInfluence, compute_sensor_influences
from flexsid.sysid.adequacy.several_tests import adjust_by_holm
from flexsid.sysid.estimation import noise
from flexsid.sysid.estimation.covariance import (
    FinalSpectra,
    compute_leverage,
    compute_own_covariances,
    estimate_noise,
    weight_score_noise,
)
from flexsid.sysid.estimation.experiment import Experiment, Parameters
from flexsid.sysid.estimation.frequency_domain_model import (
    FactoredModel,
    FrequencyDomainModel,
    ModelResponse,
    Sensitivity,
    expand_sensitivity,
)
from flexsid.sysid.estimation.kronecker import NormalForm
from flexsid.sysid.estimation.likelihood import build_prior
from flexsid.sysid.estimation.maneuver_data import ManeuverData
from flexsid.sysid.estimation.noise import compute_band_powers
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.regression.equation_error import build_regressors
from flexsid.sysid.regression.joint_equation_error import reconstruct_with_out_of_band_modes
from flexsid.sysid.signals import FrequencyData

FALSE_ALARM_RATE = 0.05
"""Probability that any test of a fit rejects a correct model."""

_INDEPENDENT_SHARE = 2.0 / 3.0
"""Independent tests over all tests but those of residual power, from Monte Carlo with FLEX-28.

The smallest p times the number of tests is below 0.069 to 0.096 in 5 % of the fits, for white and
coloured noise, noise on the surfaces, 1 to 3 modes, 10 to 20 outputs, 100 to 325 frequencies.
Residual powers are of the noise of one output in one band, independent of all others."""

_INDEPENDENT_SYMMETRY_SHARE = 0.85
"""The same for tests of symmetry: of 600 flights of a symmetric aircraft, 5 % are below 0.059."""

_LEAST_INFORMATION = 1e-6  # of a held quantity, left by the free ones: not identifiable below
_RIDGE = 1e-10  # of unit diagonal: nearly dependent normal equations stay solvable
_RELATIVE_WIDTH = 0.05  # of the frequency: width of the smooth responses that are sought
_NEGLIGIBLE = 0.01  # weight or correlation of two frequencies
_NO_SKEW = 1e-4  # the normal distribution differs by less than 1e-4 of a standard deviation
_LEAST_WEIGHT = 0.2  # of two frequencies, for the effect of the fit
_PAIRS_AT_ONCE = 2000  # of frequencies, by memory
_RELATIVE_FLOOR = 1e-20  # of the measured power: weights of noise-free data stay finite
_FURTHER_STEPS = 8  # to the efficient estimate, after the first
_SMALL_STEP = 0.2  # standard errors that end them
_LEAST_FREQUENCIES = 20  # for a variance from the residuals


class Hypothesis(StrEnum):
    """Model error that a test seeks."""

    OUTPUT_DELAY = "output delay"
    OUTPUT_SCALE = "scale factor"
    INPUT_DELAY = "input delay"
    AERODYNAMIC_LAG = "aerodynamic lag"
    DERIVATIVE = "held derivative"
    FURTHER_MODE = "further mode"
    RESIDUAL_RESPONSE = "residual response"
    RESIDUAL_POWER = "residual power"
    SENSOR_CONSISTENCY = "sensor consistency"
    REGRESSOR_NOISE = "noise of the regressors"
    SURFACE_EFFECTIVENESS = "surface effectiveness"
    CROSS_DERIVATIVE = "cross derivative"
    CROSS_RESPONSE = "cross response"


SYMMETRY_HYPOTHESES = frozenset(
    {
        Hypothesis.SURFACE_EFFECTIVENESS,
        Hypothesis.CROSS_DERIVATIVE,
        Hypothesis.CROSS_RESPONSE,
    }
)
"""Hypotheses of an asymmetry of aircraft or flight; the others are errors of one axis."""


@dataclass(frozen=True, slots=True)
class ModelTest:
    """One test of a fit.

    ``subject`` is the output, input, derivative or mode. ``statistic`` is chi-square with
    ``degrees_of_freedom`` for a correct model and many frequencies; that of a residual response
    is in standard deviations, without degrees of freedom. ``p`` is the probability of a larger
    one, ``adjusted_p`` that in any test of the fit (Holm). ``estimate`` is the change of the
    held quantity after one Gauss-Newton step (delays in s, scale factors relative, lag in
    s), of a residual power its ratio to the noise, ``frequency_hz`` where a residual response is
    largest. The statistic of a sensor's consistency is the largest change of a parameter without
    it, in standard deviations; ``influence`` has all changes. ``explained`` is the share of the
    weighted power of all residuals that the held quantity would remove; zero of other tests.
    """

    hypothesis: Hypothesis
    subject: str
    statistic: float
    degrees_of_freedom: int
    p: float
    adjusted_p: float = 1.0
    estimate: float | None = None
    frequency_hz: float | None = None
    influence: SensorInfluence | None = None
    explained: float = 0.0

    @property
    def rejects(self) -> bool:
        """Whether the model is rejected at the false-alarm rate of the fit."""
        return self.adjusted_p < FALSE_ALARM_RATE


@dataclass(frozen=True, slots=True)
class OpposedMotion:
    """Motion and surfaces of the other axis in a maneuver of both, at the same frequencies.

    A symmetric aircraft has no response to it in this axis. ``variables`` are its nondimensional
    motions, rates and inputs [s], ``pairs`` by input of this axis that of the other with the same
    surfaces.
    """

    variables: FrequencyData
    pairs: Mapping[str, str]

    @property
    def inputs(self) -> Complex[np.ndarray, "n_omega n_u"]:
        """Inputs of the other axis."""
        return self.variables.pick(tuple(self.pairs.values())).values


def reconstruct_opposed_motion(data: ManeuverData) -> OpposedMotion | None:
    """Reconstruct the motion of the other axis; only its inputs without enough sensors."""
    other = data.opposed
    if other is None:
        return None
    inputs = other.measured.inputs
    try:
        motion, _ = reconstruct_with_out_of_band_modes(other)
    except NotIdentifiable:
        variables = inputs
    else:
        regressors = build_regressors(other.model, motion, inputs)
        variables = FrequencyData(inputs.omega, regressors, other.model.variables)
    return OpposedMotion(variables, data.pairs)


def select_causes(tests: Sequence[ModelTest], n_outputs: int) -> list[ModelTest]:
    """Select the rejecting tests of held quantities that explain most of the residuals.

    At least half of the residuals of one output, and half of what the first cause explains.
    """
    found = sorted((test for test in tests if test.rejects), key=lambda test: -test.explained)
    if not found:
        return []
    least = max(0.5 / n_outputs, 0.5 * found[0].explained)
    return [test for test in found if test.explained >= least]


def compute_model_tests(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    priors: Mapping[str, tuple[float, float]] | None = None,
    *,
    extended_models: Sequence[AeroelasticModel] = (),
    opposed_motions: Sequence[OpposedMotion | None] = (),
    overlap: float = 1.0,
    nuisance: Set[str] = frozenset(),
    std_errors: Float[np.ndarray, " n_theta"] | None = None,
) -> tuple[ModelTest, ...]:
    """Test a fit for remaining model error.

    Parameters
    ----------
    experiments, parameters
        Data and free parameters of the fit.
    theta
        Estimate.
    priors
        Mean and standard deviation by parameter, of the fit.
    extended_models
        Models of the experiments with further modes after their own; none by default.
    opposed_motions
        Motion of the other axis in the experiments; none by default. Each of its variables
        could have a derivative in this axis, each surface be more effective on one side.
    overlap
        Frequencies per resolution 1/T of the record, at least one.
    nuisance
        Names of parameters that are no results; sensors need not agree on them.
    std_errors
        Of an estimate by another method than output error, to test by how far it differs from it;
        None for output error.

    Returns
    -------
    tuple of ModelTest
        Smallest p first; empty where there are too few frequencies. Quantities that free
        parameters replace (as scale factors of inputs with free control derivatives) have no
        test. Holm's method holds for the tests of symmetry and for the others, each by itself.

    Notes
    -----
    With J the sensitivities to the free parameters, D those to the held quantity, W the
    weights and N = Re sum J^H W J + P with the prior information P, the efficient sensitivity
    is D' = D - J N^-1 Re sum J^H W D. W is diagonal, from the residuals at neighbouring
    frequencies: with the fit's own weights, one for each output, parameter errors due to noise at
    some frequencies would be seen at others. The score is s = Re sum D^H W nu - D^H W J N^-1 g,
    with the gradient g of the fit with these weights and the prior; its covariance
    V = 1/2 Re sum D'^H W S W D' has S from neighbouring leave-one-out residuals, so that it
    also holds for noise that is correlated between outputs, as that on the inputs. s^T V^-1 s
    is chi-square; its quantiles are those of F with the number of residuals that V is
    computed from. The errors of the priors, which are in g, add 1/2 L^T P L to V, with
    L = N^-1 Re sum J^H W D.
    Sources: Rao (1948), Large sample tests of statistical hypotheses; Neyman (1959), C(alpha);
    White (1980) for V; Holm (1979), A simple sequentially rejective multiple test procedure.
    """
    n_data = sum(2 * e.measured.size for e in experiments)
    n_omega = sum(e.omega.size for e in experiments)
    if n_omega < _LEAST_FREQUENCIES or n_data <= theta.size:
        return ()
    inflation = n_data / (n_data - theta.size)
    fits = [
        _Fit(
            *evaluate_fit(experiment, parameters, theta, inflation),
            parameters.table(theta),
            extended,
            opposed,
        )
        for experiment, extended, opposed in zip(
            experiments,
            extended_models or [None] * len(experiments),
            opposed_motions or [None] * len(experiments),
            strict=True,
        )
    ]
    n_theta = theta.size
    joint = np.sum([fit.compute_information() for fit in fits], axis=0)
    gradient = np.sum([fit.compute_gradient() for fit in fits], axis=0)
    mean, information = build_prior(parameters, priors)
    inverse = invert_information(joint[:n_theta, :n_theta] + information)
    g = gradient[:n_theta] + information @ (mean - theta)
    lever = inverse @ joint[:n_theta, n_theta:]
    # Columns of efficient sensitivities, in those to all quantities.
    efficient = np.concatenate([-lever, np.eye(lever.shape[1])])
    scores = _Scores(
        score=gradient[n_theta:] - lever.T @ g,
        total=np.diag(joint)[n_theta:],
        left=joint[n_theta:, n_theta:] - joint[:n_theta, n_theta:].T @ lever,
        power=sum(fit.compute_power() for fit in fits),
        covariance=0.5
        * (
            overlap * np.sum([fit.compute_noise(efficient, inverse) for fit in fits], axis=0)
            + lever.T @ information @ lever
        ),
        residual_df=2.0 * (n_omega - n_theta / experiments[0].measured.shape[1]),
    )
    step = inverse @ g
    tests = [
        *_test_scores(fits[0].held, scores),
        *_test_residual_responses(Hypothesis.RESIDUAL_RESPONSE, fits, inverse, step),
    ]
    tests += _test_residual_powers(fits, inverse, step)
    influences = compute_sensor_influences(
        [fit.final for fit in fits],
        information,
        information @ (mean - theta),
        np.array([k for k, name in enumerate(parameters.names) if name not in nuisance]),
        overlap=overlap,
        residual_df=scores.residual_df,
        inverse=inverse,
    )
    tests += [
        ModelTest(Hypothesis.SENSOR_CONSISTENCY, one.output, one.z, 0, one.p, influence=one)
        for one in influences
    ]
    if all(fit.opposed is not None for fit in fits):
        tests += _test_residual_responses(Hypothesis.CROSS_RESPONSE, fits, inverse, step)
    of_symmetry = [test for test in tests if test.hypothesis in SYMMETRY_HYPOTHESES]
    others = [test for test in tests if test.hypothesis not in SYMMETRY_HYPOTHESES]
    against_efficient = []
    if std_errors is not None and np.isfinite(std_errors).all():
        further = _step_to_efficient(
            experiments, parameters, theta + step, (mean, information), inflation
        )
        if further is not None:
            efficient_std = np.sqrt(0.5 * overlap * np.diag(further[1]))
            results = np.array([name not in nuisance for name in parameters.names])
            against_efficient = [
                _test_against_efficient(
                    parameters, step + further[0], std_errors, efficient_std, results
                )
            ]
    return (
        *_adjust_by_holm(others, _INDEPENDENT_SHARE),
        *_adjust_by_holm(of_symmetry, _INDEPENDENT_SYMMETRY_SHARE),
        *against_efficient,
    )


def _step_to_efficient(
    experiments: Sequence[Experiment],
    parameters: Parameters,
    theta: Float[np.ndarray, " n_theta"],
    prior: tuple[Float[np.ndarray, " n_theta"], Float[np.ndarray, "n_theta n_theta"]],
    inflation: float,
) -> tuple[Float[np.ndarray, " n_theta"], Float[np.ndarray, "n_theta n_theta"]] | None:
    """Step on to the efficient estimate, by its own weights; return the inverse, too.

    Where the noise of the regressors biases an estimate, its residuals contain the bias: weights
    from them give the sensors less than their due, and the first step is too short. None where the
    steps do not become small: they then lead to no estimate.
    """
    mean, information = prior
    value = theta
    for _ in range(_FURTHER_STEPS):
        N, g = information, information @ (mean - value)
        for experiment in experiments:
            final, _ = evaluate_fit(experiment, parameters, value, inflation)
            own, gradient = final.form.equations(final.sensitivity, final.residuals, final.weights)
            N, g = N + own, g + gradient
        inverse = invert_information(N)
        step = inverse @ g
        value = value + step
        if np.all(np.abs(step) < _SMALL_STEP * np.sqrt(np.diag(inverse))):
            return value - theta, inverse
    return None


def _test_against_efficient(
    parameters: Parameters,
    step: np.ndarray,
    std_errors: np.ndarray,
    efficient_std: np.ndarray,
    results: Bool[np.ndarray, " n_theta"],
) -> ModelTest:
    """Test how far an estimate is from the efficient one, by the steps towards it.

    Notes
    -----
    Without noise in its regressors equation error is consistent, and its difference from the
    efficient estimate has the difference of the variances: Hausman (1978), Specification tests in
    econometrics, Econometrica 46. It is a test of the method, not of the model, by itself. Errors
    of both are known to a tenth and not always nested, where their difference says nothing: with
    the larger variance, of which the difference is a part, it rejects less often than stated.
    Parameters that are no results are not compared: equation error holds some of them.
    """
    z = np.where(results, step / np.maximum(std_errors, efficient_std), 0.0)
    k = int(np.argmax(np.abs(z)))
    p = min(1.0, 2.0 * int(np.count_nonzero(results)) * float(special.ndtr(-abs(z[k]))))
    return ModelTest(
        Hypothesis.REGRESSOR_NOISE,
        parameters.names[k],
        float(z[k]),
        0,
        p,
        adjusted_p=p,
        estimate=float(step[k]),
    )


def evaluate_fit(
    experiment: Experiment, parameters: Parameters, theta: np.ndarray, inflation: float
) -> tuple[FinalSpectra, ModelResponse]:
    """Compute residuals, their weights and the sensitivities at the estimate."""
    model = FrequencyDomainModel(experiment, parameters)
    response = model.respond(theta)
    residuals = experiment.measured - response.outputs
    smooth = noise.smooth_density(residuals, experiment.group, len(experiment.group_names))
    density = np.real(np.einsum("bii->bi", smooth.blocks)) * inflation
    floor = _RELATIVE_FLOOR * np.mean(np.abs(experiment.measured) ** 2, axis=0)
    weights = noise.SpectralMatrix(1.0 / np.maximum(density, floor), smooth.block)
    sensitivity = model.sensitivity(theta, response)
    return FinalSpectra(NormalForm(model), sensitivity, residuals, weights), response


def invert_information(N: Float[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Invert a normal matrix; nearly dependent parameters stay finite.

    Raises
    ------
    LinAlgError
        If it is singular.
    """
    size = np.sqrt(np.maximum(np.diag(N), np.finfo(float).tiny))
    scaled = N / np.outer(size, size)
    scaled[np.diag_indices_from(scaled)] += _RIDGE
    factor = linalg.cho_factor(scaled)
    return linalg.cho_solve(factor, np.eye(len(N))) / np.outer(size, size)


@dataclass(frozen=True, slots=True)
class _Scores:
    """Scores of the held quantities with their covariance.

    ``total`` and ``left`` are their information before and after projection on the free ones,
    ``power`` is the weighted power of the residuals.
    """

    score: Float[np.ndarray, " n_c"]
    total: Float[np.ndarray, " n_c"]
    left: Float[np.ndarray, "n_c n_c"]
    covariance: Float[np.ndarray, "n_c n_c"]
    residual_df: float
    power: float


def _test_scores(held: Sequence[_Held], scores: _Scores) -> Iterator[ModelTest]:
    """Compute the score test of every held quantity that is identifiable."""
    start = 0
    left = np.diag(scores.left)
    for one in held:
        at = np.arange(start, start + len(one.terms))
        start += len(one.terms)
        at = at[left[at] > _LEAST_INFORMATION * scores.total[at]]
        if not at.size:
            continue
        V, s = scores.covariance[np.ix_(at, at)], scores.score[at]
        size = np.sqrt(np.maximum(np.diag(V), np.finfo(float).tiny))
        values, vectors = np.linalg.eigh(V / np.outer(size, size))
        resolved = values > _LEAST_INFORMATION * values[-1]
        statistic = float(np.sum((vectors.T @ (s / size))[resolved] ** 2 / values[resolved]))
        df = int(resolved.sum())
        if np.isfinite(statistic):
            p = float(special.fdtrc(df, max(scores.residual_df, 4.0), statistic / df))
            step = float(s[0] / left[at[0]]) if df == 1 else None
            removed = float(s @ np.linalg.lstsq(scores.left[np.ix_(at, at)], s, rcond=None)[0])
            yield ModelTest(
                one.hypothesis,
                one.subject,
                statistic,
                df,
                p,
                estimate=step,
                explained=removed / scores.power,
            )


@dataclass(frozen=True, slots=True)
class _Held:
    """A held quantity: its terms in the sensitivities; each has one or more columns."""

    hypothesis: Hypothesis
    subject: str
    terms: tuple[tuple[int, ...], ...]


class _Fit:
    """Fit of one experiment with sensitivities to free and to held quantities.

    The forces of further modes are rows, lagged variables are columns of the factored form.
    """

    def __init__(
        self,
        final: FinalSpectra,
        response: ModelResponse,
        table: DerivativeTable,
        extended: AeroelasticModel | None,
        opposed: OpposedMotion | None,
    ) -> None:
        self.final = final
        self.opposed = opposed
        self.held: list[_Held] = []
        model, sensitivity = final.form.model, final.sensitivity
        aeroelastic = model.experiment.model
        n_r = sensitivity.forces.shape[2]
        n_w, n_u = model.columns.size, len(aeroelastic.inputs)
        w = sensitivity.variables
        forces = model.rows[:, None] * table.values * model.columns
        minus_s = -model.s
        first_lag = len(w)
        if model.factors is None:
            load, late_inputs, driving_variables = forces @ w[:n_w], w[n_w - n_u : n_w], []
        else:
            of_rows = w[: n_r * n_w].reshape(n_r, n_w, -1)
            load = np.einsum("ij,ijk->ik", forces, of_rows)
            late_inputs = of_rows[:, n_w - n_u :].reshape(n_r * n_u, -1)
            driving_variables = [response.motion[:, 0], *model.experiment.inputs.T]
        crossing = [] if opposed is None else list(opposed.variables.values.T)
        variables = [
            *w, *(minus_s * load), *(minus_s * late_inputs), *driving_variables, *crossing
        ]  # fmt: skip
        modes = [] if extended is None else list(_list_further_modes(model, extended, response))
        pairs = list(zip(model.pair_rows.tolist(), model.pair_columns.tolist(), strict=True))
        scale = model.scale.tolist()
        held_pairs: list[tuple[Hypothesis, str, list[list[int]]]] = []

        def add(hypothesis: Hypothesis, subject: str, *terms: list[tuple[int, int, float]]) -> None:
            places = []
            for term in terms:
                places.append(list(range(len(pairs), len(pairs) + len(term))))
                pairs.extend((i, j) for i, j, _ in term)
                scale.extend(factor for *_, factor in term)
            held_pairs.append((hypothesis, subject, places))

        lagged = [(i, first_lag + i, 1.0) for i in range(n_r)]
        add(Hypothesis.AERODYNAMIC_LAG, "all forces", lagged)
        for k, name in enumerate(aeroelastic.inputs):
            column, load = first_lag + n_r + k, forces[:, n_w - n_u + k]
            stride = 0 if model.factors is None else n_u
            late = [(i, column + stride * i, float(load[i])) for i in range(n_r)]
            add(Hypothesis.INPUT_DELAY, name, late)
        free = set(pairs[: model.pair_rows.size])
        for i, row in enumerate(aeroelastic.coefficients):
            for j, variable in enumerate(aeroelastic.variables):
                at = j if model.factors is None else i * n_w + j
                if (i, at) not in free:
                    factor = float(model.rows[i] * model.columns[j])
                    add(Hypothesis.DERIVATIVE, f"{row}_{variable}", [(i, at, factor)])
        driving = [0, *range(n_w - n_u, n_w)]
        at = dict(zip(driving, driving, strict=True))
        if model.factors is not None:
            first = len(variables) - len(crossing) - len(driving)
            at = dict(zip(driving, range(first, len(variables)), strict=True))
        for k, (number, _) in enumerate(modes):
            terms = [[(n_r + k, at[j], float(model.columns[j]))] for j in driving]
            add(Hypothesis.FURTHER_MODE, f"mode {number}", *terms)
        if opposed is not None:
            first_crossing = len(variables) - len(crossing)
            crossing_at = {n: first_crossing + k for k, n in enumerate(opposed.variables.names)}
            for i, row in enumerate(aeroelastic.coefficients):
                for name, column in crossing_at.items():
                    factor = float(model.rows[i])
                    add(Hypothesis.CROSS_DERIVATIVE, f"{row}_{name}", [(i, column, factor)])
            for k, name in enumerate(aeroelastic.inputs):
                if name in opposed.pairs:
                    column, load = crossing_at[opposed.pairs[name]], forces[:, n_w - n_u + k]
                    terms = [(i, column, float(load[i])) for i in range(n_r)]
                    add(Hypothesis.SURFACE_EFFECTIVENESS, name, terms)
        own = list(sensitivity.own)
        outputs = model.own_outputs.tolist()
        known = {(e.kind, e.output) for e in model.parameters.extras}
        held_own: list[tuple[Hypothesis, str, int]] = []
        for output, name in enumerate(aeroelastic.outputs):
            y = response.outputs[:, output]
            for kind, hypothesis, row in (
                ("delay", Hypothesis.OUTPUT_DELAY, minus_s * y),
                ("scale", Hypothesis.OUTPUT_SCALE, y),
            ):
                if (kind, output) not in known:
                    held_own.append((hypothesis, name, len(own)))
                    own.append(row)
                    outputs.append(output)
        self.held = [
            *(_Held(h, n, tuple(map(tuple, places))) for h, n, places in held_pairs),
            *(_Held(h, n, ((len(pairs) + k,),)) for h, n, k in held_own),
        ]
        shapes = [shape[:, :, None] for _, shape in modes]
        self.sensitivity = Sensitivity(
            np.concatenate([sensitivity.forces, *shapes], axis=2),
            np.array(variables),
            np.array(own).reshape(len(own), model.s.size),
            sensitivity.ends,
        )
        n_ends = 0 if sensitivity.ends is None else sensitivity.ends.shape[2]
        factored = FactoredModel(
            rows=np.ones(n_r + len(modes)),
            columns=np.ones(len(variables)),
            pair_rows=np.array([i for i, _ in pairs], dtype=int),
            pair_columns=np.array([j for _, j in pairs], dtype=int),
            scale=np.array(scale),
            own_outputs=np.array(outputs, dtype=int),
            order=np.arange(len(pairs) + len(own) + n_ends),
            sensors=self.sensitivity.forces,
            s=model.s,
        )
        self.factored = factored
        self.form = NormalForm(model, factored)
        n_theta = model.order.size
        terms = [places for one in self.held for places in one.terms]
        self.columns = np.zeros((factored.order.size, n_theta + len(terms)))
        n_pairs, n_places = model.pair_rows.size, factored.order.size
        first_held = len(pairs) + n_theta - n_pairs - n_ends
        position = np.r_[:n_pairs, len(pairs) : first_held, n_places - n_ends : n_places]
        self.columns[position, model.order] = 1.0
        for k, places in enumerate(terms, start=n_theta):
            self.columns[list(places), k] = 1.0

    def compute_information(self) -> Float[np.ndarray, "n n"]:
        """Compute Re sum X^H W X of the sensitivities X to free and held quantities."""
        matrix = self.form.matrix(self.sensitivity, self.final.weights)
        return self.columns.T @ matrix @ self.columns

    def compute_power(self) -> float:
        """Compute Re sum nu^H W nu."""
        final = self.final
        return float(np.sum(np.abs(final.residuals) ** 2 * final.weights.expand_blocks()))

    def compute_gradient(self) -> Float[np.ndarray, " n"]:
        """Compute Re sum X^H W nu."""
        final = self.final
        return self.columns.T @ self.form.gradient(self.sensitivity, final.residuals, final.weights)

    def compute_noise(
        self,
        efficient: Float[np.ndarray, "n n_c"],
        inverse: Float[np.ndarray, "n_theta n_theta"],
    ) -> Float[np.ndarray, "n_c n_c"]:
        """Compute Re sum D'^H W S W D' of the efficient sensitivities D' = X efficient."""
        final = self.final
        if not final.shares_noise:
            S = estimate_noise(final.with_leave_one_out_residuals(inverse)).between(final.weights)
            columns = self.columns @ efficient
            return columns.T @ self.form.matrix(self.sensitivity, S) @ columns
        X = expand_sensitivity(self.factored, self.sensitivity)
        n_omega, n_y, n = X.shape
        D = (X.reshape(-1, n) @ (self.columns @ efficient)).reshape(n_omega, n_y, -1)
        A, S = weight_score_noise(final, final.weights.times(D))
        n_c = A.shape[2]
        return np.real(A.reshape(-1, n_c).conj().T @ S.times(A).reshape(-1, n_c))


def _list_further_modes(
    model: FrequencyDomainModel, extended: AeroelasticModel, response: ModelResponse
) -> Iterator[tuple[int, Complex[np.ndarray, "n_omega n_y"]]]:
    """Yield the outputs per unit force on each further mode, without its aerodynamics."""
    n = len(model.experiment.model.modes.numbers)
    sensors = extended.sensors.response(model.experiment.omega)
    instruments = model.experiment.instruments
    if response.delayed is not None:
        instruments = instruments * response.delayed
    factors = extended.row_factors()
    for k in range(n, len(extended.modes.numbers)):
        frequency, damping = extended.modes.omega[k], extended.modes.zeta[k]
        dynamics = model.s**2 + 2.0 * damping * frequency * model.s + frequency**2
        motion = extended.n_rigid + k
        shape = instruments * sensors[:, :, motion] * (factors[motion] / dynamics)[:, None]
        yield extended.modes.numbers[k], shape


def _test_residual_responses(
    hypothesis: Hypothesis,
    fits: Sequence[_Fit],
    inverse: Float[np.ndarray, "n_theta n_theta"],
    step: Float[np.ndarray, " n_theta"],
) -> Iterator[ModelTest]:
    """Test whether the residuals of each output are a smooth response to inputs.

    To the own inputs, or for a cross response to those of the other axis.

    Notes
    -----
    An unmodelled response Delta(omega) u gives residuals nu with nu_k nu_m* about
    |Delta|^2 u_m^H u_k at neighbouring frequencies, noise gives zero. The statistic is
    nu^H M nu with M_km = h((omega_k - omega_m)/b) u_m^H u_k without its diagonal, of residuals
    and inputs over their local size, with a Gaussian h. Its mean is that of the correlation of
    the record's noise and of the fit, -1/2 tr(M J N^-1 J^H) over S; its cumulants are
    (n - 1)! tr(M^n), and its distribution that of Pearson type III.
    Source: Mathai and Provost (1992), Quadratic forms in random variables.
    """
    outputs = fits[0].final.form.model.experiment.model.outputs
    n_y = len(outputs)
    total, mean = np.zeros(n_y), np.zeros(n_y)
    second = third = 0.0
    peaks = np.zeros((n_y, 2))
    for fit in fits:
        final, experiment = fit.final, fit.final.form.model.experiment
        inputs = experiment.inputs
        if hypothesis is Hypothesis.CROSS_RESPONSE and fit.opposed is not None:
            inputs = fit.opposed.inputs
        moved = _compute_change(final, step)
        local = 1.0 / np.sqrt(final.weights.expand_blocks())
        r = (final.residuals - moved) / local
        M = _compute_similarity(experiment, inputs)
        contributions = np.real(r.conj() * (M @ r))
        total += contributions.sum(axis=0)
        mean -= 0.5 * _compute_fit_covariance(final, M, inverse, local)
        C = experiment.noise_correlation()
        MC = M
        if C is not None:
            MC = M @ sparse.csr_array(np.where(np.abs(C) > _NEGLIGIBLE, C, 0.0))
            mean += float(np.real(MC.trace()))
        second += float(np.real((MC * MC.T).sum()))
        third += 2.0 * float(np.real(((MC @ MC) * MC.T).sum()))
        strongest = contributions.argmax(axis=0)
        for output, k in enumerate(strongest.tolist()):
            if contributions[k, output] > peaks[output, 0]:
                peaks[output] = contributions[k, output], experiment.omega[k] / (2.0 * np.pi)
    if not second > 0.0:
        return
    skew = third / second**1.5
    for output, name in enumerate(outputs):
        z = float((total[output] - mean[output]) / np.sqrt(second))
        p = _compute_skewed_tail(z, skew)
        where = float(peaks[output, 1])
        yield ModelTest(hypothesis, name, z, 0, p, frequency_hz=where)


def _compute_skewed_tail(z: float, skew: float) -> float:
    """Compute the probability above z of a Pearson III variable of zero mean and unit variance."""
    if abs(skew) < _NO_SKEW:
        return float(special.ndtr(-z))
    shape, x = 4.0 / skew**2, max(4.0 / skew**2 + 2.0 * z / skew, 0.0)
    tail = special.gammaincc if skew > 0.0 else special.gammainc
    return float(tail(shape, x))


def _test_residual_powers(
    fits: Sequence[_Fit],
    inverse: Float[np.ndarray, "n_theta n_theta"],
    step: Float[np.ndarray, " n_theta"],
) -> Iterator[ModelTest]:
    """Test the power of the residuals of each output in each band against the noise there."""
    for fit in fits:
        final, experiment = fit.final, fit.final.form.model.experiment
        if experiment.source is not None:
            continue  # responses share the noise of the record: their scatter is not its noise
        size = np.sqrt(final.weights.expand_blocks())
        leverage = compute_leverage(final.form.model, final.sensitivity, inverse) * size**2
        residuals = (final.residuals - _compute_change(final, step)) * size
        for one in compute_band_powers(experiment.omega, experiment.inputs, residuals, leverage):
            name = experiment.model.outputs[one.output]
            if len(fits) > 1:
                name = f"{experiment.name} {name}"
            low, high = one.band_hz
            yield ModelTest(
                Hypothesis.RESIDUAL_POWER,
                f"{name}, {low:.3g} to {high:.3g} Hz",
                one.statistic,
                one.degrees_of_freedom,
                one.p,
                estimate=one.ratio,
            )


def _compute_change(
    final: FinalSpectra, step: Float[np.ndarray, " n_theta"]
) -> Complex[np.ndarray, "n_omega n_y"]:
    """Compute the change of the outputs with a small step of the free parameters."""
    model, sensitivity = final.form.model, final.sensitivity
    n_pairs = model.pair_rows.size
    table = np.zeros((sensitivity.forces.shape[2], len(sensitivity.variables)))
    n_single = n_pairs + model.own_outputs.size
    pairs, own, ends = np.split(model.order, [n_pairs, n_single])
    np.add.at(table, (model.pair_rows, model.pair_columns), model.scale * step[pairs])
    load = (table @ sensitivity.variables).T
    change = np.matmul(sensitivity.forces, load[:, :, None])[:, :, 0]
    np.add.at(change.T, model.own_outputs, sensitivity.own * step[own, None])
    return change if sensitivity.ends is None else change + sensitivity.ends @ step[ends]


def _compute_fit_covariance(
    final: FinalSpectra,
    M: sparse.csr_array,
    inverse: Float[np.ndarray, "n_theta n_theta"],
    local: Float[np.ndarray, "n_omega n_y"],
) -> Float[np.ndarray, " n_y"]:
    """Compute tr(M J N^-1 J^H) of every output over its local size.

    Without end states, and only of frequencies that have a weight.
    """
    model, G, w = final.form.model, final.sensitivity.forces, final.sensitivity.variables.T
    n_omega, n_y, n_r = G.shape
    n_w = w.shape[1]
    place = model.pair_rows * n_w + model.pair_columns
    pairs = model.order[: place.size]
    own = inverse[np.ix_(pairs, pairs)] * np.outer(model.scale, model.scale)
    if model.factors is not None:
        by_pair = np.zeros((n_omega, n_r, place.size), dtype=complex)
        by_pair[:, model.pair_rows, np.arange(place.size)] = w[:, model.pair_columns]
        first = by_pair.conj() @ own

        def couple(k: np.ndarray, m: np.ndarray) -> np.ndarray:
            return by_pair[m] @ first[k].transpose(0, 2, 1)

    else:
        C = np.zeros((n_r * n_w, n_r * n_w))
        C[np.ix_(place, place)] = own
        by_column = C.reshape(-1, n_r, n_w).transpose(0, 2, 1).reshape(-1, n_w, n_r)
        once = np.tensordot(w.conj(), by_column, axes=(1, 1)).reshape(n_omega, n_r, n_w, n_r)

        def couple(k: np.ndarray, m: np.ndarray) -> np.ndarray:
            return np.matmul(w[m][:, None, None, :], once[k])[:, :, 0]

    upper = sparse.triu(M, 1).tocoo()
    large = np.abs(upper.data) > _LEAST_WEIGHT
    total = np.zeros(n_y)
    for part in np.array_split(np.flatnonzero(large), 1 + large.sum() // _PAIRS_AT_ONCE):
        k, m = upper.row[part], upper.col[part]
        moved = np.matmul(G[m], couple(k, m))
        values = np.sum(moved * G[k].conj(), axis=2) / (local[k] * local[m])
        total += 2.0 * np.real(upper.data[part] @ values)
    outputs = model.own_outputs
    if outputs.size:
        of_own = compute_own_covariances(model, final.sensitivity, inverse)
        left, right = (part.T / local[:, outputs] for part in (final.sensitivity.own, of_own))
        np.add.at(total, outputs, np.real(np.sum(left.conj() * (M @ right), axis=0)))
    return total


def _compute_similarity(
    experiment: Experiment, inputs: Complex[np.ndarray, "n_omega n_u"]
) -> sparse.csr_array:
    """Compute the weights M of products of residuals at two frequencies by the inputs."""
    size = np.sqrt(np.mean(np.abs(inputs) ** 2, axis=0))
    u = inputs / np.where(size > 0.0, size, 1.0)
    length = np.sqrt(np.sum(np.abs(u) ** 2, axis=1, keepdims=True))
    u = u / np.where(length > 0.0, length, 1.0)
    omega = experiment.omega
    n_u = np.linalg.matrix_rank(u) if experiment.group.max() == 0 else 1
    width = np.maximum(
        _RELATIVE_WIDTH * np.sqrt(np.outer(omega, omega)),
        n_u * np.ptp(omega) / max(omega.size / len(experiment.group_names) - 1, 1),
    )
    near = np.exp(-0.5 * ((omega[:, None] - omega) / width) ** 2)
    np.fill_diagonal(near, 0.0)
    near[near < _NEGLIGIBLE] = 0.0
    return sparse.csr_array(near * (u @ u.conj().T))


def _adjust_by_holm(tests: Sequence[ModelTest], share: float) -> tuple[ModelTest, ...]:
    """Multiply p by the number of independent tests not yet rejected; smallest first.

    All tests of residual power count, but only a share of the others: tests of one output depend
    on each other.
    """
    ordered = sorted(tests, key=lambda test: test.p)
    counts = [1.0 if one.hypothesis is Hypothesis.RESIDUAL_POWER else share for one in ordered]
    adjusted = adjust_by_holm([one.p for one in ordered], counts)
    return tuple(replace(test, adjusted_p=p) for test, p in zip(ordered, adjusted, strict=True))
