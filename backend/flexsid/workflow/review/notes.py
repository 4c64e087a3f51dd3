"""Notes on maneuvers, runs, modes and derivatives: every edit is a new revision."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache

from markdown_it import MarkdownIt

from flexsid.errors import BadInput, Conflict, UnknownRecord
from flexsid.records.note import Note, NoteRevision, NoteSubject
from flexsid.storage.access import get_access
from flexsid.storage.store import Store
from flexsid.sysid.model.derivatives import RIGID_BODIES, list_derivative_names
from flexsid.text import LARGEST_ID
from flexsid.workflow.model_structures.model_structures import StaleEdit


def add_note(
    store: Store,
    subject: NoteSubject,
    key: str,
    text: str,
    author: str,
    aircraft_id: int | None = None,
) -> Note:
    """Store a note.

    Parameters
    ----------
    store
        Database.
    subject, key
        What it is about; see ``NoteRevision``.
    text
        Markdown.
    author
        Name of the analyst.
    aircraft_id
        Aircraft of a mode or derivative; of a maneuver or run it follows from the record.

    Raises
    ------
    BadInput
        If the key is not one of the subject, or the aircraft is missing.
    UnknownRecord
        If the maneuver or run does not exist.
    """
    with store.transaction():
        aircraft_id = _find_aircraft(store, subject, key, aircraft_id)
        stored = store.notes.add(
            NoteRevision(
                aircraft_id=aircraft_id,
                subject=subject,
                key=key,
                text=text,
                author=author,
                author_verified=_is_verified(author),
            )
        )
    return _build_note([stored])


def edit_note(store: Store, note_id: int, revision: int, text: str, author: str) -> Note:
    """Store a new revision of a note of one's own.

    Raises
    ------
    Conflict
        If the note is of another author, or deleted.
    StaleEdit
        If ``revision`` is not the newest.
    """
    return _append(store, note_id, revision, author, text)


def delete_note(store: Store, note_id: int, revision: int, author: str) -> Note:
    """Mark a note of one's own as deleted; its revisions remain readable.

    Raises
    ------
    Conflict, StaleEdit
        As ``edit_note``.
    """
    return _append(store, note_id, revision, author, None)


def get_note(store: Store, note_id: int) -> Note:
    """Return a note with all its revisions, also if it is deleted."""
    return _build_note(_read_revisions(store, note_id))


def list_notes(
    store: Store,
    *,
    aircraft_id: int | None = None,
    maneuver_id: int | None = None,
    run_id: int | None = None,
) -> list[Note]:
    """List the notes of a campaign, a maneuver or a run that are not deleted, oldest first.

    Those of a run are also the notes on its maneuver, its modes and its derivatives.
    """
    topics: set[tuple[NoteSubject, str]] | None = None
    if run_id is not None:
        run = store.runs.get(run_id)
        aircraft_id = store.maneuvers.get(run.maneuver_id).aircraft_id
        names = () if run.result is None else (one.name for one in run.result.parameters)
        topics = {
            (NoteSubject.RUN, str(run_id)),
            (NoteSubject.MANEUVER, str(run.maneuver_id)),
            *((NoteSubject.MODE, str(mode)) for mode in run.structure.modes),
            *((NoteSubject.DERIVATIVE, name) for name in names),
        }
    elif maneuver_id is not None:
        aircraft_id = store.maneuvers.get(maneuver_id).aircraft_id
        topics = {(NoteSubject.MANEUVER, str(maneuver_id))}
    known = {} if aircraft_id is None else {"aircraft_id": aircraft_id}
    groups: dict[int, list[NoteRevision]] = {}
    for one in store.notes.find(**known):
        if topics is None or (one.subject, one.key) in topics:
            groups.setdefault(one.original_id or one.id or 0, []).append(one)
    notes = map(_build_note, groups.values())
    return [note for note in notes if not note.is_deleted]


@cache
def _make_renderer() -> MarkdownIt:
    # Neither HTML of the author, nor images, which would load from elsewhere; the parser
    # refuses links with the schemes javascript, vbscript, file and data.
    renderer = MarkdownIt("commonmark", {"html": False, "breaks": True}).enable("table")
    return renderer.disable(["image", "html_block", "html_inline"])


def render_markdown(text: str) -> str:
    """Render Markdown (CommonMark and tables) as HTML without HTML of its own and images."""
    return _make_renderer().render(text)


def _append(store: Store, note_id: int, revision: int, author: str, text: str | None) -> Note:
    with store.transaction():
        store.notes.get(note_id)  # locks the note
        revisions = _read_revisions(store, note_id)
        first, last = revisions[0], revisions[-1]
        if first.author.casefold() != author.casefold():
            raise Conflict(
                f"only {first.author} can change this note; add another note",
                code="not-your-note",
            )
        if last.is_deleted:
            raise Conflict(f"note {note_id} was deleted; add a new one", code="deleted")
        if last.revision != revision:
            raise StaleEdit(
                f"you read revision {revision} of note {note_id}, which has revision"
                f" {last.revision} by now; reload it",
                current=last,
            )
        stored = store.notes.add(
            replace(
                last,
                id=None,
                created_at=None,
                original_id=note_id,
                revision=revision + 1,
                text=text or "",
                is_deleted=text is None,
                author=author,
                author_verified=_is_verified(author),
            )
        )
    return _build_note([*revisions, stored])


def _read_revisions(store: Store, note_id: int) -> list[NoteRevision]:
    first = store.notes.get(note_id)
    if first.original_id is not None:
        raise UnknownRecord(f"there is no note {note_id}")
    return [first, *store.notes.find(original_id=note_id)]


def _build_note(revisions: Iterable[NoteRevision]) -> Note:
    ordered = sorted(revisions, key=lambda one: one.revision)
    first, last = ordered[0], ordered[-1]
    assert first.id is not None
    return Note(
        id=first.id,
        aircraft_id=first.aircraft_id,
        subject=first.subject,
        key=first.key,
        text=last.text,
        html=render_markdown(last.text),
        author=first.author,
        author_verified=last.author_verified,
        revision=last.revision,
        is_deleted=last.is_deleted,
        created_at=first.created_at,
        changed_at=last.created_at,
        revisions=tuple(ordered),
    )


def _is_verified(author: str) -> bool:
    access = get_access()
    return access is not None and access.author == author


def _find_aircraft(store: Store, subject: NoteSubject, key: str, aircraft_id: int | None) -> int:
    """Check what a note is about, and return its aircraft."""
    if subject in (NoteSubject.MANEUVER, NoteSubject.RUN):
        if not (key.isascii() and key.isdigit() and 1 <= int(key[:12]) <= LARGEST_ID):
            raise BadInput(f"key is {key!r}; expected the id of a {subject.value}", code="bad-key")
        number = int(key)
        if key != str(number):
            raise BadInput(f"key is {key!r}; expected {number}", code="bad-key")
        maneuver_id = store.runs.get(number).maneuver_id if subject is NoteSubject.RUN else number
        return store.maneuvers.get(maneuver_id).aircraft_id
    if aircraft_id is None:
        raise BadInput(
            f"a note on a {subject.value} needs its aircraft; give aircraft_id", code="no-aircraft"
        )
    aircraft = store.aircraft.get(aircraft_id)
    tables = store.modal_tables.find(aircraft_id=aircraft_id)
    modes = tuple(sorted({mode for table in tables for mode in table.numbers}))
    if subject is NoteSubject.MODE:
        if key not in map(str, modes):
            raise BadInput(
                f"mode {key!r} is in no modal table of {aircraft.name}; its modes are"
                f" {', '.join(map(str, modes)) or 'none'}",
                code="unknown-mode",
            )
        return aircraft_id
    surfaces = tuple(surface.name for surface in aircraft.surfaces)
    bodies = RIGID_BODIES.values()
    if not any(key in list_derivative_names(modes, surfaces, body) for body in bodies):
        raise BadInput(
            f"{key!r} is not a derivative of {aircraft.name}, such as Cm_alpha",
            code="unknown-derivative",
        )
    return aircraft_id
