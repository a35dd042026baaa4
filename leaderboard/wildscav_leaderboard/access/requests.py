"""What every route gets from its request: the season, the database, the time, and who asks.

A program shows a token in the header ``Authorization: Bearer …``. A browser has a cookie, and each of its
forms carries a token as well, so that no other site can send them (cross-site request forgery).
"""

import asyncio
from collections.abc import AsyncIterator, Callable
from datetime import UTC, datetime
from secrets import compare_digest
from typing import Annotated, Any

from fastapi import Depends, Request
from fastapi.concurrency import contextmanager_in_threadpool
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from pydantic import Field
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.rate_limits import RateLimits, subscriber
from wildscav_leaderboard.accounts.models import Token
from wildscav_leaderboard.accounts.service import (
    Caller,
    caller_of_cookie,
    caller_of_token,
    is_use_to_be_noted,
)
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force
from wildscav_leaderboard.seasons.refusals import ForbiddenError, UnknownCallerError
from wildscav_leaderboard.spectating.render_cache import RenderCache
from wildscav_leaderboard.visibility import check_organizer

LOG_IN = "log in first: `wildscav login URL` gets a token"
bearer = HTTPBearer(
    auto_error=False, description="A token from `wildscav login`, or from the account's page."
)


async def database_of(request: Request) -> Database:
    """Return the season's database."""
    database: Database = request.app.state.database
    return database


async def present() -> datetime:
    """Return the time."""
    return datetime.now(UTC)


async def reading(
    request: Request, database: Annotated[Database, Depends(database_of)]
) -> AsyncIterator[Session]:
    """Yield a session that reads, once it is the request's turn.

    Requests that wait here take no thread. If all threads waited for a connection to the database, the
    requests that have one could not go on, and no page would be answered.
    """
    turn: asyncio.Semaphore = request.app.state.readers
    async with turn, contextmanager_in_threadpool(database.reading()) as session:
        yield session


# It ends before the answer is sent, or whoever reads an answer slowly would keep a connection all the while.
Reading = Annotated[Session, Depends(reading, scope="function")]


def season_of(request: Request, session: Reading) -> Season:
    """Return the season that is served, with the rules that are in force."""
    season = in_force(session, request.app.state.season)
    request.state.season = season  # for what every page shows
    return season


async def renders_of(request: Request) -> RenderCache:
    """Return the cache of files that are rendered from records."""
    renders: RenderCache = request.app.state.renders
    return renders


CurrentSeason = Annotated[Season, Depends(season_of)]
CurrentDatabase = Annotated[Database, Depends(database_of)]
Renders = Annotated[RenderCache, Depends(renders_of)]
Now = Annotated[datetime, Depends(present)]
Number = Annotated[int, Field(ge=1, le=2**53)]  # of an entry of the database, which has no larger ones
Bearer = Annotated[HTTPAuthorizationCredentials | None, Depends(bearer)]


def program(database: CurrentDatabase, now: Now, given: Bearer) -> Caller | None:
    """Return who asks by a token; None if none was given.

    Raises:
        UnknownCallerError: The token is nobody's.
    """
    if given is None:
        return None
    with database.reading() as session:
        caller, token = caller_of_token(session, given.credentials)
    if is_use_to_be_noted(token, now):
        with database.writing() as session:
            session.get_one(Token, token.id).used = now
    return caller


AnyProgram = Annotated[Caller | None, Depends(program)]


def _known(by: Callable[..., Any], how: str) -> Callable[[Caller | None], Caller]:
    """Return what refuses whoever is nobody, and says how to log in."""

    def known(caller: Annotated[Caller | None, Depends(by)]) -> Caller:
        if caller is None:
            raise UnknownCallerError(how)
        return caller

    return known


def _organizing(by: Callable[..., Any]) -> Callable[[Caller], Caller]:
    """Return what refuses whoever is no organizer."""

    def organizing(caller: Annotated[Caller, Depends(by)]) -> Caller:
        return check_organizer(caller)

    return organizing


known_program = _known(program, LOG_IN)
KnownProgram = Annotated[Caller, Depends(known_program)]
organizing_program = _organizing(known_program)
OrganizingProgram = Annotated[Caller, Depends(organizing_program)]


def browser(request: Request, database: CurrentDatabase, now: Now) -> Caller | None:
    """Return who is logged in with this browser; None if nobody is."""
    cookie = request.cookies.get(cookie_name(request))
    if cookie is None:
        return None
    with database.reading() as session:
        caller = caller_of_cookie(session, cookie, now)
    request.state.caller = caller  # for the page that says what went wrong
    return caller


known_browser = _known(browser, "log in first")
AnyBrowser = Annotated[Caller | None, Depends(browser)]
KnownBrowser = Annotated[Caller, Depends(known_browser)]
OrganizingBrowser = Annotated[Caller, Depends(_organizing(known_browser))]


def reader(by_token: AnyProgram, by_cookie: AnyBrowser) -> Caller | None:
    """Return who reads, for files that programs and pages load; nothing may be changed on its word."""
    return by_token or by_cookie


AnyReader = Annotated[Caller | None, Depends(reader)]
KnownReader = Annotated[Caller, Depends(_known(reader, LOG_IN))]


def check_form(caller: Caller, csrf: str) -> None:
    """Check that a form was made by our own page for whoever sends it.

    Raises:
        ForbiddenError: It was not.
    """
    if caller.csrf is None or not compare_digest(caller.csrf.encode(), csrf.encode("utf-8", "replace")):
        raise ForbiddenError("this form is from another session: load the page again")


async def address_of(request: Request) -> str:
    """Return the address from which a request comes; of version 6, its subscriber's network."""
    return subscriber(request.client.host) if request.client is not None else "unknown"


Address = Annotated[str, Depends(address_of)]


async def rate_limits(database: CurrentDatabase) -> RateLimits:
    """Return what counts uses."""
    return RateLimits(database)


Limits = Annotated[RateLimits, Depends(rate_limits)]


def cookie_name(request: Request) -> str:
    """Return the name of the season's cookie, which browsers bind to TLS where there is TLS.

    Browsers send the cookies of a host to all of its ports, on each of which there may be a season.
    """
    season: Season = request.app.state.season
    return f"{'__Host-' if request.url.scheme == 'https' else ''}wildscav-{season.settings.name}"
