"""Model adequacy of a run: tests for remaining model error and their meaning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexsid.records.run import AdequacyState, AdequacyTest, Aerodynamics, ModelAdequacy
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.limits import find_parameters_at_limits
from flexsid.sysid.estimation.model_tests import Hypothesis, ModelTest, compute_model_tests
from flexsid.sysid.estimation.parameters import Parameters
from flexsid.workflow.runs.estimation_task import EstimationTask

UNTESTED_METHOD = ModelAdequacy(
    reason="Equation error has no test for remaining model error: compare with output error."
)
_MOST_REASONS = 2


def assess_model_adequacy(
    task: EstimationTask,
    experiments: Sequence[Experiment],
    parameters: Parameters,
    estimate: Estimate,
    spread: float,
) -> ModelAdequacy:
    """Test an output-error or frequency-response-error fit for remaining model error.

    Parameters
    ----------
    task
        The estimation; known modes that are not in its model are tested as further modes.
    experiments
        Data of the fit, after the correction of leakage.
    parameters, estimate
        The fit.
    spread
        Spread of the nuisance prior.
    """
    if not estimate.outcome.is_optimum:
        return ModelAdequacy(
            reason=f"Not tested, since the fit did not converge: {estimate.outcome}."
        )
    if find_parameters_at_limits(parameters, estimate.values).any():
        return ModelAdequacy(reason="Not tested, since a parameter is at its limit.")
    maneuvers = task.maneuvers
    further = min(len(data.extended_model.modes.numbers) for data in maneuvers)
    try:
        tests = compute_model_tests(
            experiments,
            parameters,
            estimate.values,
            task.list_priors(spread),
            extended_models=[data.extended_model.with_modes(further) for data in maneuvers],
            overlap=max(data.measured.resolution_overlap for data in maneuvers),
        )
    except np.linalg.LinAlgError:
        return ModelAdequacy(reason="Not tested, since the information of the fit is singular.")
    if not tests:
        return ModelAdequacy(reason="Not tested, since the data have too few frequencies.")
    is_shaped = task.settings.aerodynamics is Aerodynamics.SHAPED
    found = tuple(_describe_test(test, is_shaped=is_shaped) for test in tests)
    rejecting = [test.meaning for test in found if test.rejects]
    if not rejecting:
        reason = f"None of {len(found)} tests for remaining model error rejects the model."
        return ModelAdequacy(state=AdequacyState.CONSISTENT, reason=reason, tests=found)
    more = len(rejecting) - _MOST_REASONS
    reason = " ".join(rejecting[:_MOST_REASONS])
    if more > 0:
        reason += f" {more} further {'test rejects' if more == 1 else 'tests reject'} the model."
    return ModelAdequacy(state=AdequacyState.SUSPECT, reason=reason, tests=found)


def _describe_test(test: ModelTest, *, is_shaped: bool) -> AdequacyTest:
    return AdequacyTest(
        hypothesis=test.hypothesis.value,
        subject=test.subject,
        statistic=test.statistic,
        degrees_of_freedom=test.degrees_of_freedom,
        p=test.p,
        adjusted_p=test.adjusted_p,
        rejects=test.rejects,
        meaning=_state_meaning(test, is_shaped) if test.rejects else "No evidence.",
    )


def _state_meaning(test: ModelTest, is_shaped: bool) -> str:
    """State what a rejecting test indicates, with the size of the missing quantity."""
    name, value = test.subject, test.estimate
    size = 0.0 if value is None or not np.isfinite(value) else value
    match test.hypothesis:
        case Hypothesis.OUTPUT_DELAY:
            way = "later" if size > 0.0 else "earlier"
            return f"{name} is recorded about {1e3 * abs(size):.2g} ms {way} than modelled."
        case Hypothesis.OUTPUT_SCALE:
            way = "more" if size > 0.0 else "less"
            return (
                f"{name} measures about {100.0 * abs(size):.2g} % {way} than modelled: check its "
                "scale factor, location and mode shape."
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
