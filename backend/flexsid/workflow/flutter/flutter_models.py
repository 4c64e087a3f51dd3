"""Models for flutter prediction: identified runs at one loading, fused by model structure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Annotated, Any

import numpy as np

from flexsid.allowed import Airspeed, Allowed, Altitude, Fuel, RunIds
from flexsid.errors import BadInput
from flexsid.records.aircraft import Aircraft
from flexsid.records.run import DerivedRun, Progress, ReportProgress
from flexsid.storage.store import Store
from flexsid.sysid.estimation.estimate import Outcome
from flexsid.sysid.global_model.selection import LEAST_RUNS
from flexsid.sysid.model.condition import compute_standard_density
from flexsid.sysid.stability.derivative_fusion import (
    EnvelopeModel,
    IdentifiedModes,
    fit_envelope,
    fuse_identified,
    fuse_with_trend,
)
from flexsid.sysid.stability.flutter_extrapolation import FlownPoint
from flexsid.sysid.stability.flutter_prediction import (
    FlutterPrediction,
    compute_structure_spread,
    fuse_at_crossing,
    predict_flutter,
)
from flexsid.sysid.stability.poles import Aeroelastic
from flexsid.workflow.aircraft.aircraft_models import build_flight_condition
from flexsid.workflow.aircraft.flight_condition import complete_condition
from flexsid.workflow.aircraft.written_back import refuse_counted_twice
from flexsid.workflow.flutter.run_models import (
    RunModel,
    UnmodelledModes,
    compute_fuel_factors,
    load_model_of_coarse_mesh,
    load_model_with_fewer_modes,
    load_run_models,
    load_run_modes,
    scale_to_fuel,
)
from flexsid.workflow.modal_data.modal_tables import AircraftModes
from flexsid.workflow.model_structures.baselines import find_approved_global_model
from flexsid.workflow.model_structures.model_structures import get_result
from flexsid.workflow.runs.derived_runs import DerivedFit, DerivedRuns
from flexsid.workflow.runs.run_identity import list_run_contents

NEXT = 1.03
"""Default next test point, as a ratio of the fastest flown airspeed."""

_FUSION_SHARE = 0.6  # of the progress of a prediction
_BAND = (0.35, 2.0)  # of the fastest flown point: range of the flutter search
_MOST_RUNS = 100  # in a prediction: minutes where each is fitted again
_ALIKE = 0.25  # of the fuel: flutter speeds of FLEX-28 differ by less than 1 % over so much
_CONTRADICTED = -0.5  # log likelihood a value: residuals of two thirds more power with the modes
_DISAGREEING = 1.2  # errors over standard errors: ratios of runs that agree scatter by 0.1


_TOO_FEW = {
    "no-trend": "a trend needs more points",
    "bad-number-of-runs": f"a global model needs {LEAST_RUNS} runs or more",
    "no-common-derivative": "the runs estimated no derivative",
}
_LEAST_FLIGHTS = 3  # of a global model; otherwise each maneuver is a flight


class Variation(StrEnum):
    """Variation of the derivatives over the envelope.

    A global model has dynamic pressure and fuel as variables.
    """

    CONSTANT = "constant"
    LINEAR = "linear"
    GLOBAL_MODEL = "global-model"


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterQuery:
    """Runs, loading and air density of a flutter prediction; the fastest maneuver's by default.

    Modes omitted by a run are included in a second fit with derivatives of a prediction that
    has them, unless ``unmodelled_modes`` leaves them residualised in the run's derivatives.
    Derivatives vary over the envelope where a structure has enough runs.
    """

    run_ids: RunIds
    fuel: Annotated[
        Fuel | None, Allowed(text="Fuel fraction; by default that of the fastest test point.")
    ] = None
    altitude_m: Annotated[
        Altitude | None,
        Allowed(text="Standard altitude; by default the air of the fastest test point."),
    ] = None
    next_m_s: Annotated[
        Airspeed | None,
        Allowed(text="Airspeed of the next test point; by default 3 % above the fastest."),
    ] = None
    unmodelled_modes: Annotated[
        UnmodelledModes,
        Allowed(text="Modes not modelled by the runs: with predicted dynamics, or residualised."),
    ] = UnmodelledModes.PREDICTED
    variation: Annotated[
        Variation,
        Allowed(
            text="Derivatives over the envelope: constant, linear over dynamic pressure, or of a "
            "global model over dynamic pressure and fuel."
        ),
    ] = Variation.CONSTANT

    def __post_init__(self) -> None:
        """Sort the runs: the same set is the same request."""
        object.__setattr__(self, "run_ids", tuple(sorted(set(self.run_ids))))


@dataclass(frozen=True, slots=True)
class Group:
    """Runs of one model structure with their fused derivatives and flutter prediction."""

    parts: list[RunModel]
    found: IdentifiedModes
    prediction: FlutterPrediction

    def weight_speed(self, speed: float) -> float:
        """Return the flutter speed of these runs as weighted in the spread about ``speed``. [m/s]

        The change by the last mode bounds the change by further modes at two standard
        deviations; another structure is as likely as the preferred one. Lattices converge with the
        first power of the divisions: the change by a mesh of half of them is the error left.
        """
        crossing = self.prediction.crossing
        if crossing is None:
            return np.nan
        part = self.parts[0]
        share = 0.5 if part.check and not part.coarse_mesh else 1.0
        return speed + share * (crossing.airspeed - speed)


@dataclass(frozen=True, slots=True)
class _At:
    """Common to all runs of a query: aircraft, loading, fastest point, kind of fusion.

    ``envelopes`` are the global models that were fitted already, by the runs of each.
    """

    aircraft: Aircraft
    modes: AircraftModes
    fuel: float
    density: float
    tested: float
    variation: Variation
    envelopes: dict[tuple[int | None, ...], EnvelopeModel] = field(
        default_factory=dict[tuple[int | None, ...], EnvelopeModel]
    )

    @property
    def band(self) -> tuple[float, float]:
        """Range of airspeed of the flutter search. [m/s]"""
        return _BAND[0] * self.tested, _BAND[1] * self.tested

    def predict(
        self, found: IdentifiedModes, parts: Sequence[RunModel], fuel: float, spread: float = 0.0
    ) -> FlutterPrediction:
        """Predict flutter of fused runs and check the prediction against flown points."""
        names = {str(number): name for number, name in self.modes.names.items()}
        flown_points = [self._evidence(part, fuel) for part in parts]
        return predict_flutter(
            found, self.band, self.density, spread, names, flown_points, draws=True
        )

    def _evidence(self, part: RunModel, fuel: float) -> FlownPoint:
        """Return identified roots of a run at the airspeed of equal dynamic pressure."""
        condition = part.maneuver.condition
        return replace(
            part.evidence,
            airspeed=condition.airspeed_m_s * np.sqrt(condition.density_kg_m3 / self.density),
            comparable=abs(condition.fuel_fraction - fuel) <= _ALIKE,
        )


@dataclass(frozen=True, slots=True)
class FlutterModels:
    """Fused models of a flutter query by model structure; the preferred group is ``best``.

    ``derived_runs`` are the refits that these rest on, ``new_fits`` those computed for them. The
    spread between structures is infinite where one of them failed.
    """

    query: FlutterQuery
    at: _At
    groups: list[Group]
    best: Group
    fuel: float
    derived_runs: tuple[DerivedRun, ...]
    new_fits: tuple[DerivedFit, ...]

    @property
    def has_failed_fits(self) -> bool:
        """Whether a refit failed, so that the spread between structures is unknown."""
        return any(one.failure is not None for one in self.derived_runs)

    def predict(
        self, store: Store, parts: Sequence[RunModel], spread: float = 0.0
    ) -> FlutterPrediction:
        """Predict flutter with some or all runs of one structure."""
        found = self.fuse(store, parts, self.fuel)
        return self.at.predict(found, parts, self.fuel, spread)

    def fuse(self, store: Store, parts: Sequence[RunModel], fuel: float) -> IdentifiedModes:
        """Fuse some or all runs of one structure at a loading."""
        return _fuse(store, parts, self.at, fuel)[0]


def build_approved_query(store: Store, aircraft_id: int, axis: str, **more: Any) -> FlutterQuery:
    """Build the query of the runs of the approved global model, without the outlying ones.

    Derivatives vary over the envelope as in a global model; ``more`` are further fields.

    Raises
    ------
    BadInput
        If no global model of the axis is approved.
    """
    version = find_approved_global_model(store, aircraft_id, axis)
    if version is None:
        raise BadInput(
            f"no global model of the {axis} axis is approved; name the runs, or propose a version "
            "of a global model",
            code="no-run",
        )
    runs = tuple(run.run_id for run in version.runs if not run.is_outlying)
    asked: dict[str, Any] = {"variation": Variation.GLOBAL_MODEL, **more, "run_ids": runs}
    return FlutterQuery(**asked)


def identify_query(store: Store, query: FlutterQuery) -> tuple[object, ...]:
    """Check a query, and return all records on which its result depends.

    Raises
    ------
    BadInput
        If no run is selected, too many are, the loading is impossible, or a run has the data of
        another one in its prior.
    UnknownRecord
        If a run does not exist.
    Conflict
        If a run has no result, or it was altered.
    """
    _check(query)
    runs = [store.runs.get(number) for number in query.run_ids]
    for run in runs:
        get_result(run)
    refuse_counted_twice(store, runs)
    return list_run_contents(store, query.run_ids)


def _check(query: FlutterQuery) -> None:
    """Check the number of runs."""
    if not query.run_ids:
        raise BadInput("no run is selected; select at least one run that succeeded", code="no-run")
    if len(query.run_ids) > _MOST_RUNS:
        raise BadInput(
            f"{len(query.run_ids)} runs; expected at most {_MOST_RUNS}, since each may be"
            " fitted again; select one run of each maneuver, or the fastest maneuvers",
            code="too-many-runs",
        )


def build_loaded_model(
    aircraft: Aircraft, modes: AircraftModes, parts: Sequence[RunModel], fuel: float, density: float
) -> Aeroelastic:
    """Build modes and trim at a loading, with the derivatives of the last part."""
    last = parts[-1]
    condition = complete_condition(
        aircraft,
        {
            "airspeed": last.maneuver.condition.airspeed_m_s,
            "density": density,
            "fuel_fraction": fuel,
        },
    )
    structure = modes.table.at(fuel).select(last.found.aircraft.modes.numbers)
    return Aeroelastic(
        build_flight_condition(aircraft, condition),
        structure.tuned(_average_factors(modes, parts)),
        last.found.aircraft.derivatives,
        last.found.aircraft.shape,
    )


def _average_factors(modes: AircraftModes, parts: Sequence[RunModel]) -> dict[str, float]:
    """Average the estimated factors on frequencies and damping ratios of the modal table."""
    found: dict[str, float] = {}
    for number in parts[-1].found.aircraft.modes.numbers:
        ratios = []
        for part in parts:
            own = part.found.aircraft.modes.select((number,))
            table = modes.table.at(part.maneuver.condition.fuel_fraction).select((number,))
            ratios.append((own.omega[0] / table.omega[0], own.zeta[0] / (table.zeta[0] or 1.0)))
        frequency, damping = np.mean(ratios, axis=0)
        found |= {f"omega_{number}": float(frequency), f"zeta_{number}": float(damping)}
    return found


def name_motion(modes: AircraftModes, motion: str) -> str:
    """Return the display name of a motion."""
    return motion if not motion.isdigit() else modes.names.get(int(motion), f"mode {motion}")


def fuse_runs(
    store: Store, query: FlutterQuery, report: ReportProgress = lambda progress: None
) -> FlutterModels:
    """Load runs, scale them to one loading and fuse those of one model structure.

    Refits that are not stored are computed, and stored as runs.

    Parameters
    ----------
    store, query
        Runs, and the loading.
    report
        Called at every run and iteration; may raise to stop.

    Raises
    ------
    BadInput
        If there is no run, runs are of several aircraft, or the loading is impossible.
    """
    _check(query)
    derived = DerivedRuns(store, report)
    parts: list[RunModel] = []
    for k, number in enumerate(query.run_ids):
        progress = Progress(
            fraction=_FUSION_SHARE * k / len(query.run_ids), message=f"Run {number}"
        )
        report(progress)
        parts += load_run_models(store, number, query.unmodelled_modes, derived, progress)
    parts, excluded = _drop_unknown(parts)
    parts, refused = _drop_worse_fits(_drop_duplicates(parts))
    assigned_inputs = {part.maneuver.aircraft_id for part in parts}
    if len(assigned_inputs) > 1:
        raise BadInput(
            "the runs belong to different aircraft; select runs of one aircraft",
            code="different-aircraft",
        )
    if len({part.found.aircraft.derivatives.body.axis for part in parts}) > 1:
        raise BadInput(
            "the runs are of both axes, whose flutter is predicted separately; select runs of one "
            "axis",
            code="mixed-axes",
        )
    aircraft = store.aircraft.get(assigned_inputs.pop())
    modes = load_run_modes(store, parts[0].run, parts[0].maneuver)
    fastest = max(parts, key=lambda part: part.maneuver.condition.airspeed_m_s).maneuver.condition
    fuel = fastest.fuel_fraction if query.fuel is None else query.fuel
    density = fastest.density_kg_m3
    if query.altitude_m is not None:
        density = compute_standard_density(query.altitude_m)
    at = _At(aircraft, modes, fuel, density, fastest.airspeed_m_s, query.variation)
    structures = _group_by_structure(parts)
    if len(structures) == 1:
        checks: list[RunModel | None] = []
        for part in (one for one in parts if not one.retained_modes):
            progress = Progress(fraction=_FUSION_SHARE, message=f"Run {part.run.id}")
            checks.append(load_model_with_fewer_modes(store, part, derived, progress))
        structures += _group_by_structure([check for check in checks if check is not None])
    meshes = []
    for part in parts:
        progress = Progress(fraction=_FUSION_SHARE, message=f"Run {part.run.id}")
        meshes.append(load_model_of_coarse_mesh(store, part, derived, progress))
    structures += _group_by_structure([mesh for mesh in meshes if mesh is not None])
    fused: list[tuple[list[RunModel], IdentifiedModes, str]] = []
    for same in structures:
        found, note = _fuse(store, same, at, fuel)
        fused.append(
            (
                same,
                found,
                f"{_describe_modes(same, found)}{excluded}{refused}{note}"
                f"{_describe_disagreement(same, found)}{_describe_outcomes(same)}",
            )
        )
    has_failed_fits = any(one.failure is not None for one in derived.used)
    groups = _predict_groups(fused, at, fuel, has_failed_fits=has_failed_fits)
    used, computed = tuple(derived.used), tuple(derived.computed)
    return FlutterModels(query, at, groups, groups[0], fuel, used, computed)


def _group_by_structure(parts: Sequence[RunModel]) -> list[list[RunModel]]:
    found: dict[tuple[object, ...], list[RunModel]] = {}
    for part in parts:
        key = (
            part.found.aircraft.modes.numbers,
            part.source is None,
            _identify_shape(part),
            *_list_free(part),
        )
        found.setdefault(key, []).append(part)
    return list(found.values())


def _identify_shape(part: RunModel) -> tuple[int | None, bool]:
    """Return prediction and mesh of the frequency shape; derivatives are fused within them."""
    if part.found.aircraft.shape is None:
        return None, False
    return get_result(part.run).prediction_id, part.coarse_mesh


def _drop_worse_fits(parts: Sequence[RunModel]) -> tuple[list[RunModel], str]:
    """Drop second fits whose additional modes reduce the likelihood; return parts and a note.

    Where residuals are model errors rather than noise, likelihoods differ little and neither
    fit is dropped: each is part of the other's spread.
    """
    gains = [part.gain for part in parts if part.source is not None]
    if not gains or np.mean(gains) >= _CONTRADICTED:
        return list(parts), ""
    sources = sorted({part.source for part in parts if part.source is not None})
    note = (
        f" With derivatives of {' and '.join(sources)}, further modes fit the data worse"
        " and are omitted."
    )
    return [part for part in parts if part.source is None], note


def _drop_unknown(parts: Sequence[RunModel]) -> tuple[list[RunModel], str]:
    """Drop runs without finite derivatives and standard errors; return parts and a note.

    All remain where no run has them, and cannot be fused.
    """

    def is_known(part: RunModel) -> bool:
        found = part.found
        values = found.aircraft.derivatives.values
        return bool(np.isfinite(values).all() and np.isfinite(found.uncertain.covariance).all())

    known = [part for part in parts if is_known(part)]
    if not known or len(known) == len(parts):
        return list(parts), ""
    ids = sorted({part.run.id or 0 for part in parts if not is_known(part)})
    which = f"Runs {_join(ids)} are" if len(ids) > 1 else f"Run {ids[0]} is"
    return known, f" {which} excluded, since a derivative or its standard error is not finite."


def _drop_duplicates(parts: Sequence[RunModel]) -> list[RunModel]:
    """Drop second fits where a run of the same maneuver estimated the same modes."""
    known = {_get_content(part) for part in parts if part.source is None}
    return [part for part in parts if part.source is None or _get_content(part) not in known]


def _get_content(part: RunModel) -> tuple[int, frozenset[int]]:
    return part.run.maneuver_id, frozenset(part.found.aircraft.modes.numbers)


def _predict_groups(
    fused: Sequence[tuple[list[RunModel], IdentifiedModes, str]],
    at: _At,
    fuel: float,
    *,
    has_failed_fits: bool,
) -> list[Group]:
    """Predict flutter for all structures, the preferred one first, with the structure spread.

    Preferred is the structure that flight does not contradict, then with most modes, then with
    most estimated modes, then with most runs; never a second fit with one mode fewer.
    """

    def weight(one: Group) -> tuple[bool, bool, int, int, int]:
        found = one.found
        return (
            not one.parts[0].check,
            not one.prediction.refusal,
            len(found.aircraft.modes.numbers),
            found.uncertain.rows.size,
            len(one.parts),
        )

    groups = [
        Group(same, found, _add_note(at.predict(found, same, fuel), note))
        for same, found, note in fused
    ]
    first, *rest = sorted(groups, key=weight, reverse=True)
    crossing = first.prediction.crossing
    if crossing is None:
        return [first, *rest]
    note = next(note for same, _, note in fused if same is first.parts)
    spread = np.inf if has_failed_fits else compute_spread(crossing.airspeed, first, rest)
    best = at.predict(first.found, first.parts, fuel, spread)
    return [Group(first.parts, first.found, _add_note(best, note)), *rest]


def compute_spread(speed: float, preferred: Group, groups: Sequence[Group]) -> float:
    """Compute the standard deviation of the flutter speed by structures and mesh. [m/s]

    Infinite where the coarser mesh of the preferred structure has no flutter.
    """
    modes = preferred.found.aircraft.modes.numbers
    meshes = [group for group in groups if group.parts[0].coarse_mesh]
    own = [group for group in meshes if group.found.aircraft.modes.numbers == modes]
    others = [group for group in groups if not group.parts[0].coarse_mesh]
    if any(group.prediction.crossing is None for group in own):
        return np.inf
    by_structure, by_mesh = (
        compute_structure_spread(
            [g.weight_speed(speed) for g in some if g.prediction.crossing is not None], speed
        )
        for some in (others, own)
    )
    return float(np.hypot(by_structure, by_mesh))


def _add_note(prediction: FlutterPrediction, note: str) -> FlutterPrediction:
    return replace(prediction, sentence=prediction.sentence + note)


def _describe_modes(parts: Sequence[RunModel], fused: IdentifiedModes) -> str:
    """Describe the modes that the runs did not estimate."""
    part, estimated = parts[-1], fused.estimated_modes
    retained = list_nuisance_modes(parts, fused)
    known = estimated.union(retained)
    held = [n for n in fused.aircraft.modes.numbers if n not in known]
    if part.coarse_mesh:
        return " Shape of a coarser mesh, in a second fit, to bound the effect of the mesh."
    if part.check:
        return " One mode fewer, in a second fit, to bound the effect of omitted modes."
    text = ""
    if retained:
        text += f" Modes {_join(retained)} as nuisance parameters."
    for one in parts:
        if own := [n for n in one.retained_modes if n in estimated]:
            text += f" Modes {_join(own)} as nuisance parameters in run {one.run.id}."
    if held and part.source is not None:
        text += f" Modes {_join(held)} with derivatives of {part.source}, in a second fit."
    elif held:
        text += f" Modes {_join(held)} fixed at the values of the runs."
    if part.omitted_modes:
        text += (
            f" Modes {_join(part.omitted_modes)} omitted; the derivatives include their static"
            " response at the flown condition."
        )
    return text


def list_nuisance_modes(parts: Sequence[RunModel], fused: IdentifiedModes) -> tuple[int, ...]:
    """List the modes that are nuisance parameters in all runs that have them."""
    retained = {n for part in parts for n in part.retained_modes}
    return tuple(sorted(retained - fused.estimated_modes))


def _describe_outcomes(parts: Sequence[RunModel]) -> str:
    """Describe runs that did not converge."""
    ends: dict[str, list[int]] = {}
    for part in parts:
        ends.setdefault(get_result(part.run).fit.outcome, []).append(part.run.id or 0)
    return "".join(
        f" {'Run' if len(ids) == 1 else 'Runs'} {_join(ids)} ended with {outcome}."
        for outcome, ids in ends.items()
        if outcome != Outcome.CONVERGED
    )


def _describe_disagreement(parts: Sequence[RunModel], fused: IdentifiedModes) -> str:
    """Describe by how much the runs contradict each other beyond their errors, and which most."""
    ratios = {
        part.run.id or 0: ratio
        for part, ratio in zip(parts, fused.error_ratios, strict=False)
        if ratio > _DISAGREEING
    }
    if not ratios:
        return ""
    first, *others = sorted(ratios, key=lambda one: -ratios[one])
    if len({round(ratio, 6) for ratio in ratios.values()}) == 1 and len(ratios) == len(parts):
        which = f"{ratios[first]:.1f} times their standard errors"
    else:
        which = f"{ratios[first]:.1f} times its standard errors in run {first}"
        which += "".join(f", {ratios[one]:.1f} times in run {one}" for one in others)
    return (
        f" The runs contradict each other: the errors of the derivatives are {which}; the interval"
        " includes this, and such runs have less weight."
    )


def _join(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))


def _fuse(
    store: Store, flown_parts: Sequence[RunModel], at: _At, fuel: float
) -> tuple[IdentifiedModes, str]:
    """Fuse derivatives of one structure at a loading; return them and a note on the fusion."""
    parts = [
        _share_data(scale_to_fuel(store, part, fuel), shares)
        for part, shares in zip(flown_parts, _count_shared(flown_parts), strict=True)
    ]
    # The static response of omitted modes changes C_Qi_etai as an error of a frequency does.
    if any(part.check or part.omitted_modes for part in flown_parts):
        parts = [_drop_slopes(part) for part in parts]
    to = replace(
        build_loaded_model(at.aircraft, at.modes, flown_parts, fuel, at.density),
        derivatives=parts[-1].aircraft.derivatives,
    )
    constant = fuse_identified(parts, to)
    if at.variation is Variation.CONSTANT:
        return constant, ""
    try:
        if at.variation is Variation.LINEAR:
            found = _fuse_at_crossing(at, lambda q: fuse_with_trend(parts, to, q))
            note = "Derivatives vary with dynamic pressure"
        else:
            envelope = _get_envelope(store, flown_parts, at)
            factors = _compute_factors(store, flown_parts[-1], at.fuel, fuel)
            # A global model is one of derivatives with the frequencies of the modal table.
            as_in_table = fuse_identified([_drop_slopes(part) for part in parts], to)
            found = _fuse_at_crossing(
                at, lambda q: envelope.fuse(as_in_table, np.array([q, fuel]), factors)
            )
            excluded = _describe_outlying(envelope, flown_parts)
            note = f"Derivatives are those of a global model{excluded}"
    except BadInput as error:
        if error.code not in _TOO_FEW:
            raise
        return constant, f" Derivatives are constant, since {_TOO_FEW[error.code]}."
    note = f" {note} and are evaluated at the flutter point"
    held = predict_flutter(constant, at.band, at.density)
    if held.crossing is None:
        return found, f"{note}; constant derivatives predict no flutter."
    error = f" ± {2.0 * held.airspeed_std:.2f}" if np.isfinite(held.airspeed_std) else ""
    return found, f"{note}; constant derivatives predict {held.crossing.airspeed:.2f}{error} m/s."


def _drop_slopes(found: IdentifiedModes) -> IdentifiedModes:
    """Return a run whose frequencies and damping are not corrected when it is fused."""
    stiffness = found.stiffness
    exact = stiffness and replace(stiffness, slopes=None, damping_slopes=None)
    return replace(found, stiffness=exact)


def _fuse_at_crossing(at: _At, fuse: Callable[[float], IdentifiedModes]) -> IdentifiedModes:
    return fuse_at_crossing(fuse, at.band, at.density, at.tested)


def _get_envelope(store: Store, flown_parts: Sequence[RunModel], at: _At) -> EnvelopeModel:
    """Fit a global model of runs at the loading of the query, once."""
    key = tuple(part.fitted.id for part in flown_parts)
    if key not in at.envelopes:
        conditions = [part.maneuver.condition for part in flown_parts]
        flights = np.array([part.maneuver.flight_id for part in flown_parts])
        if np.unique(flights).size < _LEAST_FLIGHTS:
            flights = np.array([part.run.maneuver_id for part in flown_parts])
        at.envelopes[key] = fit_envelope(
            [scale_to_fuel(store, part, at.fuel) for part in flown_parts],
            np.array(
                [(0.5 * c.density_kg_m3 * c.airspeed_m_s**2, c.fuel_fraction) for c in conditions]
            ),
            flights,
            1.0 / np.array(_count_shared(flown_parts)),
        )
    return at.envelopes[key]


def _compute_factors(store: Store, part: RunModel, before: float, fuel: float) -> np.ndarray:
    """Compute the ratios of all predicted derivatives at two fuel weights."""
    there, here = (compute_fuel_factors(store, part, f) for f in (fuel, before))
    return there / here


def _describe_outlying(envelope: EnvelopeModel, parts: Sequence[RunModel]) -> str:
    """Describe the runs that a global model excludes."""
    ids = [parts[k].run.id or 0 for k in envelope.outlying]
    return f" without the outlying runs {_join(ids)}" if ids else ""


def _count_shared(parts: Sequence[RunModel]) -> list[int]:
    """Count the runs that use the data of each run, itself included."""
    used = [{part.run.maneuver_id, *part.run.settings.additional_maneuver_ids} for part in parts]
    return [max(sum(m in other for other in used) for m in own) for own in used]


def _share_data(found: IdentifiedModes, shares: int) -> IdentifiedModes:
    """Divide the information of a run by the number of runs that share its data."""
    uncertain, prior = found.uncertain, found.prior
    return replace(
        found,
        uncertain=replace(uncertain, covariance=shares * uncertain.covariance),
        prior=None if prior is None else replace(prior, weight=1.0 / shares),
    )


def _list_free(part: RunModel) -> tuple[tuple[int, int], ...]:
    uncertain = part.found.uncertain
    return tuple(zip(uncertain.rows.tolist(), uncertain.columns.tolist(), strict=True))
