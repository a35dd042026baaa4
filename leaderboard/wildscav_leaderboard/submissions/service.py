"""What can be done with submissions: hand in, cancel, move from state to state, list."""

from collections.abc import Sequence
from datetime import datetime

from sqlalchemy import ColumnElement, or_, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.database.connection import once
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.names import checked_line
from wildscav_leaderboard.seasons.refusals import ForbiddenError, NotFoundError, RefusalError, TooMuchError
from wildscav_leaderboard.submissions import quotas, states
from wildscav_leaderboard.submissions.archives import CheckedArchive, archive_name
from wildscav_leaderboard.submissions.models import Submission, Transition
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.webhooks.service import queue_message

LONGEST_MESSAGE = 200  # characters
MAX_LISTED = 100  # submissions in one list
PLATFORM = "platform"
DISQUALIFIED = "disqualified: "  # begins the reason for which a submission is disabled
NO_PLACE = "newer submissions of the team take part already"  # why one takes no part
INSTEAD = {  # of handing in the same content again, by the state of the earlier submission
    states.DISABLED: " (restore it, and it goes on with its results)",
    states.FAILED: " (change what made it fail)",
}


class StateError(RefusalError):
    """A submission cannot go from its state into another one."""


def check_accepting(session: Session, season: Season, team: Team, account: Account, now: datetime) -> None:
    """Check that an account may hand in a submission of its team now.

    Raises:
        RefusalError: The season is not open, a quota is used up, or the team is disqualified or another one
            for which the account submitted.
    """
    check_open(session, season, now)
    its_teams = select(Submission.team_id).where(Submission.account_id == account.id)
    for one in session.scalars(select(Team).where(or_(Team.id == team.id, Team.id.in_(its_teams)))):
        if one.disqualified is not None:
            whose = "" if one is team else ", for which you submitted,"
            raise ForbiddenError(f"the team {one.name}{whose} is disqualified: {one.disqualified}")
    quotas.check_day(session, season.settings.quotas, team, account, now)


def check_open(session: Session, season: Season, now: datetime) -> None:
    """Check that what takes part may still be changed.

    Raises:
        RefusalError: The season is not open.
    """
    settings = season.settings
    if now < settings.opens:
        raise RefusalError(f"the season opens at {settings.opens:%Y-%m-%d %H:%M} UTC")
    if now >= settings.closes:
        raise RefusalError(f"the season closed at {settings.closes:%Y-%m-%d %H:%M} UTC")
    if season_state.is_finalized(session):
        raise RefusalError("the season is over: its boards are final")
    if season_state.read_state(session, season_state.FINALIZING) is not None:
        raise RefusalError("the season is closed: it is being decided")


def hand_in(
    session: Session,
    season: Season,
    team: Team,
    account: Account,
    archive: CheckedArchive,
    message: str,
    now: datetime,
    replaces: int | None = None,
) -> Submission:
    """Enter a submission whose archive is in the season's files.

    Raises:
        RefusalError: The season is not open, the quota is used up, or the team has had the same content.
    """
    check_accepting(session, season, team, account, now)
    message = checked_line(message, "message", LONGEST_MESSAGE, empty=True)
    _check_new(session, team, archive)
    interface = archive.manifest.interface
    submission = Submission(
        team_id=team.id,
        account_id=account.id,
        name=archive.manifest.name,
        version=archive.manifest.version,
        message=message,
        tracks=archive.tracks,
        digest=archive.digest,
        content=archive.content,
        archive=archive_name(archive),
        size=archive.size,
        created=now,
        state=states.SUBMITTED,
        since=now,
        replaces=replaces,
        interface=None if interface == "numbers" else interface,
    )
    session.add(submission)
    session.flush()
    _check_place(session, season, submission)
    session.add(Transition(submission_id=submission.id, at=now, state=states.SUBMITTED))
    _report(session, submission, now)
    return submission


def _check_place(session: Session, season: Season, submission: Submission) -> None:
    """Check that there will be a place for a submission, as things are now.

    Raises:
        RefusalError: It names one to replace that takes part on none of its tracks, or all are kept.
    """
    places = [quotas.on_track(session, submission.team_id, track) for track in submission.tracks]
    if submission.replaces not in {None, *(one.id for place in places for one in place)}:
        tracks = " and ".join(submission.tracks)
        raise RefusalError(f"your team has no submission {submission.replaces} that takes part on {tracks}")
    quotas.replaced_by(session, season.settings.quotas, submission)


def _check_new(session: Session, team: Team, archive: CheckedArchive) -> None:
    """Refuse content that the team has had on a track: a copy would be a second try of the same agent."""
    same_content = or_(Submission.content == archive.content, Submission.digest == archive.digest)
    for same in session.scalars(select(Submission).where(Submission.team_id == team.id, same_content)):
        if same.state == states.CANCELLED or same.fault == PLATFORM:
            continue  # it never took part
        if shared := [track for track in same.tracks if track in archive.tracks]:
            instead = INSTEAD.get(same.state, "")
            raise RefusalError(
                f"your team's submission {same.id} has the same content on {', '.join(shared)} and is "
                f"{same.state}{instead}: nothing was submitted or charged"
            )


def find_submission(session: Session, number: int) -> Submission:
    """Return a submission.

    Raises:
        NotFoundError: There is none of this number.
    """
    wanted = select(Submission, Team).join(Team, Team.id == Submission.team_id)
    found = session.execute(wanted.where(Submission.id == number)).one_or_none()
    if found is None:
        raise NotFoundError(f"there is no submission {number}")
    submission, team = found
    once(session, Team, dict[int, Team])[team.id] = team  # for its page, which names it
    return submission


def move(
    session: Session,
    submission: Submission,
    state: str,
    now: datetime,
    *,
    detail: str = "",
    deadline: datetime | None = None,
    fault: str | None = None,
    reason: str = "",
    last_lines: Sequence[str] = (),
    command: str = "",
) -> None:
    """Move a submission into another state: the one place where states change.

    Args:
        session: A writing session.
        detail: What the history says about it.
        deadline: For leaving the new state.
        fault: Whose fault it is, if it failed: ``agent`` or ``platform``, which is never charged.
        reason: What happened, in one line.
        last_lines: The last lines that its agent printed.
        command: The command that shows it again on the competitor's machine.

    Raises:
        StateError: The state cannot follow.
    """
    if state not in states.FOLLOWING[submission.state]:
        raise StateError(
            f"submission {submission.id} is {submission.state}, and cannot become {state}"
            f"{_allowed(submission.state)}"
        )
    submission.state, submission.since, submission.deadline = state, now, deadline
    submission.fault, submission.reason = fault, reason
    submission.playing, submission.kept = list(submission.tracks) if state == states.ACTIVE else [], False
    submission.last_lines, submission.command = list(last_lines), command
    if fault == PLATFORM:
        submission.charged = False
    session.add(Transition(submission_id=submission.id, at=now, state=state, detail=detail or reason))
    session.flush()
    _report(session, submission, now)


def _allowed(state: str) -> str:
    following = sorted(states.FOLLOWING[state])
    return f"; it may become {', '.join(following)}" if following else ""


def _report(session: Session, submission: Submission, now: datetime) -> None:
    """Queue messages to the team's webhooks about a submission's new state."""
    data = {
        "submission": submission.id,
        "name": submission.name,
        "version": submission.version,
        "state": submission.state,
        "fault": submission.fault,
        "reason": submission.reason,
    }
    queue_message(session, submission.team_id, f"submission.{submission.state}", data, now)


def activate(
    session: Session, season: Season, submission: Submission, now: datetime, warnings: str = ""
) -> list[tuple[str, Submission]]:
    """Let a submission take part; where that is too many of its team, one leaves the track.

    Returns:
        Which track is left by which one.
    """
    move(session, submission, states.ACTIVE, now, detail=warnings)
    try:
        replaced = quotas.replaced_by(session, season.settings.quotas, submission)
    except TooMuchError:  # they were kept meanwhile, so there is no place for it
        replaced = [(track, submission) for track in submission.tracks]
    for track, old in replaced:
        reason = f"replaced by submission {submission.id}"
        if old is submission:  # that an attempt more, or an organizer, held up
            reason = NO_PLACE
        old.playing = [one for one in old.playing if one != track]
        if old.playing:
            note(session, old, now, f"{reason} on {track}")
        else:
            move(session, old, states.DISABLED, now, reason=reason)
    return replaced


def note(session: Session, submission: Submission, now: datetime, detail: str) -> None:
    """Add a line to the history of a submission whose state stays as it is."""
    session.add(Transition(submission_id=submission.id, at=now, state=submission.state, detail=detail))
    session.flush()


def history_of(session: Session, submission: Submission) -> list[Transition]:
    """Return the states that a submission went through, the first one first."""
    wanted = select(Transition).filter_by(submission_id=submission.id).order_by(Transition.id)
    return list(session.scalars(wanted))


def list_submissions(
    session: Session,
    *,
    team: int | None = None,
    in_states: Sequence[str] = (),
    before: int | None = None,
    limit: int = MAX_LISTED,
    where: ColumnElement[bool] | None = None,
) -> list[Submission]:
    """Return submissions, the newest first."""
    wanted = select(Submission).order_by(Submission.id.desc()).limit(limit)
    if where is not None:
        wanted = wanted.where(where)
    if team is not None:
        wanted = wanted.where(Submission.team_id == team)
    if in_states:
        wanted = wanted.where(Submission.state.in_(in_states))
    if before is not None:
        wanted = wanted.where(Submission.id < before)
    return list(session.scalars(wanted))


def taking_part(session: Session, track: str) -> list[tuple[Submission, Team]]:
    """Return the submissions that take part on a track, the oldest first, with their teams."""
    wanted = (
        select(Submission, Team)
        .join(Team, Team.id == Submission.team_id)
        .where(Submission.state == states.ACTIVE, Team.disqualified.is_(None))
        .order_by(Submission.id)
    )
    return [(one, team) for one, team in session.execute(wanted) if track in one.playing]


def team_names(session: Session, submissions: Sequence[Submission]) -> dict[int, Team]:
    """Return the teams of some submissions, by number."""
    found = once(session, Team, dict[int, Team])
    missing = {one.team_id for one in submissions} - found.keys()
    if missing:
        found |= {team.id: team for team in session.scalars(select(Team).where(Team.id.in_(missing)))}
    return found
