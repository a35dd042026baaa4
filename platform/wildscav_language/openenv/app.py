"""The server of environments of OpenEnv: ``python -m wildscav_language.openenv.app``."""

import asyncio
import functools
from pathlib import Path
from typing import Annotated

import typer
import uvicorn
from fastapi import FastAPI
from openenv.core.env_server.http_server import create_app
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from wildscav_language.openenv.environment import WildscavEnvironment
from wildscav_language.openenv.host import IDLE_LIMIT, Host
from wildscav_language.openenv.models import WildscavAction, WildscavObservation, WildscavState

SESSIONS = 16
LARGEST_MESSAGE = 64 << 10  # bytes
KEPT = ("/ws", "/health", "/metadata", "/schema")  # OpenEnv's others start matches that no session holds


class QuietDisconnected:
    """Takes clients of WebSockets that send nothing for long for gone.

    Args:
        app: Which they talk to.
        limit: s.
    """

    def __init__(self, app: ASGIApp, limit: float) -> None:
        self._app, self._limit = app, limit

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a connection."""

        async def received() -> Message:
            try:
                return await asyncio.wait_for(receive(), self._limit)
            except TimeoutError:
                return {"type": "websocket.disconnect", "code": 1001}

        await self._app(scope, received if scope["type"] == "websocket" else receive, send)


def make_app(
    sessions: int = SESSIONS, records: Path | None = None, idle_limit: float = IDLE_LIMIT
) -> FastAPI:
    """Return the application, for any server of ASGI.

    Args:
        sessions: That may be open at one time; each plays a match of its own.
        records: The folder for records of matches; None keeps none.
        idle_limit: s that a match waits for a call, after which its seat is closed; a connection waits twice
            as long, and all calls of a match may wait six times as long together.
    """
    host = Host(records, idle_limit)
    app: FastAPI = create_app(
        functools.partial(WildscavEnvironment, host),
        WildscavAction,
        WildscavObservation,
        env_name="wildscav",
        max_concurrent_envs=sessions,
        state_cls=WildscavState,
    )
    app.router.routes[:] = [route for route in app.routes if getattr(route, "path", "") in KEPT]
    app.add_middleware(QuietDisconnected, limit=2 * idle_limit)
    app.router.on_shutdown.append(host.close)
    return app


def serve(
    host: Annotated[
        str, typer.Option(help="The address to listen at. Clients need no password.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="The port.", min=0, max=65535)] = 8000,
    sessions: Annotated[int, typer.Option(help="Sessions at one time.", min=1)] = SESSIONS,
    records: Annotated[Path | None, typer.Option(help="Folder for the records of matches.")] = None,
    idle_limit: Annotated[
        float,
        typer.Option(
            help="Seconds to wait for a call, and six times as long for all calls, before a seat is closed.",
            min=1,
        ),
    ] = IDLE_LIMIT,
) -> None:
    """Serve environments over WebSockets."""
    app = make_app(sessions, records, idle_limit)
    uvicorn.run(app, host=host, port=port, log_level="info", access_log=False, ws_max_size=LARGEST_MESSAGE)


if __name__ == "__main__":
    typer.run(serve)
