"""The web application: the API and the pages of one season."""

import asyncio
from collections import Counter
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from http import HTTPStatus

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, PlainTextResponse, Response
from starlette.exceptions import HTTPException

from wildscav.errors import UserError
from wildscav.version import __version__
from wildscav_evaluator.cache import cache_folder
from wildscav_leaderboard.access.rate_limits import AddressLimit
from wildscav_leaderboard.access.uploads import CHECKED
from wildscav_leaderboard.api.routers import PREFIX, answer, api_router, as_json
from wildscav_leaderboard.database.connection import READERS, Database, DatabaseError
from wildscav_leaderboard.hosting.middleware import BodyLimit, BrokenRequests, HeadRequests, SecurityHeaders
from wildscav_leaderboard.hosting.rendering_ahead import RenderingAhead
from wildscav_leaderboard.hosting.request_log import RequestLog, WebCounts
from wildscav_leaderboard.playing.tables import Tables
from wildscav_leaderboard.seasons.disk import check_room
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.spectating import rerun_viewer
from wildscav_leaderboard.spectating.live import LiveMatches
from wildscav_leaderboard.spectating.render_cache import RenderCache
from wildscav_leaderboard.spectating.streams import Streams
from wildscav_leaderboard.visibility import why_live_is_hidden
from wildscav_leaderboard.web.pages import add_pages, as_page
from wildscav_server.monitoring.logs import Log

UPLOADS = frozenset({f"{PREFIX}/submissions", "/submit"})


def create_app(
    season: Season, database: Database, counts: WebCounts | None = None, log: Log | None = None
) -> FastAPI:
    """Return the application of a season.

    Args:
        database: Its database, whose schema is current.
        counts: Where requests and tables are counted; None counts for nobody.
        log: Where requests are logged; None logs nothing.
    """
    renders = RenderCache(season.files / "rendered", season.settings.web.replays << 20)
    counts = counts or WebCounts()
    tables = Tables(season, log, counts.tables)

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        with renders, tables, RenderingAhead(season, database, renders, log):
            yield

    app = FastAPI(
        title=season.settings.title,
        version=__version__,
        docs_url=None,  # they load their scripts from other hosts
        redoc_url=None,
        openapi_url=f"{PREFIX}/openapi.json",
        lifespan=lifespan,
    )
    app.state.season, app.state.database = season, database
    app.state.readers, app.state.checks = asyncio.Semaphore(READERS), asyncio.Semaphore(CHECKED)
    app.state.uploads = Counter()  # in progress, by account
    app.state.renders, app.state.tables = renders, tables
    app.state.streams = Streams(LiveMatches(season.live), partial(_why_hidden, app))
    app.include_router(api_router())
    app.include_router(rerun_viewer.router(cache_folder("rerun-viewer")))
    add_pages(app)
    app.add_api_route("/health", _health, include_in_schema=False)
    app.add_api_route("/ready", _ready, include_in_schema=False, response_model=None)
    for kind in (UserError, HTTPException, RequestValidationError):
        app.add_exception_handler(kind, _answer)
    app.add_middleware(BrokenRequests, answer=_answer)
    app.add_middleware(AddressLimit, per_minute=season.settings.web.requests_per_minute)
    app.add_middleware(BodyLimit, uploads=UPLOADS)
    app.add_middleware(HeadRequests)
    app.add_middleware(RequestLog, counts=counts.requests, log=log)
    app.add_middleware(SecurityHeaders)
    return app


def _answer(request: Request, error: Exception) -> Response:
    """Answer a request that was refused, or went wrong: a document for programs, a page for people."""
    return as_json(error) if request.url.path.startswith("/api/") else as_page(request, error)


async def _why_hidden(app: FastAPI, match: int) -> str | None:
    """Return why strangers may not watch a match, when it is the question's turn; None if that is unknown."""
    database: Database = app.state.database
    async with app.state.readers:
        try:
            return await asyncio.to_thread(why_live_is_hidden, database, match)
        except DatabaseError:
            return None


def _health() -> PlainTextResponse:
    """Say that the process answers."""
    return PlainTextResponse("ok\n")


def _ready(request: Request) -> Response:
    """Say whether the database answers too, and the disks have room."""
    database: Database = request.app.state.database
    try:
        database.check()
        check_room(request.app.state.season)
    except UserError as error:
        _, reason = answer(error)  # without the address of the database
        return JSONResponse({"ready": False, "reason": reason}, HTTPStatus.SERVICE_UNAVAILABLE)
    return JSONResponse({"ready": True})
