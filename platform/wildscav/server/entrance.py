"""An entrance of a match server: one address, with a gRPC server of its own that listens there.

gRPC does not tell over which of its addresses a stream came in, so each has a server to itself. A seat can
thus be tied to one address, and nobody who crowds one keeps others from joining at another.
"""

from collections.abc import Callable, Mapping

import grpc
from grpc_health.v1 import health, health_pb2, health_pb2_grpc

from wildscav.errors import AddressInUseError
from wildscav.proto.match_pb2_grpc import ArenaServicer, add_ArenaServicer_to_server
from wildscav.server.addresses import with_port
from wildscav.server.service import MatchService, Place
from wildscav.wire.errors import RefusalError

SERVICES = ("", "wildscav.match.v1.Match")
OPTIONS = (
    ("grpc.so_reuseport", 0),  # so that a port in use is an error
    ("grpc.max_receive_message_length", 256 * 1024),  # bytes: actions are tiny, specs small
    ("grpc.keepalive_time_ms", 30_000),  # finds out that a remote peer is gone
    ("grpc.keepalive_timeout_ms", 10_000),
    ("grpc.server_handshake_timeout_ms", 10_000),  # for a connection to speak HTTP/2
    ("grpc.max_connection_idle_ms", 60_000),  # without a stream
    ("grpc.max_concurrent_streams", 128),  # of one connection
)


class Entrance:
    """Listens on one address, once it is started.

    Args:
        address: Free to be taken; port 0 takes any.
        connections: How many may be open at one time; more are closed at once.
        places: What each token stands for.
        refused: Told of every refusal.
        broke: Told of an error of ours, met before it was known whose stream it was, and of the address.
        arena: Opens matches over the wire; nobody does if none.

    Raises:
        AddressInUseError: The address cannot be had.
    """

    def __init__(
        self,
        address: str,
        connections: int,
        places: Mapping[str, Place],
        refused: Callable[[RefusalError], None],
        broke: Callable[[str, Exception], None],
        arena: ArenaServicer | None,
    ) -> None:
        limit = ("grpc.max_allowed_incoming_connections", connections)
        self._grpc = grpc.aio.server(options=(*OPTIONS, limit))
        try:
            port = self._grpc.add_insecure_port(address)
        except RuntimeError as error:
            raise AddressInUseError(address, str(error)) from None
        self.address = with_port(address, port)
        self._service = MatchService(places, refused, broke, self.address)
        self._grpc.add_generic_rpc_handlers((self._service.handler(),))
        self._health = health.aio.HealthServicer()  # type: ignore[attr-defined]
        health_pb2_grpc.add_HealthServicer_to_server(self._health, self._grpc)
        if arena is not None:
            add_ArenaServicer_to_server(arena, self._grpc)

    @property
    def strangers(self) -> int:
        """How many streams have not said which seat they are."""
        return len(self._service.strangers)

    async def start(self) -> None:
        """Let streams come in."""
        await self._grpc.start()
        for service in SERVICES:
            await self._health.set(service, health_pb2.HealthCheckResponse.SERVING)

    async def announce_end(self) -> None:
        """Tell whoever asks that the server is about to stop."""
        await self._health.enter_graceful_shutdown()

    async def stop(self, grace: float) -> None:
        """Close all connections.

        Args:
            grace: s that open calls have to end by themselves.
        """
        await self._grpc.stop(grace)
