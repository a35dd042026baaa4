"""The clock of a match: how long its seats may take.

A seat has a budget for each step, and a bank for the whole match that pays for time beyond the budget. Once
the bank is used up, an answer that is not there within the budget is late: the step is played without it.

What one seat may take never costs another its actions. But a match must end: in all, its steps wait no longer
than ``game_time_factor`` times its game time. So the budget and the bank are cut to what a match of that
length has room for, and when all seats together have used up its patience beyond the budgets, every further
step waits for its budget alone.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wildscav_engine.specs.match_spec import MatchSpec


@dataclass(frozen=True, slots=True)
class Clock:
    """The limits, s."""

    step_budget: float = 0.1  # to answer an observation, at no cost
    time_bank: float = 30.0  # for answers beyond the budget, a seat and match
    join_timeout: float = 30.0  # for all seats to join
    game_time_factor: float = 2.0  # of the game time limit: the longest that the steps may take in all

    def __post_init__(self) -> None:
        for name in ("step_budget", "join_timeout", "game_time_factor"):
            if not getattr(self, name) > 0:
                raise ValueError(f"clock: {name} is {getattr(self, name)}, must be above 0")
        if not self.time_bank >= 0:
            raise ValueError(f"clock: time_bank is {self.time_bank}, must not be below 0")

    def fitted(self, spec: "MatchSpec") -> "Clock":
        """Return the clock of one match: no budget and no bank beyond what the match has room for."""
        longest = self.game_time_factor * spec.time_limit
        budget = min(self.step_budget, longest / spec.step_limit)
        fitted = replace(self, step_budget=budget)
        return replace(fitted, time_bank=min(self.time_bank, fitted.patience(spec)))

    def patience(self, spec: "MatchSpec") -> float:
        """Return how long all steps of a match may wait beyond their budgets, s."""
        return max(0.0, self.game_time_factor * spec.time_limit - self.step_budget * spec.step_limit)


class TimeBank:
    """What is left of one seat's time."""

    __slots__ = ("_budget", "_used_up", "left")

    def __init__(self, clock: Clock) -> None:
        self._budget = clock.step_budget
        self.left = clock.time_bank  # s
        self._used_up = False

    @property
    def allowed(self) -> float:
        """How long the next answer may take, s."""
        return self._budget + self.left

    @property
    def used_up(self) -> bool:
        """Whether an answer has been late: the bank could not pay for it."""
        return self._used_up

    def charge(self, elapsed: float) -> bool:
        """Pay for an answer, and return whether it came in time. A late one takes all that is left.

        Args:
            elapsed: s from sending the observation to receiving the answer.
        """
        over = elapsed - self._budget
        if over <= 0.0:
            return True
        if over > self.left:
            self.left, self._used_up = 0.0, True
            return False
        self.left -= over
        return True
