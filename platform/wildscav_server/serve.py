"""``wildscav serve``: a shared match server."""

import asyncio
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import typer

from wildscav.errors import UserError
from wildscav_server.endpoints.addresses import LAST_PORT

if TYPE_CHECKING:
    from wildscav_server.endpoints.tls import Certificate
    from wildscav_server.monitoring.logs import LogFormat

SHORTEST_TOKEN = 16  # characters
MAX_WORKERS = 64


class ServerOptions(NamedTuple):
    """The options of a server."""

    addresses: list[str]
    token: str | None
    certificate: "Certificate | None"
    insecure: bool
    log_format: "LogFormat | None"
    metrics_port: int | None


def serve(
    listen: Annotated[
        list[str] | None,
        typer.Option(help="HOST:PORT or unix:/PATH to listen on; may be repeated.", show_default=False),
    ] = None,
    organizer_token_file: Annotated[
        Path | None,
        typer.Option(
            help="File with the secret that is needed to open a match. Required on public addresses."
        ),
    ] = None,
    tls_cert: Annotated[
        Path | None,
        typer.Option(help="The server's certificate, PEM. Required on public addresses."),
    ] = None,
    tls_key: Annotated[Path | None, typer.Option(help="Its private key, PEM.")] = None,
    client_ca: Annotated[
        Path | None,
        typer.Option(help="Accept only clients with a certificate that this authority (PEM) has signed."),
    ] = None,
    insecure: Annotated[
        bool,
        typer.Option(
            "--insecure", help="Accept other machines without TLS: tokens cross the network in clear."
        ),
    ] = False,
    workers: Annotated[
        int | None,
        typer.Option(
            help="Processes that play the matches, each with its own address. Default: one per core.",
            min=1,
            max=MAX_WORKERS,
            show_default=False,
        ),
    ] = None,
    log_format: Annotated[
        Literal["json", "text"] | None,
        typer.Option(help="Write a log line to stderr for every event: as JSON or as text."),
    ] = None,
    metrics_port: Annotated[
        int | None,
        typer.Option(
            help="Serve Prometheus metrics to this machine on this port, and those of further workers on "
            "the ports after it; 0 takes free ports.",
            min=0,
            max=LAST_PORT,
        ),
    ] = None,
) -> None:
    """Run a match server (default 127.0.0.1:50051) until it is interrupted.

    The protocol's Arena service (HostMatch) opens a match. It answers with a token for every seat and the
    address where the seats are joined: with several workers, worker n listens for its seats on PORT + n, or
    on unix:/PATH.n. To join, start the agent with python -m wildscav.sdk FOLDER and with WILDSCAV_ADDRESS
    and WILDSCAV_TOKEN in its environment.
    """
    from wildscav_engine.parallel.threads import cores

    token = None if organizer_token_file is None else read_token(organizer_token_file)
    certificate = _certificate(tls_cert, tls_key, client_ca)
    addresses = listen or ["127.0.0.1:50051"]
    workers = workers or min(cores(), MAX_WORKERS)
    if metrics_port is not None and (last := metrics_port + workers - 1) > LAST_PORT:
        raise UserError(
            f"--metrics-port is {metrics_port}: {workers} workers would need ports up to {last}", exit_code=2
        )
    options = ServerOptions(addresses, token, certificate, insecure, log_format, metrics_port)
    asyncio.run(_serve(options, workers))


def _certificate(chain: Path | None, key: Path | None, client_ca: Path | None) -> "Certificate | None":
    from wildscav_server.endpoints.tls import Certificate

    if chain is None and key is None:
        if client_ca is not None:
            raise UserError("--client-ca needs --tls-cert and --tls-key", exit_code=2)
        return None
    if chain is None or key is None:
        raise UserError("--tls-cert and --tls-key belong together: give both or neither", exit_code=2)
    certificate = Certificate(str(chain), str(key), None if client_ca is None else str(client_ca))
    certificate.context()  # reports errors before the engine is prepared, which may take a while
    return certificate


def read_token(path: Path) -> str:
    """Return the secret in a file, or raise a UserError if it is too short or cannot be sent."""
    token = path.read_text("utf-8", errors="replace").strip()
    if len(token) < SHORTEST_TOKEN or not token.isascii() or not token.isprintable():
        raise UserError(
            f"{path} must hold a token of {SHORTEST_TOKEN} or more printable ASCII characters", exit_code=2
        )
    return token


async def _serve(options: ServerOptions, workers: int) -> None:
    from wildscav_server.monitoring.logs import open_log

    open_log(options.log_format).info("preparing_engine", workers=workers)  # it may take a minute or two
    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, stopped.set)
    await (_serve_alone(options, stopped) if workers == 1 else _serve_with(workers, options, stopped))


async def _serve_alone(options: ServerOptions, stopped: asyncio.Event) -> None:
    """Serve in this process."""
    from wildscav.terminal.console import console
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_server.endpoints.endpoint import EndpointSettings
    from wildscav_server.hosting.precompile import precompile
    from wildscav_server.match_server import MatchServer
    from wildscav_server.monitoring.logs import open_log
    from wildscav_server.monitoring.metrics import serving_metrics

    endpoint_settings = EndpointSettings(
        tls=options.certificate.context() if options.certificate else None, insecure=options.insecure
    )
    server = MatchServer(
        arena=True,
        organizer_token=options.token,
        endpoint_settings=endpoint_settings,
        log=open_log(options.log_format),
    )
    bound = await server.start(options.addresses)
    with preparing(console, is_said=options.log_format == "json"):
        await asyncio.to_thread(precompile)
    _print_listening(bound)
    with serving_metrics(server.metrics, options.metrics_port) as metrics:
        if metrics is not None:
            console.print(f"metrics at {metrics}")
        await stopped.wait()
    console.print("stopping")
    await server.stop()


async def _serve_with(workers: int, options: ServerOptions, stopped: asyncio.Event) -> None:
    """Serve with several worker processes."""
    from wildscav.terminal.console import console
    from wildscav_engine.compilation.engine_progress import preparing
    from wildscav_server.workers.shared_server import SharedServer

    server = SharedServer(
        workers,
        organizer_token=options.token,
        certificate=options.certificate,
        insecure=options.insecure,
        log_format=options.log_format,
        metrics_port=options.metrics_port,
    )
    with preparing(console, is_said=options.log_format == "json"):
        bound = await server.start(options.addresses)
    _print_listening(bound)
    for worker in server.workers:
        metrics = f", metrics at {worker.metrics}" if worker.metrics else ""
        console.print(f"worker {worker.number}: seats at {', '.join(worker.seats)}{metrics}")
    await stopped.wait()
    console.print("stopping")
    await server.stop()


def _print_listening(addresses: list[str]) -> None:
    from wildscav.terminal.console import console

    for address in addresses:
        console.print(f"listening on {address}")
