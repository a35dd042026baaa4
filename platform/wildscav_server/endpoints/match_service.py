"""The Match service: one call of ``Play`` is one seat's stream.

Messages are passed as bytes, so that their size is checked before they are parsed.
"""

import asyncio
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import NamedTuple

import grpc
from google.protobuf.message import DecodeError

from wildscav.proto import PROTOCOL_VERSION
from wildscav.proto.match_pb2 import ClientMessage, Join
from wildscav.wire.errors import ProtocolRefusalError, RefusalError
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.hosting.seat import Seat
from wildscav_server.http2.stream import Stream, StreamLostError

PENDING_LIMIT = 256  # streams that have not joined, at one time
JOIN_TIMEOUT = 10.0  # s that a new stream has to send its Join
REFUSAL_DELAY = 0.2  # s before a Join is refused, which slows down repeated attempts
STREAM_ENDED = "its stream ended"
STALE_LIMIT = 16  # old answers that a seat may send in one step


class Reservation(NamedTuple):
    """The seat that a token stands for."""

    match: HostedMatch
    seat: Seat
    address: str | None = None  # the only address at which it can be joined; None: any


class MatchService:
    """Serves the seats of all matches of a server, which adds and removes reservations, at one address."""

    def __init__(
        self,
        reservations: Mapping[str, Reservation],
        on_refusal: Callable[[RefusalError], None],
        on_failure: Callable[[str, Exception], None],
        address: str,
    ) -> None:
        self._reservations, self._address = reservations, address
        self._on_refusal, self._on_failure = on_refusal, on_failure
        self._pending: dict[asyncio.Task[None], None] = {}  # in the order of their arrival
        self._evicted: set[asyncio.Task[None]] = set()

    @property
    def pending_streams(self) -> int:
        """How many streams have not joined a seat yet."""
        return len(self._pending)

    async def play(self, stream: Stream) -> None:
        """Serve one seat from joining to the end of its match."""
        try:
            reservation, join = await self._identify(stream)
            await _join_and_serve(reservation, stream, join)
        except RefusalError as refusal:
            self._on_refusal(refusal)
            raise
        except asyncio.CancelledError:
            if stream.refusal is not None:  # the client is gone, but the refusal is counted and logged
                self._on_refusal(stream.refusal)
            raise
        except StreamLostError:
            pass  # the client is gone
        except Exception as error:
            self._on_failure(self._address, error)
            raise _platform_failed() from error

    async def _identify(self, stream: Stream) -> tuple[Reservation, Join]:
        """Read which seat a new stream is for. Refusals are delayed."""
        with self._counted_as_pending(_this_task()):
            try:
                join = await _read_join(stream)
                return self._find_reservation(join), join
            except RefusalError:
                await asyncio.sleep(REFUSAL_DELAY)
                raise

    @contextmanager
    def _counted_as_pending(self, task: "asyncio.Task[None]") -> Iterator[None]:
        """Count the stream that a task serves as pending. Of too many, the oldest one is refused.

        Agents join at once, so the oldest streams are not those of agents.
        """
        if len(self._pending) >= PENDING_LIMIT:
            oldest = next(iter(self._pending))
            del self._pending[oldest]
            self._evicted.add(oldest)
            oldest.cancel()
        self._pending[task] = None
        try:
            yield
        except asyncio.CancelledError:
            if task not in self._evicted:  # its connection was lost
                raise
            raise RefusalError(
                grpc.StatusCode.RESOURCE_EXHAUSTED,
                "SERVER_BUSY",
                f"more than {PENDING_LIMIT} streams have not joined; send the Join sooner",
            ) from None
        finally:
            self._pending.pop(task, None)
            self._evicted.discard(task)

    def _find_reservation(self, join: Join) -> Reservation:
        if join.protocol_version != PROTOCOL_VERSION:
            raise RefusalError(
                grpc.StatusCode.FAILED_PRECONDITION,
                "PROTOCOL_VERSION",
                f"the client speaks protocol version {join.protocol_version}, the server {PROTOCOL_VERSION}",
            )
        reservation = self._reservations.get(join.token)
        if reservation is None:
            raise RefusalError(
                grpc.StatusCode.UNAUTHENTICATED, "SEAT_TOKEN_UNKNOWN", "no seat here has this token"
            )
        if reservation.address not in (None, self._address):
            raise RefusalError(
                grpc.StatusCode.PERMISSION_DENIED,
                "SEAT_ELSEWHERE",
                f"seat {reservation.seat.number} is not joined over this address: "
                "the token is another agent's",
            )
        return reservation


def _this_task() -> "asyncio.Task[None]":
    task = asyncio.current_task()
    if task is None:
        raise RuntimeError("a stream is served by a task")
    return task


def _platform_failed() -> RefusalError:
    return RefusalError(grpc.StatusCode.INTERNAL, "PLATFORM_FAILED", "the platform failed")


async def _join_and_serve(reservation: Reservation, stream: Stream, join: Join) -> None:
    """Take the seat for this stream, and serve it."""
    try:
        reservation.match.join(reservation.seat, _this_task(), join)
        stream.mark_authenticated()
    except RefusalError:
        raise
    except Exception as error:
        reservation.match.fail(error)
        raise _platform_failed() from error
    await _serve(reservation, stream)


async def _serve(reservation: Reservation, stream: Stream) -> None:
    """Serve a seat that has been taken, from the match info to the end of the match."""
    match, seat = reservation.match, reservation.seat
    try:
        await stream.write(match.info_for(seat).SerializeToString())
        if seat.gets_ready:
            await _read_ready(stream)
            match.ready(seat)
        exchange = _Exchange(match, seat, stream)
        while (rest := await exchange.play()) is not None:
            await stream.write(rest)
        await stream.write(exchange.final)
    except asyncio.CancelledError:
        refusal = seat.refusal or stream.refusal
        if refusal is None:  # the connection was lost
            raise
        if isinstance(refusal, ProtocolRefusalError):
            match.leave(seat, SeatStatus.PROTOCOL_ERROR, str(refusal))
        raise refusal from None
    except ProtocolRefusalError as refusal:
        match.leave(seat, SeatStatus.PROTOCOL_ERROR, str(refusal))
        raise
    except (RefusalError, StreamLostError):
        raise
    except Exception as error:
        match.fail(error)
        raise _platform_failed() from error
    finally:
        # Does nothing if the seat has left already; otherwise the connection was lost.
        match.leave(seat, SeatStatus.CRASHED, STREAM_ENDED)


async def _read_join(stream: Stream) -> Join:
    """Read the first message, which must be a Join."""
    try:
        async with asyncio.timeout(JOIN_TIMEOUT):
            message = await _read(stream)
    except TimeoutError:
        raise ProtocolRefusalError("JOIN_TIMEOUT", f"sent nothing for {JOIN_TIMEOUT:g} s") from None
    if not message.HasField("join"):
        raise ProtocolRefusalError("PROTOCOL_ERROR", "the first message must be a Join")
    return message.join


async def _read_ready(stream: Stream) -> None:
    if not (await _read(stream)).HasField("ready"):
        raise ProtocolRefusalError("PROTOCOL_ERROR", "after a Join with gets_ready, a Ready must follow")


class _Exchange:
    """The observations and answers of a seat that is ready.

    An answer is taken in the turn of the event loop in which it arrives, and the next observation is sent if
    it is there. The stream's task only waits meanwhile, since waking it would cost another turn.
    """

    def __init__(self, match: HostedMatch, seat: Seat, stream: Stream) -> None:
        self._match, self._seat, self._stream = match, seat, stream
        self._owes = False  # whether the seat has an observation that it has not answered
        self._stale = 0  # old answers since the last observation
        self._stopped: asyncio.Future[bytes | None]
        self.final = b""  # the last message, once the match is over

    async def play(self) -> bytes | None:
        """Play on; return a message that must wait for the client, or None if the match is over.

        Raises:
            RefusalError: The client has violated the protocol.
            StreamLostError: The client is gone.
        """
        self._stopped = asyncio.get_running_loop().create_future()
        with self._stream.calling(self._go_on):
            self._go_on()
            try:
                return await self._stopped
            finally:
                self._seat.wakes = None

    def _go_on(self) -> None:
        """Send and take what there is to send and to take."""
        try:
            while not self._stopped.done() and (self._take_answer() if self._owes else self._send()):
                pass
        except Exception as error:  # noqa: BLE001 - the task that serves the stream says what it means
            if not self._stopped.done():
                self._stopped.set_exception(error)

    def _send(self) -> bool:
        """Send the next observation, and return whether there was one that could be sent."""
        final = self._match.final_message(self._seat)
        if final is not None:
            self.final = final.SerializeToString()
            self._stopped.set_result(None)
            return False
        message = self._match.next_observation(self._seat)
        if message is None:
            self._seat.wakes = self._go_on
            return False
        self._owes, self._stale = True, 0
        if not self._stream.write_at_once(message):
            self._stopped.set_result(message)
        return True

    def _take_answer(self) -> bool:
        """Take the answer to the last observation, or drop an older one; return whether there was one."""
        content = self._stream.take()
        if content is None:
            return False
        message = _parsed(content)
        if not message.HasField("action"):
            raise ProtocolRefusalError("PROTOCOL_ERROR", "after joining, every message must be an Action")
        step, asked = message.action.step, self._seat.asked
        if step > asked:
            raise ProtocolRefusalError("TOO_EARLY", f"answered step {step} before it was asked")
        if step == asked:
            self._owes = False
            self._match.receive(self._seat, message.action)
            return True
        self._seat.conduct.dropped_actions += 1
        self._stale += 1
        if self._stale == STALE_LIMIT:
            raise ProtocolRefusalError("FLOOD", f"sent {STALE_LIMIT} old answers in one step")
        return True


async def _read(stream: Stream) -> ClientMessage:
    """Read a message."""
    return _parsed(await stream.read())


def _parsed(content: bytes) -> ClientMessage:
    try:
        return ClientMessage.FromString(content)
    except DecodeError:
        raise ProtocolRefusalError("PROTOCOL_ERROR", "sent bytes that are not a ClientMessage") from None
