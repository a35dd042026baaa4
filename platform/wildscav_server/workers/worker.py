"""A worker of a shared server: a process with its own event loop and matches.

``supervisor`` starts it as ``python -m wildscav_server.workers.worker``. The worker reads its configuration
as one line of JSON from its standard input, and answers with one line on its standard output. It ends when
its input is closed, and so at the latest when the process that started it ends.
"""

import asyncio
import json
import signal
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from wildscav.errors import AddressInUseError, UserError
from wildscav_server.endpoints.endpoint import EndpointSettings
from wildscav_server.endpoints.tls import Certificate
from wildscav_server.hosting.precompile import precompile
from wildscav_server.match_server import MatchServer
from wildscav_server.monitoring.logs import open_log
from wildscav_server.monitoring.metrics import serving_metrics

if TYPE_CHECKING:
    from wildscav_server.monitoring.logs import LogFormat


class WorkerConfig(NamedTuple):
    """The configuration of a worker."""

    seats: Sequence[str]  # addresses to listen on for seats
    arena: str  # the address of its Arena service, for the dispatcher
    number: int  # its number in log lines
    certificate: Sequence[Any] | None = None  # for TLS on its ports, the fields of ``Certificate``
    insecure: bool = False  # whether other machines may connect without TLS
    log_format: "LogFormat | None" = None
    metrics_port: int | None = None


class WorkerReady(NamedTuple):
    """A worker's answer."""

    seats: Sequence[str] = ()  # its actual addresses
    metrics: str | None = None  # URL of its metrics
    error: str = ""  # why it cannot start; it ends then
    exit_code: int = 1


async def _work(config: WorkerConfig) -> None:
    stopped = asyncio.Event()
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGTERM, stopped.set)
    loop.add_reader(sys.stdin.fileno(), stopped.set)  # nothing more comes but the end of the input
    try:
        tls = Certificate(*config.certificate).context() if config.certificate else None
    except UserError as error:
        _answer(WorkerReady(error=str(error), exit_code=error.exit_code))
        return
    log = open_log(config.log_format, worker=config.number)
    server = MatchServer(
        arena=True, endpoint_settings=EndpointSettings(tls=tls, insecure=config.insecure), log=log
    )
    try:
        taken = await server.start(config.seats, arena=False)
        await server.start([config.arena])
        await asyncio.to_thread(precompile)
        with serving_metrics(server.metrics, config.metrics_port) as metrics:
            _answer(WorkerReady(taken, metrics))
            await stopped.wait()
    except AddressInUseError as error:
        _answer(WorkerReady(error=str(error)))
    except UserError as error:
        _answer(WorkerReady(error=str(error), exit_code=error.exit_code))
    await server.stop()


def _answer(ready: WorkerReady) -> None:
    print(json.dumps(ready._asdict()), flush=True)  # noqa: T201 - the answer goes to standard output


def main() -> None:
    """Read the configuration and work until told to stop."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent, which also gets a Ctrl-C, stops this process
    config: dict[str, Any] = json.loads(sys.stdin.readline())
    asyncio.run(_work(WorkerConfig(**config)))


if __name__ == "__main__":
    main()
