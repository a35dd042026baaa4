"""The match server: its addresses, its matches and its services."""

import asyncio
import contextlib
import resource
import secrets
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from wildscav.wire.errors import ProtocolRefusalError, RefusalError
from wildscav_server.arena_service import ArenaService
from wildscav_server.endpoints.endpoint import Endpoint, EndpointSettings
from wildscav_server.endpoints.match_service import Reservation
from wildscav_server.endpoints.organizer import Organizer
from wildscav_server.endpoints.routes import arena_routes
from wildscav_server.event_log import EventLog
from wildscav_server.hosting.hosted_match import HostedMatch, MatchCancelledError
from wildscav_server.hosting.precompile import precompile
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.hosting.seat import Seat, parse_sensors
from wildscav_server.monitoring.logs import Log
from wildscav_server.server_metrics import ServerMetrics
from wildscav_server.time_limits import Clock, SeatClock

if TYPE_CHECKING:
    from wildscav_engine.sensors import Sensor
    from wildscav_engine.simulation.match import Match
    from wildscav_engine.specs.match_spec import MatchSpec

DEFAULT_SETTINGS = EndpointSettings()


class MatchServer:
    """Hosts many matches at once in one event loop. Construct it inside the loop that it is to run in.

    Args:
        arena: Whether matches can also be opened over the network, by the Arena service.
        organizer_token: The secret that the Arena service requires; needed on public addresses.
        log: Where to write events; None writes nothing.
    """

    def __init__(
        self,
        *,
        arena: bool = False,
        organizer_token: str | None = None,
        endpoint_settings: EndpointSettings = DEFAULT_SETTINGS,
        log: Log | None = None,
    ) -> None:
        from wildscav_engine.parallel.threads import cores

        self._reservations: dict[str, Reservation] = {}
        self._matches: set[HostedMatch] = set()
        self._endpoints: list[Endpoint] = []
        # So that no running match waits for maps, not even for those of calls that are cancelled.
        self._map_makers = ThreadPoolExecutor(max(1, cores() - 1), "map")
        self._settings, self._time = endpoint_settings, SeatClock()
        self._organizer = Organizer(organizer_token)
        self._arena_routes = arena_routes(ArenaService(self.host), self._organizer) if arena else {}
        self.metrics = ServerMetrics(
            lambda: self._matches, lambda: sum(one.pending_streams for one in self._endpoints)
        )
        self._event_log = EventLog(log)

    async def start(self, addresses: Sequence[str], *, arena: bool = True) -> list[str]:
        """Listen; may be called again for more addresses.

        Args:
            addresses: ``unix:/path`` or ``host:port``; port 0 takes a free one.
            arena: Whether the server's Arena service, if it has one, can be reached there.

        Returns:
            The same addresses with their actual ports, as values for ``WILDSCAV_ADDRESS``.

        Raises:
            AddressInUseError: An address cannot be bound.
            UserError: An address is malformed, or is public and has no TLS or no organizer token.
        """
        routes = self._arena_routes if arena else {}
        for address in addresses:
            if routes:
                self._organizer.check_address(address)
            self._settings.check_address(address)
        allow_many_files()
        new = []
        for address in addresses:
            new.append(
                Endpoint(
                    address,
                    self._settings,
                    self._reservations,
                    self._stream_refused,
                    self._stream_failed,
                    self._seat_flooded,
                    routes,
                )
            )
            self._endpoints.append(new[-1])
        for endpoint in new:
            endpoint.start()
        return [endpoint.address for endpoint in new]

    async def host(
        self,
        spec: "MatchSpec",
        *,
        names: Sequence[str],
        sensors: Mapping[int, Mapping[str, Mapping[str, Any]]] | None = None,
        seeds: Mapping[int, int] | None = None,
        clock: Clock | None = None,
        addresses: Mapping[int, str] | None = None,
        starting: bool = False,
        make: "Callable[[MatchSpec], Match] | None" = None,
    ) -> HostedMatch:
        """Open a match; its submission seats can be joined from now on.

        Args:
            seeds: The private seeds of seats that are not to be told the one that follows from the spec.
            addresses: For seats that can be joined at one address only, that address, as ``start`` returned
                it; their tokens are invalid at any other.
            starting: Whether the caller has yet to start the agents: the time to join then begins once each
                seat is ``launched``, and not now.
            make: Makes the match from its spec, if it is not to be a plain ``Match``.

        Raises:
            MatchSetupError: The spec cannot be played.
            SensorError: A sensor does not exist, or does not have an option.
            ValueError: The number of names is not the number of seats, a seat with sensors or an address is
                not a submission's, or the server does not listen at an address.
        """
        from wildscav_engine.sensors import allowed_sensors
        from wildscav_engine.specs.match_spec import SUBMISSION

        numbers = [number for number, filled_by in enumerate(spec.seats) if filled_by == SUBMISSION]
        if len(names) != len(spec.seats):
            raise ValueError(f"{len(names)} names for {len(spec.seats)} seats")
        if wrong := set(sensors or {}) - set(numbers):
            raise ValueError(f"sensors for seat {min(wrong)}, which no submission fills")
        own = self._own_addresses(addresses or {}, numbers)
        clock = (clock or Clock()).fitted(spec)
        seats = []
        for number in numbers:
            wanted = allowed_sensors(parse_sensors((sensors or {}).get(number, {})), spec.rules)
            seats.append(Seat(number, secrets.token_urlsafe(24), clock.bank(), wanted))
        # In a thread, so that other matches play on while the map is made.
        match = await asyncio.get_running_loop().run_in_executor(
            self._map_makers, _set_up, spec, [seat.sensors for seat in seats], make
        )
        match.seeds = seeds or match.seeds
        hosted = HostedMatch(match, names, seats, clock, self._time, starting=starting)
        self._matches.add(hosted)
        self._reservations.update(
            {seat.token: Reservation(hosted, seat, own.get(seat.number)) for seat in seats}
        )
        hosted.task.add_done_callback(lambda _: self._forget(hosted))
        self._event_log.match_opened(hosted)
        return hosted

    def _own_addresses(self, addresses: Mapping[int, str], numbers: Sequence[int]) -> Mapping[int, str]:
        """Check that seats can be joined at the addresses that are given for them."""
        if wrong := set(addresses) - set(numbers):
            raise ValueError(f"an address for seat {min(wrong)}, which no submission fills")
        if unknown := set(addresses.values()) - {endpoint.address for endpoint in self._endpoints}:
            raise ValueError(f"this server does not listen on {min(unknown)}")
        return addresses

    def _stream_refused(self, refusal: RefusalError) -> None:
        self.metrics.refused(refusal.reason)
        self._event_log.stream_refused(refusal)

    def _stream_failed(self, address: str, error: Exception) -> None:
        """End the matches that have a seat at an address where the server failed."""
        self._event_log.stream_failed(address, error)
        for match in {
            reservation.match for reservation in self._reservations.values() if reservation.address == address
        }:
            match.fail(error)

    def _seat_flooded(self, address: str, reason: str) -> None:
        """Close the seats at an address that their agent has flooded."""
        self._stream_refused(ProtocolRefusalError("FLOOD", reason))
        for reservation in tuple(self._reservations.values()):
            if reservation.address == address:
                reservation.match.give_up(reservation.seat.number, reason, SeatStatus.PROTOCOL_ERROR)

    def _forget(self, hosted: HostedMatch) -> None:
        self._matches.discard(hosted)
        how = "cancelled" if hosted.task.cancelled() else "failed" if hosted.task.exception() else "finished"
        self.metrics.ended(hosted, how)
        self._event_log.match_ended(hosted, how)
        for token in hosted.tokens.values():
            self._reservations.pop(token, None)

    async def stop(self, grace: float = 1.0) -> None:
        """Cancel the matches that are not over, and close all connections; see ``Endpoint.stop``."""
        for endpoint in self._endpoints:
            endpoint.announce_end()
        for hosted in tuple(self._matches):
            hosted.cancel()
            with contextlib.suppress(MatchCancelledError):
                await hosted.finished()
        await asyncio.gather(*(endpoint.stop(grace) for endpoint in self._endpoints))
        self._map_makers.shutdown(wait=False, cancel_futures=True)


def allow_many_files() -> None:
    """Raise the limit of open files as far as allowed, because each connection is one."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != hard:
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


def _set_up(
    spec: "MatchSpec",
    sensors: Iterable[Mapping[str, "Sensor"]],
    make: "Callable[[MatchSpec], Match] | None",
) -> "Match":
    from wildscav_engine.simulation.match import Match

    wanted = [sensor for of_seat in sensors for sensor in of_seat.values()]
    precompile(wanted)
    match = (make or Match)(spec)
    for sensor in wanted:
        sensor.prepare(match.game_map)
    return match
