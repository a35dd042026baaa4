"""An endpoint of a match server: one address with its own listener.

So a seat can be tied to one address, and a flood at one address does not keep clients from joining at
another.
"""

import contextlib
import ssl
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from wildscav.errors import UserError
from wildscav.wire.errors import RefusalError
from wildscav_server.endpoints.addresses import UNIX, bind, is_public, with_port
from wildscav_server.endpoints.match_service import MatchService, Reservation
from wildscav_server.endpoints.routes import PLAY, Health
from wildscav_server.http2.connection import Listener
from wildscav_server.http2.session import Route

CONNECTIONS = 2000  # to one address at one time


@dataclass(frozen=True)
class EndpointSettings:
    """Who may connect to an address, and how."""

    connections: int = CONNECTIONS  # open at one time; beyond that, one of an unknown client is closed
    max_total_connections: int | None = None  # after which the address is closed; None: any number
    tls: ssl.SSLContext | None = field(default=None, compare=False)  # for ports; unix sockets need none
    insecure: bool = False  # whether other machines may connect without TLS

    def check_address(self, address: str) -> None:
        """Raise a UserError for an address where tokens would cross the network in clear."""
        if self.tls is None and not self.insecure and is_public(address):
            raise UserError(
                f"{address} can be reached from other machines, and tokens would cross the network in clear: "
                "give a certificate (--tls-cert, --tls-key), or --insecure if you trust the network",
                exit_code=2,
            )


class Endpoint:
    """Listens on one address once it is started.

    Args:
        address: The address; port 0 takes a free one.
        on_failure: Called with the address and an internal error before a stream's seat was known.
        on_flood: Called with the address of a seat that its agent has flooded, and with what the agent did.
        routes: Further methods that are served there.

    Raises:
        AddressInUseError: The address cannot be bound.
        UserError: It is malformed.
    """

    def __init__(
        self,
        address: str,
        endpoint_settings: EndpointSettings,
        reservations: Mapping[str, Reservation],
        on_refusal: Callable[[RefusalError], None],
        on_failure: Callable[[str, Exception], None],
        on_flood: Callable[[str, str], None],
        routes: Mapping[str, Route],
    ) -> None:
        sockets = bind(address)
        name = sockets[0].getsockname()
        self.address = address if address.startswith(UNIX) else with_port(address, name[1])
        self._path = Path(name) if address.startswith(UNIX) else None
        self._inode = self._path.stat().st_ino if self._path else 0
        self._service = MatchService(reservations, on_refusal, on_failure, self.address)
        self._health = Health()
        self._listener = Listener(
            sockets,
            {PLAY: Route(self._service.play), **self._health.routes(), **routes},
            connections=endpoint_settings.connections,
            max_total_connections=endpoint_settings.max_total_connections,
            on_flood=lambda reason: on_flood(self.address, reason),
            tls=None if self._path else endpoint_settings.tls,
        )

    @property
    def pending_streams(self) -> int:
        """How many streams have not joined a seat yet."""
        return self._service.pending_streams

    def start(self) -> None:
        """Accept connections."""
        self._listener.start()
        self._health.serving = True

    def announce_end(self) -> None:
        """Report to health checks that the server is about to stop."""
        self._health.serving = False

    async def stop(self, grace: float) -> None:
        """Close all connections, once open calls had ``grace`` seconds to end by themselves."""
        await self._listener.stop(grace)
        if self._path is not None:
            with contextlib.suppress(OSError):
                if self._path.stat().st_ino == self._inode:  # it has not been replaced by another process's
                    self._path.unlink()
