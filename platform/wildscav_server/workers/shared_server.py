"""A shared server: a dispatcher for organizers, and worker processes that play the matches.

One event loop uses one processor core, so there is one worker per core. A match stays at one worker from
start to end; its seats are joined at that worker's own address.
"""

import asyncio
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from wildscav_server.endpoints.addresses import UNIX, split
from wildscav_server.endpoints.endpoint import Endpoint, EndpointSettings
from wildscav_server.endpoints.organizer import Organizer
from wildscav_server.endpoints.routes import arena_routes
from wildscav_server.endpoints.tls import Certificate
from wildscav_server.event_log import EventLog
from wildscav_server.leftovers import own_folder
from wildscav_server.match_server import allow_many_files
from wildscav_server.monitoring.logs import open_log
from wildscav_server.workers.dispatcher import Dispatcher
from wildscav_server.workers.supervisor import WorkerSupervisor
from wildscav_server.workers.worker import WorkerConfig

if TYPE_CHECKING:
    from wildscav_server.monitoring.logs import LogFormat


class SharedServer:
    """Hosts matches in several processes. Construct it inside an event loop.

    Args:
        organizer_token: The secret that is needed to open a match; required on public addresses.
        certificate: For TLS on its ports; None for no encryption.
        log_format: Format of the log lines on stderr; None writes no log.
        metrics_port: Local port of the first worker's metrics; the other workers use the ports after it. 0
            takes free ports, and None serves no metrics.
    """

    def __init__(
        self,
        workers: int,
        *,
        organizer_token: str | None = None,
        certificate: Certificate | None = None,
        insecure: bool = False,
        log_format: "LogFormat | None" = None,
        metrics_port: int | None = None,
    ) -> None:
        self._organizer = Organizer(organizer_token)
        self._settings = EndpointSettings(
            tls=certificate.context() if certificate else None, insecure=insecure
        )
        self._certificate = certificate
        self._count, self._log_format, self._metrics_port = workers, log_format, metrics_port
        self._folder = tempfile.TemporaryDirectory(prefix="serve-", dir=own_folder())
        self._log = open_log(log_format)
        self._event_log = EventLog(self._log)
        self._endpoints: list[Endpoint] = []
        self.workers: list[WorkerSupervisor] = []

    async def start(self, addresses: Sequence[str]) -> list[str]:
        """Start the workers and listen.

        Args:
            addresses: ``unix:/path`` or ``host:port`` for organizers; port 0 takes a free one. Worker ``n``
                listens for seats at ``unix:/path.n`` or at ``port + n``.

        Returns:
            The same addresses with their actual ports.

        Raises:
            AddressInUseError: An address cannot be bound.
            UserError: An address is malformed, or public without TLS or a token, or a worker cannot start.
        """
        try:
            for address in addresses:
                self._organizer.check_address(address)
                self._settings.check_address(address)
            allow_many_files()
            self.workers = [
                WorkerSupervisor(self._config(number, addresses), self._log)
                for number in range(1, self._count + 1)
            ]
            self._bind(addresses)
            await self._start_workers()
        except BaseException:
            await self.stop()
            raise
        for endpoint in self._endpoints:
            endpoint.start()
        return [endpoint.address for endpoint in self._endpoints]

    async def _start_workers(self) -> None:
        """Start all workers, and wait until each is ready or has failed."""
        started = await asyncio.gather(*(worker.start() for worker in self.workers), return_exceptions=True)
        for failure in filter(None, started):
            raise failure

    def _bind(self, addresses: Sequence[str]) -> None:
        """Bind the organizers' addresses, without accepting connections yet."""
        for place, address in enumerate(addresses):
            routes = arena_routes(Dispatcher(self.workers, place), self._organizer)
            self._endpoints.append(
                Endpoint(
                    address,
                    self._settings,
                    {},
                    self._event_log.stream_refused,
                    self._event_log.stream_failed,
                    _ignore,
                    routes,
                )
            )

    def _config(self, number: int, addresses: Sequence[str]) -> WorkerConfig:
        first = self._metrics_port
        return WorkerConfig(
            seats=[beside(address, number) for address in addresses],
            arena=f"{UNIX}{Path(self._folder.name) / str(number)}",
            number=number,
            certificate=self._certificate,
            insecure=self._settings.insecure,
            log_format=self._log_format,
            metrics_port=first + number - 1 if first else first,
        )

    async def stop(self) -> None:
        """Stop the workers, which cancels their matches, and close all connections."""
        for endpoint in self._endpoints:
            endpoint.announce_end()
        await asyncio.gather(*(worker.stop() for worker in self.workers))
        await asyncio.gather(*(endpoint.stop(1.0) for endpoint in self._endpoints))
        self._folder.cleanup()


def _ignore(address: str, reason: str) -> None:
    """Ignore a flood: at organizers' addresses, no seat is to blame."""


def beside(address: str, number: int) -> str:
    """Return the address of a worker's seats that belongs to an organizers' address."""
    if address.startswith(UNIX):
        return f"{address}.{number}"
    host, port = split(address)
    shown = f"[{host}]" if ":" in host else host
    return f"{shown}:{port + number if port else 0}"
