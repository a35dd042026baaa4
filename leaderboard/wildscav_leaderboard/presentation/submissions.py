"""Submissions as they are shown: to everyone, and to their own team and the organizers."""

from collections.abc import Sequence
from contextlib import suppress
from datetime import datetime

from sqlalchemy.orm import Session

from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.boards.progress import progress_of, totals_of
from wildscav_leaderboard.presentation.documents import SubmissionView, TransitionView
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import TooMuchError
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.listing import is_own, team_names
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.queue import expected_wait, mean_time, queue, validations
from wildscav_leaderboard.submissions.quotas import replaced_by
from wildscav_leaderboard.submissions.service import history_of
from wildscav_leaderboard.teams.models import Team


def submission_views(
    session: Session, submissions: Sequence[Submission], caller: Caller | None, now: datetime
) -> list[SubmissionView]:
    """Return submissions for a list, without their history."""
    teams = team_names(session, submissions)
    waits = any(one.state in states.ON_THE_WAY for one in submissions)
    positions = {one.id: number for number, one in enumerate(queue(session), 1)} if waits else {}
    each, at_once = mean_time(session) if waits else 0.0, validations(session)
    places = [(one, positions.get(one.id)) for one in submissions]
    return [
        _view(session, one, teams[one.team_id], caller, place, expected_wait(one, place, each, at_once, now))
        for one, place in places
    ]


def submission_view(
    session: Session,
    season: Season,
    submission: Submission,
    caller: Caller | None,
    now: datetime,
    *,
    with_progress: bool = True,
) -> SubmissionView:
    """Return a submission with its history, and unless somebody else shows it, its progress on its tracks."""
    (view,) = submission_views(session, [submission], caller, now)
    history = [TransitionView.model_validate(one) for one in history_of(session, submission)]
    own = is_own(session, caller, submission)
    if not own:
        history = [one.model_copy(update={"detail": ""}) for one in history]
    replaces = {}
    if own and submission.state in states.ON_THE_WAY:
        with suppress(TooMuchError):
            pairs = replaced_by(session, season.settings.quotas, submission)
            replaces = {track: one.id for track, one in reversed(pairs)}
    validation = ""
    if own and submission.state == states.VALIDATING:
        with suppress(OSError):
            validation = season.validation_file(submission.id).read_text("utf-8")
    return view.model_copy(
        update={
            "history": history,
            "replaces": replaces,
            "validation": validation,
            "progress": progress_of(session, season, submission) if with_progress else [],
            "totals": totals_of(session, submission) if own else [],
        }
    )


def _view(
    session: Session,
    one: Submission,
    team: Team,
    caller: Caller | None,
    position: int | None,
    wait: float | None,
) -> SubmissionView:
    own = is_own(session, caller, one)
    return SubmissionView.about(
        one,
        team=team.name,
        team_title=team.title,
        message=one.message if own else "",
        replaces={},
        queue_position=position,
        expected_wait=wait,
        # Why a submission was replaced or disqualified is for everyone; why its code failed is not.
        reason=one.reason if own or one.state in ("disabled", "cancelled") else None,
        last_lines=one.last_lines if own else [],
        command=one.command if own else None,
    )
