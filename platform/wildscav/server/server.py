"""The match server: its addresses, its matches, and what it serves."""

import asyncio
import contextlib
import resource
import secrets
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import grpc
from grpc_health.v1 import health, health_pb2, health_pb2_grpc

from wildscav.errors import AddressInUseError, UserError
from wildscav.logs import Log
from wildscav.proto.match_pb2_grpc import add_ArenaServicer_to_server
from wildscav.server.addresses import check_free, is_public, with_port
from wildscav.server.arena import ArenaService
from wildscav.server.deadlines import Clock, TimeBank
from wildscav.server.diary import Diary
from wildscav.server.meters import ServerMeters
from wildscav.server.seat import Seat, parse_sensors
from wildscav.server.service import MatchService, Place
from wildscav.server.session import HostedMatch, MatchCancelledError
from wildscav.server.warm import warm
from wildscav.wire.errors import RefusalError

if TYPE_CHECKING:
    from wildscav_engine.match import Match
    from wildscav_engine.sensors import Sensor
    from wildscav_engine.spec import MatchSpec

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
CONNECTIONS = 2000  # to one address at one time


class MatchServer:
    """Hosts many matches at once in one event loop. Make it inside the loop that it is to run in.

    Args:
        arena: Whether matches can be opened over the wire, too.
        organizer_token: The secret that the arena asks for; needed on addresses that others can reach.
        connections: How many may be open to one address; more are closed at once.
        log: Where to write what happens; nowhere if none.
    """

    def __init__(
        self,
        *,
        arena: bool = False,
        organizer_token: str | None = None,
        connections: int = CONNECTIONS,
        log: Log | None = None,
    ) -> None:
        self._places: dict[str, Place] = {}
        self._matches: set[HostedMatch] = set()
        self._arena, self._organizer_token = arena, organizer_token
        self._health = health.aio.HealthServicer()  # type: ignore[attr-defined]
        limit = ("grpc.max_allowed_incoming_connections", connections)
        self._grpc = grpc.aio.server(options=(*OPTIONS, limit))
        service = MatchService(self._places, self._refused)
        self.meters = ServerMeters(lambda: self._matches, lambda: len(service.strangers))
        self._diary = Diary(log)
        self._grpc.add_generic_rpc_handlers((service.handler(),))
        health_pb2_grpc.add_HealthServicer_to_server(self._health, self._grpc)
        if arena:
            add_ArenaServicer_to_server(ArenaService(self, organizer_token), self._grpc)

    async def start(self, addresses: Sequence[str]) -> list[str]:
        """Listen.

        Args:
            addresses: ``unix:/path`` or ``host:port``; port 0 takes a free one.

        Returns:
            The same, with the ports taken: what ``WILDSCAV_ADDRESS`` may be.

        Raises:
            AddressInUseError: An address cannot be had.
            UserError: An address is malformed, or an arena without a token would be open to others.
        """
        for address in addresses:
            check_free(address)
            if self._arena and self._organizer_token is None and is_public(address):
                raise UserError(
                    f"{address} can be reached from other machines: name an organizer token "
                    "(--organizer-token-file), or listen on 127.0.0.1 or a unix socket",
                    exit_code=2,
                )
        _allow_many_files()
        taken = [self._listen(address) for address in addresses]
        await self._grpc.start()
        for service in SERVICES:
            await self._health.set(service, health_pb2.HealthCheckResponse.SERVING)
        return taken

    def _listen(self, address: str) -> str:
        try:
            port = self._grpc.add_insecure_port(address)
        except RuntimeError as error:
            raise AddressInUseError(address, str(error)) from None
        return with_port(address, port)

    async def host(
        self,
        spec: "MatchSpec",
        *,
        names: Sequence[str],
        sensors: Mapping[int, Mapping[str, Mapping[str, Any]]] | None = None,
        clock: Clock | None = None,
    ) -> HostedMatch:
        """Open a match; its submission seats can be joined from now on.

        Args:
            spec: The match.
            names: Display name of every seat.
            sensors: For each seat, the sensors it wants with their options.
            clock: The limits of the seats' time.

        Raises:
            MatchSetupError: The spec cannot be played.
            SensorError: A sensor does not exist, or does not have an option.
            ValueError: Another number of names than seats, or sensors for a seat that there is not.
        """
        from wildscav_engine.spec import SUBMISSION

        numbers = [number for number, filled_by in enumerate(spec.seats) if filled_by == SUBMISSION]
        if len(names) != len(spec.seats):
            raise ValueError(f"{len(names)} names for {len(spec.seats)} seats")
        if wrong := set(sensors or {}) - set(numbers):
            raise ValueError(f"sensors for seat {min(wrong)}, which no submission fills")
        clock = (clock or Clock()).fitted(spec)
        seats = []
        for number in numbers:
            wanted = parse_sensors((sensors or {}).get(number, {}))
            seats.append(Seat(number, secrets.token_urlsafe(24), TimeBank(clock), wanted))
        # In a thread, so that other matches play on while the map is made.
        match = await asyncio.to_thread(_set_up, spec, [seat.sensors for seat in seats])
        hosted = HostedMatch(match, names, seats, clock)
        self._matches.add(hosted)
        self._places.update({seat.token: Place(hosted, seat) for seat in seats})
        hosted.task.add_done_callback(lambda _: self._forget(hosted))
        self._diary.opened(hosted)
        return hosted

    def _refused(self, refusal: RefusalError) -> None:
        self.meters.refused(refusal.reason)
        self._diary.refused(refusal)

    def _forget(self, hosted: HostedMatch) -> None:
        self._matches.discard(hosted)
        how = "cancelled" if hosted.task.cancelled() else "failed" if hosted.task.exception() else "finished"
        self.meters.ended(hosted, how)
        self._diary.ended(hosted, how)
        for token in hosted.tokens.values():
            self._places.pop(token, None)

    async def stop(self, grace: float = 1.0) -> None:
        """Cancel the matches that are not over, and close all connections.

        Args:
            grace: s that open calls have to end by themselves.
        """
        await self._health.enter_graceful_shutdown()
        for hosted in tuple(self._matches):
            hosted.cancel()
            with contextlib.suppress(MatchCancelledError):
                await hosted.finished()
        await self._grpc.stop(grace)


def _allow_many_files() -> None:
    """Raise the limit of open files as far as it goes: each connection is one."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != hard:
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


def _set_up(spec: "MatchSpec", sensors: Iterable[Mapping[str, "Sensor"]]) -> "Match":
    from wildscav_engine.match import Match

    wanted = [sensor for of_seat in sensors for sensor in of_seat.values()]
    warm(wanted)
    match = Match(spec)
    for sensor in wanted:
        sensor.prepare(match.game_map)
    return match
