"""Serving a table: the match server, the web server, and the links to play."""

import asyncio
import socket
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, NamedTuple

import uvicorn

from wildscav_engine.sensors import parse_sensors
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_server.endpoints.endpoint import EndpointSettings
from wildscav_server.hosting.opponents import playing
from wildscav_server.hosting.precompile import precompile, small_map
from wildscav_server.leftovers import temporary_folder
from wildscav_server.match_server import MatchServer
from wildscav_stage.listening import GRACE, listen
from wildscav_stage.playing.links import Addresses, Base, Links, base_of
from wildscav_stage.playing.plan import Plan
from wildscav_stage.playing.rounds import Agents, MatchHosting
from wildscav_stage.playing.sight import Known, Sight
from wildscav_stage.playing.site.app import Site
from wildscav_stage.playing.table import COUNTDOWN, Table
from wildscav_stage.scene.map_file import map_file

LARGEST_MESSAGE = 1 << 15  # bytes, from a page: the names of all robots of a match
MAX_CONNECTIONS = 200  # open at one time, so that strangers cannot take all files that the match needs
JOINING = EndpointSettings(connections=16)  # at one time, to where a submission or all people join


@asynccontextmanager
async def served(
    plan: Plan,
    folder: Path,
    host: str,
    port: int,
    say: Callable[[str], None],
    *,
    public_url: str | None = None,
    countdown: int = COUNTDOWN,
    delay: float | None = None,
) -> AsyncIterator[tuple[Addresses, asyncio.Task[None]]]:
    """Serve a table within the block.

    See ``served_on``. The ``public_url`` is a proxy's root, by which others reach it; port 0 is any free one.

    Yields:
        The links, and the task of the web server, which ends on Ctrl-C.

    Raises:
        AddressInUseError: The web server cannot listen there.
    """
    listening, links = listen(host, port), Links(plan.people)
    base = base_of(host, listening.getsockname()[1], public_url)
    options: Any = {"countdown": countdown, "delay": delay}
    async with served_on(listening, base, links, plan, folder, say, **options) as served_table:
        addresses = base.addresses(links, plan.people)
        if code := served_table.table.lobby.room.code:
            addresses = addresses._replace(entrance=base.entrance(code))
        yield addresses, served_table.serving


class Served(NamedTuple):
    """A table that is served."""

    table: Table
    serving: asyncio.Task[None]  # of the web server; it ends on Ctrl-C


@asynccontextmanager
async def served_on(
    listening: socket.socket,
    base: Base,
    links: Links,
    plan: Plan,
    folder: Path,
    say: Callable[[str], None],
    *,
    countdown: int = COUNTDOWN,
    delay: float | None = None,
    agents: Agents = playing,
    at_home: bool = True,
) -> AsyncIterator[Served]:
    """Serve a table on a socket within the block.

    Args:
        listening: The socket, which is closed at the end.
        base: Where the site is reached.
        links: Of the table.
        plan: What is played at it.
        folder: For records, and for the output of agents.
        say: Called with a line for whoever started the table.
        countdown: s before a match of several people.
        delay: s after which spectators see a match; None for what the plan says.
        agents: Runs the submissions.
        at_home: Whether this machine is the host's.
    """
    with listening, temporary_folder("play-") as place:
        server = MatchServer(endpoint_settings=JOINING)
        (address,) = await server.start([f"unix:{place}/match"])
        # Each submission has a socket of its own, in a folder of its own: a sandbox passes on no other.
        for seat in plan.submissions:
            (place / str(seat)).mkdir(mode=0o700)
        own = await server.start([f"unix:{place}/{seat}/match" for seat in plan.submissions])
        hosting = MatchHosting(server, address, dict(zip(plan.submissions, own, strict=True)), folder, agents)
        table = Table(plan, hosting, links, base, say, countdown, delay=delay, at_home=at_home)
        web = uvicorn.Server(_config(Site(table, links, base)))
        serving = asyncio.create_task(web.serve(sockets=[listening]))
        try:
            yield Served(table, serving)
        finally:
            web.should_exit = True
            await table.close()
            await serving
            await server.stop()


def prepare(plan: Plan) -> None:
    """Compile all kernels that matches and what people see of them need, or load them from the cache."""
    precompile([])
    game_map = small_map()
    spec = MatchSpec(track="battle", map=game_map.spec, seats=(SUBMISSION, "fighter"))
    Sight(Match(spec, game_map), 0).message(Known())
    map_file(game_map)
    for opponent in plan.opponents:
        precompile(parse_sensors(opponent.sensors or {}).values())


def _config(site: Site) -> uvicorn.Config:
    return uvicorn.Config(
        site.app,
        log_level="warning",
        access_log=False,
        lifespan="off",
        ws="websockets-sansio",
        ws_max_size=LARGEST_MESSAGE,
        ws_per_message_deflate=False,
        server_header=False,
        limit_concurrency=MAX_CONNECTIONS,
        timeout_graceful_shutdown=GRACE,
    )
