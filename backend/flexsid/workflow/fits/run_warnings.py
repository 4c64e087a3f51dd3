"""Warnings about the request and the result of an estimation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft, list_surface_parts
from flexsid.records.decision import Structure
from flexsid.records.maneuver import Maneuver
from flexsid.records.run import Method, ModelAdequacy, OutOfBandModes, RunSettings
from flexsid.sysid.adequacy.model_tests import Hypothesis
from flexsid.sysid.estimation.estimate import Estimate, Outcome, standard_errors
from flexsid.sysid.estimation.experiment import LONGEST_DELAY_S
from flexsid.sysid.estimation.nuisance import NuisancePrior
from flexsid.sysid.model.aeroelastic import AeroelasticModel
from flexsid.sysid.model.derivatives import DerivativeTable, is_derivative
from flexsid.sysid.modes.shapes import may_be
from flexsid.sysid.stability.poles import NamedPole

MAX_CORRELATION = 0.9
_POOR_FIT = 0.8
_MAX_ERROR_RATIO = 2.0
_POOR_PREDICTION = 0.5  # of the size of a derivative; panel codes are within 0.3
_REVERSED = 2.5  # standard deviations below zero of a surface's effectiveness over its prediction
_SURE = 3.0  # standard errors from zero
_INTERPOLATION_BIAS = 0.5  # of the standard deviation of a response: total error 12 % larger
_PRIOR_DOMINATES = 0.95  # posterior over prior deviation at a tenth of the prior's information


def check_extras(method: Method, extras: Iterable[str]) -> None:
    """Refuse extra parameters that equation error does not estimate.

    Raises
    ------
    BadInput
        If the method is equation error and a parameter is no derivative.
    """
    for name in extras:
        if method is Method.EE:
            raise BadInput(
                f"equation error estimates derivatives only; '{name}' needs OE or FRE",
                code="not-in-method",
                name=name,
            )


def list_request_warnings(
    method: Method,
    structure: Structure,
    maneuver: Maneuver,
    aircraft: Aircraft,
    model: AeroelasticModel,
    max_omega: float,
    names: Mapping[int, str],
    symmetric: Mapping[int, bool | None],
) -> list[str]:
    """List warnings about modes out of the band, omitted inputs and held delays.

    Parameters
    ----------
    method, structure
        Of the request.
    maneuver, aircraft, model
        Its first maneuver, and the model that is fitted to it.
    max_omega
        Highest frequency of the fit. [rad/s]
    names, symmetric
        Name of every mode, and whether it is symmetric (None: not known), by number.
    """
    numbers = model.modes.numbers
    held = method is Method.EE and structure.free_delays
    return [
        *_warn_of_out_of_band_modes(model, max_omega, names),
        *(
            f"{names[number]} is not {model.body.symmetry} and not identifiable from "
            f"{model.body.axis} motion."
            for number in numbers
            if not may_be(symmetric[number], model.body.symmetry == "symmetric")
        ),
        *(() if method is Method.FRE else _warn_of_omitted_inputs(maneuver, aircraft, model)),
        *(["Equation error holds the delays; OE and FRE estimate them."] if held else []),
    ]


def list_result_warnings(estimate: Estimate) -> tuple[str, ...]:
    """List warnings about convergence, identifiability, correlation, fit and residuals."""
    found = []
    if estimate.outcome is not Outcome.CONVERGED:
        found.append(estimate.message)
    names = np.array(estimate.names)
    derivative = np.array([is_derivative(name) for name in estimate.names])
    weak = np.flatnonzero(derivative & (np.abs(estimate.values) < 2.0 * estimate.std_errors))
    if weak.size:
        found.append(
            f"{weak.size} of {derivative.sum()} derivatives {'is' if weak.size == 1 else 'are'} "
            "within two standard errors "
            f"of zero: {_list_names(names[weak])}."
        )
    correlation = np.abs(np.triu(estimate.correlation, 1))
    pairs = np.argwhere(correlation > MAX_CORRELATION)
    if pairs.size:
        worst = pairs[np.argsort(-correlation[pairs[:, 0], pairs[:, 1]])]
        found.append(
            f"{len(pairs)} {'pair' if len(pairs) == 1 else 'pairs'} of parameters "
            f"{'is' if len(pairs) == 1 else 'are'} correlated above {MAX_CORRELATION}: "
            + _list_names(np.array([f"{names[i]} with {names[j]}" for i, j in worst]))
            + "."
        )
    poor = {
        output
        for block in estimate.lines
        for output, r2 in zip(block.outputs, block.r_squared(), strict=True)
        if r2 < _POOR_FIT
    }
    if poor:
        found.append(
            f"The model explains less than {_POOR_FIT:.0%} of {_list_names(sorted(poor))}."
        )
    ratios = estimate.std_errors / standard_errors(estimate.covariance)
    known = ratios[np.isfinite(ratios)]
    ratio = float(np.median(known)) if known.size else 1.0
    if ratio > _MAX_ERROR_RATIO:
        found.append(
            f"Residuals are coloured or correlated between outputs; standard errors are "
            f"{ratio:.1f} times what white residuals would give. A mode may be missing."
        )
    return tuple(found)


def warn_of_lag(adequacy: ModelAdequacy, settings: RunSettings) -> tuple[str, ...]:
    """Warn that the forces lag the motion, by the score test of a quasi-steady fit.

    Faults of the data that explain the rejections make the test meaningless.
    """
    if settings.aerodynamics.is_shaped or adequacy.causes:
        return ()
    return tuple(
        f"{test.meaning} Quasi-steady derivatives and the flutter speed from them can be biased "
        "to the unsafe side: compare with a frequency shape (tab Aerodynamics)."
        for test in adequacy.tests
        if test.hypothesis == Hypothesis.AERODYNAMIC_LAG and test.rejects
    )


def warn_of_unknown_modes(
    settings: RunSettings, nuisance: NuisancePrior | None, *, is_rigid: bool
) -> tuple[str, ...]:
    """Warn that no further modes are known, where they were to be retained.

    An aircraft without a modal table is rigid.
    """
    is_omitted = settings.out_of_band_modes is OutOfBandModes.OMITTED
    if is_rigid or is_omitted or nuisance is not None:
        return ()
    return (
        "No prediction gives the derivatives of modes outside the model structure a size: the "
        "standard errors assume that the aircraft has no such modes. Import a prediction.",
    )


def warn_of_poor_prediction(spread: float) -> tuple[str, ...]:
    """Warn that the prior of the nuisance parameters is wide because the prediction is poor."""
    if spread < _POOR_PREDICTION:
        return ()
    return (
        f"The derivatives of the modes in the band differ from their prediction by {spread:.0%} "
        "of their size; those of out-of-band modes were given the same uncertainty. Check the "
        "prediction, or the model structure.",
    )


def warn_of_reversed_surfaces(
    estimate: Estimate, predicted: DerivativeTable | None
) -> tuple[str, ...]:
    """Warn of surfaces whose derivatives have the opposite sign of their prediction.

    Parameters
    ----------
    estimate
        Derivatives with standard errors.
    predicted
        Of the same modes and inputs; None where there is no prediction.

    Notes
    -----
    The effectiveness e of a surface is the factor on all its predicted derivatives p that fits
    the estimated ones b best, by weighted least squares with the variances
    s^2 + (``_POOR_PREDICTION`` p)^2: e = sum(w p b) / sum(w p^2), var(e) = 1 / sum(w p^2).
    """
    if predicted is None:
        return ()
    expected = predicted.named()
    warnings = []
    for surface in predicted.inputs:
        at = [k for k, n in enumerate(estimate.names) if n.partition("_")[2] == surface]
        p = np.array([expected.get(estimate.names[k], 0.0) for k in at])
        b, std = estimate.values[at], estimate.std_errors[at]
        usable = np.isfinite(std) & (p != 0.0)
        if not usable.any():
            continue
        p, b, std = p[usable], b[usable], std[usable]
        weight = 1.0 / (std**2 + (_POOR_PREDICTION * p) ** 2)
        information = float(np.sum(weight * p**2))
        effectiveness = float(np.sum(weight * p * b)) / information
        if effectiveness * np.sqrt(information) < -_REVERSED:
            warnings.append(
                f"The derivatives of {surface} are {effectiveness:.2g} times their prediction: "
                "they have the opposite sign. Check the sign of its channel (sign = -1 in the "
                "mapping), or the prediction."
            )
    return tuple(warnings)


def warn_of_implausible_surfaces(
    estimate: Estimate, inputs: Iterable[str], *, is_longitudinal: bool
) -> tuple[str, ...]:
    """Warn of surfaces that, trailing edge down, reduce lift and pitch the nose up."""
    if not is_longitudinal:
        return ()
    sure = np.array(estimate.names)[estimate.values > _SURE * estimate.std_errors]
    return tuple(
        f"CZ_{one} and Cm_{one} are positive, which is implausible of a surface behind the c.g. "
        "that is positive trailing edge down. Check the sign of its channel (sign = -1 in the "
        "mapping)."
        for one in inputs
        if {f"CZ_{one}", f"Cm_{one}"}.issubset(sure.tolist())
    )


def warn_of_limits(estimate: Estimate, at_limit: np.ndarray) -> tuple[str, ...]:
    """Warn of parameters that converged to a physical limit; empty where there are none."""
    if not at_limit.any():
        return ()
    named = [
        f"{name} = {value:.3g}"
        for name, value, out in zip(estimate.names, estimate.values, at_limit, strict=True)
        if out
    ]
    one = len(named) == 1
    return (
        f"{_list_names(named)} {'is' if one else 'are'} at or beyond a physical limit "
        f"(delays within ±{LONGEST_DELAY_S:g} s, factors above zero): "
        f"{'it is' if one else 'they are'} no estimate and {'has' if one else 'have'} no standard "
        f"error, and the other values depend on {'it' if one else 'them'}. "
        f"Hold {'it' if one else 'them'}, or correct the channel.",
    )


def warn_of_priors(
    estimate: Estimate, priors: Mapping[str, tuple[float, float]]
) -> tuple[str, ...]:
    """Warn of estimates that the prior dominates; empty where there are none."""
    held = [
        name
        for name, sigma in zip(estimate.names, estimate.std_errors, strict=True)
        if name in priors and sigma > _PRIOR_DOMINATES * priors[name][1]
    ]
    if not held:
        return ()
    return (
        f"The data contain little information on {_list_names(held)}: "
        f"{'its value and standard error are' if len(held) == 1 else 'values and errors are'} "
        "those of the prior.",
    )


def warn_of_moved_poles(poles: Sequence[NamedPole], max_omega: float) -> list[str]:
    """Warn of out-of-band modes whose estimated pole moved into the band."""
    lowest = {p.name: p.frequency for p in sorted(poles, key=lambda p: -p.frequency)}
    return [
        f"{name} lies above the highest fitted frequency ({max_omega / 2 / np.pi:.3g} Hz), but its "
        f"pole was estimated at {frequency / 2 / np.pi:.3g} Hz, where it fits noise or unmodelled "
        "dynamics. Its derivatives and standard errors are not valid: omit the mode, hold its "
        "derivatives, or give them priors at a prediction."
        for name, frequency in lowest.items()
    ]


def warn_of_interpolation(
    bias: float,
    poles: Sequence[NamedPole],
    omega: np.ndarray,
    assigned_input: np.ndarray,
) -> tuple[str, ...]:
    """Warn that frequency responses are biased by interpolation between harmonics of one input.

    Parameters
    ----------
    bias
        Largest rms bias of the responses, in their standard deviations. [1]
    poles
        Of the estimated model.
    omega, assigned_input
        Frequencies [rad/s], and the input that each is a harmonic of.
    """
    if not bias > _INTERPOLATION_BIAS:
        return ()
    every = [np.diff(omega[assigned_input == index]) for index in np.unique(assigned_input)]
    spacing = max(float(gaps.max()) for gaps in every if gaps.size) / (2.0 * np.pi)
    width = {
        pole.name: abs(pole.value.real) / np.pi
        for pole in poles
        if pole.value.imag > 0.0 and omega[0] <= pole.frequency <= omega[-1]
    }
    narrow = [f"{name} ({own:.2g} Hz)" for name, own in width.items() if own < spacing]
    cause = f" The half-power bandwidth of {_list_names(narrow)} is narrower." if narrow else ""
    return (
        "Interpolation between the harmonics of one input, up to "
        f"{spacing:.2g} Hz apart, biases frequency responses by up to {bias:.1f} of their standard "
        f"deviations (rms), and derivatives with them.{cause} Use OE, or repeat the maneuver with "
        "a longer period.",
    )


def _warn_of_out_of_band_modes(
    model: AeroelasticModel, max_omega: float, names: Mapping[int, str]
) -> tuple[str, ...]:
    return tuple(
        f"{names[number]} ({omega / 2 / np.pi:.3g} Hz in vacuo) lies above the highest fitted "
        f"frequency ({max_omega / 2 / np.pi:.3g} Hz): the data contain little of its dynamics, and "
        "standard errors of its derivatives may be too small. Add a prior at the prediction."
        for number, omega in zip(model.modes.numbers, model.modes.omega, strict=True)
        if omega > max_omega
    )


def _warn_of_omitted_inputs(
    maneuver: Maneuver, aircraft: Aircraft, model: AeroelasticModel
) -> tuple[str, ...]:
    excited = () if maneuver.excitation is None else maneuver.excitation.harmonics
    parts = list_surface_parts(aircraft)
    moved = {term for name in model.inputs for term, _ in parts.get(name, ())}
    missing = [name for name in excited if name not in model.inputs and name not in moved]
    if not missing:
        return ()
    what = "is excited too and is" if len(missing) == 1 else "are excited too and are"
    return (
        f"{', '.join(missing)} {what} no input of the model: that motion counts as noise, or "
        "biases the derivatives of the other inputs.",
    )


def _list_names(names: np.ndarray | list[str], most: int = 6) -> str:
    listed = ", ".join(map(str, names[:most]))
    return listed if len(names) <= most else f"{listed} and {len(names) - most} more"
