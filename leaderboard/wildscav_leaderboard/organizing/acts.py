"""What organizers can do. Pages, API and command line are made of this list, and each act is logged."""

from collections.abc import Callable, Sequence
from inspect import signature
from typing import Any

from sqlalchemy import select, update
from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.models import ORGANIZER
from wildscav_leaderboard.accounts.service import add_account, known_account, set_password
from wildscav_leaderboard.accounts.service import invite as new_invitation
from wildscav_leaderboard.conductor import attempts
from wildscav_leaderboard.matches import service as matches
from wildscav_leaderboard.matches.models import FINAL, FINISHED, LADDER, VOID, WAITING, Match, MatchSeat
from wildscav_leaderboard.organizing.arguments import (
    AccountName,
    Chosen,
    Days,
    Label,
    MatchNumber,
    NewKey,
    NewPassword,
    Number,
    Reason,
    ReasonForOwner,
    Role,
    Submissions,
    TeamName,
    Text,
    Title,
    Track,
    Uses,
)
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.acts import Act, Doing
from wildscav_leaderboard.seasons.in_force import edition_numbers
from wildscav_leaderboard.seasons.models import Announcement
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.seasons.state import is_decided
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.quotas import check_room, tracks_with_room
from wildscav_leaderboard.submissions.service import DISQUALIFIED, NO_PLACE, find_submission, move, note
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import find_team

TEAM_DISQUALIFIED = "the team is disqualified: "  # begins why its submissions are disabled
COMMAND_LINE = "command line"  # how the actor of an act begins that no account did
ACTS: dict[str, Act] = {}  # by the names that forms use


def act(
    subject: str,
    title: str = "",
    *,
    path: str | None = None,
    command: str = "",
    says: str = "",
    detail: str = "{reason}",
) -> Callable[[Callable[..., Any]], Act]:
    """Make an act of a function; for what the texts are, see ``Act``.

    Unless it is told otherwise, its command is the first word of the function's name, and its title, too. Its
    route is that of its subject, followed by the command. The audit log has the reason, if there is one.
    """

    def made(effect: Callable[..., Any]) -> Act:
        verb = command or effect.__name__.partition("_")[0]
        noun, _, argument = subject.partition(" ")
        route = f"/{noun}s/{argument}/{verb}" if argument else f"/{verb}"
        noted = detail if detail != "{reason}" or "reason" in signature(effect).parameters else ""
        shown = title or verb.capitalize()
        one = Act(effect, shown, subject, noted, route if path is None else path, verb, says)
        ACTS[one.name] = one
        return one

    return made


@act("season", "Pause the season", says="paused")
def pause(doing: Doing, *, reason: Reason = "maintenance") -> None:
    """Let nothing new be begun; what is being played is finished."""
    season_state.write_state(doing.session, season_state.PAUSED, {"reason": reason}, doing.now)


@act("season", "Resume the season", says="the season goes on")
def resume(doing: Doing) -> None:
    """Let a paused season go on."""
    _unset(doing, season_state.PAUSED, "the season is not paused")


@act("boards", "Freeze the public boards", says="the public boards are frozen")
def freeze(doing: Doing) -> None:
    """Keep the public boards as they are until the season is over; organizers still see the hidden ones."""
    if not season_state.freeze(doing.session, doing.now):
        raise RefusalError("the public boards are frozen already")


@act("boards", "Unfreeze the public boards", says="the boards go on")
def unfreeze(doing: Doing) -> None:
    """Show on the public boards what is played. A date of the settings that has passed freezes no more."""
    _unset(doing, season_state.FROZEN, "the public boards are not frozen")


def _unset(doing: Doing, name: str, otherwise: str) -> None:
    """Remove a value of the season's state; refuse if there is none."""
    if season_state.read_state(doing.session, name) is None:
        raise RefusalError(otherwise)
    season_state.write_state(doing.session, name, None, doing.now)


@act("announcement {title!r}", path="/announcements", says="announced")
def announce(doing: Doing, title: Title, text: Text = "") -> None:
    """Show an announcement on the season's page."""
    author = "the organizers" if doing.actor.startswith(COMMAND_LINE) else doing.actor
    doing.session.add(Announcement(at=doing.now, author=author, title=title, text=text))


@act("{role}", "Make an invitation", path="/invitations", detail="{label}: {uses} registrations")
def invite(
    doing: Doing, *, label: Label = "", uses: Uses = 1, days: Days = 30, role: Role = "competitor"
) -> NewKey:
    """Make an invitation, with whose key people register. The key is shown once."""
    return NewKey(key=new_invitation(doing.session, label, doing.now, role=role, uses=uses, days=days))


@act("account {name}", "Make an organizer", path="", command="organizer", says="account  {name}")
def add_organizer(doing: Doing, name: AccountName, *, password: Chosen = None) -> NewPassword:  # type: ignore[assignment]
    """Make an account of an organizer, who sees the organizers' pages."""
    add_account(doing.session, name, password.secret, ORGANIZER, doing.now)
    return NewPassword(name=name, password=password.text if password.is_new else None)


@act("account {name}", "New password", command="password", says="account  {name}")
def reset_password(doing: Doing, name: AccountName, *, password: Chosen = None) -> NewPassword:  # type: ignore[assignment]
    """Give an account another password; it is logged out everywhere, and its tokens are revoked."""
    set_password(doing.session, known_account(doing.session, name), password.secret, doing.now)
    return NewPassword(name=name, password=password.text if password.is_new else None)


@act("account {name}", says="the account {name} is disabled")
def disable_account(doing: Doing, name: AccountName, *, reason: ReasonForOwner) -> None:
    """Let an account no longer be used. What its team handed in goes on."""
    account = known_account(doing.session, name)
    if name == doing.actor:
        raise RefusalError("this is your own account: another organizer, or the command line, can disable it")
    account.disabled = reason


@act("account {name}", says="the account {name} may be used again")
def enable_account(doing: Doing, name: AccountName) -> None:
    """Let a disabled account be used again."""
    account = known_account(doing.session, name)
    if account.disabled is None:
        raise RefusalError(f"the account {name} is not disabled")
    account.disabled = None


@act("submission {number}", "Run again", says="submission {number} is tried again")
def rerun(doing: Doing, number: Number) -> Submission:
    """Try a failed submission again, or play the matches again that were given up."""
    submission = find_submission(doing.session, number)
    if submission.state == states.FAILED:
        _check_not_disqualified(doing.session, submission)
        attempts.forgive_submission(doing.session, submission.id)
        move(doing.session, submission, states.QUEUED, doing.now, detail="run again by the organizers")
        submission.platform_faults = 0
    elif not _play_again(doing, submission):
        raise RefusalError(f"submission {number} is {submission.state}, and none of its matches was given up")
    return submission


def _check_not_disqualified(session: Session, submission: Submission) -> None:
    team = session.get_one(Team, submission.team_id)
    if team.disqualified is not None:
        raise RefusalError(f"the team {team.name} is disqualified: {team.disqualified}")


@act(
    "results",
    "Judge again",
    says="they are judged again",
    detail="submissions {submission} on the tracks {track}: {reason}",
)
def rejudge(
    doing: Doing, *, track: Track = "all", submission: Submissions = "all", reason: Reason = "judged again"
) -> None:
    """Play matches again that were played under the rules in force; it costs no quota.

    A result counts until the new one arrives, and is kept as superseded from then on.
    """
    del reason  # it is for the audit log
    session, decided = doing.session, is_decided(doing.session)
    if season_state.is_finalized(session):
        raise RefusalError("the season is finalized: its boards are final")
    editions = edition_numbers(session)
    if track != "all" and track not in editions:
        raise RefusalError(f"nobody has played on {track!r}; the tracks are {', '.join(editions)}, or all")
    played = editions.values() if track == "all" else [editions[track]]
    wanted = select(Match).where(
        Match.edition_id.in_(played),
        Match.state == FINISHED,
        Match.superseded.is_(None),
        Match.decides if decided else ~Match.decides,
    )
    if submission != "all":
        numbers = [find_submission(session, int(number)).id for number in submission.split()]
        wanted = wanted.where(
            Match.id.in_(select(MatchSeat.match_id).where(MatchSeat.submission_id.in_(numbers)))
        )
    chosen = [one for one in session.scalars(wanted.order_by(Match.id)) if matches.takes_part(session, one)]
    if not sum(matches.judge_again(session, one, doing.now) is not None for one in chosen):
        raise RefusalError(
            "none of these was played under the rules in force, or all are judged again already"
        )


@act(
    "match {number}",
    "Hide what agents said",
    path="/matches/{number}/hide",
    says="what agents said in match {number} is hidden",
)
def hide_notes(doing: Doing, number: MatchNumber, *, reason: Reason) -> None:
    """Let other teams see nothing of what agents said and drew in a match, public or not."""
    matches.find_match(doing.session, number)
    hidden = season_state.read_state(doing.session, season_state.NOTES_HIDDEN) or {}
    value = {**hidden, str(number): reason}
    season_state.write_state(doing.session, season_state.NOTES_HIDDEN, value, doing.now)


@act(
    "match {number}",
    "Show what agents said",
    path="/matches/{number}/unhide",
    command="unhide",
    says="it is shown again",
)
def show_notes(doing: Doing, number: MatchNumber) -> None:
    """Let other teams see again what agents said and drew in a match, as far as it is public."""
    hidden = dict(season_state.read_state(doing.session, season_state.NOTES_HIDDEN) or {})
    if hidden.pop(str(number), None) is None:
        raise RefusalError(f"what agents said in match {number} is not hidden")
    season_state.write_state(doing.session, season_state.NOTES_HIDDEN, hidden or None, doing.now)


def given_up(session: Session, submissions: Sequence[Submission]) -> dict[int, list[int]]:
    """Return the matches of some submissions that were given up and can be played again, by submission."""
    active = [one.id for one in submissions if one.state == states.ACTIVE]
    in_force = matches.are_in_force(session)  # others would wait for ever
    of_suites = (Match.kind != LADDER, Match.group_id.in_(active), Match.state == VOID)
    wanted = select(Match.group_id, Match.id).where(*of_suites, in_force)
    found: dict[int, list[int]] = {}
    for submission, match in session.execute(wanted):
        found.setdefault(submission, []).append(match)
    return found


def _play_again(doing: Doing, submission: Submission) -> int:
    """Let the matches of a submission wait again that were given up; return how many there are."""
    numbers = given_up(doing.session, [submission]).get(submission.id, [])
    attempts.forgive_matches(doing.session, numbers)
    doing.session.execute(
        update(Match)
        .where(Match.id.in_(numbers))
        .values(state=WAITING, since=doing.now, detail="", platform_faults=0)
    )
    return len(numbers)


@act("team {name}", says="{name} is disqualified")
def disqualify_team(doing: Doing, name: TeamName, *, reason: Reason) -> None:
    """Take a team or a submission off all boards."""
    team = find_team(doing.session, name)
    team.disqualified = reason
    wanted = select(Submission).where(Submission.team_id == team.id, Submission.state.not_in(states.FINAL))
    for submission in doing.session.scalars(wanted).all():
        _take_off(doing, submission, f"{TEAM_DISQUALIFIED}{reason}")


@act("submission {number}", says="{number} is disqualified")
def disqualify_submission(doing: Doing, number: Number, *, reason: Reason) -> Submission:
    """Take a submission off all boards."""
    submission = find_submission(doing.session, number)
    _take_off(doing, submission, f"{DISQUALIFIED}{reason}")
    return submission


def _take_off(doing: Doing, submission: Submission, reason: str) -> None:
    """Let a submission no longer take part, or not take part at all if it is still on its way."""
    state = states.DISABLED if submission.state == states.ACTIVE else states.CANCELLED
    move(doing.session, submission, state, doing.now, reason=reason)
    matches.withdraw(doing.session, submission, doing.now)


@act("team {name}", says="{name} takes part again")
def requalify_team(doing: Doing, name: TeamName, *, reason: Reason) -> None:
    """Let a disqualified team or submission take part again, with the results that it had."""
    team = find_team(doing.session, name)
    if team.disqualified is None:
        raise RefusalError(f"the team {name} is not disqualified")
    why, team.disqualified = f"{TEAM_DISQUALIFIED}{team.disqualified}", None
    wanted = select(Submission).filter_by(team_id=team.id, state=states.DISABLED, reason=why)
    # The newest first, since older ones had left the tracks on which newer ones took their place.
    for submission in doing.session.scalars(wanted.order_by(Submission.id.desc())).all():
        if tracks := tracks_with_room(doing.session, doing.season.settings.quotas, submission):
            _take_part(doing, submission, tracks, reason)
        else:  # its team may restore it once there is room
            submission.reason = NO_PLACE
            note(doing.session, submission, doing.now, NO_PLACE)


@act("submission {number}", says="{number} takes part again")
def requalify_submission(doing: Doing, number: Number, *, reason: Reason) -> Submission:
    """Let a disqualified submission take part again, with the results that it had."""
    submission = find_submission(doing.session, number)
    if not submission.reason.startswith(DISQUALIFIED):
        raise RefusalError(f"submission {number} is {submission.state}, and not disqualified")
    return take_part_again(doing, submission, reason)


@act("submission {number}", says="submission {number} takes part again")
def reactivate(doing: Doing, number: Number, *, reason: Reason) -> Submission:
    """Let a submission take part again that a newer one replaced, or that its team disabled."""
    submission = find_submission(doing.session, number)
    if submission.reason.startswith((DISQUALIFIED, TEAM_DISQUALIFIED)):
        raise RefusalError(
            f"submission {number} is disqualified: `wildscav season requalify` takes that back"
        )
    return take_part_again(doing, submission, reason)


def take_part_again(doing: Doing, submission: Submission, reason: str) -> Submission:
    """Let a disabled submission take part again: what it has not played yet is planned.

    Raises:
        RefusalError: It is not disabled, its team is disqualified, or has enough others that take part.
    """
    _check_not_disqualified(doing.session, submission)
    if submission.state in (states.DISABLED, states.ACTIVE):
        check_room(doing.session, doing.season.settings.quotas, submission)
    return _take_part(doing, submission, list(submission.tracks), reason)


def _take_part(doing: Doing, submission: Submission, tracks: list[str], reason: str) -> Submission:
    """Let a submission take part on some of its tracks, all of which have room for it."""
    from wildscav_leaderboard.conductor.plans import plan_suites  # which loads SciPy, for ladders

    session, season, _, now = doing
    if submission.state == states.ACTIVE and submission.playing != tracks:  # it left some
        note(session, submission, now, reason)
    else:
        move(session, submission, states.ACTIVE, now, detail=reason)
    submission.playing = tracks
    if not season_state.is_decided(session):
        plan_suites(session, season, submission, now)
    field = (season_state.read_state(session, season_state.FINALIZING) or {}).get("field") or {}
    for track, specs in season.final_matches.items():
        if submission.id in field.get(track, ()):
            matches.add_suite_matches(session, submission, track, specs, now, FINAL)
    return submission
