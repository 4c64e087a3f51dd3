"""Model adequacy of a run: tests for remaining model error and their meaning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from flexsid.records import finite_or_none
from flexsid.records.run import (
    AdequacyState,
    AdequacyTest,
    EstimateWithoutSensor,
    Method,
    ModelAdequacy,
)
from flexsid.sysid.adequacy.model_tests import (
    SYMMETRY_HYPOTHESES,
    Hypothesis,
    ModelTest,
    compute_model_tests,
    reconstruct_opposed_motion,
    select_causes,
)
from flexsid.sysid.adequacy.sensor_influence import SensorInfluence
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment, Parameters, find_parameters_at_limits
from flexsid.sysid.estimation.leakage import remove_leakage
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.workflow.fits.estimation_task import EstimationTask, build_experiments

_MOST_REASONS = 2
_SIGN = 1.5  # loss of a sensor, relative: it is nearer to the opposite sign than to none
_NOTHING = 0.7  # the same: nearer to none than to half of the signal


def assess_model_adequacy(
    task: EstimationTask,
    experiments: Sequence[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    start: Parameters,
) -> tuple[ModelAdequacy, ModelAdequacy | None]:
    """Test a fit for remaining model error by the residuals of output error at its estimate.

    Where there is no optimum to test, the reason names what is most wrong at ``start``.

    Parameters
    ----------
    task
        The estimation; known modes that are not in its model are tested as further modes.
    experiments
        Data of output error or frequency-response error, after their correction; frequency
        responses are tested where they are of some of the excited inputs only.
    parameters, estimate
        The fit.
    start
        Free parameters at their first start values, those of equation error by default.

    Returns
    -------
    adequacy, symmetry
        Result of the tests, and of those for asymmetry; None where the other axis was not
        excited.
    """
    if not estimate.outcome.is_optimum:
        reason = f"Not tested, since the fit did not converge: {estimate.outcome}."
        return _describe_untested(task, f"{reason}{_name_causes(task, start)}")
    if find_parameters_at_limits(parameters, estimate.values).any():
        reason = "Not tested, since a parameter is at its limit."
        return _describe_untested(task, f"{reason}{_name_causes(task, start)}")
    maneuvers = task.maneuvers
    is_of_record = not fits_some_inputs(task)
    if is_of_record and task.method is not Method.OE:
        # The tests remove the errors of the estimate to first order, whatever the estimator.
        experiments = build_record_experiments(task, parameters, estimate)
    try:
        tests = compute_model_tests(
            experiments,
            parameters,
            estimate.values,
            task.list_priors(),
            extended_models=_list_extended_models(task),
            opposed_motions=[
                reconstruct_opposed_motion(data) if is_of_record else None for data in maneuvers
            ],
            overlap=max(data.measured.resolution_overlap for data in maneuvers),
            nuisance=estimate.nuisance,
            std_errors=estimate.std_errors if task.method is Method.EE else None,
        )
    except np.linalg.LinAlgError:
        return _describe_untested(task, "Not tested, since the information of the fit is singular.")
    if not tests:
        return _describe_untested(task, "Not tested, since the data have too few frequencies.")
    is_shaped, n_outputs = task.settings.aerodynamics.is_shaped, len(task.model.outputs)
    results = estimate.select([n for n in estimate.names if n not in estimate.nuisance])
    influences = [test.influence for test in tests if test.influence is not None]
    of_symmetry = [test for test in tests if test.hypothesis in SYMMETRY_HYPOTHESES]
    others = [test for test in tests if test.hypothesis not in SYMMETRY_HYPOTHESES]
    claim = "for remaining model error rejects the model"
    adequacy = replace(
        _summarize(others, claim, results, n_outputs, is_shaped=is_shaped),
        without_sensors=tuple(_describe_influence(one, results) for one in influences),
    )
    if not of_symmetry:
        return adequacy, None
    claim = "of symmetry indicates an asymmetry"
    return adequacy, _summarize(of_symmetry, claim, results, n_outputs, is_shaped=is_shaped)


def fits_some_inputs(task: EstimationTask) -> bool:
    """Whether frequency responses of some of the excited inputs are fitted.

    The spectra of the record then contain the motion of the others, and are not tested.
    """
    fitted = set(task.model.inputs)
    return task.method is Method.FRE and any(
        not fitted.issuperset(data.measured.excited.inputs.names) for data in task.maneuvers
    )


def build_record_experiments(
    task: EstimationTask, parameters: Parameters, estimate: Estimate
) -> list[Experiment]:
    """Build output error at the estimate of another method."""
    experiments = build_experiments(task, Method.OE)
    if task.corrected and not task.has_steps:
        return experiments  # without the noise of feedback, from whole maneuvers
    return [remove_leakage(one, parameters, estimate.values) for one in experiments]


def _list_extended_models(task: EstimationTask) -> list[AeroelasticModel]:
    models = [data.extended_model for data in task.maneuvers]
    further = min(len(model.modes.numbers) for model in models)
    return [model.with_modes(further) for model in models]


def _name_causes(task: EstimationTask, start: Parameters) -> str:
    """Name what is most wrong at the start values of a fit without an optimum; empty if nothing.

    Notes
    -----
    A score test removes the errors of the free parameters to first order and needs no optimum. The
    end of an iteration that found none is no better point: there the parameters have already
    followed the error. Only large causes are of use: the start is not the truth.
    """
    experiments = build_experiments(task, Method.OE)
    try:
        tests = compute_model_tests(
            experiments,
            start,
            start.start,
            task.list_priors(),
            extended_models=_list_extended_models(task),
            nuisance=task.marginalised,
        )
    except np.linalg.LinAlgError:
        return ""
    is_shaped = task.settings.aerodynamics.is_shaped
    causes = select_causes(tests, len(task.model.outputs))
    meanings = [_state_meaning(test, None, is_shaped) for test in causes[:_MOST_REASONS]]
    return f" At its start values most is wrong with this: {' '.join(meanings)}" if meanings else ""


def _describe_untested(
    task: EstimationTask, reason: str
) -> tuple[ModelAdequacy, ModelAdequacy | None]:
    untested = ModelAdequacy(reason=reason)
    combined = any(one.opposed is not None for one in task.maneuver_tasks)
    return untested, untested if combined else None


def _summarize(
    tests: Sequence[ModelTest],
    claim: str,
    results: Estimate,
    n_outputs: int,
    *,
    is_shaped: bool,
) -> ModelAdequacy:
    """Summarize tests; the claim completes "None of 12 tests ..."."""
    found = tuple(_describe_test(test, results, is_shaped=is_shaped) for test in tests)
    # A cause explains residuals, however small their own p is.
    causes = [found[tests.index(test)] for test in select_causes(tests, n_outputs)]
    rejecting = list(dict.fromkeys([*causes, *(test for test in found if test.rejects)]))
    if not rejecting:
        reason = f"None of {len(found)} tests {claim}."
        return ModelAdequacy(state=AdequacyState.CONSISTENT, reason=reason, tests=found)
    of_sensors = [test for test in found if test.hypothesis == Hypothesis.SENSOR_CONSISTENCY]
    inconsistent = [test for test in of_sensors if test.rejects]
    first = rejecting[:_MOST_REASONS]
    if 2 * len(inconsistent) < len(of_sensors):
        # What a wrong sensor changes in the results is stated, whatever test has the smallest p;
        # where most sensors are inconsistent, the model is wrong.
        first = list(dict.fromkeys([*first, *inconsistent[:1]]))
    more = len(rejecting) - len(first)
    reason = " ".join(test.meaning for test in first)
    if more > 0:
        reason += f" {more} further {'test rejects' if more == 1 else 'tests reject'} the model."
    return ModelAdequacy(state=AdequacyState.SUSPECT, reason=reason, tests=found)


def _describe_influence(influence: SensorInfluence, results: Estimate) -> EstimateWithoutSensor:
    return EstimateWithoutSensor(
        output=influence.output,
        values=_round(results.values + influence.change),
        std_ratios=_round(influence.std_ratio),
        differences=_round(influence.change / influence.change_std),
    )


def _round(values: Float[np.ndarray, " n"]) -> tuple[float | None, ...]:
    """Round to the digits that a standard error supports; None for what is no number."""
    return tuple(float(f"{v:.6g}") if np.isfinite(v) else None for v in values.tolist())


def _describe_test(test: ModelTest, results: Estimate, *, is_shaped: bool) -> AdequacyTest:
    return AdequacyTest(
        hypothesis=test.hypothesis.value,
        subject=test.subject,
        statistic=test.statistic,
        degrees_of_freedom=test.degrees_of_freedom,
        p=test.p,
        adjusted_p=test.adjusted_p,
        rejects=test.rejects,
        estimate=None if test.estimate is None else finite_or_none(test.estimate),
        meaning=_state_meaning(test, results, is_shaped) if test.rejects else "No evidence.",
    )


def _state_meaning(test: ModelTest, results: Estimate | None, is_shaped: bool) -> str:
    """State what a rejecting test indicates, with the size of the missing quantity."""
    name, value = test.subject, test.estimate
    size = 0.0 if value is None or not np.isfinite(value) else value
    match test.hypothesis:
        case Hypothesis.OUTPUT_DELAY:
            way = "later" if size > 0.0 else "earlier"
            return f"{name} is recorded about {1e3 * abs(size):.2g} ms {way} than modelled."
        case Hypothesis.OUTPUT_SCALE:
            if size < -_SIGN:
                return f"{name} has the opposite sign of what is modelled: check its axis."
            if size < -_NOTHING:
                return (
                    f"{name} measures almost nothing of what is modelled: check its scale factor, "
                    "and the signs of its two sides if it is a mean."
                )
            way = "more" if size > 0.0 else "less"
            return (
                f"{name} measures about {_format_size(100.0 * abs(size))} % {way} than modelled: "
                "check its scale factor, location and mode shape."
            )
        case Hypothesis.INPUT_DELAY:
            way = "after" if size > 0.0 else "before"
            return f"{name} acts about {1e3 * abs(size):.2g} ms {way} its recorded deflection."
        case Hypothesis.AERODYNAMIC_LAG:
            way = "lag" if size > 0.0 else "lead"
            model = "more than the frequency shape" if is_shaped else "the model is quasi-steady"
            return (
                f"The forces {way} the motion by about {1e3 * abs(size):.2g} ms"
                f"{', ' if is_shaped else ': '}{model}."
            )
        case Hypothesis.DERIVATIVE:
            return f"{name} differs from its held value by about {size:.3g}: free it."
        case Hypothesis.FURTHER_MODE:
            return f"The residuals contain the response of {name}: include it in the model."
        case Hypothesis.RESIDUAL_RESPONSE:
            return (
                f"The residuals of {name} are a response to the inputs, largest near "
                f"{test.frequency_hz:.3g} Hz: a mode is missing, or the model of this output or "
                "the aerodynamics is not adequate."
            )
        case Hypothesis.RESIDUAL_POWER:
            return (
                f"The residuals of {name} have {_format_size(size)} times the power of the noise "
                "there: the model is not adequate in this band."
            )
        case Hypothesis.REGRESSOR_NOISE:
            is_known = results is not None and name in results.names
            own = float(results.values[results.names.index(name)]) if is_known else 0.0
            before, after = _format_change(own, size)
            return (
                f"By output error {name} would be {after} instead of {before}: noise of the "
                "regressors, such as turbulence at a vane, biases equation error. Use OE."
            )
        case Hypothesis.SENSOR_CONSISTENCY:
            if results is None or test.influence is None:
                return ""
            return _state_change(test.influence, results)
        case Hypothesis.SURFACE_EFFECTIVENESS:
            loss = 200.0 * abs(size) / (1.0 + abs(size))
            less = "left" if size > 0.0 else "right"
            return (
                f"The {less} surface of {name} is about {loss:.2g} % less effective than the other."
            )
        case Hypothesis.CROSS_DERIVATIVE:
            return f"{name} is about {size:.3g}; it is zero for a symmetric aircraft and flight."
        case Hypothesis.CROSS_RESPONSE:
            return (
                f"{name} responds to surfaces of the other axis, most near "
                f"{test.frequency_hz:.3g} Hz: left and right surfaces or sensors differ, or the "
                "flight was not symmetric."
            )


def _format_size(value: float) -> str:
    """Format two digits without an exponent."""
    return f"{float(f'{value:.2g}'):.6g}"


def _state_change(influence: SensorInfluence, results: Estimate) -> str:
    """State the parameter that changes most without a sensor, over the noise of the change."""
    k, sensor = influence.largest, influence.output
    before, after = _format_change(float(results.values[k]), float(influence.change[k]))
    return (
        f"Without {sensor}, {results.names[k]} would be {after} instead of {before} "
        f"({influence.z:.2g} standard errors of the difference): check {sensor}, its location and "
        "its mode shapes."
    )


def _format_change(value: float, change: float) -> tuple[str, str]:
    """Format a value and the changed one with two digits of their difference, three at least."""
    sizes = [size for size in (10.0 * abs(value), abs(change)) if size > 0.0]
    digits = max(0, *(1 - int(np.floor(np.log10(size))) for size in sizes)) if sizes else 0
    return f"{value:.{digits}f}", f"{value + change:.{digits}f}"
