"""What is served by which method: gRPC's paths, and how a call with one answer is spoken."""

from collections.abc import Awaitable, Callable
from typing import Protocol, TypeVar

import grpc
from google.protobuf.message import DecodeError, Message
from grpc_health.v1.health_pb2 import HealthCheckRequest, HealthCheckResponse

from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest, HostMatchResponse
from wildscav.server.endpoints.organizer import Organizer
from wildscav.server.http2.calls import Route
from wildscav.server.http2.stream import Stream
from wildscav.wire.errors import ProtocolRefusalError, RefusalError

PLAY = "/wildscav.match.v1.Match/Play"
HOST_MATCH, GET_MATCH = (f"/wildscav.match.v1.Arena/{name}" for name in ("HostMatch", "GetMatch"))
CHECK = "/grpc.health.v1.Health/Check"
SERVICES = ("", "wildscav.match.v1.Match")  # whose health is known
SPEC_LIMIT = 256 * 1024  # bytes of what an organizer sends

Request = TypeVar("Request", bound=Message)


class ArenaHandler(Protocol):
    """What serves the Arena service: it opens matches for organizers, who have been let in already."""

    async def host_match(self, request: HostMatchRequest) -> HostMatchResponse:
        """Open a match.

        Raises:
            RefusalError: It is not opened.
        """
        ...

    async def get_match(self, request: GetMatchRequest) -> GetMatchResponse:
        """Tell how a match stands.

        Raises:
            RefusalError: There is none.
        """
        ...


def arena_routes(arena: ArenaHandler, organizer: Organizer) -> dict[str, Route]:
    """Return how an arena is reached."""
    return {
        HOST_MATCH: Route(unary(HostMatchRequest, arena.host_match), SPEC_LIMIT, organizer.admit),
        GET_MATCH: Route(unary(GetMatchRequest, arena.get_match), admit=organizer.admit),
    }


class Health:
    """Answers whether the server serves (``grpc.health.v1``)."""

    def __init__(self) -> None:
        self.serving = False

    def routes(self) -> dict[str, Route]:
        """Return how it is reached."""
        return {CHECK: Route(unary(HealthCheckRequest, self._check))}

    async def _check(self, request: HealthCheckRequest) -> HealthCheckResponse:
        if request.service not in SERVICES:
            raise RefusalError(grpc.StatusCode.NOT_FOUND, "", "there is no such service")
        status = HealthCheckResponse.SERVING if self.serving else HealthCheckResponse.NOT_SERVING
        return HealthCheckResponse(status=status)


def unary(
    kind: type[Request], call: Callable[[Request], Awaitable[Message]]
) -> Callable[[Stream], Awaitable[None]]:
    """Return what serves a method that has one request and one answer.

    Args:
        kind: Of the request.
        call: Answers it; may raise ``RefusalError``.
    """

    async def serve(stream: Stream) -> None:
        try:
            request = kind.FromString(await stream.read())
        except DecodeError:
            raise ProtocolRefusalError("PROTOCOL_ERROR", f"sent bytes that are no {kind.__name__}") from None
        await stream.write((await call(request)).SerializeToString())

    return serve
