"""The page on which a submission is handed in, and the forms that withdraw one."""

from http import HTTPStatus
from typing import Annotated

import anyio.to_thread
from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, JSONResponse, RedirectResponse, Response

from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.submissions.archives import SUFFIXES
from wildscav_leaderboard.access.requests import (
    CurrentDatabase,
    CurrentSeason,
    KnownBrowser,
    Now,
    Number,
    Reading,
    check_form,
)
from wildscav_leaderboard.access.uploads import check_upload_wanted, take_upload, uploaded
from wildscav_leaderboard.api.accounts import account_view
from wildscav_leaderboard.organizing.team_acts import do_team_act
from wildscav_leaderboard.seasons.in_force import sandbox_of
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.submissions.quotas import active_of
from wildscav_leaderboard.teams.service import own_team
from wildscav_leaderboard.web.rendering import page

router = APIRouter()
Text = Annotated[str, Form(max_length=2000)]


@router.get("/submit", response_class=HTMLResponse)
def form(
    request: Request, caller: KnownBrowser, season: CurrentSeason, session: Reading, now: Now
) -> HTMLResponse:
    """Show how to hand in a submission."""
    account = account_view(session, season, caller, now)
    active = active_of(session, own_team(session, caller.account).id) if account.team else []
    sandbox, tracks = sandbox_of(session, season), season.settings.tracks
    return page(
        request,
        "submit.html",
        caller,
        suffixes=SUFFIXES,
        quota=account.quota,
        active=active,
        now=now,
        sandbox=sandbox,
        limits={track: season.limits(track) for track in tracks} if SANDBOXES[sandbox].isolated else {},
    )


@router.post("/submit")
async def submit(
    request: Request,
    caller: KnownBrowser,
    season: CurrentSeason,
    database: CurrentDatabase,
    now: Now,
    message: Annotated[str, Query(max_length=1000)] = "",
    suffix: Annotated[str, Query(max_length=20)] = ".tar.gz",
    replaces: Number | None = None,
) -> JSONResponse:
    """Take a submission from the form's script; the body of the request is the archive."""
    run = anyio.to_thread.run_sync
    try:
        check_form(caller, request.headers.get("x-csrf", ""))
        await run(check_upload_wanted, database, season, caller.account, now)
        async with uploaded(request, season, suffix) as path:
            one = await run(take_upload, database, season, caller.account, path, message, now, replaces)
    except RefusalError as error:
        # The connection is closed, or all of an archive that is refused would be read.
        return JSONResponse({"error": str(error)}, error.status, {"Connection": "close"})
    return JSONResponse({"address": f"/submissions/{one.id}"}, HTTPStatus.CREATED)


@router.post("/submissions/{number}/{act}")
def act(
    request: Request,
    number: Number,
    act: str,
    caller: KnownBrowser,
    database: CurrentDatabase,
    now: Now,
    csrf: Text,
) -> Response:
    """Do an act on a submission of one's team, and show its page."""
    check_form(caller, csrf)
    with database.writing() as session:
        do_team_act(session, request.app.state.season, caller, act, number, now)
    return RedirectResponse(f"/submissions/{number}", 303)
