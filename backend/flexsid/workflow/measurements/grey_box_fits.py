"""Fits of grey-box models, of a file or an installed package, to the channels of a maneuver.

The code of a file runs where a job is computed, and nowhere else: what is checked before is its
syntax.
"""

from __future__ import annotations

import hashlib
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import CodeType, ModuleType
from typing import Annotated

import numpy as np

from flexsid.allowed import Allowed, Frequency, Id, Name
from flexsid.errors import BadInput, FlexsidError
from flexsid.extensions import (
    MODELS,
    find_extension_package,
    list_extension_names,
    load_extensions,
    report_errors,
)
from flexsid.records.aircraft import Aircraft
from flexsid.records.grey_box import (
    FittedParameter,
    FittedResponse,
    GreyBoxFit,
)
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import AdequacyState, Method, Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.grey_box.fit import (
    GreyBoxData,
    GreyBoxEstimate,
    fit_grey_box,
    list_response_data,
)
from flexsid.sysid.grey_box.model import GreyBox
from flexsid.sysid.grey_box.residual_tests import (
    ResidualTestResult,
    compute_poles,
    run_residual_tests,
)
from flexsid.sysid.model.condition import FlightCondition
from flexsid.text import LONGEST_TEXT, count_noun
from flexsid.units import lookup, si_unit
from flexsid.workflow.aircraft.aircraft_models import (
    build_flight_condition,
    compute_input_correction,
    define_outputs,
    get_output_instrument,
)
from flexsid.workflow.aircraft.axes import find_body
from flexsid.workflow.measurements.maneuver_spectra import (
    LOW_OMEGA,
    read_measurement,
    read_recording,
)
from flexsid.workflow.measurements.recording import Recording, select_frequencies
from flexsid.workflow.measurements.sensor_responses import find_excited_band

_MODULE = "flexsid_model_of_a_file"  # name of its module while it is executed


@dataclass(frozen=True, slots=True, kw_only=True)
class GreyBoxQuery:
    """Maneuver, model, method and band of a fit.

    The band is the excited one by default, from 1/T on. [Hz]
    """

    maneuver_id: Id
    model: Annotated[Name, Allowed(text="Name of the file, or of an installed model.")]
    source: Annotated[
        str, Allowed(max_length=LONGEST_TEXT, text="Text of the file; empty: it is installed.")
    ] = ""
    method: Annotated[str, Allowed(choices=(Method.OE, Method.FRE))] = Method.OE
    low_hz: Annotated[Frequency | None, Allowed(text="Begin of the band.")] = None
    high_hz: Annotated[Frequency | None, Allowed(text="End of the band.")] = None

    def __post_init__(self) -> None:
        """Refuse half a band.

        Raises
        ------
        BadInput
            If one limit is missing, or they do not rise.
        """
        low, high = self.low_hz, self.high_hz
        if (low is None) != (high is None) or (
            low is not None and high is not None and not low < high
        ):
            raise BadInput("give both low_hz and high_hz, rising, or neither", code="bad-band")

    @property
    def band_hz(self) -> tuple[float, float] | None:
        """Limits of the band; None for the excited one. [Hz]"""
        if self.low_hz is None or self.high_hz is None:
            return None
        return self.low_hz, self.high_hz


def identify_grey_box(store: Store, query: GreyBoxQuery) -> tuple[object, ...]:
    """Check a request without executing its file; return what its code is.

    Raises
    ------
    BadInput
        If the file is no Python, or no such model is installed.
    UnknownRecord
        If there is no such maneuver.
    """
    store.maneuvers.get(query.maneuver_id)
    if query.source:
        _compile(query)
        return (hashlib.sha256(query.source.encode()).hexdigest(),)
    package = find_extension_package(MODELS, query.model)
    if package is None:
        known = ", ".join(list_extension_names(MODELS)) or "none"
        raise BadInput(
            f"no model '{query.model}' is installed; installed are: {known}", code="unknown-model"
        )
    return (package,)


def _compile(query: GreyBoxQuery) -> CodeType:
    try:
        return compile(query.source, query.model, "exec")
    except SyntaxError as error:
        message = f"{query.model}, line {error.lineno}: {error.msg}"
    except (ValueError, RecursionError, MemoryError) as error:
        message = f"{query.model} is no Python: {error}"
    raise BadInput(message, code="bad-model-file")


# --- The fit, where jobs are computed -------------------------------------------------------------


def compute_grey_box(store: Store, query: GreyBoxQuery, report: ReportProgress) -> GreyBoxFit:
    """Execute the file of a model, or load it from its package, and fit it to a maneuver.

    Raises
    ------
    BadInput
        If the code fails, naming its line; if channels or units differ from the record's.
    NotIdentifiable
        If the data do not determine the parameters.
    """
    maneuver = store.maneuvers.get(query.maneuver_id)
    aircraft = store.aircraft.get(maneuver.aircraft_id)
    report(Progress(fraction=0.1, message="Loading the model"))
    with _loading(query) as (model, source):
        data = _read_data(store, maneuver, aircraft, model, query)
        condition = _find_condition(aircraft, maneuver)

        def report_step(iteration: int, cost: float) -> None:
            report(Progress(iteration=iteration, cost=cost, message="Fitting"))

        estimate = fit_grey_box(model, data, condition, report_step)
    return _describe(query, source, data, estimate)


@contextmanager
def _loading(query: GreyBoxQuery) -> Iterator[tuple[GreyBox, str]]:
    """Provide the model and its source; errors of its code in the block are reported as such."""
    if not query.source:
        with report_errors(find_extension_package(MODELS, query.model) or query.model):
            found = {
                name: (one, package) for name, package, one in load_extensions(MODELS, GreyBox)
            }
            if query.model not in found:
                raise BadInput(f"no model '{query.model}' is installed", code="unknown-model")
            yield found[query.model]
        return
    module = ModuleType(_MODULE)
    module.__file__ = query.model
    sys.modules[_MODULE] = module
    try:
        exec(_compile(query), module.__dict__)
        models = [one for one in vars(module).values() if isinstance(one, GreyBox)]
        if len(models) != 1:
            raise BadInput(
                f"{query.model} defines {count_noun(len(models), 'GreyBox value')}; expected one, "
                "such as MODEL = GreyBox(title=..., matrices=..., parameters=[...], "
                'inputs={"aileron": "rad"}, outputs={"p": "rad/s"})',
                code="bad-model-file",
            )
        yield models[0], query.source
    except (FlexsidError, MemoryError):
        raise
    except (Exception, SystemExit) as error:
        lines = [one.lineno for one in traceback.extract_tb(error.__traceback__)
                 if one.filename == query.model]  # fmt: skip
        if not lines:
            raise
        raise BadInput(
            f"{query.model}, line {lines[-1]}: {type(error).__name__}: {error}",
            code="model-failed",
        ) from error
    finally:
        del sys.modules[_MODULE]


def _find_condition(aircraft: Aircraft, maneuver: Maneuver) -> FlightCondition | None:
    """Return the condition of a flight; None of a ground record."""
    if not maneuver.condition.airspeed_m_s > 0.0:
        return None
    return build_flight_condition(aircraft, maneuver.condition)


def _read_data(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, model: GreyBox, query: GreyBoxQuery
) -> list[GreyBoxData]:
    """Read the spectra of a record, or its responses, in the units of the model."""
    if query.method == Method.FRE:
        outputs = define_outputs(aircraft, tuple(model.outputs))
        measured = read_measurement(
            store, maneuver, aircraft, tuple(model.inputs), outputs, query.band_hz
        )
        scale_u, scale_y = _find_scales(measured.recording, model)
        responses = []
        for factor, one in zip(scale_u, measured.transform().responses.values(), strict=True):
            scale = scale_y[:, None] / factor
            std = None if one.std is None else one.std * scale
            responses.append(replace(one, values=one.values * scale, std=std))
        return list_response_data(responses, model)
    names = (*model.inputs, *model.outputs)
    recording = read_recording(store, maneuver, aircraft, names)
    low = np.array([LOW_OMEGA])
    lags = {
        part: -float(np.angle(_compute_response(aircraft, name, low)[0])) / LOW_OMEGA
        for name in names
        for part, _ in recording.parts[name]
    }
    recording = recording.with_common_window(lags)
    assert recording.window_s is not None
    duration_s = recording.compute_duration_s()
    band_hz = query.band_hz or _find_band(store, maneuver, aircraft, duration_s)
    # All multiples of 1/T, also where harmonics are known: motion at the ends then has no leakage.
    frequencies = select_frequencies(replace(maneuver, excitation=None), band_hz, duration_s)
    spectra = recording.spectra(names, frequencies)
    omega, n_u = spectra.omega, len(model.inputs)
    instruments = np.stack([_compute_response(aircraft, name, omega) for name in names], axis=1)
    scale_u, scale_y = _find_scales(recording, model)
    return [
        GreyBoxData(
            omega=omega,
            inputs=spectra.values[:, :n_u] / instruments[:, :n_u] * scale_u,
            outputs=spectra.values[:, n_u:] * scale_y,
            instruments=instruments[:, n_u:],
            ends_s=recording.window_s[1:],
            duration_s=duration_s,
        )
    ]


def _compute_response(aircraft: Aircraft, name: str, omega: np.ndarray) -> np.ndarray:
    """Compute the response from a quantity to its recorded channel; one where none is known."""
    if any(name == one.name for one in (*aircraft.sensors, *aircraft.combinations)):
        (output,) = define_outputs(aircraft, (name,))
        return get_output_instrument(aircraft, output).response(omega)
    if any(name == one.name for one in aircraft.surfaces):
        return 1.0 / compute_input_correction(aircraft, name, omega)
    return np.ones(omega.size, dtype=complex)


def _find_band(
    store: Store, maneuver: Maneuver, aircraft: Aircraft, duration_s: float
) -> tuple[float, float]:
    if maneuver.excitation is None:
        high_hz = find_excited_band(store, maneuver, aircraft, find_body(maneuver.axis))[1]
    else:
        numbers = [n for own in maneuver.excitation.harmonics.values() for n in own]
        high_hz = max(numbers) / maneuver.excitation.period_s
    return 1.0 / duration_s, high_hz


def _find_scales(recording: Recording, model: GreyBox) -> tuple[np.ndarray, np.ndarray]:
    """Return the factors from SI to the units of inputs and outputs.

    Raises
    ------
    BadInput
        If a channel measures another quantity than the model states.
    """
    units = {channel.name: channel.unit for channel, _ in recording.channels}
    scales = []
    for signals in (model.inputs, model.outputs):
        factors = []
        for name, unit in signals.items():
            recorded = units[recording.parts[name][0][0]]
            stated = lookup(unit)
            if stated.dimension != lookup(recorded).dimension:
                raise BadInput(
                    f"'{name}' is recorded in {si_unit(recorded)}, a "
                    f"{lookup(recorded).dimension}; the model states '{unit}', a "
                    f"{stated.dimension}",
                    code="wrong-dimension",
                    channel=name,
                )
            factors.append(1.0 / stated.factor)
        scales.append(np.array(factors))
    return scales[0], scales[1]


# --- The result -----------------------------------------------------------------------------------


def _describe(
    query: GreyBoxQuery, source: str, data: Sequence[GreyBoxData], estimate: GreyBoxEstimate
) -> GreyBoxFit:
    model = estimate.model
    tests = run_residual_tests(estimate, data)
    rejected = [one for one in tests if one.rejects]
    correlation = estimate.covariance / np.outer(estimate.std_errors, estimate.std_errors)
    is_optimum = estimate.outcome.is_optimum
    all_hz = np.unique(np.concatenate([one.omega for one in data])) / (2.0 * np.pi)
    found = estimate.matrices
    A, B, C, D = (tuple(map(tuple, one.tolist())) for one in (found.A, found.B, found.C, found.D))
    return GreyBoxFit(
        maneuver_id=query.maneuver_id,
        method=query.method,
        model=query.model,
        title=model.title,
        source=source,
        band_hz=(float(all_hz[0]), float(all_hz[-1])),
        n_frequencies=all_hz.size,
        inputs=dict(model.inputs),
        outputs=dict(model.outputs),
        states=found.states,
        parameters=tuple(_list_parameters(estimate)),
        correlation=tuple(map(tuple, correlation.tolist())) if is_optimum else (),
        A=A,
        B=B,
        C=C,
        D=D,
        poles=compute_poles(estimate) if is_optimum else (),
        responses=tuple(_list_responses(data, estimate)),
        tests=tests,
        adequacy=AdequacyState.SUSPECT if rejected else AdequacyState.CONSISTENT,
        cost=estimate.cost,
        bic=estimate.bic,
        n_data=estimate.n_data,
        outcome=estimate.outcome.value,
        iterations=estimate.iterations,
        derivatives="complex step" if estimate.by_complex_step else "central differences",
        sentence=_summarise(tests, rejected),
        warnings=tuple(_list_warnings(estimate)),
    )


def _list_parameters(estimate: GreyBoxEstimate) -> Iterator[FittedParameter]:
    values, std, bounds = estimate.values, estimate.std_errors, estimate.cramer_rao
    is_optimum = estimate.outcome.is_optimum
    for k, one in enumerate(estimate.model.parameters):
        yield FittedParameter(
            name=one.name,
            unit=one.unit,
            value=float(values[k]),
            std=float(std[k]) if is_optimum else None,
            bound=float(bounds[k]) if is_optimum else None,
            start=float(one.start),
            prior_value=None if one.prior is None else float(one.prior[0]),
            prior_std=None if one.prior is None else float(one.prior[1]),
        )


def _list_responses(
    data: Sequence[GreyBoxData], estimate: GreyBoxEstimate
) -> Iterator[FittedResponse]:
    for one, modelled, residuals in zip(data, estimate.modelled, estimate.residuals, strict=True):
        hz = tuple((one.omega / (2.0 * np.pi)).tolist())
        for column, (name, unit) in enumerate(estimate.model.outputs.items()):
            measured = one.outputs[:, column]
            power = float(np.sum(np.abs(measured - measured.mean()) ** 2))
            error = float(np.sum(np.abs(residuals[:, column]) ** 2))
            yield FittedResponse(
                output=name,
                input=one.name,
                unit=f"{unit}/{estimate.model.inputs[one.name]}" if one.name else f"{unit}*s",
                r_squared=1.0 - error / max(power, 1e-300),
                frequency_hz=hz,
                measured=tuple(np.abs(measured).tolist()),
                modelled=tuple(np.abs(modelled[:, column]).tolist()),
                residual=tuple(np.abs(residuals[:, column]).tolist()),
            )


def _summarise(tests: Sequence[ResidualTestResult], rejected: Sequence[ResidualTestResult]) -> str:
    if not rejected:
        return f"The residuals are consistent with the model ({count_noun(len(tests), 'test')})."
    first = rejected[0]
    low, high = first.band_hz
    return (
        f"The model is rejected by {len(rejected)} of {count_noun(len(tests), 'test')}: the "
        f"{first.test.value}, most of {first.output} from {low:.3g} to {high:.3g} Hz "
        f"(p = {first.adjusted_p:.2g})."
    )


def _list_warnings(estimate: GreyBoxEstimate) -> Iterator[str]:
    if not estimate.outcome.is_optimum:
        yield (
            f"The fit ended without an optimum ({estimate.outcome.value}): its standard errors do "
            "not hold. Start closer, or give priors."
        )
    if not estimate.by_complex_step:
        yield (
            "The function is not analytic in its parameters (an absolute value, a comparison, or "
            "a conversion to a real number): derivatives are central differences."
        )
