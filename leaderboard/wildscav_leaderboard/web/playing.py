"""Playing against a submission: the form that opens a table, and the pages of tables."""

from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Depends, Form, Request, WebSocket
from fastapi.responses import RedirectResponse, Response

from wildscav_leaderboard.access.rate_limits import CODES, GAMES, TRIES
from wildscav_leaderboard.access.requests import (
    Address,
    AnyBrowser,
    CurrentDatabase,
    CurrentSeason,
    Limits,
    Number,
    check_form,
)
from wildscav_leaderboard.access.same_site import SameSite, is_own_origin
from wildscav_leaderboard.api.match_views import titled
from wildscav_leaderboard.database.connection import Database, DatabaseError
from wildscav_leaderboard.playing.passing import OVER, pass_request, pass_socket, refuse
from wildscav_leaderboard.playing.permission import refused_why
from wildscav_leaderboard.playing.tables import READY, STARTING, Tables, Wish
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import (
    ForbiddenError,
    NotFoundError,
    UnavailableError,
    UnknownCallerError,
)
from wildscav_leaderboard.submissions.service import find_submission
from wildscav_leaderboard.web.rendering import base_of, page
from wildscav_stage.playing.room import NOT_VALID

router = APIRouter()
Text = Annotated[str, Form(max_length=2000)]


async def tables_of(request: Request) -> Tables:
    """Return the tables of this web server."""
    tables: Tables = request.app.state.tables
    return tables


OwnTables = Annotated[Tables, Depends(tables_of)]


@router.post("/submissions/{number}/play")
def play(
    request: Request,
    number: Number,
    _own_form: SameSite,
    season: CurrentSeason,
    database: CurrentDatabase,
    tables: OwnTables,
    caller: AnyBrowser,
    limits: Limits,
    where: Address,
    track: Text,
    csrf: Text = "",
) -> Response:
    """Open a table for whoever asks, and send them to it."""
    if caller is not None:
        check_form(caller, csrf)
    with database.reading() as session:
        one = find_submission(session, number)
        if why := refused_why(session, season, one, track):
            raise ForbiddenError(why)
        if caller is None and season.settings.play.who == "accounts":
            raise UnknownCallerError("log in first: people without an account cannot play here")
        wish = Wish(
            person=f"address {where}" if caller is None else f"account {caller.account.id}",
            submission=number,
            archive=one.archive,
            entrant=one.entrant,
            title=titled(one.name, one.version),
            track=track,
            base=base_of(request),
        )
    limits.use(GAMES, "games", wish.person)
    table = tables.open(wish, lambda: _refused_now(database, season, number, track))
    return RedirectResponse(table.path, HTTPStatus.SEE_OTHER)


@router.get("/play")
def code_page(request: Request, season: CurrentSeason, caller: AnyBrowser) -> Response:
    """Show the form in which a guest enters the code of a table."""
    _check_guests(season)
    return page(request, "play_code.html", caller, error="", code="")


@router.post("/play")
def join(
    request: Request,
    _own_form: SameSite,
    season: CurrentSeason,
    tables: OwnTables,
    caller: AnyBrowser,
    limits: Limits,
    where: Address,
    code: Text = "",
) -> Response:
    """Send a guest, with the code, to the entrance of the table whose code it is."""
    _check_guests(season)
    limits.use(TRIES, "code", where)
    limits.use(CODES, "codes")
    try:
        table = tables.find_by_code(code)
    except NotFoundError as error:
        return page(request, "play_code.html", caller, HTTPStatus.NOT_FOUND, error=str(error), code=code)
    return RedirectResponse(f"{table.base_path}join", HTTPStatus.TEMPORARY_REDIRECT)


@router.post("/play/{secret}/join")
async def enter_table(request: Request, secret: str, _own_form: SameSite, tables: OwnTables) -> Response:
    """Pass a code on to a table, which gives whoever sent it a seat."""
    table = tables.find(secret)
    if table.state != READY or table.why:
        raise NotFoundError(f"this game is over: {table.why}" if table.why else NOT_VALID)
    return await pass_request(table, "join", request)


def _check_guests(season: Season) -> None:
    if not season.settings.play.enabled or season.settings.play.people == 1:
        raise ForbiddenError("in this season nobody joins the games of others")


def _refused_now(database: Database, season: Season, number: int, track: str) -> str:
    try:
        with database.reading() as session:
            return refused_why(session, season, find_submission(session, number), track)
    except DatabaseError:
        return ""  # it will answer again


@router.get("/play/{secret}/{path:path}")
async def table_page(
    request: Request, secret: str, path: str, tables: OwnTables, caller: AnyBrowser
) -> Response:
    """Show a page of a table, or that it is being opened."""
    table = tables.find(secret)
    if table.why:
        raise (UnavailableError if table.failed else NotFoundError)(f"this game is over: {table.why}")
    if table.state == STARTING:
        return page(request, "play_wait.html", caller, HTTPStatus.ACCEPTED, wish=table.wish)
    return await pass_request(table, path, request)


@router.websocket("/play/{secret}/{path:path}")
async def table_socket(socket: WebSocket, secret: str, path: str) -> None:
    """Pass the messages of a table's page on."""
    tables: Tables = socket.app.state.tables
    origin = socket.headers.get("origin")
    if origin is not None and not is_own_origin(socket, origin):
        return await refuse(socket, OVER, "another site opened this game")
    try:
        table = tables.find(secret)
    except NotFoundError as error:
        return await refuse(socket, OVER, str(error))
    if table.why:
        return await refuse(socket, OVER, table.why)
    return await pass_socket(table, path, socket)
