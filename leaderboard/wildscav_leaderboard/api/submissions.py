"""Submissions as they are shown, to everyone and to their own team and the organizers, and the routes."""

from collections.abc import Sequence
from contextlib import suppress
from datetime import datetime
from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import PlainTextResponse
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.requests import (
    AnyProgram,
    CurrentDatabase,
    CurrentSeason,
    KnownProgram,
    Now,
    Number,
    Reading,
    season_of,
)
from wildscav_leaderboard.access.uploads import Uploaded
from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.api.accounts import quota_view
from wildscav_leaderboard.api.boards import opponent_views
from wildscav_leaderboard.api.documents import (
    REFUSALS,
    HandedIn,
    OpponentView,
    SubmissionList,
    SubmissionView,
    TransitionView,
)
from wildscav_leaderboard.api.matches import shown_log
from wildscav_leaderboard.boards.progress import progress_of, totals_of
from wildscav_leaderboard.organizing.team_acts import do_team_act
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import TooMuchError
from wildscav_leaderboard.submissions import service, states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.queue import expected_wait, mean_time, queue, validations
from wildscav_leaderboard.submissions.quotas import replaced_by
from wildscav_leaderboard.submissions.service import MAX_LISTED, history_of, list_submissions, team_names
from wildscav_leaderboard.teams.models import Team
from wildscav_leaderboard.teams.service import find_team, own_team
from wildscav_leaderboard.visibility import check_own, is_own, listed_for


def submission_views(
    session: Session, submissions: Sequence[Submission], caller: Caller | None, now: datetime
) -> list[SubmissionView]:
    """Return submissions for a list, without their history."""
    teams = team_names(session, submissions)
    waits = any(one.state in states.ON_THE_WAY for one in submissions)
    positions = {one.id: number for number, one in enumerate(queue(session), 1)} if waits else {}
    each, at_once = mean_time(session) if waits else 0.0, validations(session)
    queued = [(one, positions.get(one.id)) for one in submissions]
    return [
        _view(session, one, teams[one.team_id], caller, turn, expected_wait(one, turn, each, at_once, now))
        for one, turn in queued
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


router = APIRouter(tags=["submissions"])
Limit = Annotated[int, Query(ge=1, le=MAX_LISTED)]


@router.post(
    "/submissions",
    status_code=201,
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {"application/octet-stream": {"schema": {"type": "string"}}},
        }
    },
)
async def submit(caller: KnownProgram, upload: Uploaded) -> HandedIn:
    """Hand in a submission; the body of the request is its archive."""
    one = await upload.take(caller.account)
    with upload.database.reading() as session:
        season = season_of(upload.request, session)
        view = submission_view(session, season, session.get_one(Submission, one.id), caller, upload.now)
        quota = quota_view(session, season, own_team(session, caller.account), upload.now)
    return HandedIn(submission=view, quota=quota)


@router.get("/submissions")
def submissions(
    caller: AnyProgram,
    session: Reading,
    now: Now,
    team: str | None = None,
    state: Annotated[list[str] | None, Query()] = None,
    before: Number | None = None,
    limit: Limit = MAX_LISTED,
) -> SubmissionList:
    """List submissions, the newest first; of other teams, none that failed or were cancelled."""
    number = None if team is None else find_team(session, team).id
    listed = listed_for(session, caller)
    found = list_submissions(
        session, team=number, in_states=state or (), before=before, limit=limit, where=listed
    )
    more = None
    if len(found) == limit:
        more = f"/api/v1/submissions?before={found[-1].id}&limit={limit}" + (f"&team={team}" if team else "")
    return SubmissionList(submissions=submission_views(session, found, caller, now), next=more)


@router.get("/submissions/{submission}")
def submission(
    submission: Number, caller: AnyProgram, season: CurrentSeason, session: Reading, now: Now
) -> SubmissionView:
    """Return a submission. Its team and the organizers see why it failed."""
    return submission_view(session, season, service.find_submission(session, submission), caller, now)


@router.post("/submissions/{submission}/{act}")
def act(
    submission: Number,
    act: str,
    caller: KnownProgram,
    season: CurrentSeason,
    database: CurrentDatabase,
    now: Now,
) -> SubmissionView:
    """Do one of the acts on a submission of your team: cancel, disable, restore, keep or release it."""
    with database.writing() as session:
        found = do_team_act(session, season, caller, act, submission, now)
        return submission_view(session, season, found, caller, now)


@router.get("/submissions/{submission}/opponents")
def opponents(submission: Number, track: str, current: CurrentSeason, session: Reading) -> list[OpponentView]:
    """Return how a submission did against everyone whom it met on a ladder."""
    current.track(track)
    found = service.find_submission(session, submission)
    return opponent_views(session, [track], found).get(track, [])


@router.get("/submissions/{submission}/logs", response_class=PlainTextResponse, responses=REFUSALS)
def logs(submission: Number, caller: KnownProgram, session: Reading, season: CurrentSeason) -> str:
    """Return what a submission of your team printed in its validation."""
    found = service.find_submission(session, submission)
    check_own(session, caller, found)
    return "".join(_sections(season, submission)) or "It printed nothing.\n"


def _sections(season: Season, submission: int) -> list[str]:
    folder = season.submission_folder(submission) / "logs"
    logs = [path for path in sorted(folder.glob("*.log")) if path.stat().st_size]
    return [f"── {path.stem} ──\n{shown_log(path)}\n" for path in logs]
