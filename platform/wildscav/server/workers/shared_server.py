"""A server that many share: a dispatcher for organizers, and worker processes that play the matches.

One event loop keeps one processor core busy, so there is a worker a core. A match is one worker's from its
start to its end; its seats are joined there, at an address of the worker's own.
"""

import asyncio
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from wildscav.monitoring.logs import open_log
from wildscav.server.endpoints.addresses import UNIX, split
from wildscav.server.endpoints.endpoint import Endpoint, EndpointSettings
from wildscav.server.endpoints.organizer import Organizer
from wildscav.server.endpoints.routes import arena_routes
from wildscav.server.endpoints.tls import Certificate
from wildscav.server.event_log import EventLog
from wildscav.server.match_server import allow_many_files
from wildscav.server.workers.dispatcher import Dispatcher
from wildscav.server.workers.supervisor import WorkerSupervisor
from wildscav.server.workers.worker import WorkerConfig
from wildscav.system.leftovers import own_folder

if TYPE_CHECKING:
    from wildscav.monitoring.logs import LogFormat


class SharedServer:
    """Hosts matches in several processes. Make it inside an event loop.

    Args:
        workers: How many processes, at least 1.
        organizer_token: The secret that opening a match asks for; needed on addresses that others can reach.
        certificate: How its ports are encrypted; they are not if none.
        insecure: Whether other machines may come without that.
        log_format: Of the lines on stderr for what happens; none if None.
        metrics_port: Of the first worker's metrics, on this machine alone; the others' follow. 0 takes free
            ones; None: none are served.
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
            The same, with the ports taken.

        Raises:
            AddressInUseError: An address cannot be had.
            UserError: An address is malformed or open to others without a token, or a worker cannot start.
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
        """Start all of them, and wait until each is ready or has failed."""
        started = await asyncio.gather(*(worker.start() for worker in self.workers), return_exceptions=True)
        for failure in filter(None, started):
            raise failure

    def _bind(self, addresses: Sequence[str]) -> None:
        """Take the organizers' addresses, though nobody is let in yet."""
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
        """End the workers, their matches with them, and close all connections."""
        for endpoint in self._endpoints:
            endpoint.announce_end()
        await asyncio.gather(*(worker.stop() for worker in self.workers))
        await asyncio.gather(*(endpoint.stop(1.0) for endpoint in self._endpoints))
        self._folder.cleanup()


def _ignore(address: str, reason: str) -> None:
    """Hear of a flood: where organizers call, no seat is to blame."""


def beside(address: str, number: int) -> str:
    """Return the address of a worker's seats that goes with an organizers' address."""
    if address.startswith(UNIX):
        return f"{address}.{number}"
    host, port = split(address)
    shown = f"[{host}]" if ":" in host else host
    return f"{shown}:{port + number if port else 0}"
