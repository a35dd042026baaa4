"""The web server of a season: uvicorn, with TLS from files or behind a proxy."""

import gc

import uvicorn
from starlette.types import ASGIApp

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.hosting.guarded_connections import GuardedConnection
from wildscav_leaderboard.hosting.web_counts import WebCounts
from wildscav_leaderboard.seasons.folder import Season
from wildscav_server.monitoring.logs import Log

GRACE = 10  # s for requests to end when the server is stopped
LARGEST_MESSAGE = 4096  # bytes, through the WebSocket of a page on which somebody plays


def run_web(
    season: Season, database: Database, counts: WebCounts | None = None, log: Log | None = None
) -> None:
    """Serve the web site and the API until the process is told to end."""
    config = configured(season, create_app(season, database, counts, log))
    # What is loaded by now stays: a full collection that went through it would answer nobody for 0.1 s.
    gc.collect()
    gc.freeze()
    uvicorn.Server(config).run()


def configured(season: Season, app: ASGIApp) -> uvicorn.Config:
    """Return how uvicorn serves a season's application."""
    web = season.settings.web
    return uvicorn.Config(
        app,
        host=web.host,
        port=web.port,
        log_level="warning",
        access_log=False,
        proxy_headers=bool(web.proxies),
        forwarded_allow_ips=list(web.proxies) or None,
        ssl_certfile=None if web.certificate is None else str(season.folder / web.certificate),
        ssl_keyfile=None if web.key is None else str(season.folder / web.key),
        timeout_graceful_shutdown=GRACE,
        http=GuardedConnection,
        ws="websockets-sansio",
        ws_max_size=LARGEST_MESSAGE,
        ws_per_message_deflate=False,  # pictures are compressed already
        server_header=False,
    )
