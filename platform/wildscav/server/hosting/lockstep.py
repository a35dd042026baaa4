"""The lockstep between the engine and the seats' streams.

A step opens with an observation to every seat that listens. It closes as soon as every seat in the match has
answered, at the latest when the time of the last one is up. A seat that has not answered yet gets no further
observation until it does; then it gets the one of the step that is open. So nothing piles up at a slow agent,
and a stalled one holds up no buffer.

Whoever brings the last answer closes the step: it is played and the next one opened right there, in that
stream's task, because each turn of the event loop in between costs as much as the step itself. What all seats
sense is taken at that moment; it is sent by their own streams, one after the other, and sensors are read only
then, so that the first agents think while the others are served.
"""

import asyncio
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav.proto.match_pb2 import Action
from wildscav.server.hosting.observations import SeatObservations
from wildscav.server.hosting.reports import SlowAnswer
from wildscav.server.hosting.seat import Seat
from wildscav.server.hosting.seat_clock import SeatClock
from wildscav.server.hosting.time_limits import Clock
from wildscav.wire.actions import ACTION_FIELDS, decode_action
from wildscav.wire.observations import encode_observation

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

LONGEST_TURN = 0.005  # s of playing without waiting after which other matches get their turn
LAG = 0.01  # s that the loop may be late with a deadline before the seats are given that time back


class Lockstep:
    """Plays the steps of a match.

    Args:
        match: At its start.
        seats: Those that agent processes fill.
        clock: The limits of their time.
        time: What it is measured by.
    """

    def __init__(self, match: "Match", seats: Sequence[Seat], clock: Clock, time: SeatClock) -> None:
        self._match, self._seats, self._clock, self._time = match, seats, clock, time
        self._observations = SeatObservations(match, [seat.number for seat in seats])
        self._loop = asyncio.get_running_loop()
        columns = range(len(ACTION_FIELDS))
        self._outside = tuple(column for column in columns if column not in match.track.fields)
        self._done: asyncio.Future[None] = self._loop.create_future()  # nobody is asked any more
        self._patience = clock.patience(match.spec)  # s that steps may still wait beyond their budgets
        # The open step; times are those of seats:
        self._opened = 0.0
        self._due = 0.0  # when to look at the clock again
        self._lag_refunded = False  # whether the server's own delay has been made good
        self._timer: asyncio.TimerHandle | None = None
        self._step: int | None = None  # its number; None: no step is open
        self._rows: NDArray[np.float32] = np.zeros((match.seats, len(ACTION_FIELDS)), np.float32)
        self._pending: set[Seat] = set()  # who has not answered yet

    async def play(self) -> None:
        """Play the match to its end."""
        if not self._done.done():
            self._open()
        await self._done
        for seat in self._seats:
            self._note_slow_answer(seat)  # what is still owed took until now at least
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

    # What the seats' streams do.

    def observation_for(self, seat: Seat) -> bytes | None:
        """Return the bytes of the open step's message to a seat that has not had it; None: it must wait."""
        if self._step is None or seat not in self._pending or seat.asked == self._step:
            return None
        if seat.bank.used_up and seat.sensor_time > self._clock.step_budget:
            return None  # it cannot answer in time any more, and all others would wait for its sensors
        message = encode_observation(self._observations.of(seat.number), self._read_sensors(seat))
        now = self._time.now()
        seat.asked, seat.asked_at = self._step, now - seat.sensor_time
        seat.answering_since = self._loop.time()
        if seat.notified:
            seat.notified, self._opened = False, now  # nobody pays for what others' observations take
        return message

    def _read_sensors(self, seat: Seat) -> dict[str, NDArray[Any]]:
        """Read a seat's sensors: what that takes is the seat's own time, and nobody else's."""
        if not seat.sensors:
            return {}
        began = self._loop.time()
        with self._time.standing_still():
            readings = seat.read_sensors(self._match)
        seat.sensor_time = self._loop.time() - began
        return readings

    def receive(self, seat: Seat, message: Action) -> None:
        """Take a seat's answer to its last observation."""
        self._note_slow_answer(seat)
        if self._step is None or seat not in self._pending or seat.asked != self._step:
            seat.conduct.dropped_actions += 1
            return
        now = self._time.now()
        self._refund_lag(now)
        self._pending.discard(seat)
        if self._charge(seat, now):
            self._accept(seat, message)
        else:
            self._count_late(seat)
            seat.conduct.dropped_actions += 1
        self._settle()

    def _charge(self, seat: Seat, now: float) -> bool:
        """Charge a seat for the open step, and return whether it had the time."""
        elapsed = now - self._asked_at(seat)
        seat.times.append(max(0.0, elapsed - seat.sensor_time) if seat.asked == self._step else elapsed)
        return seat.bank.charge(elapsed)

    def _count_late(self, seat: Seat) -> None:
        """Count that the open step is played without a seat's answer."""
        seat.conduct.late_steps += 1
        if self._step is not None:
            seat.late.append(self._step)

    def _note_slow_answer(self, seat: Seat) -> None:
        """Note how long a seat has taken for the answer that it owed, if that was longer than its budget."""
        since, now = seat.answering_since, self._loop.time()
        if since is not None and now - since > self._clock.step_budget:
            seat.slow_answers.append(SlowAnswer(seat.asked, since, now))
        seat.answering_since = None

    def _asked_at(self, seat: Seat) -> float:
        """Return from when a seat's time for the open step counts: it may still owe an older answer."""
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
        """Wait for a seat no longer: it has gone."""
        self._note_slow_answer(seat)
        self._pending.discard(seat)
        if self._step is not None:
            self._settle()

    # One step.

    def _open(self) -> None:
        """Ask everyone for the next step, if there is one and anyone to be asked."""
        present = [seat for seat in self._seats if seat.present]
        if self._match.over or not present:
            self._disarm()
            self._done.set_result(None)
            return
        self._step = self._match.step_number
        self._observations.encode(seat.bank.left for seat in self._seats)
        self._rows.fill(0.0)
        self._pending = set(present)
        self._opened = self._time.now()
        for seat in present:
            seat.notify()
        self._lag_refunded = False
        # Until the budget is used up, nobody's time is.
        self._arm(self._opened + self._clock.step_budget)

    def _settle(self) -> None:
        """After one seat less is waited for: close the step if nobody else has time left."""
        now = self._time.now()
        if not self._pending:
            self._close(now)
        elif now > self._opened + self._clock.step_budget:
            self._close_or_wait(now)

    def _close_or_wait(self, now: float) -> None:
        """Close the step if the time of all is up; else wait for the one with most of it."""
        free = self._opened + self._clock.step_budget
        asked = max((self._asked_at(seat) + seat.bank.allowed for seat in self._pending), default=now)
        deadline = min(asked, free + self._patience)
        if now < deadline:
            self._arm(deadline)
            return
        for seat in self._pending:
            self._charge(seat, now)
            self._count_late(seat)
        self._close(now)

    def _close(self, now: float) -> None:
        """Play the step that is open, and open the next."""
        over = now - self._opened - self._clock.step_budget
        if over > 0.0:
            self._patience = max(0.0, self._patience - over)
        self._step = None
        self._pending.clear()
        try:
            self._match.step(self._rows)
            self._open()
        except Exception as error:  # noqa: BLE001 - it is not the fault of the stream that runs this
            self.fail(error)

    # Its time.

    def _arm(self, when: float) -> None:
        """Look at the clock again at some time.

        A timer that comes too early sets itself anew: most steps are over long before their time, and to set
        and cancel one for each costs more than to be woken for nothing ten times a second.
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
        if self._time.now() < self._due:  # it was moved, or the clock has stood still
            self._set_timer()
            return
        try:
            self._time_is_up()
        except Exception as error:  # noqa: BLE001 - nobody else would hear of it, and wait for ever
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
        """Give the agents back, once a step, what the server is late with looking at the clock.

        It was busy then, and answers may lie unread. Nobody gets more than has passed since it was asked.
        """
        lag = now - self._due
        if lag > LAG and not self._lag_refunded:
            self._lag_refunded = True
            self._opened = min(now, self._opened + lag + LAG)
            for seat in self._pending:
                seat.asked_at = min(now, seat.asked_at + lag + LAG)
