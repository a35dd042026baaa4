"""A seat's bank is its own: in whatever order others stall, nobody loses a step while their own bank lasts.

The real lockstep plays, without streams: the seats take their observations and answer by a clock set by hand.
"""

import asyncio
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import pytest
from tests.platform.helpers.manual_clock import HOP, HandSetLoop
from tests.platform.helpers.seats import small_spec

from wildscav.proto.match_pb2 import Action
from wildscav_engine.simulation.match import Match
from wildscav_server.hosting.lockstep import Lockstep
from wildscav_server.hosting.seat import Seat
from wildscav_server.time_limits import Clock, SeatClock, TimeBank

STEPS, BUDGET, BANK = 4, 1 / 16, 1 / 4  # s; sums of powers of two, so that times are exact
CLOCK = Clock(step_budget=BUDGET, time_bank=BANK)
NEVER = 1000.0  # s beyond the budget
# How long beyond its budget a seat takes in each step: its bank in one, a part of it in each, or for ever.
WAYS = (
    *(tuple(BANK - HOP if step == at else 0.0 for step in range(STEPS)) for at in range(STEPS)),
    (BANK / STEPS - HOP,) * STEPS,
    *(tuple(NEVER if step >= at else -HOP for step in range(STEPS)) for at in (0, 2)),
)


class Waits:
    """A meter of waits for a processor that is told what it measured, s of each s since the start."""

    def __init__(self, clock: HandSetLoop, share: float) -> None:
        self._clock, self._share, self._since = clock, share, 0.0

    def start(self) -> None:
        self._since = self._clock.time()

    def waited(self) -> float:
        return self._share * (self._clock.time() - self._since)


def play(ways: Sequence[Sequence[float]], waits: Sequence[float] = ()) -> tuple[list[Seat], float]:
    """Play a match in which each seat takes its time in its way; return the seats and its length, s."""
    loop = HandSetLoop()

    async def run() -> tuple[list[Seat], float]:
        match = Match(small_spec(seats=len(ways), seconds=STEPS / 10))
        seats = [Seat(number, "", TimeBank(CLOCK), {}) for number in range(len(ways))]
        for seat in seats:
            seat.stream = asyncio.current_task()
        for seat, share in zip(seats, waits, strict=False):
            seat.meter = Waits(loop, share)
        lockstep = Lockstep(match, seats, CLOCK, SeatClock())
        playing, began = asyncio.create_task(lockstep.play()), loop.time()
        await asyncio.sleep(0)
        answers: dict[Seat, float] = {}  # when they are due
        while not playing.done():
            for seat, way in zip(seats, ways, strict=True):
                if lockstep.observation_for(seat) is not None:
                    answers[seat] = loop.time() + BUDGET + way[seat.asked]
                elif answers.get(seat, NEVER + loop.time()) <= loop.time():
                    del answers[seat]
                    lockstep.receive(seat, Action(step=seat.asked))
            await loop.pass_time(HOP)
        assert match.step_number == STEPS
        return seats, loop.time() - began

    with asyncio.Runner(loop_factory=lambda: loop) as runner:
        return runner.run(run())


def orders(seats: int) -> Iterator[tuple[tuple[float, ...], ...]]:
    """Yield all orders of stalling; of many seats, a sample."""
    if seats <= 3:
        yield from product(WAYS, repeat=seats)
        return
    dice = np.random.default_rng(1)
    for _ in range(40):
        yield tuple(WAYS[way] for way in dice.integers(0, len(WAYS), seats))
    yield tuple(WAYS[seat % STEPS] for seat in range(seats))  # all in turn


@pytest.mark.parametrize("seats", [2, 3, 10])
def test_nobody_loses_a_step_while_their_own_bank_lasts(seats: int) -> None:
    for ways in orders(seats):
        played, seconds = play(ways)

        for seat, way in zip(played, ways, strict=True):
            honest = NEVER not in way
            assert honest == (seat.conduct.late_steps == 0), (seat.number, ways)
            assert honest or seat.bank.used_up
        most = STEPS * BUDGET + seats * BANK
        assert seconds <= most + 2 * HOP * STEPS, ways  # the server notes a time up to two hops later


def test_waiting_for_a_processor_is_credited_to_the_own_bank_alone() -> None:
    # Both take longer than they have; one of them had no processor in three quarters of that time.
    late = (BANK + BUDGET - HOP, -HOP, -HOP, -HOP)

    (starved, slow), _ = play((late, late), waits=(0.75, 0.0))

    assert (starved.conduct.late_steps, slow.conduct.late_steps) == (0, 1)
    assert starved.report().credited == BUDGET  # no more in a step
    assert slow.report().credited == 0.0


def test_what_nobody_measures_is_not_credited() -> None:
    (one, other), _ = play((WAYS[0], WAYS[-1]))

    assert (one.report().credited, other.report().credited) == (None, None)


def test_an_agent_that_never_gets_a_processor_does_not_hold_the_match_up_for_ever() -> None:
    (starved, _), seconds = play((WAYS[5], WAYS[4]), waits=(1.0, 0.0))

    assert starved.bank.used_up
    assert (
        seconds <= STEPS * BUDGET + 3 * BANK + 2 * HOP * STEPS
    )  # two banks, and as much as one was credited
