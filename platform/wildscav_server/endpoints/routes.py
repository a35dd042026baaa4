"""The methods that are served: their gRPC paths and handlers."""

from collections.abc import Awaitable, Callable
from typing import Protocol, TypeVar

import grpc
from google.protobuf.message import DecodeError, Message
from grpc_health.v1.health_pb2 import HealthCheckRequest, HealthCheckResponse

from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest, HostMatchResponse
from wildscav.wire.errors import ProtocolRefusalError, RefusalError
from wildscav_server.endpoints.organizer import Organizer
from wildscav_server.http2.session import Route
from wildscav_server.http2.stream import Stream

PLAY = "/wildscav.match.v1.Match/Play"
HOST_MATCH, GET_MATCH = (f"/wildscav.match.v1.Arena/{name}" for name in ("HostMatch", "GetMatch"))
CHECK = "/grpc.health.v1.Health/Check"
SERVICES = ("", "wildscav.match.v1.Match")  # the services that health checks may name
SPEC_LIMIT = 256 * 1024  # bytes of a HostMatchRequest

Request = TypeVar("Request", bound=Message)


class ArenaHandler(Protocol):
    """The interface of the Arena service's implementations. Their callers have been authenticated already."""

    async def host_match(self, request: HostMatchRequest) -> HostMatchResponse:
        """Open a match, or raise a RefusalError if it cannot be opened."""
        ...

    async def get_match(self, request: GetMatchRequest) -> GetMatchResponse:
        """Return the state of a match, or raise a RefusalError if there is no such match."""
        ...


def arena_routes(arena: ArenaHandler, organizer: Organizer) -> dict[str, Route]:
    """Return the routes of an Arena service."""
    return {
        HOST_MATCH: Route(unary(HostMatchRequest, arena.host_match), SPEC_LIMIT, organizer.admit),
        GET_MATCH: Route(unary(GetMatchRequest, arena.get_match), admit=organizer.admit),
    }


class Health:
    """The health check of a server (``grpc.health.v1``)."""

    def __init__(self) -> None:
        self.serving = False

    def routes(self) -> dict[str, Route]:
        """Return the routes of the health check."""
        return {CHECK: Route(unary(HealthCheckRequest, self._check))}

    async def _check(self, request: HealthCheckRequest) -> HealthCheckResponse:
        if request.service not in SERVICES:
            raise RefusalError(grpc.StatusCode.NOT_FOUND, "", "there is no such service")
        status = HealthCheckResponse.SERVING if self.serving else HealthCheckResponse.NOT_SERVING
        return HealthCheckResponse(status=status)


def unary(
    kind: type[Request], call: Callable[[Request], Awaitable[Message]]
) -> Callable[[Stream], Awaitable[None]]:
    """Return the handler of a method with one request and one response.

    The call returns the response; it may raise ``RefusalError``.
    """

    async def serve(stream: Stream) -> None:
        try:
            request = kind.FromString(await stream.read())
        except DecodeError:
            raise ProtocolRefusalError(
                "PROTOCOL_ERROR", f"sent bytes that are not a {kind.__name__}"
            ) from None
        await stream.write((await call(request)).SerializeToString())

    return serve
