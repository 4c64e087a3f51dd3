"""Notifications: decisions awaiting an analyst, changes since the last visit, and messages."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime

from flexsid.records.account import Account, AccountRole
from flexsid.records.decision import (
    Decision,
    DecisionState,
    EventKind,
    SeenEvents,
    StructureVersion,
)
from flexsid.storage.store import Store
from flexsid.workflow.accounts.accounts import find_role, list_roles
from flexsid.workflow.review.decision_review import OPEN, get_rules

_MOST = 100
_LONG_AGO = datetime.min.replace(tzinfo=UTC)


@dataclass(frozen=True, slots=True, kw_only=True)
class Waiting:
    """A decision awaiting this analyst; ``what`` is review or revise."""

    decision_id: int
    title: str
    what: str
    revision: int
    since: datetime | None


@dataclass(frozen=True, slots=True, kw_only=True)
class TeamChange:
    """A change by another analyst; ``subject`` is a decision or a model structure."""

    subject: str
    id: int
    title: str
    what: str
    author: str
    text: str
    number: int
    at: datetime | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Notifications:
    """Decisions awaiting an analyst, and the latest changes (at most 100), newest first."""

    waiting: list[Waiting]
    changes: list[TeamChange]


def list_notifications(store: Store, analyst: str) -> Notifications:
    """List the notifications of an analyst."""
    seen = {look.subject: look.seen for look in store.looks.find(analyst=analyst.casefold())}
    decisions = store.decisions.find()
    waiting = [_find_waiting(store, one, analyst) for one in decisions]
    changes = _merge(
        _list_decision_changes(store, decisions, analyst, seen),
        _list_structure_changes(store, analyst, seen),
    )
    return Notifications(
        waiting=[one for one in waiting if one is not None], changes=changes[:_MOST]
    )


def _merge(*kinds: list[tuple[int, TeamChange]]) -> list[TeamChange]:
    """Merge changes of several kinds, each in the order in which it was written.

    Times only order the kinds: a clock may have been set back, so the time of each change is at
    least that of the changes written before it.
    """
    placed: list[tuple[datetime, int, TeamChange]] = []
    for changes in kinds:
        latest = _LONG_AGO
        for number, change in sorted(changes, key=lambda one: one[0]):
            latest = max(latest, change.at or latest)
            placed.append((latest, number, change))
    placed.sort(key=lambda one: one[:2], reverse=True)
    return [change for _, _, change in placed]


def mark_seen(store: Store, analyst: str, subject: str, number: int) -> None:
    """Store the last event of a subject seen by an analyst; never decreases."""
    key = analyst.casefold()
    with store.transaction():
        known = next(iter(store.looks.find(analyst=key, subject=subject)), None)
        if known is None:
            store.looks.add(SeenEvents(analyst=key, subject=subject, seen=number))
        elif number > known.seen:
            store.looks.replace(replace(known, seen=number))


def mark_all_seen(store: Store, analyst: str) -> None:
    """Mark all present events as seen by an analyst."""
    with store.transaction():
        for decision in store.decisions.find():
            mark_seen(store, analyst, f"decision {decision.id}", decision.version)
        for structure in store.model_structures.find():
            mark_seen(store, analyst, f"structure {structure.id}", structure.version)


# --- Messages to accounts that do not open the page, each sent once -------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Message:
    """What is new of a decision that concerns an account, up to event ``number``."""

    analyst: str
    decision_id: int
    number: int
    title: str
    lines: tuple[str, ...]


def list_messages(store: Store, channel: str, since: datetime) -> list[Message]:
    """List what accounts have neither seen nor been sent by a channel, of events since a time.

    Reviewers are sent proposals and revisions that await their vote; authors of a proposal all
    that others decide or comment.
    """
    decisions = [one for one in store.decisions.find() if (one.changed_at or since) > since]
    accounts = [one for one in store.accounts.find() if one.disabled_at is None]
    found = [_list_messages_to(store, channel, one, decisions, since) for one in accounts]
    return [message for messages in found for message in messages]


def mark_sent(store: Store, channel: str, message: Message) -> int:
    """Store that a message is sent; return the event up to which the one before it was."""
    subject = f"{channel} decision {message.decision_id}"
    with store.transaction():
        before = store.looks.find(analyst=message.analyst.casefold(), subject=subject)
        mark_seen(store, message.analyst, subject, message.number)
    return before[0].seen if before else 0


def mark_unsent(store: Store, channel: str, message: Message, number: int) -> None:
    """Store that a message marked as sent was refused, so that it is sent again."""
    subject = f"{channel} decision {message.decision_id}"
    with store.transaction():
        (known,) = store.looks.find(analyst=message.analyst.casefold(), subject=subject)
        store.looks.replace(replace(known, seen=number))


def _list_messages_to(
    store: Store, channel: str, account: Account, decisions: list[Decision], since: datetime
) -> list[Message]:
    roles = list_roles(store, account)
    messages: list[Message] = []
    marks = {one.subject: one.seen for one in store.looks.find(analyst=account.name.casefold())}
    for decision in decisions:
        role = find_role(roles, decision.aircraft_id)
        if role is None:
            continue
        subject = f"decision {decision.id}"
        seen = {subject: max(marks.get(subject, 0), marks.get(f"{channel} {subject}", 0))}
        changes = [
            change
            for _, change in _list_decision_changes(store, [decision], account.name, seen)
            if (change.at or since) > since
        ]
        if account.name.casefold() not in {name.casefold() for name in decision.authors}:
            waiting = _find_waiting(store, decision, account.name)
            if waiting is None or role.rank < AccountRole.REVIEWER.rank:
                continue
            kinds = (EventKind.PROPOSED.value, EventKind.REVISED.value)
            changes = [change for change in changes if change.what in kinds]
        if changes:
            messages.append(
                Message(
                    analyst=account.name,
                    decision_id=decision.id or 0,
                    number=changes[-1].number,
                    title=" ".join(decision.proposal.title.split()),
                    lines=tuple(f"{change.author}: {change.what}" for change in changes),
                )
            )
    return messages


# --- What awaits an analyst, and what has changed -------------------------------------------------


def _find_waiting(store: Store, decision: Decision, analyst: str) -> Waiting | None:
    if decision.state not in OPEN:
        return None
    me = analyst.casefold()
    own = me in {name.casefold() for name in decision.authors}
    voted = me in {name.casefold() for name in decision.votes}
    if own and decision.state is DecisionState.CHANGES_REQUESTED:
        what = "revise"
    elif voted or (own and not get_rules(store, decision.aircraft_id).own_allowed):
        return None
    else:
        what = "review"
    assert decision.id is not None
    return Waiting(
        decision_id=decision.id,
        title=decision.proposal.title,
        what=what,
        revision=decision.revision,
        since=decision.changed_at,
    )


def _list_decision_changes(
    store: Store, decisions: list[Decision], analyst: str, seen: dict[str, int]
) -> list[tuple[int, TeamChange]]:
    changes: list[tuple[int, TeamChange]] = []
    for decision in decisions:
        assert decision.id is not None
        last = seen.get(f"decision {decision.id}", 0)
        if decision.version <= last:
            continue
        changes += [
            (
                event.id or 0,
                TeamChange(
                    subject="decision",
                    id=decision.id,
                    title=decision.proposal.title,
                    what=event.vote.value if event.vote is not None else event.kind.value,
                    author=event.author,
                    text=event.text if event.kind is not EventKind.PROPOSED else "",
                    number=event.number,
                    at=event.created_at,
                ),
            )
            for event in store.decision_events.find(decision_id=decision.id)
            if event.number > last and event.author.casefold() != analyst.casefold()
        ]
    return changes


def _list_structure_changes(
    store: Store, analyst: str, seen: dict[str, int]
) -> list[tuple[int, TeamChange]]:
    """List versions by others after those saved or seen by this analyst."""
    me = analyst.casefold()
    changes: list[tuple[int, TeamChange]] = []
    for structure in store.model_structures.find():
        assert structure.id is not None
        if structure.version == 1:
            continue
        versions: list[StructureVersion] = store.structure_versions.find(structure_id=structure.id)
        own = max((one.version for one in versions if one.author.casefold() == me), default=0)
        last = max(own, seen.get(f"structure {structure.id}", 0))
        changes += [
            (
                one.id or 0,
                TeamChange(
                    subject="structure",
                    id=structure.id,
                    title=one.name,
                    what=f"version {one.version}",
                    author=one.author,
                    text=one.note,
                    number=one.version,
                    at=one.created_at,
                ),
            )
            for one in versions
            if one.version > last > 0
        ]
    return changes
