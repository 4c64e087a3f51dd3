"""Flight conditions of a campaign, and the sheet of evidence of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum

from flexsid.records.decision import StructureVersion
from flexsid.records.flutter import Flutter
from flexsid.records.run import AdequacyState, AdequacyTest, Pole


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditionRecord:
    """A maneuver of a flight condition."""

    maneuver_id: int
    label: str
    flight_number: int
    fta: int | None
    airspeed_m_s: float
    fuel_fraction: float
    n_runs: int


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditionItem:
    """A flight condition: maneuvers of one aircraft and axis at one airspeed and nearly one fuel.

    ``id`` and condition are those of its first maneuver, so that they do not change when others
    are added.
    """

    id: int
    aircraft_id: int
    aircraft_name: str
    axis: str
    airspeed_m_s: float
    airspeed_ratio: float | None
    dynamic_pressure_pa: float
    fuel_fraction: float
    records: tuple[ConditionRecord, ...]
    n_runs: int


class SourceRole(StrEnum):
    """What a source of a sheet is compared with the reference for."""

    REFERENCE = "reference"
    METHOD = "method"  # another estimator on the same record
    REPEAT = "repeat"  # another record of the condition
    PREDICTION = "prediction"
    TRUTH = "truth"  # of a simulated aircraft


@dataclass(frozen=True, slots=True, kw_only=True)
class SheetSource:
    """One source of derivatives; ``fuel_fraction`` is where it was flown."""

    key: str
    label: str
    role: SourceRole
    method: str | None = None
    run_id: int | None = None
    prediction_id: int | None = None
    maneuver_id: int | None = None
    maneuver_label: str | None = None
    fuel_fraction: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SheetValue:
    """Value of a derivative by one source, and its deviation from the reference.

    ``moved`` is what was added to the value of a repeat to bring it from its own fuel to that of
    the sheet, None of others. ``deviation_sigma`` is in standard errors of the reference; that of
    a repeat in those of the difference, without the errors that both share.
    ``deviation_percent`` is of the size of the reference.
    """

    key: str
    value: float
    std_error: float | None
    moved: float | None = None
    deviation_sigma: float | None = None
    deviation_percent: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SheetRow:
    """One derivative; ``values`` follow the sources, None without a value.

    ``modal_share`` is the share of the variance that stems from the modal data: all runs have
    this error in common, and where it is most of the variance (``is_testable`` is False) no
    repeat can test the estimate.
    """

    name: str
    label: str
    unit: str
    value: float
    std_error: float | None
    modal_share: float | None
    is_testable: bool
    values: tuple[SheetValue | None, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CorrelatedPair:
    """Two derivatives whose estimates are correlated. [1]"""

    first: str
    second: str
    correlation: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SheetAdequacy:
    """Tests for remaining model error of one run; ``smallest`` has the smallest p of them."""

    run_id: int
    method: str
    label: str
    state: AdequacyState
    n_tests: int
    n_rejected: int
    smallest: AdequacyTest | None


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOutRecord:
    """A record that the reference run was not fitted to, predicted by its model.

    ``r_squared`` is by output, None where the prediction is not stored.
    """

    maneuver_id: int
    label: str
    fuel_fraction: float
    r_squared: dict[str, float] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedAircraft:
    """An aircraft that is simulated, whose derivatives are known: the entry points of truths.

    ``compute_derivatives`` returns the true derivatives by name at a fuel fraction.
    """

    name: str
    compute_derivatives: Callable[[float], Mapping[str, float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class ConditionSheet:
    """Evidence for the model of a flight condition, from stored results.

    ``reference_run_id`` is None where no run of the condition has succeeded; all that rests on
    it is then empty. ``unfinished_run_ids`` are queued or running. ``flutter`` is stored for the
    reference alone. ``decision_id`` names the newest decision on the model structure of the
    sheet, ``baseline_decision_id`` the one that holds at this condition. ``has_truth`` if the
    aircraft is simulated; where its truth is shown, it lies in ±2σ of ``n_inside`` of ``n_true``
    derivatives.
    """

    condition: ConditionItem
    record: ConditionRecord
    reference_run_id: int | None
    prediction_ids: tuple[int, ...]
    unfinished_run_ids: tuple[int, ...]
    structure: StructureVersion | None
    decision_id: int | None
    decision_state: str | None
    baseline_decision_id: int | None
    baseline_name: str | None
    verdict: AdequacyState
    sentence: str
    note: str
    sources: tuple[SheetSource, ...]
    rows: tuple[SheetRow, ...]
    n_testable: int
    n_repeated: int
    pairs: tuple[CorrelatedPair, ...]
    n_pairs: int
    poles: tuple[Pole, ...]
    flutter: Flutter | None
    adequacy: tuple[SheetAdequacy, ...]
    held_out: tuple[HeldOutRecord, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    data_hash: str | None
    input_hash: str | None
    versions: dict[str, str]
    has_truth: bool = False
    n_true: int = 0
    n_inside: int = 0
