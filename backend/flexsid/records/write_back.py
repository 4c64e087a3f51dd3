"""Write back: the posterior of a run as new versions of modal table and prediction."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from flexsid.allowed import RequiredText
from flexsid.records.run import AdequacyState


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteBack:
    """A decision to write back the posterior of a run, with what it wrote.

    ``maneuver_ids`` are the records whose data are in the posterior: those of the run, and those of
    the versions that it used. ``names`` with ``values`` are its parameters, ``covariance`` is the
    hash of the joint covariance of their errors, at ``fuel_fraction``; ``modes`` are those of the
    model, retained ones included. ``adequacy`` is that of the run. The former versions stay; an
    undone write-back is no default.
    """

    aircraft_id: int
    run_id: int
    run_hash: str
    reason: RequiredText
    sentence: str
    maneuver_ids: tuple[int, ...]
    fuel_fraction: float
    modes: tuple[int, ...]
    names: tuple[str, ...]
    values: tuple[float, ...]
    covariance: str
    adequacy: AdequacyState
    prediction_id: int
    former_prediction_id: int | None = None
    modal_table_id: int | None = None
    former_modal_table_id: int | None = None
    author: str = ""
    created_at: datetime | None = None
    undone_by: str | None = None
    undone_at: datetime | None = None
    id: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenParameter:
    """A parameter before and after a write-back; None where it was not known.

    ``omega_<mode>`` and ``zeta_<mode>`` are factors on frequency and damping of the former table.
    """

    name: str
    before: float | None
    before_std: float | None
    after: float
    after_std: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteBackProposal:
    """What a write-back of a run would write; ``warnings`` are reasons to look at it first."""

    run_id: int
    sentence: str
    prediction: str
    former_prediction: str | None
    modal_table: str | None
    former_modal_table: str | None
    maneuver_ids: tuple[int, ...]
    parameters: tuple[WrittenParameter, ...]
    n_shapes: int
    warnings: tuple[str, ...] = ()
