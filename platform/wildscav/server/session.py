"""One hosted match: the lockstep between the engine and the seats' streams.

A step opens with an observation to every seat that listens. It closes as soon as every seat in the match has
answered, at the latest when the time of the last one is up. A seat that has not answered yet gets no further
observation until it does; then it gets the one of the step that is open. So nothing piles up at a slow agent,
and a stalled one holds up no buffer.
"""

import asyncio
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING

import grpc
import numpy as np
from numpy.typing import NDArray

from wildscav.errors import WildscavError
from wildscav.proto.match_pb2 import Action, MatchOver, ServerMessage
from wildscav.server.deadlines import Clock
from wildscav.server.reports import MatchOutcome, SeatStatus
from wildscav.server.seat import Seat
from wildscav.server.snapshot import match_info, take_snapshot
from wildscav.wire.actions import ACTION_FIELDS, decode_action
from wildscav.wire.errors import RefusalError
from wildscav.wire.matches import encode_conduct, encode_match_info, encode_seat_result
from wildscav.wire.observations import Snapshot, encode_observation

if TYPE_CHECKING:
    from wildscav_engine.match import Match

CLOSING_TIME = 1.0  # s that seats have to take the match's last message
BREATH = 0.005  # s of playing without waiting after which other matches get their turn
LAG = 0.01  # s that the loop may be late with a deadline before the seats are given that time back


class MatchCancelledError(WildscavError):
    """The match was cancelled before it was over."""


class HostedMatch:
    """A match on a server. Make one with ``MatchServer.host``.

    Args:
        match: At its start.
        names: Display name of every seat.
        seats: Those that agent processes fill.
        clock: The limits of their time.
    """

    def __init__(self, match: "Match", names: Sequence[str], seats: Sequence[Seat], clock: Clock) -> None:
        from wildscav_engine.rules import FRAME

        self.match = match
        self.names = tuple(names)
        self._seats = {seat.number: seat for seat in seats}
        self._clock = clock
        self._loop = asyncio.get_running_loop()
        self._frame_time = FRAME
        self._outside = tuple(
            column for column in range(len(ACTION_FIELDS)) if column not in match.track.fields
        )
        self._joined = asyncio.Event()  # nobody is waited for any more
        self._cut_time = float("inf")  # of the loop's clock, when the match is cut
        self._cut_at: int | None = None
        self._playing = False
        # The open step:
        self._snapshot: Snapshot | None = None  # None: no step is open
        self._rows: NDArray[np.float32] = np.zeros((match.seats, len(ACTION_FIELDS)), np.float32)
        self._pending: set[Seat] = set()  # who has not answered yet
        self._opened = 0.0  # of the loop's clock
        self._due = 0.0  # of the loop's clock, when to look at it again
        self._excused = False  # whether the server's own delay has been made good
        self._closed: asyncio.Future[None] = self._loop.create_future()
        self._timer: asyncio.TimerHandle | None = None
        self._goodbyes: dict[int, ServerMessage] = {}
        self._task = asyncio.create_task(self._run(), name="match")

    # What the host of the match sees.

    @property
    def tokens(self) -> dict[int, str]:
        """The secret token of every submission seat."""
        return {number: seat.token for number, seat in self._seats.items()}

    @property
    def seats(self) -> dict[int, Seat]:
        """The submission seats."""
        return self._seats

    @property
    def playing(self) -> bool:
        """Whether the wait for seats is over."""
        return self._playing

    @property
    def task(self) -> asyncio.Task[MatchOutcome]:
        """Plays the match."""
        return self._task

    def give_up(self, seat: int, reason: str) -> None:
        """Play a seat with no action from now on: its launcher knows that nobody is there any more.

        Does nothing if the seat is gone already or the match is over.
        """
        given_up = self._seats[seat]
        if not given_up.gone and not self.match.over:
            self.leave(given_up, SeatStatus.LEFT, reason)
            given_up.dismiss(
                RefusalError(grpc.StatusCode.FAILED_PRECONDITION, "SEAT_CLOSED", f"given up: {reason}")
            )

    def cancel(self) -> None:
        """End the match at once, without a result."""
        self._task.cancel()

    async def finished(self) -> MatchOutcome:
        """Wait until the match is over.

        Raises:
            MatchCancelledError: It was cancelled.
        """
        await asyncio.wait([self._task])
        if self._task.cancelled():
            raise MatchCancelledError("the match was cancelled")
        return self._task.result()

    # What the seats' streams do.

    def join(self, seat: Seat, stream: asyncio.Task[None]) -> ServerMessage:
        """Take a seat for a stream, and return the match info.

        Raises:
            RefusalError: The seat is not to be had.
        """
        if seat.gone:
            raise RefusalError(
                grpc.StatusCode.FAILED_PRECONDITION, "SEAT_CLOSED", f"seat {seat.number} is closed"
            )
        if seat.stream is not None:
            raise RefusalError(grpc.StatusCode.ALREADY_EXISTS, "SEAT_TAKEN", f"seat {seat.number} is taken")
        seat.stream = stream
        self._check_joined()
        return encode_match_info(match_info(self.match, seat.number, self._clock))

    async def next_message(self, seat: Seat) -> ServerMessage:
        """Wait for what a seat that owes no answer is to be sent next: an observation, or the end."""
        if seat.number in self._goodbyes:
            return self._goodbyes[seat.number]
        if self._snapshot is not None and seat in self._pending and seat.asked < self._snapshot.step:
            return self._observe(seat, self._snapshot)
        return await seat.message()

    def receive(self, seat: Seat, message: Action) -> None:
        """Take a seat's answer to its last observation."""
        if self._snapshot is None or seat not in self._pending or seat.asked != self._snapshot.step:
            seat.conduct.dropped_actions += 1
            return
        elapsed = self._loop.time() - self._opened
        self._pending.discard(seat)
        seat.times.append(elapsed)
        if seat.bank.charge(elapsed):
            self._accept(seat, message)
        else:
            seat.conduct.late_steps += 1
            seat.conduct.dropped_actions += 1
        self._settle()

    def _accept(self, seat: Seat, message: Action) -> None:
        action = decode_action(message, self._outside)
        seat.conduct.steps_played += 1
        if action.row is None:
            seat.conduct.invalid_actions += 1
        else:
            seat.conduct.ignored_fields += action.ignored
            self._rows[seat.number] = action.row

    def leave(self, seat: Seat, status: SeatStatus, detail: str) -> None:
        """Play a seat with no action from now on. Does nothing if it is gone already or the match is over."""
        if seat.gone or self.match.over:
            return
        seat.gone = True
        seat.mark(status, detail)
        self._pending.discard(seat)
        self._check_joined()
        if self._snapshot is not None:
            self._settle()

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
            self._disarm()

    def _dismiss_all(self, code: grpc.StatusCode, reason: str, message: str) -> None:
        for seat in self._seats.values():
            if seat.present:
                seat.dismiss(RefusalError(code, reason, message))

    async def _wait_for_seats(self) -> None:
        self._check_joined()
        timer = self._loop.call_later(self._clock.join_timeout, self._joined.set)
        await self._joined.wait()
        timer.cancel()
        self._playing = True
        for seat in self._seats.values():
            if seat.stream is None:
                self.leave(
                    seat, SeatStatus.NEVER_JOINED, f"did not join within {self._clock.join_timeout:g} s"
                )

    def _check_joined(self) -> None:
        if all(seat.gone or seat.stream is not None for seat in self._seats.values()):
            self._joined.set()

    async def _play(self) -> MatchOutcome:
        """Play all steps."""
        started = breathed = self._loop.time()
        self._cut_time = started + self._clock.game_time_factor * self.match.spec.time_limit
        while not self.match.over:
            self._rows = np.zeros_like(self._rows)
            if self._anybody():
                await self._collect()
            elif self._loop.time() - breathed > BREATH:
                await asyncio.sleep(0)
                breathed = self._loop.time()
            self.match.step(self._rows)
        seconds = self._loop.time() - started
        await self._say_goodbye()
        reports = {number: seat.report() for number, seat in self._seats.items()}
        return MatchOutcome(self.match, reports, self._cut_at, seconds)

    def _anybody(self) -> bool:
        """Whether there is a seat to be asked."""
        return self._cut_at is None and any(seat.present for seat in self._seats.values())

    async def _collect(self) -> None:
        """Open a step, wait for the answers, and close it."""
        self._snapshot = take_snapshot(self.match)
        self._closed = self._loop.create_future()
        self._pending = {seat for seat in self._seats.values() if seat.present}
        for seat in self._pending:
            if seat.waits:
                seat.hand_over(self._observe(seat, self._snapshot))
        self._opened = self._loop.time()
        self._excused = False
        # Until the budget is used up, nobody's time is.
        self._arm(self._opened + self._clock.step_budget)
        await self._closed
        self._disarm()
        self._snapshot = None
        if self._cut_at is None:
            self._charge_the_late()

    def _observe(self, seat: Seat, snapshot: Snapshot) -> ServerMessage:
        seat.asked = snapshot.step
        return encode_observation(
            snapshot,
            seat.number,
            seconds_per_frame=self._frame_time,
            time_bank=seat.bank.left,
            tensors=seat.sense(self.match),
        )

    def _arm(self, when: float) -> None:
        """Look at the clock again at a time of the loop's."""
        self._disarm()
        self._due = min(when, self._cut_time)
        self._timer = self._loop.call_at(self._due, self._time_is_up)

    def _disarm(self) -> None:
        if self._timer is not None:
            self._timer.cancel()

    def _time_is_up(self) -> None:
        lag = self._loop.time() - self._due
        if lag > LAG and not self._excused:
            # The server was busy, and answers may lie unread: the agents get that time back, once a step.
            self._excused = True
            self._opened += lag + LAG
        self._close_or_wait()

    def _settle(self) -> None:
        """After one seat less is waited for: close the step if nobody else has time left."""
        if not self._pending or self._loop.time() > self._opened + self._clock.step_budget:
            self._close_or_wait()

    def _close_or_wait(self) -> None:
        """Close the step if all have answered or their time is up; else wait for the one with most time."""
        now = self._loop.time()
        if now >= self._cut_time and self._pending and self._cut_at is None:
            self._cut_at = self.match.step_number
        longest = max((seat.bank.allowed for seat in self._pending), default=0.0)
        deadline = self._opened + longest
        if not self._pending or now >= min(deadline, self._cut_time):
            if not self._closed.done():
                self._closed.set_result(None)
        else:
            self._arm(deadline)

    def _charge_the_late(self) -> None:
        elapsed = self._loop.time() - self._opened
        for seat in self._pending:
            seat.bank.charge(elapsed)
            seat.times.append(elapsed)
            seat.conduct.late_steps += 1

    async def _say_goodbye(self) -> None:
        """Tell every seat that is still there how the match ended, and wait until it has heard."""
        result = self.match.result()
        for number, seat in self._seats.items():
            if seat.present:
                self._mark_finished(seat)
            conduct = encode_conduct(asdict(seat.conduct))
            own = encode_seat_result(result.seats[number].model_dump(), self.names[number])
            over = MatchOver(result=own, steps=result.steps, frames=result.frames, conduct=conduct)
            self._goodbyes[number] = ServerMessage(match_over=over)
            if seat.waits:
                seat.hand_over(self._goodbyes[number])
        streams = {seat.stream for seat in self._seats.values() if seat.stream is not None and seat.present}
        if streams:
            _, unheard = await asyncio.wait(streams, timeout=CLOSING_TIME)
            for stream in unheard:
                stream.cancel()

    def _mark_finished(self, seat: Seat) -> None:
        if seat.bank.used_up:
            late = seat.conduct.late_steps
            seat.mark(SeatStatus.TIMED_OUT, f"its time bank was used up; {late} steps were played without it")
        elif self._cut_at is not None:
            seat.mark(
                SeatStatus.FINISHED,
                f"the match ran out of wall time: no actions from step {self._cut_at} on",
            )
