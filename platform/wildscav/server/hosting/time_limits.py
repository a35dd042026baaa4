"""The time limits of a match's seats.

A seat has a budget for each step, and a bank for the whole match that pays for time beyond the budgets. Once
the bank is used up, an answer that does not arrive within the budget is late: the step is played without it.

One seat's time never costs another seat its actions. But a match must end: its steps wait no longer in all
than ``game_time_factor`` times its game time. So budget and bank are reduced to what fits into a match of
that length. When all seats together have used up the match's patience, the time that its steps may wait
beyond their budgets, every further step waits for its budget only.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wildscav_engine.specs.match_spec import MatchSpec


@dataclass(frozen=True, slots=True)
class Clock:
    """The limits, s."""

    step_budget: float = 0.1  # to answer an observation without spending the bank
    time_bank: float = 30.0  # for answers beyond the budget, per seat and match
    join_timeout: float = 30.0  # for all seats to join
    game_time_factor: float = 2.0  # limit of the time for all steps, as a multiple of the game time limit

    def __post_init__(self) -> None:
        for name in ("step_budget", "join_timeout", "game_time_factor"):
            if not getattr(self, name) > 0:
                raise ValueError(f"clock: {name} is {getattr(self, name)}, must be above 0")
        if not self.time_bank >= 0:
            raise ValueError(f"clock: time_bank is {self.time_bank}, must not be below 0")

    def fitted(self, spec: "MatchSpec") -> "Clock":
        """Return the clock of one match, with budget and bank reduced to what fits into its length."""
        longest = self.game_time_factor * spec.time_limit
        budget = min(self.step_budget, longest / spec.step_limit)
        fitted = replace(self, step_budget=budget)
        return replace(fitted, time_bank=min(self.time_bank, fitted.patience(spec)))

    def patience(self, spec: "MatchSpec") -> float:
        """Return how long all steps of a match may wait beyond their budgets, s."""
        return max(0.0, self.game_time_factor * spec.time_limit - self.step_budget * spec.step_limit)


class TimeBank:
    """The time bank of one seat."""

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
        """Whether an answer has been late because the bank could not pay for it."""
        return self._used_up

    def charge(self, elapsed: float) -> bool:
        """Pay for an answer, and return whether it was in time. A late answer empties the bank.

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
