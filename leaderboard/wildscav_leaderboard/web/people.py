"""The pages of whoever takes part: log in, register, the account and its team, and handing in."""

import re
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, JSONResponse, RedirectResponse, Response
from sqlalchemy.orm import Session
from starlette.concurrency import run_in_threadpool

from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.submissions.archives import SUFFIXES
from wildscav_leaderboard.access.logins import log_in
from wildscav_leaderboard.access.rate_limits import SIGN_UPS
from wildscav_leaderboard.access.requests import (
    Address,
    AnyBrowser,
    CurrentDatabase,
    CurrentSeason,
    KnownBrowser,
    Limits,
    Now,
    Number,
    Reading,
    check_form,
    cookie_name,
)
from wildscav_leaderboard.access.same_site import SameSite
from wildscav_leaderboard.access.uploads import Uploaded
from wildscav_leaderboard.accounts import passwords, service
from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.accounts.service import Caller
from wildscav_leaderboard.api.accounts import account_view
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.organizing.team_acts import do_team_act
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import sandbox_of
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.submissions.quotas import active_of
from wildscav_leaderboard.teams import service as teams
from wildscav_leaderboard.teams.service import own_team
from wildscav_leaderboard.web.rendering import page
from wildscav_leaderboard.webhooks import service as webhooks

router = APIRouter()
Text = Annotated[str, Form(max_length=2000)]
OWN_PAGE = re.compile(r"/(?:[A-Za-z0-9?&=_.~-][A-Za-z0-9/?&=_.~-]*)?")  # never the address of another host
SEE = 303  # See Other: the answer to a form that did its work


@router.get("/login", response_class=HTMLResponse)
def login_form(
    request: Request, caller: AnyBrowser, following: Annotated[str, Query(max_length=2000)] = ""
) -> HTMLResponse:
    """Show the form to log in."""
    return page(request, "login.html", caller, error="", name="", following=following)


@router.post("/login", response_class=HTMLResponse)
async def login(
    request: Request,
    _own_form: SameSite,
    database: CurrentDatabase,
    now: Now,
    where: Address,
    name: Text,
    password: Text,
    following: Text = "",
) -> Response:
    """Log in, and go on to the page that asked for it."""
    try:
        account = await log_in(database, where, name, password)
    except RefusalError as error:
        return page(
            request, "login.html", None, error.status, error=str(error), name=name, following=following
        )
    return await run_in_threadpool(_logged_in, request, database, account, now, following)


def _logged_in(
    request: Request, database: Database, account: Account, now: Now, following: str = ""
) -> Response:
    """Send a browser on, with a cookie that scripts and other sites cannot use."""
    with database.writing() as session:
        cookie, _ = service.open_web_session(session, account, now)
    response = RedirectResponse(following if OWN_PAGE.fullmatch(following) else "/account", SEE)
    response.set_cookie(
        cookie_name(request),
        cookie,
        max_age=int(service.SESSION_LASTS.total_seconds()),
        secure=request.url.scheme == "https",
        httponly=True,
        samesite="lax",
    )
    return response


@router.post("/logout")
def logout(request: Request, caller: KnownBrowser, database: CurrentDatabase, csrf: Text) -> Response:
    """Log out."""
    check_form(caller, csrf)
    with database.writing() as session:
        service.close_web_session(session, request.cookies[cookie_name(request)])
    response = RedirectResponse("/", SEE)
    response.delete_cookie(cookie_name(request), secure=request.url.scheme == "https", httponly=True)
    return response


@router.get("/register", response_class=HTMLResponse)
def register_form(request: Request, caller: AnyBrowser) -> HTMLResponse:
    """Show the form to register."""
    return page(request, "register.html", caller, error="", name="")


@router.post("/register", response_class=HTMLResponse)
def register(
    request: Request,
    _own_form: SameSite,
    season: CurrentSeason,
    database: CurrentDatabase,
    now: Now,
    limits: Limits,
    where: Address,
    name: Text,
    password: Text,
    invitation: Text = "",
) -> Response:
    """Register and log in."""
    try:
        limits.use(SIGN_UPS, "accounts", where)
        hashed = passwords.hashed(password)
        with database.writing() as session:
            account = service.register(session, season.settings, name, hashed, invitation.strip(), now)
    except RefusalError as error:
        return page(request, "register.html", None, error.status, error=str(error), name=name)
    return _logged_in(request, database, account, now)


@router.get("/account", response_class=HTMLResponse)
def account(
    request: Request, caller: KnownBrowser, season: CurrentSeason, database: CurrentDatabase, now: Now
) -> HTMLResponse:
    """Show the account, its tokens, and its team."""
    return _account_page(request, caller, season, database, now)


def _account_page(
    request: Request,
    caller: Caller,
    season: Season,
    database: Database,
    now: Now,
    *,
    status: int = 200,
    error: str = "",
    shown_once: tuple[str, str] | None = None,
) -> HTMLResponse:
    with database.reading() as session:
        team = teams.team_of(session, caller.account)
        return page(
            request,
            "account.html",
            caller,
            status,
            view=account_view(session, season, caller, now),
            tokens=service.tokens_of(session, caller.account),
            webhooks=[] if team is None else webhooks.webhooks_of(session, team),
            error=error,
            shown_once=shown_once,
        )


@router.post("/account", response_class=HTMLResponse)
def change_account(
    request: Request,
    caller: KnownBrowser,
    season: CurrentSeason,
    database: CurrentDatabase,
    now: Now,
    csrf: Text,
    act: Text,
    value: Text = "",
    title: Text = "",
) -> Response:
    """Do what a form of the account's page asks for."""
    check_form(caller, csrf)
    try:
        with database.writing() as session:
            once = _change(session, season, caller.account, act, value.strip(), title.strip(), now)
    except RefusalError as refused:
        return _account_page(
            request, caller, season, database, now, status=refused.status, error=str(refused)
        )
    if once is not None:
        return _account_page(request, caller, season, database, now, shown_once=once)
    return RedirectResponse("/account", SEE)


def _change(
    session: Session, season: Season, account: Account, act: str, value: str, title: str, now: Now
) -> tuple[str, str] | None:
    """Change something about an account or its team; return what is shown once, and what it is."""
    match act:
        case "token":
            return "Your new token", service.new_token(session, account, value or "token", now)
        case "revoke":
            service.revoke_token(session, account, _number(value), now)
        case "make-team":
            _, key = teams.make_team(session, account, value, title, now)
            return "The key with which others join your team", key
        case "join-team":
            teams.join_team(session, season.settings, account, value, now)
        case "leave-team":
            teams.leave_team(session, account)
        case "team-key":
            key = teams.new_team_key(teams.own_team(session, account))
            return "The key with which others join your team", key
        case "webhook":
            added = webhooks.add_webhook(session, teams.own_team(session, account), value, now)
            return "The secret that signs the webhook's messages", added.secret
        case "remove-webhook":
            webhooks.remove_webhook(session, teams.own_team(session, account), _number(value))
        case _:
            raise RefusalError("the form asks for something that is not known: load the page again")
    return None


def _number(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 16 else 0


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
async def submit(request: Request, caller: KnownBrowser, upload: Uploaded) -> JSONResponse:
    """Take a submission from the form's script; the body of the request is the archive."""
    try:
        check_form(caller, request.headers.get("x-csrf", ""))
        one = await upload.take(caller.account)
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
    return RedirectResponse(f"/submissions/{number}", SEE)
