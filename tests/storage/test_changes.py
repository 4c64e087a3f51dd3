"""Changes by a team are found on every database, and by campaign."""

from __future__ import annotations

from flexsid.records.maneuver import Maneuver
from flexsid.records.note import NoteRevision, NoteSubject
from flexsid.storage.changes import find_changed, read_totals
from flexsid.storage.store import Store


def test_a_note_is_one_change_of_its_campaign(store: Store, maneuver: Maneuver) -> None:
    before = read_totals(store)
    note = NoteRevision(
        aircraft_id=maneuver.aircraft_id,
        subject=NoteSubject.MANEUVER,
        key=str(maneuver.id),
        text="Repeat at 30 m/s",
        author="Ada",
    )
    store.notes.add(note)
    after = read_totals(store)
    assert find_changed(before, after) == {("notes", maneuver.aircraft_id)}
    assert find_changed(after, read_totals(store)) == frozenset()
