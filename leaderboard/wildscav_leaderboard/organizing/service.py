"""What organizers can do. Every act is entered in the audit log, with who did it and why."""

from datetime import datetime

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.models import COMPETITOR, ORGANIZER, Account
from wildscav_leaderboard.accounts.service import add_account, known_account, set_password
from wildscav_leaderboard.accounts.service import invite as new_invitation
from wildscav_leaderboard.conductor import attempts
from wildscav_leaderboard.matches import service as matches
from wildscav_leaderboard.matches.models import VOID, Match
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.models import Announcement
from wildscav_leaderboard.seasons.names import checked_line
from wildscav_leaderboard.seasons.refusals import InvalidError, RefusalError
from wildscav_leaderboard.seasons.state import log_act
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import DISQUALIFIED, find_submission, move
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import find_team

LONGEST_REASON, LONGEST_TEXT = 500, 5000  # characters
COMMAND_LINE = "command line"  # the actor of an act that no account did


def pause(session: Session, actor: str, reason: str, now: datetime) -> None:
    """Let the conductor begin nothing new until the season goes on; what is being played is finished."""
    reason = _reason(reason)
    season_state.write_state(session, season_state.PAUSED, {"reason": reason}, now)
    log_act(session, actor, "pause", "season", now, reason)


def resume(session: Session, actor: str, now: datetime) -> None:
    """Let the season go on.

    Raises:
        RefusalError: It is not paused.
    """
    if season_state.read_state(session, season_state.PAUSED) is None:
        raise RefusalError("the season is not paused")
    season_state.write_state(session, season_state.PAUSED, None, now)
    log_act(session, actor, "resume", "season", now)


def announce(session: Session, actor: str, title: str, text: str, now: datetime) -> None:
    """Show a text to everyone."""
    title = checked_line(title, "title of an announcement", 100)
    text = text.replace("\r\n", "\n").strip()
    if len(text) > LONGEST_TEXT or not all(line.isprintable() for line in text.split("\n")):
        raise InvalidError(f"an announcement may have {LONGEST_TEXT:,} printable characters at most")
    session.add(Announcement(at=now, author=actor, title=title, text=text))
    log_act(session, actor, "announce", f"announcement {title!r}", now)


def invite(
    session: Session, actor: str, label: str, now: datetime, *, role: str = COMPETITOR, uses: int | None = 1
) -> str:
    """Make an invitation, and return its key, which is shown once."""
    key = new_invitation(session, label, now, role=role, uses=uses)
    many = "any number of" if uses is None else f"{uses}"
    log_act(session, actor, "invite", role, now, f"{label}: {many} registrations")
    return key


def add_organizer(session: Session, actor: str, name: str, password_hash: str, now: datetime) -> Account:
    """Make an account of an organizer."""
    account = add_account(session, name, password_hash, ORGANIZER, now)
    log_act(session, actor, "add organizer", f"account {name}", now)
    return account


def disable_account(session: Session, actor: str, name: str, reason: str, now: datetime) -> None:
    """Let an account no longer be used; its owner is told the reason.

    Raises:
        NotFoundError: There is no such account.
        RefusalError: It is the actor's own.
    """
    account = known_account(session, name)
    if name == actor:
        raise RefusalError("this is your own account: another organizer, or the command line, can disable it")
    account.disabled = _reason(reason)
    log_act(session, actor, "disable account", f"account {name}", now, account.disabled)


def enable_account(session: Session, actor: str, name: str, now: datetime) -> None:
    """Let a disabled account be used again.

    Raises:
        NotFoundError: There is no such account.
        RefusalError: It is not disabled.
    """
    account = known_account(session, name)
    if account.disabled is None:
        raise RefusalError(f"the account {name} is not disabled")
    account.disabled = None
    log_act(session, actor, "enable account", f"account {name}", now)


def reset_password(session: Session, actor: str, name: str, password_hash: str, now: datetime) -> None:
    """Give an account another password. Its tokens and its sessions in browsers end.

    Raises:
        NotFoundError: There is no such account.
    """
    set_password(session, known_account(session, name), password_hash, now)
    log_act(session, actor, "reset password", f"account {name}", now)


def disqualify_team(session: Session, actor: str, name: str, reason: str, now: datetime) -> None:
    """Take a team off all boards; the reason is shown to everyone."""
    team = find_team(session, name)
    team.disqualified = _reason(reason)
    wanted = select(Submission).where(Submission.team_id == team.id, Submission.state.not_in(states.FINAL))
    for submission in session.scalars(wanted).all():
        _take_off(session, submission, f"the team is disqualified: {team.disqualified}", now)
    log_act(session, actor, "disqualify team", f"team {name}", now, team.disqualified)


def disqualify_submission(session: Session, actor: str, number: int, reason: str, now: datetime) -> None:
    """Take a submission off all boards; the reason is shown to everyone."""
    reason = _reason(reason)
    _take_off(session, find_submission(session, number), f"{DISQUALIFIED}{reason}", now)
    log_act(session, actor, "disqualify submission", f"submission {number}", now, reason)


def _take_off(session: Session, submission: Submission, reason: str, now: datetime) -> None:
    """Let a submission no longer take part, or not take part at all if it is still on its way."""
    state = states.DISABLED if submission.state == states.ACTIVE else states.CANCELLED
    move(session, submission, state, now, reason=reason)
    matches.withdraw(session, submission, now)


def rerun(session: Session, actor: str, number: int, now: datetime) -> None:
    """Try a failed submission again, or play the matches again that the platform gave up.

    Raises:
        RefusalError: There is nothing to try again.
    """
    submission = find_submission(session, number)
    if submission.state == states.FAILED:
        _check_not_disqualified(session, submission)
        attempts.forgive_submission(session, submission.id)
        move(session, submission, states.QUEUED, now, detail="run again by the organizers")
        submission.platform_faults = 0
    elif not _play_again(session, submission, now):
        raise RefusalError(f"submission {number} is {submission.state}, and none of its matches was given up")
    log_act(session, actor, "rerun", f"submission {number}", now)


def _check_not_disqualified(session: Session, submission: Submission) -> None:
    team = session.get_one(Team, submission.team_id)
    if team.disqualified is not None:
        raise RefusalError(f"the team {team.name} is disqualified: {team.disqualified}")


def _play_again(session: Session, submission: Submission, now: datetime) -> int:
    """Let the matches of a submission wait again that were given up; return how many there are."""
    if submission.state != states.ACTIVE:
        return 0
    given_up = select(Match.id).where(Match.group_id == submission.id, Match.state == VOID)
    numbers = session.scalars(given_up).all()
    attempts.forgive_matches(session, numbers)
    session.execute(
        update(Match)
        .where(Match.id.in_(numbers))
        .values(state="waiting", since=now, detail="", platform_faults=0)
    )
    return len(numbers)


def freeze(session: Session, actor: str, now: datetime) -> None:
    """Keep the public boards as they are until the season is over.

    Raises:
        RefusalError: They are frozen already.
    """
    if season_state.read_state(session, season_state.FROZEN) is not None:
        raise RefusalError("the public boards are frozen already")
    season_state.freeze(session, now)
    log_act(session, actor, "freeze", "boards", now)


def _reason(text: str) -> str:
    return checked_line(text, "reason", LONGEST_REASON)
