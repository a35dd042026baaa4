"""A hostile client, move by move."""

import asyncio
import contextlib
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import grpc
from hypothesis import strategies as some
from tests.platform.helpers.seats import HandPlayed, connected

from wildscav.proto.match_pb2 import Action, ClientMessage, Join, Ready
from wildscav.wire.errors import reason_of

REASONS = frozenset(
    {
        *("PROTOCOL_VERSION", "SEAT_TOKEN_UNKNOWN", "SEAT_ELSEWHERE", "SEAT_TAKEN"),
        *("SEAT_CLOSED", "SERVER_BUSY"),
        *("JOIN_TIMEOUT", "PROTOCOL_ERROR", "MESSAGE_TOO_LARGE", "TOO_EARLY", "FLOOD", "MATCH_CANCELLED"),
    }
)
PATIENCE = 0.15  # s that an attacker waits for an answer
END = 60.0  # s in which any stream must end: the server takes one, but the machine may have much else to do
NUMBERS = some.sampled_from([0.0, 5.0, 10.1, -1.0, math.nan, math.inf, -math.inf, 1e38, -1e38])


class Move(NamedTuple):
    """Something that a hostile client does."""

    kind: str
    what: Any = None


MOVES = some.one_of(
    some.sampled_from(["own", "unknown", "other", ""]).map(lambda token: Move("join", token)),
    some.sampled_from([0, 2, 2**32 - 1]).map(lambda version: Move("version", version)),
    some.tuples(some.integers(-4, 4), NUMBERS, NUMBERS, NUMBERS).map(lambda what: Move("act", what)),
    some.binary(max_size=40).map(lambda content: Move("bytes", content)),
    some.sampled_from([4_096, 4_097, 100_000, 262_144, 262_145]).map(lambda size: Move("large", size)),
    some.integers(2, 40).map(lambda count: Move("repeat", count)),
    some.sampled_from(["get ready", "ready", "empty", "read", "twice", "half", "cancel", "pause"]).map(Move),
)
# Most begin as an agent does, or the rest would never be reached.
ATTACKS = some.tuples(some.booleans(), some.lists(MOVES, max_size=8)).map(
    lambda drawn: [Move("join", "own"), Move("read"), Move("read"), *drawn[1]] if drawn[0] else drawn[1]
)


class Attacker:
    """One client at one seat.

    Args:
        seat: Its stream.
        tokens: Its own and that of another seat.
        address: The server's.
    """

    def __init__(self, seat: HandPlayed, tokens: Mapping[int, str], address: str) -> None:
        self._seat, self._tokens, self._address = seat, tokens, address
        self._ears = Listener(seat)
        self._asked = 0  # step of the last observation
        self._last = ClientMessage()

    async def make(self, moves: Sequence[Move]) -> str:
        """Make moves until the stream ends; return how it ended: a reason, or nothing if without one."""
        try:
            with contextlib.suppress(asyncio.InvalidStateError):  # it wrote to a stream that had ended
                for move in moves:
                    await self._make(move)
                await self._seat.call.done_writing()
            async with asyncio.timeout(END):
                await self._ears.hear_out()
        except grpc.aio.AioRpcError as error:
            return reason_of(error) or untyped(error)
        except asyncio.CancelledError:
            if not self._seat.call.cancelled():
                raise
        return ""

    async def _make(self, move: Move) -> None:  # noqa: C901 - a row a move
        match move.kind:
            case "join":
                tokens = {"own": self._tokens[0], "other": self._tokens[1]}
                await self._send(join(tokens.get(move.what, move.what)))
            case "get ready":
                await self._send(join(self._tokens[0], gets_ready=True))
            case "version":
                await self._send(join(self._tokens[0], protocol_version=move.what))
            case "act":
                ahead, direction, speed, turn = move.what
                step = max(0, self._asked + ahead)
                action = Action(step=step, walk_direction=direction, walk_speed=speed, turn=turn)
                await self._send(ClientMessage(action=action))
            case "ready":
                await self._send(ClientMessage(ready=Ready()))
            case "empty":
                await self._send(ClientMessage())
            case "repeat":
                for _ in range(move.what):
                    await self._send(self._last)
            case "bytes":
                await self._seat.send(move.what)
            case "large":
                await self._seat.send(bytes(move.what))
            case "read":
                await self._read()
            case "twice":
                await self._join_again()
            case "half":
                await self._seat.call.done_writing()
            case "cancel":
                self._seat.call.cancel()
            case "pause":
                await asyncio.sleep(0.03)

    async def _send(self, message: ClientMessage) -> None:
        self._last = message
        await self._seat.send(message)

    async def _read(self) -> None:
        message = await self._ears.hear()
        if message is not None and message.HasField("observation"):
            self._asked = message.observation.step

    async def _join_again(self) -> None:
        async with connected(self._address) as thief:
            await thief.send(join(self._tokens[0]))
            await Listener(thief).hear()


def join(token: str, **fields: Any) -> ClientMessage:
    return ClientMessage(join=Join(**{"token": token, "protocol_version": 1, **fields}))


class Listener:
    """Reads a stream, one message at a time and no longer than it has patience for.

    A read that is given up goes on by itself: to cancel it would end the stream, and gRPC answers a second
    one beside it with the end of a stream whose status then never comes.
    """

    def __init__(self, seat: HandPlayed) -> None:
        self._seat = seat
        self._reading: asyncio.Future[Any] | None = None  # the read that was given up

    async def hear(self) -> Any:
        """Return the next message, None if none comes soon or ever."""
        reading = self._reading or asyncio.ensure_future(self._seat.call.read())
        reading.add_done_callback(lambda done: done.cancelled() or done.exception())
        done, _ = await asyncio.wait([reading], timeout=PATIENCE)
        self._reading = None if done else reading
        if not done or reading.cancelled() or reading.exception() or reading.result() is grpc.aio.EOF:
            return None
        return reading.result()

    async def hear_out(self) -> None:
        """Read to the end of the stream."""
        if self._reading is None or await self._reading is not grpc.aio.EOF:
            await self._seat.read_out()


def untyped(error: grpc.aio.AioRpcError) -> str:
    """Return what to call a status without a reason: gRPC's own of what is too large, or a surprise."""
    details = error.details() or ""
    if error.code() == grpc.StatusCode.RESOURCE_EXHAUSTED and "larger than max" in details:
        return "too large for gRPC"
    if details == "Internal error from Core":  # the client's own: it wrote to an ended stream
        return ""
    return f"{error.code().name}: {details}"
