"""The Arena service of a server that plays the matches itself."""

import asyncio
import json
import secrets
from collections import OrderedDict
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

import grpc

from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest, HostMatchResponse
from wildscav.wire.errors import RefusalError
from wildscav.wire.matches import encode_seat_result
from wildscav_server.hosting.hosted_match import HostedMatch, MatchCancelledError
from wildscav_server.hosting.reports import MatchOutcome
from wildscav_server.leftovers import temporary_folder
from wildscav_server.time_limits import Clock

OPEN_LIMIT = 64  # matches at one time
KEPT_LIMIT = 256  # finished matches whose results are kept

State = GetMatchResponse.State


class ArenaService:
    """Opens matches for organizers, and returns their results."""

    def __init__(self, host: Callable[..., Awaitable[HostedMatch]]) -> None:
        self._host_match = host  # as ``MatchServer.host``
        self._open: dict[str, HostedMatch | None] = {}  # None while the map is being made
        self._closed: OrderedDict[str, GetMatchResponse] = OrderedDict()
        self._waiting: set[asyncio.Task[None]] = set()  # tasks that wait for the end of a match

    async def host_match(self, request: HostMatchRequest) -> HostMatchResponse:
        """Open a match. See ``routes.ArenaHandler``."""
        if len(self._open) >= OPEN_LIMIT:
            raise RefusalError(
                grpc.StatusCode.RESOURCE_EXHAUSTED, "ARENA_FULL", f"{OPEN_LIMIT} matches are open; try later"
            )
        match_id, clock = secrets.token_hex(8), Clock()
        self._open[match_id] = None
        try:
            hosted = await self._host(request, clock)
        except BaseException:
            del self._open[match_id]
            raise
        self._open[match_id] = hosted
        task = asyncio.create_task(self._wait_for_end(match_id, hosted))
        self._waiting.add(task)
        task.add_done_callback(self._waiting.discard)
        return HostMatchResponse(
            match_id=match_id, seat_tokens=hosted.tokens, join_timeout=clock.join_timeout
        )

    async def _host(self, request: HostMatchRequest, clock: Clock) -> HostedMatch:
        """Host the requested match."""
        from pydantic import ValidationError

        from wildscav_engine.record import RecordError, check_recordable
        from wildscav_engine.simulation.match import MatchSetupError
        from wildscav_engine.specs.match_spec import MatchSpec
        from wildscav_engine.specs.validation import one_line

        try:
            spec = MatchSpec.model_validate_json(request.spec_json)
            check_recordable(spec)
            return await self._host_match(
                spec,
                names=tuple(request.names) or tuple(f"seat {seat}" for seat in range(len(spec.seats))),
                sensors={seat: _options(text) for seat, text in request.sensors_json.items()},
                clock=clock,
            )
        except (ValueError, RecursionError, MatchSetupError, RecordError) as error:
            message = one_line(error) if isinstance(error, ValidationError) else " ".join(str(error).split())
            raise RefusalError(grpc.StatusCode.INVALID_ARGUMENT, "SPEC_INVALID", message) from None

    async def _wait_for_end(self, match_id: str, hosted: HostedMatch) -> None:
        """Wait for a match's end, and keep its result."""
        try:
            response = await asyncio.to_thread(_finished, await hosted.finished(), hosted)
        except MatchCancelledError as error:
            response = GetMatchResponse(state=State.STATE_FAILED, error=str(error))
        except Exception as error:  # noqa: BLE001 - every failure is reported to the organizer
            response = GetMatchResponse(
                state=State.STATE_FAILED, error=f"the platform failed: {type(error).__name__}: {error}"
            )
        del self._open[match_id]
        self._closed[match_id] = response
        if len(self._closed) > KEPT_LIMIT:
            self._closed.popitem(last=False)

    async def get_match(self, request: GetMatchRequest) -> GetMatchResponse:
        """Return the state of a match. See ``routes.ArenaHandler``."""
        match_id = request.match_id
        if match_id in self._closed:
            return self._closed[match_id]
        hosted = self._open.get(match_id)
        if hosted is None:
            raise RefusalError(
                grpc.StatusCode.NOT_FOUND, "MATCH_UNKNOWN", f"there is no match {match_id!r}, or no longer"
            )
        state = State.STATE_PLAYING if hosted.playing else State.STATE_JOINING
        return GetMatchResponse(state=state, steps=hosted.match.step_number)


def _options(text: str) -> Mapping[str, Mapping[str, Any]]:
    options = json.loads(text)
    if not isinstance(options, dict) or not all(isinstance(value, dict) for value in options.values()):
        raise ValueError("sensors_json must be an object of sensor names to objects of options")
    return options


def _finished(outcome: MatchOutcome, hosted: HostedMatch) -> GetMatchResponse:
    from wildscav_engine.record import write_record

    with temporary_folder("record-") as folder:
        path = folder / "match.wsr"
        write_record(path, outcome.match, hosted.names)
        record = path.read_bytes()
    result = outcome.match.result()
    return GetMatchResponse(
        state=State.STATE_FINISHED,
        steps=result.steps,
        results=[encode_seat_result(seat.model_dump(), hosted.names[seat.seat]) for seat in result.seats],
        conduct={number: seat.conduct_message() for number, seat in hosted.seats.items()},
        record=record,
    )
