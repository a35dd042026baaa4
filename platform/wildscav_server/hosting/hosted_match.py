"""One hosted match, from joining its seats to the final messages."""

import asyncio
import contextlib
import secrets
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import grpc

from wildscav.errors import WildscavError
from wildscav.proto.match_pb2 import Action, Join, MatchOver, ServerMessage
from wildscav.wire.errors import RefusalError
from wildscav.wire.matches import decode_sdk, encode_match_info, encode_seat_result
from wildscav_server.hosting.lockstep import LAG
from wildscav_server.hosting.observations import match_info
from wildscav_server.hosting.reports import MatchOutcome, SeatStatus
from wildscav_server.hosting.seat import Seat
from wildscav_server.hosting.thinking_clocks import lockstep_of, thinking_of
from wildscav_server.thinking import Spending
from wildscav_server.time_limits import Clock, SeatClock, WaitMeter

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

CLOSING_TIME = 1.0  # s that seats have to receive the match's last message


class MatchCancelledError(WildscavError):
    """The match was cancelled before it was over."""


class HostedMatch:
    """A match on a server, made with ``MatchServer.host``; if ``starting``, seats are not launched yet."""

    def __init__(
        self,
        match: "Match",
        names: Sequence[str],
        seats: Sequence[Seat],
        clock: Clock,
        seat_time: SeatClock,
        *,
        starting: bool = False,
    ) -> None:
        self.match = match
        self.id = secrets.token_hex(8)  # in logs
        self.names = tuple(names)
        self.seats = {seat.number: seat for seat in seats}  # of submissions
        self.clock = clock
        self._lockstep = lockstep_of(match.spec)(match, seats, clock, seat_time)
        self._launched = dict.fromkeys(() if starting else self.seats, time.perf_counter())  # when, s
        self._all_launched = asyncio.Event()
        if len(self._launched) == len(self.seats):
            self._all_launched.set()
        self._joined = asyncio.Event()  # every seat is ready or gone
        self.playing = False  # whether the wait for seats is over
        self._final_messages: dict[int, ServerMessage] = {}
        self.task = asyncio.create_task(self._run(), name="match")  # which plays it

    # The interface for the match's host.

    @property
    def tokens(self) -> dict[int, str]:
        """The secret token of every submission seat."""
        return {number: seat.token for number, seat in self.seats.items()}

    def measure(self, seat: int, meter: WaitMeter) -> None:
        """Credit a seat's bank from now on with its agent's waits for a processor."""
        self.seats[seat].meter = meter

    def charge_by(self, seat: int, spending: Spending) -> None:
        """Count from now on what a seat spends, and charge it where the clock is ``tokens``."""
        self.seats[seat].purse.count(spending)

    def launched(self, seat: int) -> None:
        """Note that a seat's agent has been started. Its start-up time begins now."""
        self._launched[seat] = time.perf_counter()
        if len(self._launched) == len(self.seats):
            self._all_launched.set()

    def give_up(self, seat: int, reason: str, status: SeatStatus = SeatStatus.CRASHED) -> None:
        """Play a seat with no action from now on, because its host knows that its agent has ended.

        Does nothing if the seat is gone already or the match is over.
        """
        given_up = self.seats[seat]
        if not given_up.gone and not self.match.over:
            self.leave(given_up, status, reason)
            given_up.dismiss(
                RefusalError(grpc.StatusCode.FAILED_PRECONDITION, "SEAT_CLOSED", f"given up: {reason}")
            )

    def cancel(self) -> None:
        """Cancel the match at once, without a result."""
        self.task.cancel()

    async def finished(self) -> MatchOutcome:
        """Wait until the match is over, or raise a MatchCancelledError if it was cancelled."""
        await asyncio.wait([self.task])
        if self.task.cancelled():
            raise MatchCancelledError("the match was cancelled")
        return self.task.result()

    # The interface for the seats' streams.

    def join(self, seat: Seat, stream: asyncio.Task[None], join: Join) -> None:
        """Take a seat for the task that serves its stream; a RefusalError if it is taken or closed."""
        if seat.gone:
            raise RefusalError(
                grpc.StatusCode.FAILED_PRECONDITION, "SEAT_CLOSED", f"seat {seat.number} is closed"
            )
        if seat.stream is not None:
            raise RefusalError(grpc.StatusCode.ALREADY_EXISTS, "SEAT_TAKEN", f"seat {seat.number} is taken")
        seat.stream, seat.gets_ready = stream, join.gets_ready
        seat.sdk = decode_sdk(join)
        if not join.gets_ready:
            self.ready(seat)

    def info_for(self, seat: Seat) -> ServerMessage:
        """Return the first message to a seat."""
        return encode_match_info(match_info(self.match, seat.number, self.clock))

    def ready(self, seat: Seat) -> None:
        """Note that a seat is ready."""
        now = time.perf_counter()
        # A quick agent may be ready before its host calls ``launched``.
        seat.ready, seat.start_up = True, now - self._launched.get(seat.number, now)
        self._check_joined()

    def fail(self, error: Exception) -> None:
        """End the match with an error, because the platform failed."""
        self._lockstep.fail(error)
        self._all_launched.set()
        self._joined.set()

    def next_observation(self, seat: Seat) -> bytes | None:
        """Return the next observation of a seat that owes no answer; None if it must wait for it."""
        return self._lockstep.observation_for(seat)

    def final_message(self, seat: Seat) -> ServerMessage | None:
        """Return the last message to a seat; None before the match is over."""
        return self._final_messages.get(seat.number)

    def receive(self, seat: Seat, message: Action) -> None:
        """Receive a seat's answer to its last observation."""
        self._lockstep.receive(seat, message)

    def leave(self, seat: Seat, status: SeatStatus, detail: str) -> None:
        """Play a seat with no action from now on. Does nothing if it is gone already or the match is over."""
        if seat.gone or self.match.over:
            return
        seat.gone = True
        seat.set_outcome(status, detail)
        self._check_joined()
        self._lockstep.stop_waiting_for(seat)

    # The match itself.

    async def _run(self) -> MatchOutcome:
        try:
            await self._wait_for_seats()
            return await self._play()
        except asyncio.CancelledError:
            self._dismiss_all(grpc.StatusCode.ABORTED, "MATCH_CANCELLED", "the match was cancelled")
            raise
        except Exception as error:
            self._dismiss_all(grpc.StatusCode.INTERNAL, "PLATFORM_FAILED", f"the platform failed: {error}")
            raise
        finally:
            self._lockstep.stop()

    def _dismiss_all(self, code: grpc.StatusCode, reason: str, message: str) -> None:
        for seat in self.seats.values():
            if seat.present:
                seat.dismiss(RefusalError(code, reason, message))

    async def _wait_for_seats(self) -> None:
        self._check_joined()
        # The time that the host takes to start all agents is not theirs. If it fails, it cancels the match.
        await self._all_launched.wait()
        loop = asyncio.get_running_loop()
        due = loop.time() + self.clock.join_timeout
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout_at(due):
                await self._joined.wait()
        if not self._joined.is_set() and loop.time() - due > LAG:
            # The server was busy, and a Join may be unread, so the seats get that time back.
            await asyncio.sleep(loop.time() - due)
        self.playing = True
        for seat in self.seats.values():
            if not seat.ready:
                self._close_late_seat(seat)

    def _close_late_seat(self, seat: Seat) -> None:
        """Close a seat whose time to start up is over."""
        missed = "join" if seat.stream is None else "get ready"
        reason = f"did not {missed} within {self.clock.join_timeout:g} s"
        self.leave(seat, SeatStatus.NEVER_JOINED, reason)
        seat.dismiss(RefusalError(grpc.StatusCode.FAILED_PRECONDITION, "SEAT_CLOSED", reason))

    def _check_joined(self) -> None:
        if all(seat.gone or seat.ready for seat in self.seats.values()):
            self._joined.set()

    async def _play(self) -> MatchOutcome:
        """Play all steps and send the final messages."""
        started = time.perf_counter()
        await self._lockstep.play()
        seconds = time.perf_counter() - started
        await self._send_final_messages()
        reports = {number: seat.report() for number, seat in self.seats.items()}
        self.match.thinking = thinking_of(self.match.spec, reports.values(), self._lockstep.charges)
        return MatchOutcome(self.match, reports, seconds)

    async def _send_final_messages(self) -> None:
        """Send the result to every seat that is still present, and wait until it is received."""
        # It may search for the shortest way to the target, while other matches play on.
        result = await asyncio.to_thread(self.match.result)
        for number, seat in self.seats.items():
            if seat.present:
                self._mark_finished(seat)
            conduct = seat.conduct_message()
            own = encode_seat_result(result.seats[number].model_dump(), self.names[number])
            over = MatchOver(result=own, steps=result.steps, frames=result.frames, conduct=conduct)
            self._final_messages[number] = ServerMessage(match_over=over)
            seat.notify()
        streams = {seat.stream for seat in self.seats.values() if seat.stream is not None and seat.present}
        if streams:
            _, unheard = await asyncio.wait(streams, timeout=CLOSING_TIME)
            for stream in unheard:
                stream.cancel()

    def _mark_finished(self, seat: Seat) -> None:
        own, steps = seat.conduct.steps_played, self.match.step_number
        if seat.bank.used_up:
            seat.set_outcome(
                SeatStatus.TIMED_OUT,
                f"its time bank was used up, and step {seat.first_late} was the first without its answer: "
                f"{own} of {steps} steps were played with an answer of its own",
            )
