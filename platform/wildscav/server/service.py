"""The Match service: one call of ``Play`` is one seat's stream."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from typing import NamedTuple, TypeAlias

import grpc
from google.protobuf.message import DecodeError

from wildscav.proto import PROTOCOL_VERSION
from wildscav.proto.match_pb2 import Action, ClientMessage, Join, ServerMessage
from wildscav.proto.match_pb2_grpc import MatchServicer
from wildscav.server.reports import SeatStatus
from wildscav.server.seat import Seat
from wildscav.server.session import HostedMatch
from wildscav.wire.errors import RefusalError, encode_refusal

JOIN_TIME = 10.0  # s that a new stream has to say who it is
STREAM_ENDED = "its stream ended"
STALE_LIMIT = 16  # old answers that a seat may send in one step

Context: TypeAlias = grpc.aio.ServicerContext[ClientMessage, ServerMessage]


class Place(NamedTuple):
    """What a token stands for."""

    match: HostedMatch
    seat: Seat


class MatchService(MatchServicer):
    """Serves the seats of all matches of a server.

    Args:
        places: What each token stands for; the server adds and removes.
    """

    def __init__(self, places: Mapping[str, Place]) -> None:
        self._places = places

    async def Play(self, request_iterator: AsyncIterator[ClientMessage], context: Context) -> None:  # noqa: N802, ARG002
        """Serve one seat from joining to the end of its match."""
        try:
            place = self._place(await _read_join(context))
            task = asyncio.current_task()
            if task is not None:
                info = place.match.join(place.seat, task)
                await _serve(place, info, context)
        except RefusalError as refusal:
            await context.abort_with_status(encode_refusal(refusal))

    def _place(self, join: Join) -> Place:
        if join.protocol_version != PROTOCOL_VERSION:
            raise RefusalError(
                grpc.StatusCode.FAILED_PRECONDITION,
                "PROTOCOL_VERSION",
                f"the client speaks protocol version {join.protocol_version}, the server {PROTOCOL_VERSION}",
            )
        place = self._places.get(join.token)
        if place is None:
            raise RefusalError(
                grpc.StatusCode.UNAUTHENTICATED, "SEAT_TOKEN_UNKNOWN", "no seat here has this token"
            )
        return place


async def _serve(place: Place, info: ServerMessage, context: Context) -> None:
    """Speak the protocol with a seat that has been taken."""
    match, seat = place
    try:
        await context.write(info)
        while True:
            message = await match.next_message(seat)
            await context.write(message)
            if message.HasField("match_over"):
                return
            answer = await _read_answer(seat, context)
            if answer is None:
                match.leave(seat, SeatStatus.CRASHED, STREAM_ENDED)
                return
            match.receive(seat, answer)
    except asyncio.CancelledError:
        if seat.refusal is None:  # the connection was lost
            raise
        raise seat.refusal from None
    except RefusalError as refusal:
        if refusal.reason == "PROTOCOL_ERROR":
            match.leave(seat, SeatStatus.PROTOCOL_ERROR, str(refusal))
        raise
    finally:
        # Whatever else ended the stream, cancellation by a lost connection included.
        match.leave(seat, SeatStatus.CRASHED, STREAM_ENDED)


async def _read_join(context: Context) -> Join:
    """Read the first message, which must be a Join."""
    try:
        async with asyncio.timeout(JOIN_TIME):
            message = await _read(context)
    except TimeoutError:
        raise _protocol_error(f"said nothing for {JOIN_TIME:g} s") from None
    if message is None or not message.HasField("join"):
        raise _protocol_error("the first message must be a Join")
    return message.join


async def _read_answer(seat: Seat, context: Context) -> Action | None:
    """Read the answer to a seat's last observation, dropping older ones; None at the end of its stream."""
    for _ in range(STALE_LIMIT):
        message = await _read(context)
        if message is None:
            return None
        if not message.HasField("action"):
            raise _protocol_error("after joining, every message must be an Action")
        if message.action.step == seat.asked:
            return message.action
        if message.action.step > seat.asked:
            raise _protocol_error(f"answered step {message.action.step} before it was asked")
        seat.conduct.dropped_actions += 1
    raise _protocol_error(f"sent {STALE_LIMIT} old answers in one step")


async def _read(context: Context) -> ClientMessage | None:
    try:
        message = await context.read()
    except DecodeError:
        raise _protocol_error("sent bytes that are no ClientMessage") from None
    return message if isinstance(message, ClientMessage) else None


def _protocol_error(message: str) -> RefusalError:
    return RefusalError(grpc.StatusCode.INVALID_ARGUMENT, "PROTOCOL_ERROR", message)
