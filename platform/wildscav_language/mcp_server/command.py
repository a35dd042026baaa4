"""``wildscav mcp``: a server by which language models play."""

import asyncio
import contextlib
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

import typer

from wildscav.errors import UserError
from wildscav.system.output_folders import check_folder

THIS_MACHINE = ("127.0.0.1", "localhost", "[::1]")


def mcp(
    http: Annotated[
        str | None,
        typer.Option(
            help="Serve any number of clients over HTTP at HOST:PORT, path /mcp. Default: one client, over "
            "standard input and output.",
            metavar="HOST:PORT",
            show_default=False,
        ),
    ] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the records of the matches.")] = Path(
        "out/mcp"
    ),
    matches: Annotated[int, typer.Option(help="Matches played at one time.", min=1, max=100)] = 8,
    idle_limit: Annotated[
        float,
        typer.Option(
            help="Seconds that a match waits for a client's next action, before its seat is closed.",
            min=1,
            max=86_400,
        ),
    ] = 600.0,
    token_file: Annotated[
        Path | None,
        typer.Option(help="File with the secret that clients send over HTTP. Required on public addresses."),
    ] = None,
    site: Annotated[
        str | None,
        typer.Option(
            help="Where browsers reach the server, for links of replays, such as https://arena.example "
            "behind a proxy. Default: the address of --http.",
            metavar="URL",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Let language models start matches and play in them, by the Model Context Protocol.

    Assistants start this command themselves: give it to them as a server. It prints to standard error alone.
    """
    from wildscav.terminal.console import console
    from wildscav_server.endpoints.addresses import UNIX, is_public, is_site
    from wildscav_server.serve import read_token

    console.stderr = True
    check_folder("--out", out)
    token = None if token_file is None else read_token(token_file)
    if http is None:
        if token is not None or site is not None:
            raise UserError(
                "--token-file and --site are for --http: standard input has one client", exit_code=2
            )
    elif site is not None and not is_site(site):
        raise UserError(f"--site is {site}, must be a URL such as https://arena.example", exit_code=2)
    elif http.startswith(UNIX):
        raise UserError(f"--http is {http}, must be HOST:PORT", exit_code=2)
    elif is_public(http) and token is None:
        raise UserError(f"other machines can reach {http}: give --token-file", exit_code=2)
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(_serve(http, site, out.absolute(), (matches, idle_limit), token))


async def _serve(
    http: str | None, site: str | None, out: Path, bounds: tuple[int, float], token: str | None
) -> None:
    from wildscav.terminal.console import console
    from wildscav_language.mcp_server.desk import Desk
    from wildscav_language.mcp_server.matches import Bounds, serving
    from wildscav_language.mcp_server.protocol import PATH, REPLAYS, serve_http, serve_stdio
    from wildscav_server.endpoints.addresses import bind, is_public, split, with_port

    ready = asyncio.ensure_future(asyncio.to_thread(_prepare))
    async with serving(out, Bounds(*bounds)) as matches:
        if http is None:
            return await serve_stdio(Desk(matches, ready, None))
        sockets = bind(http)
        for one in sockets:
            one.listen()  # so that whoever reads the line below can connect
        own = f"http://{with_port(http, sockets[0].getsockname()[1])}"
        console.print(f"serving MCP at {own}{PATH}", soft_wrap=True)
        links = (site or own).rstrip("/") + REPLAYS
        hosts = [split(http)[0], f"{urlsplit(links).hostname}", *THIS_MACHINE]
        desk = Desk(matches, ready, lambda match: links.format(key=match.key))
        return await serve_http(desk, sockets, token, None if is_public(http) else hosts)


def _prepare() -> None:
    """Compile all kernels that matches and pictures need, or load them from the cache."""
    from wildscav_engine.sensors import parse_sensors
    from wildscav_language.senses import sensors
    from wildscav_server.hosting.precompile import precompile

    precompile(parse_sensors(sensors(pictures=True)).values())
