"""What a team decides about its own submissions. Pages, API and command line are made of this list."""

from datetime import datetime

from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.matches.service import withdraw
from wildscav_leaderboard.organizing.acts import TEAM_DISQUALIFIED, take_part_again
from wildscav_leaderboard.organizing.arguments import Number
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.acts import Act, Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import NotFoundError, RefusalError
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import DISQUALIFIED, check_open, find_submission, move, note
from wildscav_leaderboard.visibility import check_own


def cancel(doing: Doing, number: Number) -> None:
    """Withdraw a submission that does not take part yet. It stays charged."""
    submission = find_submission(doing.session, number)
    if submission.state == states.ACTIVE:
        raise RefusalError(
            f"submission {number} takes part: `wildscav team submissions disable {number}` ends that"
        )
    move(doing.session, submission, states.CANCELLED, doing.now, detail="withdrawn by its team")


def disable(doing: Doing, number: Number) -> None:
    """Let a submission no longer take part. Its results are kept, and it may be restored."""
    if season_state.is_finalized(doing.session):
        raise RefusalError("the season is over: its boards are final")
    submission = find_submission(doing.session, number)
    move(doing.session, submission, states.DISABLED, doing.now, reason="disabled by its team")
    withdraw(doing.session, submission, doing.now)


def restore(doing: Doing, number: Number) -> None:
    """Let a submission take part again that was replaced or disabled, with its results. It costs no quota."""
    check_open(doing.session, doing.season, doing.now)
    submission = find_submission(doing.session, number)
    if submission.reason.startswith((DISQUALIFIED, TEAM_DISQUALIFIED)):
        raise RefusalError(f"submission {number} is disqualified: only the organizers can take that back")
    take_part_again(doing, submission, "restored by its team")


def keep(doing: Doing, number: Number) -> None:
    """Let no later submission replace this one, unless it is told to."""
    _keep(doing, number, kept=True)


def release(doing: Doing, number: Number) -> None:
    """Let later submissions replace this one again."""
    _keep(doing, number, kept=False)


def _keep(doing: Doing, number: int, *, kept: bool) -> None:
    submission = find_submission(doing.session, number)
    if submission.state != states.ACTIVE or submission.kept is kept:
        state = "kept" if submission.kept else f"{submission.state} and not kept"
        raise RefusalError(f"submission {number} is {state}")
    submission.kept = kept
    note(doing.session, submission, doing.now, "kept by its team" if kept else "released by its team")


TEAM_ACTS = {
    one.name: one
    for one in (
        Act(cancel, "Withdraw it"),
        Act(disable, "Disable it"),
        Act(restore, "Restore it"),
        Act(keep, "Keep it"),
        Act(release, "Release it"),
    )
}


def acts_on(submission: Submission) -> list[Act]:
    """Return what its team may do with a submission now."""
    match submission.state:
        case states.ACTIVE:
            names = ["disable", "release" if submission.kept else "keep"]
            names += ["restore"] if submission.playing != submission.tracks else []
        case states.DISABLED:
            disqualified = submission.reason.startswith((DISQUALIFIED, TEAM_DISQUALIFIED))
            names = [] if disqualified else ["restore"]
        case _:
            names = ["cancel"] if submission.state in states.ON_THE_WAY else []
    return [TEAM_ACTS[name] for name in names]


def do_team_act(
    session: Session, season: Season, caller: Caller, name: str, number: int, now: datetime
) -> Submission:
    """Do an act on a submission of the caller's team, and return it.

    Raises:
        NotFoundError: There is no such act, or the team has no such submission.
        RefusalError: It cannot be done now.
    """
    if name not in TEAM_ACTS:
        raise NotFoundError(f"a submission has no act {name!r}, only {', '.join(TEAM_ACTS)}")
    found = find_submission(session, number)
    check_own(session, caller, found)
    act = TEAM_ACTS[name]
    act.do(Doing(session, season, caller.account.name, now), act.read({"number": number}))
    return found
