"""What changes about a season while it runs: whether it is paused, frozen, finalized or opened."""

from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_leaderboard.database.connection import KEPT, once
from wildscav_leaderboard.seasons.models import AuditEntry, StateValue

PAUSED = "paused"  # {"reason"}: the conductor starts nothing
FROZEN = "frozen"  # {"at"}, and "due" if the settings ask for it: the public boards stay as they were then
FREEZE_DONE = "freeze_done"  # {"due"}: the date of the settings that has frozen them last
# {"at", "best", "field"}: nothing more is accepted. The field is null until everything that was handed in is
# played; then it names the submissions of each suite that play the matches that decide the season.
FINALIZING = "finalizing"
FINALIZED = "finalized"  # {"at", "field", "conditions"}: those matches are played, and the boards are final
LEFT_OUT = "left_out"  # {number: reason}: submissions that are on no board, although they take part
NOTES_HIDDEN = "notes_hidden"  # {match: reason}: other teams see no notes of its agents
OPENED = "opened"  # {"secret", "final_secret"}: the secrets are public
EDITIONS = "editions"  # {track: number}: the editions that are in force
SEASON = "season"  # {"name", "commitment"}: whose database this is
FAILED = "failed"  # {"reason"}: the conductor can play nothing; unset after its next round
RESTARTS = "restarts"  # {thread: count}: how often the conductor's threads broke and were begun again
NODES = "nodes"  # {"nodes": […], "sandbox", "model"}: where and with what the conductor plays, for pages


def read_state(session: Session, name: str) -> dict[str, Any] | None:
    """Return a value of the season's state; None if it is not set."""
    if KEPT in session.info:  # all of it at once, since a page asks for several
        return state_of(session).get(name)
    found = session.get(StateValue, name)
    return None if found is None else found.value


def state_of(session: Session) -> dict[str, dict[str, Any]]:
    """Return all values of the season's state, by name."""
    return once(
        session, StateValue, lambda: {one.name: one.value for one in session.scalars(select(StateValue))}
    )


def write_state(session: Session, name: str, value: dict[str, Any] | None, now: datetime) -> None:
    """Set a value of the season's state, or remove it."""
    found = session.get(StateValue, name)
    if found is None and value is not None:
        session.add(StateValue(name=name, value=value, updated=now))
    elif found is not None and value is None:
        session.delete(found)
        session.flush()
    elif found is not None and value is not None:
        found.value, found.updated = value, now


def is_paused(session: Session) -> bool:
    """Return whether the organizers paused the season: nothing new is begun."""
    return read_state(session, PAUSED) is not None


def is_frozen(session: Session) -> bool:
    """Return whether the public boards stay as they are."""
    return read_state(session, FROZEN) is not None


def is_finalized(session: Session) -> bool:
    """Return whether the matches are played that decide the season, and its boards are final."""
    return read_state(session, FINALIZED) is not None


def is_decided(session: Session) -> bool:
    """Return whether the ladders are over, and only the matches are left that decide the season."""
    ending = read_state(session, FINALIZING) or {}
    return ending.get("field") is not None or is_finalized(session)


def freeze(session: Session, now: datetime, due: datetime | None = None) -> bool:
    """Keep the public boards as they are; return whether that is new.

    Args:
        session: A writing session.
        due: The date of the settings that asks for it, which is obeyed once; None if an organizer does.
    """
    date = None if due is None else {"due": due.isoformat()}
    if read_state(session, FROZEN) is not None or (date and read_state(session, FREEZE_DONE) == date):
        return False
    write_state(session, FROZEN, {"at": now.isoformat(), **(date or {})}, now)
    if date:
        write_state(session, FREEZE_DONE, date, now)
    return True


def log_act(session: Session, actor: str, act: str, subject: str, now: datetime, detail: str = "") -> None:
    """Add a privileged act to the log.

    Args:
        session: A writing session.
        actor: The name of the account; ``command line`` or ``conductor`` if there is none.
        act: A verb, such as "disqualify team".
        subject: What it was done to, such as "team foxes".
        detail: The reason, or what changed.
    """
    session.add(AuditEntry(at=now, actor=actor, act=act, subject=subject, detail=detail))
