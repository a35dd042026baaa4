"""The lockstep between the engine and the seats' streams.

A step opens with an observation to every seat that owes no answer. It closes as soon as every seat in the
match has answered, or when the time of all seats that have not is up; where the clock is paused, those seats
are closed. A seat that has not answered gets no further observation until it does; then it gets that of the
step that is open. So no messages pile up for a slow agent, and a stalled one blocks no buffer. What differs
by the clocks ``running`` and ``tokens`` is in ``thinking_clocks.py``.

The stream that receives the last answer closes the step: where the answer is read, the step is played, the
next one is opened, and the stream sends its observation, because another turn of the event loop would cost as
much as the step itself. The observations of all seats are encoded at that moment. Each other stream reads its
seat's sensors and sends its message in the next turn, one seat after another, so the first agents compute
while the others are served.
"""

import asyncio
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import ACTION_FIELDS
from wildscav.proto.match_pb2 import Action
from wildscav.wire.actions import decode_action
from wildscav.wire.observations import encode_observation
from wildscav_server.hosting.observations import SeatObservations
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.hosting.seat import Seat
from wildscav_server.time_limits import STANDING_STILL, Clock, SeatClock

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

LONGEST_TURN = 0.005  # s of playing without waiting, after which other matches get their turn
LAG = 0.01  # s that the loop may be late for a deadline before the seats get that time back
LEAST_CREDIT = 0.001  # s of waiting for a processor for which a step waits longer


class Lockstep:
    """Plays the steps of a match, which is at its start; the seats are those that agent processes fill."""

    def __init__(self, match: "Match", seats: Sequence[Seat], clock: Clock, time: SeatClock) -> None:
        self._match, self._seats, self._clock, self._time = match, seats, clock, time
        self._observations = SeatObservations(match, [seat.number for seat in seats])
        self._loop = asyncio.get_running_loop()
        columns = range(len(ACTION_FIELDS))
        self._outside = tuple(column for column in columns if column not in match.track.fields)
        self._done: asyncio.Future[None] = self._loop.create_future()  # done when no more seats are asked
        # The open step; times are by the seats' clock:
        self._opened = 0.0
        self._due = 0.0  # the next deadline
        self._lag_refunded = False  # whether the seats have got the server's own delay back
        self._timer: asyncio.TimerHandle | None = None
        self._step: int | None = None  # its number; None: no step is open
        self._rows: NDArray[np.float32] = np.zeros((match.seats, len(ACTION_FIELDS)), np.float32)
        self._pending: set[Seat] = set()  # the seats that have not answered yet
        self.charges: list[tuple[int, ...]] = []  # what seats were charged for thinking, as records have it

    async def play(self) -> None:
        """Play the match to its end."""
        for seat in self._seats:
            seat.purse.begin()
        if not self._done.done():
            self._open()
        await self._done
        for seat in self._seats:
            seat.purse.take()
        yielded = self._loop.time()
        while not self._match.over:
            self._match.step(np.zeros_like(self._rows))
            if self._loop.time() - yielded > LONGEST_TURN:
                await asyncio.sleep(0)
                yielded = self._loop.time()

    def fail(self, error: Exception) -> None:
        """End the match with an error."""
        self.stop()
        if not self._done.done():
            self._done.set_exception(error)

    def stop(self) -> None:
        """Play no more steps."""
        self._step = None
        self._pending.clear()
        self._disarm()

    # The interface for the seats' streams.

    def observation_for(self, seat: Seat) -> bytes | None:
        """Return the open step's message to a seat as bytes; None if the seat must wait for the next step."""
        if self._step is None or seat not in self._pending or seat.asked == self._step:
            return None
        if seat.bank.used_up and seat.sensor_time > self._clock.step_budget:
            return None  # it could not answer in time, and all others would wait for its sensors
        message = encode_observation(self._observations.of(seat.number), self._read_sensors(seat))
        now = self._time.now()
        seat.asked, seat.asked_at = self._step, now - seat.sensor_time
        seat.begin_waiting()
        if seat.notified:
            seat.notified, self._opened = False, now  # sending observations is not charged to other seats
        return message

    def _read_sensors(self, seat: Seat) -> dict[str, NDArray[Any]]:
        """Read a seat's sensors, which is charged to this seat and to no other."""
        if not seat.sensors:
            return {}
        began = self._loop.time()
        with self._time.standing_still():
            readings = seat.read_sensors(self._match)
        seat.sensor_time = self._loop.time() - began
        return readings

    def receive(self, seat: Seat, message: Action) -> None:
        """Receive a seat's answer to its last observation."""
        if self._step is None or seat not in self._pending or seat.asked != self._step:
            seat.conduct.dropped_actions += 1
            return
        now = self._time.now()
        self._refund_lag(now)
        self._pending.discard(seat)
        if self._charge(seat, now):
            self._accept(seat, message)
        else:
            self._miss(seat, now)
            seat.conduct.dropped_actions += 1
        self._settle()

    def _charge(self, seat: Seat, now: float) -> bool:
        """Charge a seat for the open step, and return whether it had enough time."""
        elapsed = now - self._asked_at(seat)
        seat.times.append(max(0.0, elapsed - seat.sensor_time) if seat.asked == self._step else elapsed)
        beyond = elapsed > self._clock.step_budget
        in_time = seat.bank.charge(elapsed, seat.waited() if beyond else 0.0)
        if beyond:
            seat.begin_waiting()  # no wait counts twice, even if the seat owes this answer in further steps
        return in_time

    def _miss(self, seat: Seat, now: float) -> None:
        """Count that the open step is played without a seat's answer; where the match waits, close it."""
        seat.conduct.late_steps += 1
        if seat.first_late is None:
            seat.first_late = self._step
        if self._match.spec.clock in STANDING_STILL:
            limit, bank = self._clock.answer_limit, self._clock.time_bank
            is_idle = now - self._asked_at(seat) >= limit - LAG
            reason = (
                f"gave no answer for {limit:g} s" if is_idle else f"its time bank of {bank:g} s was used up"
            )
            seat.close(SeatStatus.TIMED_OUT, reason)

    def _asked_at(self, seat: Seat) -> float:
        """Return when a seat's time for the open step began; the seat may still owe an older answer."""
        return seat.asked_at if seat.asked == self._step else self._opened

    def _accept(self, seat: Seat, message: Action) -> None:
        action = decode_action(message, self._outside)
        seat.conduct.steps_played += 1
        if action.row is None:
            seat.conduct.invalid_actions += 1
        else:
            seat.conduct.ignored_fields += action.ignored
            self._rows[seat.number] = action.row

    def stop_waiting_for(self, seat: Seat) -> None:
        """Stop waiting for a seat that has gone."""
        self._pending.discard(seat)
        if self._step is not None:
            self._settle()

    # One step.

    def _open(self) -> None:
        """Open the next step, or finish if the match is over or no seat is present."""
        present = [seat for seat in self._seats if seat.present]
        if self._match.over or not present:
            self._disarm()
            self._done.set_result(None)
            return
        self._step = self._match.step_number
        self._observations.encode(seat.bank.left for seat in self._seats)
        self._rows.fill(0.0)
        asked = self._asked(present)
        self._pending = set(asked)
        self._opened = self._time.now()
        for seat in asked:
            seat.notify()
        self._lag_refunded = False
        # No seat's time can be up before the budget is.
        self._arm(self._opened + self._clock.step_budget)

    def _asked(self, present: list[Seat]) -> list[Seat]:
        """Return who is asked in the step that opens, of the seats that are present."""
        return present

    def _settle(self) -> None:
        """Close the step if no other seat is pending, or none of them has time left."""
        if not self._pending:
            self._close()
        elif (now := self._time.now()) >= self._opened + self._clock.step_budget:
            self._close_or_wait(now)

    def _close_or_wait(self, now: float) -> None:
        """Close the step if the time of all pending seats is up; else wait for the one with the most time."""
        deadline = max((self._asked_at(seat) + seat.bank.allowed() for seat in self._pending), default=now)
        if now >= deadline:
            # Only now are the counters read that say how long each of them had no processor.
            least = now + LEAST_CREDIT
            ends = (self._asked_at(seat) + seat.bank.allowed(seat.waited()) for seat in self._pending)
            deadline = max((end for end in ends if end > least), default=now)
        if now < deadline:
            self._arm(deadline)
            return
        for seat in self._pending:
            self._charge(seat, now)
            seat.bank.use_up()
            self._miss(seat, now)
        self._close()

    def _close(self) -> None:
        """Play the open step, and open the next."""
        self._step = None
        self._pending.clear()
        try:
            self._match.step(self._rows)
            self._open()
        except Exception as error:  # noqa: BLE001 - the match failed, not the stream whose task runs this
            self.fail(error)

    # Its deadline.

    def _arm(self, when: float) -> None:
        """Set the deadline at which ``_time_is_up`` is called.

        A timer that is already set for an earlier time is kept; it sets itself again when it fires. Most
        steps end long before their deadline, and setting and cancelling a timer for each of them costs more
        than a few needless wake-ups per second.
        """
        self._due = when
        if self._timer is None or self._timer.when() > self._time.on_loop(when):
            self._set_timer()

    def _set_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = self._loop.call_at(self._time.on_loop(self._due), self._timer_fires)

    def _timer_fires(self) -> None:
        self._timer = None
        if self._step is None:
            return
        if self._time.now() < self._due:  # the deadline was moved, or the clock was stopped
            self._set_timer()
            return
        try:
            self._time_is_up()
        except Exception as error:  # noqa: BLE001 - otherwise the match would wait forever
            self.fail(error)

    def _disarm(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _time_is_up(self) -> None:
        now = self._time.now()
        self._refund_lag(now)
        self._close_or_wait(now)

    def _refund_lag(self, now: float) -> None:
        """Give the seats back, once per step, the time by which the server is late for the deadline.

        The server was busy, and answers may be unread. No seat gets more than the time since it was asked.
        """
        lag = now - self._due
        if lag > LAG and not self._lag_refunded:
            self._lag_refunded = True
            self._opened = min(now, self._opened + lag + LAG)
            for seat in self._pending:
                seat.asked_at = min(now, seat.asked_at + lag + LAG)
