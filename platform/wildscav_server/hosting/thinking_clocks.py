"""Matches in which thinking costs game time: their clock is ``running`` or ``tokens``.

While a seat thinks, its last action holds: it walks on. No press and no turn is repeated.
"""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav.proto.match_pb2 import Action
from wildscav_server.hosting.lockstep import LAG, Lockstep
from wildscav_server.hosting.reports import SeatReport
from wildscav_server.hosting.seat import Seat
from wildscav_server.time_limits import Clock, SeatClock

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match
    from wildscav_engine.specs.match_spec import MatchSpec
    from wildscav_engine.specs.thinking import Thinking


SHORTEST_STEP = 0.75  # of the time of a step, after one that the server ended late


class HoldingLockstep(Lockstep):
    """A lockstep that knows what holds of the last actions."""

    def __init__(self, match: "Match", seats: Sequence[Seat], clock: Clock, time: SeatClock) -> None:
        super().__init__(match, seats, clock, time)
        self._held: NDArray[np.float32] = np.zeros_like(self._rows)  # (A, FIELDS)

    def _open(self) -> None:
        from wildscav_engine.specs.thinking import held

        self._held = held(self._rows)
        super()._open()

    def stop_waiting_for(self, seat: Seat) -> None:
        """Stop waiting for a seat that has gone, which does nothing from now on."""
        self._rows[seat.number] = 0.0
        super().stop_waiting_for(seat)


class RunningLockstep(HoldingLockstep):
    """The world goes on at its own pace: every step lasts as long as the others, whoever answers.

    An answer is played in the step that is open when it arrives, and is never late. Its seat then gets the
    observation of that step, the newest there is. Of two answers in one step, the newer one is played.
    """

    def __init__(self, match: "Match", seats: Sequence[Seat], clock: Clock, time: SeatClock) -> None:
        super().__init__(match, seats, clock, time)
        self._answered: set[Seat] = set()  # in the open step
        self._began = 0.0  # when the first step opened, from which all ends count: no delay adds up

    def _open(self) -> None:
        super()._open()
        if self._step is None:
            return
        if self._step == 0:
            self._began = self._opened
        budget = self._clock.step_budget
        self._arm(max(self._began + (self._step + 1) * budget, self._opened + SHORTEST_STEP * budget))

    def _asked(self, present: list[Seat]) -> list[Seat]:
        self._answered.clear()
        for seat in present:
            self._rows[seat.number] = self._held[seat.number]
        return present

    def receive(self, seat: Seat, message: Action) -> None:
        """Receive a seat's answer to its last observation, of whichever step."""
        if self._step is None or seat not in self._pending:
            seat.conduct.dropped_actions += 1
            return
        seat.times.append(max(0.0, self._time.now() - seat.asked_at - seat.sensor_time))
        if seat in self._answered:
            seat.conduct.steps_played -= 1
            seat.conduct.dropped_actions += 1
        self._answered.add(seat)
        self._rows[seat.number] = 0.0
        self._accept(seat, message)

    def _settle(self) -> None:
        if not self._pending:  # all have left
            self._close()

    def _time_is_up(self) -> None:
        if self._time.now() - self._due > LAG and not self._lag_refunded:
            self._lag_refunded = True  # the server was busy, and answers may be unread
            self._arm(self._time.now() + LAG)
            return
        for seat in self._pending - self._answered:
            seat.held_steps += 1
        self._close()


class TokensLockstep(HoldingLockstep):
    """The match stands still while a seat thinks, and afterwards its thought costs it game time.

    Other seats play on meanwhile: they are asked in the steps in which the seat's last action holds.
    """

    def __init__(self, match: "Match", seats: Sequence[Seat], clock: Clock, time: SeatClock) -> None:
        from wildscav_engine.specs.thinking import Account

        super().__init__(match, seats, clock, time)
        price, frames = match.spec.thinking, match.spec.frames_per_action
        self._accounts = {seat.number: Account(price, frames) for seat in seats}
        # The answers that have not taken effect, and in how many further steps the last action holds.
        self._delayed: dict[Seat, tuple[NDArray[np.float32], int]] = {}

    def _open(self) -> None:
        super()._open()
        if self._step is not None and not self._pending:
            self._loop.call_soon(self._go_on, self._step)  # so that other matches get their turn

    def _go_on(self, step: int) -> None:
        if self._step == step and not self._pending:
            self._close()

    def _asked(self, present: list[Seat]) -> list[Seat]:
        thinking = [seat for seat in present if seat in self._delayed]
        for seat in thinking:
            answer, left = self._delayed.pop(seat)
            self._rows[seat.number] = self._held[seat.number] if left else answer
            if left:
                self._delayed[seat] = answer, left - 1
                seat.held_steps += 1
        return [seat for seat in present if seat not in thinking]

    def _accept(self, seat: Seat, message: Action) -> None:
        super()._accept(seat, message)
        tokens, processor = seat.purse.take()
        steps = self._accounts[seat.number].charge(tokens, processor)
        if tokens or processor:
            self.charges.append((seat.number, self._match.step_number, tokens, processor, steps))
        if steps:
            self._delayed[seat] = self._rows[seat.number].copy(), steps - 1
            self._rows[seat.number] = self._held[seat.number]
            seat.held_steps += 1


def lockstep_of(spec: "MatchSpec") -> type[Lockstep]:
    """Return what plays the steps of a match by its clock."""
    return {"running": RunningLockstep, "tokens": TokensLockstep}.get(spec.clock, Lockstep)


def thinking_of(
    spec: "MatchSpec", reports: Iterable[SeatReport], charges: Sequence[tuple[int, ...]]
) -> "Thinking | None":
    """Return how much the seats of a match thought, for its record; None if its clock is ``bank``."""
    from wildscav_engine.specs.thinking import CHARGE, SeatThinking, Thinking

    if spec.clock == "bank":
        return None
    seats = tuple(
        SeatThinking(
            seat=one.seat,
            decisions=one.steps_played,
            seconds=round(one.think_time.total, 6),
            tokens=one.tokens,
            held=one.held_steps,
        )
        for one in sorted(reports, key=lambda one: one.seat)
    )
    return Thinking(seats, np.array(charges, np.int64).reshape(-1, len(CHARGE)))
