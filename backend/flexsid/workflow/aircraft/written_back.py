"""Which versions of modal tables and predictions are the default after write-backs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from flexsid.errors import BadInput
from flexsid.records.aircraft import DerivativePrediction
from flexsid.records.modal_data import ModalTable
from flexsid.records.run import EstimationRun
from flexsid.records.write_back import WriteBack
from flexsid.storage.store import Store

_Version = TypeVar("_Version", ModalTable, DerivativePrediction)


@dataclass(frozen=True, slots=True)
class WrittenVersions:
    """The write-backs of an aircraft, oldest first, and the records that a run is of.

    A version that was undone is no default, and neither is one with the data of these records: a
    run that had it as a prior would count them twice.
    """

    write_backs: tuple[WriteBack, ...]
    maneuver_ids: frozenset[int]

    def find(
        self, *, prediction_id: int | None = None, modal_table_id: int | None = None
    ) -> WriteBack | None:
        """Find the write-back that wrote a version; None of a record from another source."""
        for one in self.write_backs:
            if prediction_id is not None and one.prediction_id == prediction_id:
                return one
            if modal_table_id is not None and one.modal_table_id == modal_table_id:
                return one
        return None

    def list_defaults(self, known: Iterable[_Version]) -> list[_Version]:
        """List those of the versions that may be a default, in their order."""
        return [
            one
            for one in known
            if (found := self._find_of(one)) is None
            or (found.undone_at is None and not self.maneuver_ids.intersection(found.maneuver_ids))
        ]

    def list_passed_over(self) -> list[WriteBack]:
        """List the write-backs in force that contain the data of these records."""
        return [
            one
            for one in self.write_backs
            if one.undone_at is None and self.maneuver_ids.intersection(one.maneuver_ids)
        ]

    def rank(self, prediction: DerivativePrediction) -> int:
        """Rank a prediction among those that cover as much: the newest write-back is first."""
        found = self.find(prediction_id=prediction.id)
        return 0 if found is None else found.id or 0

    def _find_of(self, version: ModalTable | DerivativePrediction) -> WriteBack | None:
        if isinstance(version, ModalTable):
            return self.find(modal_table_id=version.id)
        return self.find(prediction_id=version.id)


def read_written_versions(
    store: Store, aircraft_id: int, maneuver_ids: Sequence[int] = ()
) -> WrittenVersions:
    """Read the write-backs of an aircraft, for a run of these maneuvers."""
    found = store.write_backs.find(aircraft_id=aircraft_id)
    return WrittenVersions(tuple(found), frozenset(maneuver_ids))


def list_maneuvers(numbers: Iterable[int]) -> str:
    """List maneuvers for a message."""
    found = sorted(numbers)
    return f"maneuver{'s' if len(found) > 1 else ''} {', '.join(map(str, found))}"


def refuse_counted_twice(store: Store, runs: Sequence[EstimationRun]) -> None:
    """Refuse to fuse runs of which one has the posterior of another one's record as its prior.

    Raises
    ------
    BadInput
        Naming both runs and the maneuvers that would count twice.
    """
    for run in runs:
        aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
        prior = {
            number
            for one in read_written_versions(store, aircraft_id).write_backs
            if f"prediction {one.prediction_id}" in (run.rests_on or {})
            for number in one.maneuver_ids
        }
        for other in runs:
            own = {other.maneuver_id, *other.settings.additional_maneuver_ids}
            if other.id != run.id and (twice := prior & own):
                raise BadInput(
                    f"the data of {list_maneuvers(twice)} would count twice: run {run.id} has "
                    f"their posterior as its prior, and run {other.id} is of them. Leave out run "
                    f"{other.id}, or estimate run {run.id} with the prediction before it",
                    code="counted-twice",
                    run_id=run.id,
                )
