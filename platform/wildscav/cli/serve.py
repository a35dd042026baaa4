"""``wildscav serve``: a match server that others share."""

import asyncio
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav.logs import LogFormat

SHORTEST_TOKEN = 16  # characters


def serve(
    listen: Annotated[
        list[str] | None,
        typer.Option(help="HOST:PORT or unix:/PATH to listen on; may be repeated.", show_default=False),
    ] = None,
    organizer_token_file: Annotated[
        Path | None,
        typer.Option(help="File with the secret that opening a match asks for. Needed beyond this machine."),
    ] = None,
    log_format: Annotated[
        Literal["json", "text"] | None,
        typer.Option(help="Write a line on stderr for everything that happens: as JSON or as text."),
    ] = None,
    metrics_port: Annotated[
        int | None,
        typer.Option(
            help="Serve Prometheus metrics to this machine on this port; 0 takes a free one.",
            min=0,
            max=65_535,
        ),
    ] = None,
) -> None:
    """Run a match server (default 127.0.0.1:50051) until it is interrupted.

    A match is opened by the Arena service of the protocol (HostMatch), which answers with a token for every
    seat. An agent joins with WILDSCAV_ADDRESS and WILDSCAV_TOKEN in its environment, run by
    python -m wildscav.sdk FOLDER.
    """
    token = None if organizer_token_file is None else _read_token(organizer_token_file)
    asyncio.run(_serve(listen or ["127.0.0.1:50051"], token, log_format, metrics_port))


def _read_token(path: Path) -> str:
    token = path.read_text("utf-8", errors="replace").strip()
    if len(token) < SHORTEST_TOKEN or not token.isascii() or not token.isprintable():
        raise UserError(
            f"{path} must hold a token of {SHORTEST_TOKEN} or more printable ASCII characters", exit_code=2
        )
    return token


async def _serve(
    addresses: list[str], token: str | None, log_format: "LogFormat | None", metrics_port: int | None
) -> None:
    from wildscav.console import console
    from wildscav.logs import open_log
    from wildscav.metrics import serving_metrics
    from wildscav.server import MatchServer
    from wildscav.server.warm import warm

    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stopped.set)
    server = MatchServer(arena=True, organizer_token=token, log=open_log(log_format))
    taken = await server.start(addresses)
    with console.status("preparing the engine (the first run compiles it, which takes about a minute)"):
        await asyncio.to_thread(warm)
    for address in taken:
        console.print(f"listening on {address}", highlight=False)
    with serving_metrics(server.meters, metrics_port) as metrics:
        if metrics is not None:
            console.print(f"metrics at {metrics}", highlight=False)
        await stopped.wait()
    console.print("stopping", highlight=False)
    await server.stop()
