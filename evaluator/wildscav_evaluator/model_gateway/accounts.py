"""What each seat has spent, in memory that the gateway shares with the match that it serves.

The gateway writes the counts before it passes on an answer, so whoever reads them after the seat's next
action sees all that this action cost.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from wildscav.harness.spending import price
from wildscav_evaluator.model_gateway.settings import ModelSettings

PROMPT, ANSWER, REQUESTS, NANOSECONDS, OVER = range(5)
COUNTS = 5
NANOSECOND = 1e-9  # s


class Accounts:
    """The accounts of some seats, in the file that ``Accounts.make`` made, which two processes map."""

    def __init__(self, path: Path, seats: Sequence[int]) -> None:
        self._rows = {seat: row for row, seat in enumerate(seats)}
        self._counts = np.memmap(path, np.int64, "r+", shape=(len(seats), COUNTS))

    @classmethod
    def make(cls, path: Path, seats: Sequence[int]) -> "Accounts":
        """Make the file, with all counts at 0."""
        path.write_bytes(bytes(len(seats) * COUNTS * 8))
        return cls(path, seats)

    def tokens(self, seat: int) -> int:
        """Return the tokens of a seat's prompts and answers so far."""
        return self._read(seat, PROMPT) + self._read(seat, ANSWER)

    def written(self, seat: int) -> int:
        """Return the tokens of the answers to a seat so far."""
        return self._read(seat, ANSWER)

    def is_over(self, seat: int) -> bool:
        """Return whether a seat's budget has refused a request."""
        return bool(self._read(seat, OVER))

    def charge(self, seat: int, prompt: int, answer: int, seconds: float) -> None:
        """Charge a seat for a request: its tokens, and the time that the model's server took for it, s."""
        row = self._counts[self._rows[seat]]
        row[PROMPT] += prompt
        row[ANSWER] += answer
        row[NANOSECONDS] += round(seconds / NANOSECOND)

    def begin(self, seat: int) -> None:
        """Count a request."""
        self._counts[self._rows[seat], REQUESTS] += 1

    def close(self, seat: int) -> None:
        """Note that a seat's budget has refused a request."""
        self._counts[self._rows[seat], OVER] = 1

    def spent(self, seat: int, settings: ModelSettings, prompt: int) -> str:
        """Return why a seat may not send a prompt of so many tokens; "" if its budget allows it."""
        tokens, seconds = self.tokens(seat), self._read(seat, NANOSECONDS) * NANOSECOND
        if self._read(seat, REQUESTS) >= settings.requests:
            return f"its {settings.requests:,} requests to the model are used up"
        if tokens + prompt >= settings.tokens:
            return f"its next prompt exceeds its budget: {tokens:,} of {settings.tokens:,} tokens are used up"
        if seconds >= settings.seconds:
            return f"its {settings.seconds:g} s of the model's time are used up"
        if settings.money is not None and self._cost(seat, settings, prompt) >= settings.money:
            return f"its {settings.money:g} of money for the model are used up"
        return ""

    def most_answer(self, seat: int, settings: ModelSettings, prompt: int, asked: int | None) -> int:
        """Return how many tokens the next answer may have at most."""
        left = settings.tokens - self.tokens(seat) - prompt
        return max(1, min(settings.max_tokens, left, asked or settings.max_tokens))

    def _cost(self, seat: int, settings: ModelSettings, prompt: int) -> float:
        prompt += self._read(seat, PROMPT)
        return price(prompt, self._read(seat, ANSWER), settings.prompt_price, settings.answer_price)

    def _read(self, seat: int, count: int) -> int:
        return int(self._counts[self._rows[seat], count])
