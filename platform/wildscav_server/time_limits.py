"""The time limits of a match's seats.

A seat has a budget for each step, and a bank of its own for the whole match that pays for time beyond the
budgets. Once the bank is used up, an answer that does not arrive within the budget is late: the step is
played without it. What one seat spends never shortens another's bank. Seats may spend theirs in turn, so a
match lasts at most the time to join, the budgets of its steps and the banks of all seats. An organizer who
wants shorter matches sets the longest time, and every bank is made smaller alike.

A match whose spec has the clock ``paused`` or ``tokens`` stands still until all seats have answered. Its
banks are larger. A seat that gives no answer for the idle limit, or whose bank is used up, is closed, so that
it costs the others no more than that. By the clock ``running`` every step lasts equally long, and no seat has
a bank (see ``hosting/thinking_clocks.py``).

Time in which the machine had no processor for an agent, because of others' work, is credited: the bank does
not pay for it. No more than one budget is credited in a step, so that every match ends.
"""

import asyncio
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from wildscav_engine.specs.match_spec import MatchSpec

# s for everything that is not the agents' time: making the map, starting agents, the engine's own computing.
MARGIN = 3600.0
STANDING_STILL = ("paused", "tokens")  # the clocks of matches that wait for all answers


@dataclass(frozen=True, slots=True)
class Clock:
    """The limits, s."""

    step_budget: float = 0.1  # to answer an observation without spending the bank
    time_bank: float = 30.0  # for answers beyond the budget, per seat and match
    join_timeout: float = 30.0  # for all seats to join
    longest: float | None = None  # for all steps together; None: as long as budgets and banks allow
    idle_limit: float = 600.0  # for an answer where the clock is paused, before the seat is closed
    paused_bank: float = 3600.0  # the time bank where the clock is paused
    answer_limit: float = math.inf  # for one answer, whatever is left in the bank

    def __post_init__(self) -> None:
        for name in ("step_budget", "join_timeout", "idle_limit", "paused_bank"):
            if not getattr(self, name) > 0:
                raise ValueError(f"clock: {name} is {getattr(self, name)}, must be above 0")
        if not self.time_bank >= 0:
            raise ValueError(f"clock: time_bank is {self.time_bank}, must not be below 0")

    def fitted(self, spec: "MatchSpec") -> "Clock":
        """Return the clock of one match, whose banks are smaller if all would exceed the longest time.

        In a match that waits for answers, the idle limit is that of an answer; its banks are larger, or the
        budget of its spec. In one that goes on at its own pace, the budget is what a step lasts.

        Raises:
            ValueError: The budgets of its steps alone exceed the longest time.
        """
        clock = self
        if spec.clock in STANDING_STILL:
            budget, bank, limit = min(self.step_budget, self.idle_limit), self.paused_bank, self.idle_limit
            bank = bank if spec.thinking.budget is None else spec.thinking.budget
            clock = replace(self, step_budget=budget, time_bank=bank, answer_limit=limit)
        elif spec.clock == "running":
            clock = replace(self, step_budget=spec.step_time / spec.thinking.pace, time_bank=0.0)
        if clock.longest is None:
            return clock
        steps, budgets = spec.step_limit, spec.step_limit * clock.step_budget
        if not clock.longest >= budgets:
            raise ValueError(
                f"a match cannot end within {clock.longest:g} s: the budgets of its {steps:,} steps "
                f"alone are {budgets:,g} s"
            )
        bank = (clock.longest - budgets) / max(1, _seats(spec))
        return replace(clock, time_bank=min(clock.time_bank, bank))

    def bank(self) -> "TimeBank":
        """Return a seat's time bank."""
        return TimeBank(self)

    def bound(self, spec: "MatchSpec") -> float:
        """Return how long agents can make a match last, from their start, s."""
        fitted = self.fitted(spec)
        budgets = spec.step_limit * fitted.step_budget
        return fitted.join_timeout + budgets + fitted.time_bank * _seats(spec)

    def deadline(self, spec: "MatchSpec") -> float:
        """Return after how long a match hangs that has not ended, s, with all that may be credited."""
        return self.bound(spec) + spec.step_limit * self.fitted(spec).step_budget + MARGIN


def _seats(spec: "MatchSpec") -> int:
    """Return how many seats of a match have a bank."""
    from wildscav_engine.specs.match_spec import SUBMISSION

    return spec.seats.count(SUBMISSION)


class WaitMeter(Protocol):
    """Measures how long the machine had no processor for an agent, because of others' work."""

    def start(self) -> None:
        """Begin to measure from now on. It is called in every step, so it must be quick."""
        ...

    def waited(self) -> float:
        """Return for how long there was none since the start, s; a lower bound."""
        ...


class TimeBank:
    """The time bank of one seat."""

    __slots__ = ("_budget", "_most", "credited", "left", "used_up")

    def __init__(self, clock: Clock) -> None:
        self._budget = clock.step_budget
        self._most = clock.answer_limit - clock.step_budget  # s that it pays for one answer
        self.left = clock.time_bank  # s
        self.credited = 0.0  # s beyond budgets for which it did not pay
        self.used_up = False  # whether an answer has been late because the bank could not pay for it

    def allowed(self, waited: float = 0.0) -> float:
        """Return how long the next answer may take, s; for ``waited`` s of it the agent had no processor."""
        return self._budget + min(self.left, self._most) + min(waited, self._budget)

    def charge(self, elapsed: float, waited: float = 0.0) -> bool:
        """Pay for an answer of ``elapsed`` s, ``waited`` without a processor; return whether it was in time.

        A late answer empties the bank.
        """
        over = elapsed - self._budget
        if over <= 0.0:
            return True
        credit = min(over, waited, self._budget)
        self.credited += credit
        over -= credit
        if over > min(self.left, self._most):
            self.use_up()
            return False
        self.left -= over
        return True

    def use_up(self) -> None:
        """Empty it, because an answer is late."""
        self.left, self.used_up = 0.0, True


class SeatClock:
    """The clock of seats: the event loop's time minus what the server has spent on reading sensors.

    While a sensor is read, answers in all matches stay unread. So this clock stops for all seats, and the
    seat that asked for the sensor is charged separately.
    """

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._stopped = 0.0  # s that the clock has been stopped in all

    def now(self) -> float:
        """Return the time, s."""
        return self._loop.time() - self._stopped

    def on_loop(self, when: float) -> float:
        """Convert a time to the loop's clock, assuming that no sensor is read until then."""
        return when + self._stopped

    @contextmanager
    def standing_still(self) -> Iterator[None]:
        """Stop the clock during the block."""
        began = self._loop.time()
        try:
            yield
        finally:
            self._stopped += self._loop.time() - began
