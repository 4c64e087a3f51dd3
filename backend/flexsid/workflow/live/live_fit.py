"""Estimate from the spectra of a growing record: derivatives, poles, flutter speed."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtr

from flexsid.errors import NotIdentifiable
from flexsid.records import finite_or_none
from flexsid.records.live import LiveEstimate, LiveMode
from flexsid.sysid.estimation.estimate import Estimate
from flexsid.sysid.estimation.experiment import Experiment
from flexsid.sysid.estimation.growing_record import (
    GrowingFit,
    GrowingStart,
    fit_growing_record,
    select_resolved_frequencies,
)
from flexsid.sysid.estimation.output_error import output_error
from flexsid.sysid.model.derivatives import DerivativeTable
from flexsid.sysid.model.sensors import SensorRows
from flexsid.sysid.signals import FrequencyData
from flexsid.sysid.spectra.growing_record import GrowingSpectra
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction, predict_flutter
from flexsid.sysid.stability.poles import NamedPole, compute_named_poles
from flexsid.sysid.stability.root_errors import UncertainDerivatives
from flexsid.sysid.stability.state_family import Aeroelastic
from flexsid.workflow.aircraft.aircraft_models import (
    compute_input_corrections,
    get_output_instrument,
)
from flexsid.workflow.live.live_task import LiveTask

_BAND = (0.35, 2.0)  # of the airspeed: range of the flutter search, as of stored runs


@dataclass(frozen=True, slots=True)
class LiveResult:
    """Spectra and derivatives of the latest fit; ``n_free`` real parameters were fitted."""

    task: LiveTask
    experiment: Experiment
    derivatives: DerivativeTable
    n_free: int


class LiveFit:
    """Fits of one maneuver in sequence, each from the values of the one before.

    Parameters
    ----------
    task
        Model, start and priors.
    """

    def __init__(self, task: LiveTask) -> None:
        self._task = task
        self._before: GrowingStart | None = None
        self.result: LiveResult | None = None
        self._prepare(task)

    def change(self, task: LiveTask) -> None:
        """Continue at another flight condition, from the present values."""
        if task is self._task:
            return
        self._task = task
        self._prepare(task)

    def _prepare(self, task: LiveTask) -> None:
        """Compute the responses of the instruments."""
        omega, aircraft = task.omega, task.aircraft
        self._corrections = compute_input_corrections(aircraft, task.inputs, omega)
        instruments = [get_output_instrument(aircraft, o).response(omega) for o in task.outputs]
        self._instruments = np.stack(instruments, axis=1)

    def estimate(
        self, spectra: GrowingSpectra, trim: np.ndarray, excluded: Collection[str], time_s: float
    ) -> LiveEstimate:
        """Estimate from all spectra so far.

        Parameters
        ----------
        spectra
            Of the recorded channels, in SI units.
        trim
            Trim value of every channel.
        excluded
            Channels without data over the whole record; outputs that need them are omitted.
        time_s
            End of the record, by the recorder. [s]

        Raises
        ------
        NotIdentifiable
            If an input is excluded, or the data are too few.
        """
        task = self._task
        found, change = self._fit(spectra, trim, excluded)
        prediction = _predict(task, found.values, found.corrected_covariance)
        crossing, std = prediction.crossing, prediction.total_std
        beyond = None
        if crossing is not None and np.isfinite(std) and task.next_airspeed_m_s is not None:
            beyond = float(ndtr((task.next_airspeed_m_s - crossing.airspeed) / std))
        return LiveEstimate(
            time_s=time_s,
            duration_s=spectra.duration_s,
            converged=found.outcome.is_optimum,
            modes=_describe_modes(task, found),
            names=found.names,
            values=tuple(found.values.tolist()),
            std_errors=tuple(finite_or_none(std) for std in found.std_errors.tolist()),
            flutter_m_s=None if crossing is None else float(crossing.airspeed),
            flutter_std_m_s=None if crossing is None else finite_or_none(std),
            next_point_probability=beyond,
            excluded=tuple(sorted(excluded)),
            condition=task.condition,
            change_by_noise_weights=change,
            no_errors_reason="" if np.isfinite(found.std_errors).all() else found.message,
        )

    def estimate_modes(
        self, spectra: GrowingSpectra, trim: np.ndarray, excluded: Collection[str]
    ) -> tuple[LiveMode, ...]:
        """Estimate the modes only, as ``estimate`` does; none where the fit does not converge."""
        found, _ = self._fit(spectra, trim, excluded)
        return _describe_modes(self._task, found) if found.outcome.is_optimum else ()

    def _fit(
        self, spectra: GrowingSpectra, trim: np.ndarray, excluded: Collection[str]
    ) -> tuple[Estimate, float | None]:
        """Fit all spectra so far; return also the change by the noise spectrum."""
        task = self._task
        lost = [name for name in task.inputs if name in excluded]
        if lost:
            raise NotIdentifiable(
                f"no estimate without the deflection of {', '.join(lost)}; repeat the maneuver"
            )
        usable = [
            k
            for k, output in enumerate(task.outputs)
            if not any(part.name in excluded for part, _ in output.terms)
        ]
        outputs = [task.outputs[k] for k in usable]
        picked = select_resolved_frequencies(task.omega, spectra.duration_s)
        omega = task.omega[picked]
        moved = spectra.remove_trim(trim)[picked]
        place = {name: k for k, name in enumerate(spectra.names)}
        u = moved[:, [place[name] for name in task.inputs]] * self._corrections[picked]
        z = np.stack(
            [sum(w * moved[:, place[part.name]] for part, w in o.terms) for o in outputs], axis=1
        )
        names = tuple(output.name for output in outputs)
        rows = SensorRows(names, task.model.sensors.polynomial[:, usable])
        experiment = output_error(
            replace(task.model, sensors=rows),
            FrequencyData(omega, u, task.inputs),
            FrequencyData(omega, z, names),
            self._instruments[picked][:, usable],
            edges_s=spectra.edges_s,
        )
        fit = fit_growing_record(
            experiment,
            task.parameters,
            spectra.duration_s,
            task.priors,
            self._before,
            commands=moved[:, [place[name] for name in task.commands]],
        )
        self._before = fit.next_start
        change = self._compute_change(fit)
        found = fit.estimate if change is None else fit.widen(change)
        self.result = LiveResult(
            task, fit.experiment, task.parameters.table(found.values), found.values.size
        )
        return found, change

    def _compute_change(self, fit: GrowingFit) -> float | None:
        """Compute the change of the lowest damping by the noise spectrum, in standard errors."""
        if fit.plain is fit.estimate:
            return None
        task = self._task
        plain, weighted = (
            [
                pole
                for pole in compute_named_poles(
                    task.model,
                    task.parameters,
                    one.values,
                    one.corrected_covariance,
                    task.mode_names,
                )
                if pole.value.imag > 0.0
            ]
            for one in (fit.plain, fit.estimate)
        )
        if not weighted:
            return None
        least = min(weighted, key=lambda pole: pole.damping)
        before = next((pole for pole in plain if pole.name == least.name), None)
        if before is None or not before.damping_std:
            return None
        return finite_or_none(abs(least.damping - before.damping) / before.damping_std)


def _predict(task: LiveTask, values: np.ndarray, covariance: np.ndarray) -> FlutterPrediction:
    parameters, model = task.parameters, task.model
    known = np.isfinite(covariance).all()
    identified = IdentifiedModes(
        Aeroelastic(model.condition, model.modes, parameters.table(values)),
        UncertainDerivatives(
            parameters.rows,
            parameters.columns,
            covariance if known else np.full(covariance.shape, np.nan),
        ),
        task.stiffness,
    )
    speed = model.condition.airspeed
    return predict_flutter(identified, (_BAND[0] * speed, _BAND[1] * speed))


def _describe_modes(task: LiveTask, found: Estimate) -> tuple[LiveMode, ...]:
    poles = compute_named_poles(
        task.model, task.parameters, found.values, found.corrected_covariance, task.mode_names
    )
    return tuple(_describe_mode(pole) for pole in poles if pole.value.imag > 0.0)


def _describe_mode(pole: NamedPole) -> LiveMode:
    std = finite_or_none(pole.damping_std)
    return LiveMode(
        name=pole.name,
        frequency=pole.frequency,
        frequency_std=finite_or_none(pole.frequency_std),
        damping=pole.damping,
        damping_std=std,
        instability_probability=None if not std else float(ndtr(-pole.damping / std)),
    )
