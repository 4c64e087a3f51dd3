"""Flutter of the derivatives of a prediction alone, beside flutter from flight."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexsid.allowed import Airspeed, Allowed, Fuel, Id
from flexsid.errors import BadInput
from flexsid.records import finite_or_none
from flexsid.records.aircraft import Aircraft, DerivativePrediction
from flexsid.records.flutter import (
    Along,
    Flutter,
    FlutterRoots,
    Participation,
    PredictedFlutter,
    PredictedFlutterResult,
)
from flexsid.records.run import Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.model.condition import compute_standard_density
from flexsid.sysid.model.derivatives import (
    DerivativeTable,
    coefficients,
    list_derivative_names,
    variables,
)
from flexsid.sysid.model.frequency_shape import FrequencyShape
from flexsid.sysid.model.lateral import LATERAL
from flexsid.sysid.model.longitudinal import LONGITUDINAL
from flexsid.sysid.model.rigid_body import RigidBody
from flexsid.sysid.stability.derivative_fusion import IdentifiedModes, StiffnessError
from flexsid.sysid.stability.flutter_prediction import FlutterPrediction, predict_flutter
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.sysid.stability.root_errors import UncertainDerivatives, estimate_root_bands
from flexsid.sysid.stability.root_tracking import AGREEMENT, find_rational_crossing
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.derivative_predictions import (
    interpolate_prediction,
    list_predicted_modes,
    load_frequency_shape,
)
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.flutter.flutter_models import name_motion
from flexsid.workflow.flutter.flutter_roots import build_branches
from flexsid.workflow.modal_data.modal_tables import (
    AircraftModes,
    find_modal_tables,
    load_modes,
)

_REDUCED_BAND = (1.0, 0.1)
"""Reduced frequencies of the lowest mode in vacuo between which flutter is searched.

That of wing bending at the flutter speed is 0.3 for FLEX-28 and 0.2 for mAEWing1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedFlutterQuery:
    """A prediction, loading and air density.

    By default the first axis of which the prediction has modes, its middle fuel weight, standard
    air at sea level, and airspeeds at which the lowest mode has reduced frequencies from 1 to 0.1.
    """

    prediction_id: Id
    axis: Annotated[
        str | None,
        Allowed(
            choices=("longitudinal", "lateral"),
            text="Axis; by default the first of which the prediction has modes.",
        ),
    ] = None
    fuel: Annotated[
        Fuel | None, Allowed(text="Fuel fraction; by default the middle one predicted.")
    ] = None
    density_kg_m3: Annotated[
        float | None,
        Allowed(ge=0.05, le=2.0, text="Air density; by default standard air at sea level."),
    ] = None
    from_m_s: Annotated[
        Airspeed | None, Allowed(text="Lowest airspeed; by default k = 1 of the lowest mode.")
    ] = None
    to_m_s: Annotated[
        Airspeed | None, Allowed(text="Highest airspeed; by default k = 0.1 of that mode.")
    ] = None


@dataclass(frozen=True, slots=True)
class PredictedFlutterTask:
    """Numbers of a flutter analysis of a prediction, for a worker without a database."""

    query: PredictedFlutterQuery
    aircraft: Aircraft
    source: str
    modes: AircraftModes
    table: DerivativeTable
    shape: FrequencyShape | None
    uncertain: UncertainDerivatives
    fuel: float
    density: float
    band: tuple[float, float]
    not_predicted: tuple[str, ...]

    def build_aircraft(self, airspeed: float) -> Aeroelastic:
        """Build the derivatives on the structure, trimmed at an airspeed."""
        condition = complete_condition(
            self.aircraft,
            {"airspeed": airspeed, "density": self.density, "fuel_fraction": self.fuel},
        )
        structure = self.modes.table.at(self.fuel).select(self.table.modes)
        known = build_flight_condition(self.aircraft, condition)
        return Aeroelastic(known, structure, self.table, self.shape)


def query_beside_flight(prediction_id: int, flight: Flutter) -> PredictedFlutterQuery:
    """Return the query at the axis, loading, air density and airspeeds of flutter from flight."""
    return PredictedFlutterQuery(
        prediction_id=prediction_id,
        axis=flight.axis,
        fuel=flight.fuel_fraction,
        density_kg_m3=flight.density_kg_m3,
        from_m_s=flight.searched_from_m_s,
        to_m_s=flight.searched_to_m_s,
    )


def identify_predicted_flutter(store: Store, query: PredictedFlutterQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If the prediction has no modes, or the loading is impossible.
    UnknownRecord
        If the prediction does not exist.
    """
    prediction = store.predictions.get(query.prediction_id)
    for value, (low, high), what in (
        (query.fuel, (0.0, 1.0), "fuel fraction"),
        (query.density_kg_m3, (0.05, 2.0), "air density [kg/m3]"),
    ):
        if value is not None and not low <= value <= high:
            raise BadInput(
                f"the {what} is {value:g}; expected {low:g} to {high:g}", code="bad-loading"
            )
    tables = _find_tables(store, prediction)
    return (prediction, store.aircraft.get(prediction.aircraft_id), *tables)


def prepare_predicted_flutter(store: Store, query: PredictedFlutterQuery) -> PredictedFlutterTask:
    """Read what the flutter analysis of a prediction needs.

    Raises
    ------
    BadInput
        If the prediction has no modes of the modal table in the axis.
    """
    prediction = store.predictions.get(query.prediction_id)
    modes = load_modes(store, *_find_tables(store, prediction))
    body, numbers = _select_modes(prediction, modes, query.axis)
    fuel = prediction.fuel[len(prediction.fuel) // 2] if query.fuel is None else query.fuel
    values = interpolate_prediction(store, prediction, fuel)
    table = DerivativeTable.from_names(numbers, (), {n: v for n, (v, _) in values.items()}, body)
    shape, unshaped = None, ()
    if prediction.unsteady is not None:
        # The coefficients themselves, also of derivatives that are zero at the reference.
        shape = load_frequency_shape(store, prediction, fuel, numbers, (), body, 0.0)
        unshaped = load_frequency_shape(store, prediction, fuel, numbers, (), body).unshaped
    rows, columns = coefficients(numbers, body), variables(numbers, (), body)
    std = {
        (i, j): error
        for i, row in enumerate(rows)
        for j, column in enumerate(columns)
        for _, error in [values.get(f"{row}_{column}", (0.0, None))]
        if error is not None and f"{row}_{column}" not in unshaped
    }
    places = np.array(list(std), dtype=int).reshape(-1, 2)
    covariance = np.diag(np.array(list(std.values())) ** 2)
    aircraft = store.aircraft.get(prediction.aircraft_id)
    lowest = float(modes.table.at(fuel).select(numbers).omega.min())
    scale = 0.5 * lowest * aircraft.geometry.chord_m
    low, high = (scale / k for k in _REDUCED_BAND)
    return PredictedFlutterTask(
        query=query,
        aircraft=aircraft,
        source=prediction.source,
        modes=modes,
        table=table,
        shape=shape,
        uncertain=UncertainDerivatives(places[:, 0], places[:, 1], covariance),
        fuel=fuel,
        density=compute_standard_density(0.0)
        if query.density_kg_m3 is None
        else query.density_kg_m3,
        band=(query.from_m_s or low, query.to_m_s or high),
        not_predicted=tuple(
            name
            for name in list_derivative_names(numbers, (), body)
            if name in prediction.names and name not in values
        ),
    )


def _select_modes(
    prediction: DerivativePrediction, modes: AircraftModes, axis: str | None
) -> tuple[RigidBody, tuple[int, ...]]:
    """Select the axis, the first with predicted modes unless it is requested, and its modes."""
    for body in (LONGITUDINAL, LATERAL):
        own = [number for number in modes.table.numbers if modes.belongs_to(number, body)]
        numbers = list_predicted_modes(prediction, own, body)
        if numbers and axis in (None, body.axis):
            return body, numbers
    of_axis = "" if axis is None else f"{axis} "
    raise BadInput(
        f"prediction '{prediction.source}' has no {of_axis}derivatives of modes of the modal "
        "table; select another one",
        code="no-predicted-modes",
    )


def _find_tables(store: Store, prediction: DerivativePrediction) -> tuple:
    unsteady = prediction.unsteady
    own = None if unsteady is None else unsteady.modal_table_id
    return find_modal_tables(store, prediction.aircraft_id, own)


def compute_predicted_flutter(
    task: PredictedFlutterTask, report: ReportProgress
) -> PredictedFlutterResult:
    """Predict flutter of a prediction alone, trimmed at the flutter speed.

    Raises
    ------
    BadInput
        If the airspeeds are not a band.
    """
    report(Progress(fraction=0.0, message="Tracking roots"))
    low, high = task.band
    names = {str(number): name for number, name in task.modes.names.items()}
    aircraft = task.build_aircraft(float(np.sqrt(low * high)))
    frequency_std, damping_std = (
        np.array([std[number] for number in task.table.modes])
        for std in (task.modes.frequency_std, task.modes.damping_std)
    )
    stiffness = StiffnessError(frequency_std, np.inf, damping_std=damping_std)
    found = IdentifiedModes(aircraft, task.uncertain, stiffness)
    prediction = predict_flutter(found, task.band, task.density, called=names)
    if prediction.crossing is not None:
        aircraft = task.build_aircraft(prediction.crossing.airspeed)
        found = replace(found, aircraft=aircraft)
        prediction = predict_flutter(found, task.band, task.density, called=names)
    report(Progress(fraction=0.5, message="Standard errors of the roots"))
    locus = prediction.locus
    bands = estimate_root_bands(aircraft, locus, task.uncertain, task.density)
    crossing = prediction.crossing
    roots = FlutterRoots(
        along=Along.AIRSPEED,
        at=locus.airspeed,
        airspeed_m_s=locus.airspeed,
        branches=build_branches(locus, bands, task.modes),
        tested=(),
        flutter=None if crossing is None else crossing.airspeed,
        interval=prediction.interval if task.uncertain.rows.size else None,
        tested_to=None,
        by_monte_carlo=bands.by_monte_carlo,
        note=f"Derivatives of {task.source}, whose standard errors are taken as independent."
        + (
            f" Without {', '.join(task.not_predicted)}, which are not predicted."
            if task.not_predicted
            else ""
        ),
    )
    return PredictedFlutterResult(flutter=_summarise(task, aircraft, prediction), roots=roots)


def _summarise(
    task: PredictedFlutterTask, aircraft: Aeroelastic, prediction: FlutterPrediction
) -> PredictedFlutter:
    crossing, rational, remark = prediction.crossing, None, ""
    if crossing is not None and aircraft.shape is not None:
        rational = find_rational_crossing(aircraft, crossing, task.density)
        remark = _compare_methods(crossing.airspeed, rational)
    chord = task.aircraft.geometry.chord_m
    return PredictedFlutter(
        sentence=prediction.sentence + remark,
        prediction_id=task.query.prediction_id,
        source=task.source,
        modes=task.table.modes,
        fuel_fraction=task.fuel,
        density_kg_m3=task.density,
        searched_from_m_s=task.band[0],
        searched_to_m_s=task.band[1],
        airspeed_m_s=None if crossing is None else crossing.airspeed,
        airspeed_std_m_s=finite_or_none(prediction.total_std) if task.uncertain.rows.size else None,
        frequency_rad_s=None if crossing is None else crossing.frequency,
        reduced_frequency=None
        if crossing is None
        else 0.5 * crossing.frequency * chord / crossing.airspeed,
        rational_airspeed_m_s=None if rational is None else rational[0],
        rational_frequency_rad_s=None if rational is None else rational[1],
        mechanism=None if crossing is None else crossing.mechanism.value,
        participation=()
        if crossing is None
        else tuple(
            Participation(name=name_motion(task.modes, motion), share=share)
            for motion, share in sorted(crossing.participation.items(), key=lambda x: -x[1])
        ),
    )


def _compare_methods(airspeed: float, rational: tuple[float, float] | None) -> str:
    """Compare the p-k method with rational functions."""
    if rational is None:
        return " Rational functions have no crossing within 10 %: do not rely on this speed."
    difference = rational[0] / airspeed - 1.0
    text = f" Rational functions: {rational[0]:.2f} m/s ({difference:+.2%})."
    if abs(difference) > AGREEMENT:
        text += " The lags do not represent these forces: check the prediction at high k."
    return text
