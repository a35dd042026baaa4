"""Routes of submissions."""

from pathlib import Path
from typing import Annotated

import anyio.to_thread
from fastapi import APIRouter, Query, Request
from fastapi.responses import PlainTextResponse

from wildscav.terminal.console import printable
from wildscav_leaderboard.access.requests import (
    AnyProgram,
    CurrentDatabase,
    CurrentSeason,
    KnownProgram,
    Now,
    Number,
    Reading,
)
from wildscav_leaderboard.access.uploads import check_upload_wanted, take_upload, uploaded
from wildscav_leaderboard.organizing.team_acts import do_team_act
from wildscav_leaderboard.presentation.boards import opponent_views
from wildscav_leaderboard.presentation.documents import (
    REFUSALS,
    HandedIn,
    OpponentView,
    SubmissionList,
    SubmissionView,
)
from wildscav_leaderboard.presentation.people import quota_view
from wildscav_leaderboard.presentation.submissions import submission_view, submission_views
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import NotFoundError
from wildscav_leaderboard.submissions import service
from wildscav_leaderboard.submissions.listing import MOST, is_own, list_submissions, listed_for
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.service import find_team, own_team

router = APIRouter(tags=["submissions"])
Limit = Annotated[int, Query(ge=1, le=MOST)]
LARGEST_LOG = 1 << 20  # bytes


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
async def submit(
    request: Request,
    caller: KnownProgram,
    season: CurrentSeason,
    database: CurrentDatabase,
    now: Now,
    message: Annotated[str, Query(max_length=1000)] = "",
    suffix: Annotated[str, Query(max_length=20)] = ".tar.gz",
    replaces: Number | None = None,
) -> HandedIn:
    """Hand in a submission; the body of the request is its archive."""
    run = anyio.to_thread.run_sync
    await run(check_upload_wanted, database, season, caller.account, now)
    async with uploaded(request, season, suffix) as path:
        one = await run(take_upload, database, season, caller.account, path, message, now, replaces)
    with database.reading() as session:
        view = submission_view(session, season, session.get_one(Submission, one.id), caller, now)
        quota = quota_view(session, season, own_team(session, caller.account), now)
    return HandedIn(submission=view, quota=quota)


@router.get("/submissions")
def submissions(
    caller: AnyProgram,
    session: Reading,
    now: Now,
    team: str | None = None,
    state: Annotated[list[str] | None, Query()] = None,
    before: Number | None = None,
    limit: Limit = MOST,
) -> SubmissionList:
    """List submissions, the newest first; of other teams, none that failed or were cancelled."""
    number = None if team is None else find_team(session, team).id
    listed = listed_for(session, caller)
    found = list_submissions(
        session, team=number, states=state or (), before=before, limit=limit, where=listed
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
    if not is_own(session, caller, found):
        raise NotFoundError(f"your team has no submission {submission}")
    return "".join(_sections(season, submission)) or "It printed nothing.\n"


def _sections(season: Season, submission: int) -> list[str]:
    folder = season.submission_folder(submission) / "logs"
    logs = [path for path in sorted(folder.glob("*.log")) if path.stat().st_size]
    return [f"── {path.stem} ──\n{shown_log(path)}\n" for path in logs]


def shown_log(path: Path) -> str:
    """Return what an agent printed, without characters that could control a terminal.

    Raises:
        NotFoundError: It is gone.
    """
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_LOG)
    except FileNotFoundError:
        raise NotFoundError("this log is no longer in the season's files") from None
    return printable(content.decode("utf-8", "replace"), keep="\n\t")
