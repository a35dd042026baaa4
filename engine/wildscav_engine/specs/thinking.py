"""What thinking costs in a match, by its clock, and what every seat has spent on it."""

from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.actions import Field as ActionField
from wildscav_engine.specs.base import Spec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND

# What agents' time is: a budget for each step and a bank; or the match stands still until all have answered;
# or it goes on at its own pace; or it stands still, and what they have spent on thinking passes afterwards.
ClockName = Literal["bank", "paused", "running", "tokens"]

NANO = 10**9  # ns per s
FRAME = NANO * NANO // FRAMES_PER_SECOND  # of game time, in billionths of a nanosecond
HELD = np.zeros(FIELDS, bool)  # (FIELDS,), whether a field of an action holds while its seat thinks
HELD[[ActionField.WALK_DIRECTION, ActionField.WALK_SPEED]] = True
CHARGE = ("seat", "step", "tokens", "processor", "steps")  # the columns of a record's charges


class ThinkingPrice(Spec):
    """The price of thinking; each clock has its own fields."""

    pace: Annotated[float, Field(ge=0.001, le=1000)] = 1.0  # running: game s per s
    token_time: Annotated[float, Field(ge=0, le=3600)] = 0.02  # tokens: s of game time per written token
    processor_time: Annotated[float, Field(ge=0, le=1000)] = 1.0  # tokens: game s per s of a processor
    # paused and tokens: s for all answers of a seat beyond the step budgets; None: the organizer's limit
    budget: Annotated[float, Field(ge=0, le=86_400)] | None = None

    def cost(self, tokens: int, processor: int) -> int:
        """Return the price of tokens and processor ns in billionths of a nanosecond of game time, exactly.

        Both rates are rounded to nanoseconds, so that this is a sum of whole numbers.
        """
        return tokens * round(self.token_time * NANO) * NANO + processor * round(self.processor_time * NANO)


USED: dict[str, tuple[str, ...]] = {
    "bank": (),
    "paused": ("budget",),
    "running": ("pace",),
    "tokens": ("token_time", "processor_time", "budget"),
}


def check_price(clock: ClockName, thinking: ThinkingPrice) -> None:
    """Refuse a price that has no meaning by a clock."""
    for name, field in ThinkingPrice.model_fields.items():
        if getattr(thinking, name) != field.default and name not in USED[clock]:
            raise ValueError(f"thinking.{name} is given, but the clock {clock} does not use it")


class ClockChoice(Spec):
    """A clock, and what thinking costs by it."""

    clock: ClockName = "bank"
    thinking: ThinkingPrice = ThinkingPrice()

    @model_validator(mode="after")
    def _price_is_of_the_clock(self) -> Self:
        check_price(self.clock, self.thinking)
        return self

    def __str__(self) -> str:
        """Return the clock with its price in a few words."""
        price = self.thinking
        words = {
            "pace": f"{price.pace:g} game s per s",
            "token_time": f"{price.token_time:g} s per token",
            "processor_time": f"{price.processor_time:g} s per processor s",
            "budget": "" if price.budget is None else f"budget {price.budget:g} s",
        }
        told = [words[name] for name in USED[self.clock] if words[name]]
        return f"{self.clock} ({', '.join(told)})" if told else self.clock


class Account:
    """What one seat owes of its thinking that has not made a whole step yet."""

    def __init__(self, price: ThinkingPrice, frames_per_action: int) -> None:
        self._price, self._step = price, frames_per_action * FRAME
        self._owed = 0  # billionths of a nanosecond of game time, less than a step

    def charge(self, tokens: int, processor: int) -> int:
        """Return how many whole steps pass for a thought of tokens and ns; the rest is owed on."""
        steps, self._owed = divmod(self._owed + self._price.cost(tokens, processor), self._step)
        return steps


def held(actions: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return what holds of actions while their seats think: walking. No press and no turn is repeated."""
    return np.where(HELD, actions, np.float32(0.0))


class SeatThinking(Spec):
    """How much one seat thought."""

    seat: Annotated[int, Field(ge=0)]
    decisions: Annotated[int, Field(ge=0)]  # answers of its own
    seconds: Annotated[float, Field(ge=0)]  # from sending observations to receiving their answers
    tokens: Annotated[int, Field(ge=0)] = 0  # that its model wrote
    held: Annotated[int, Field(ge=0)] = 0  # steps in which its last action held, because it thought


class Thinking(NamedTuple):
    """How much the seats of a match thought, and what they were charged for it."""

    seats: tuple[SeatThinking, ...]
    charges: NDArray[np.int64]  # (C, CHARGE), in the order in which they were made; processor in ns
