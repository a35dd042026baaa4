"""What a model has spent in a match, and how its play ends."""

from dataclasses import dataclass
from enum import StrEnum

from wildscav.harness.settings import ModelSettings

MILLION = 1e6  # tokens, of which a price is given


class Ending(StrEnum):
    """Why a model plays no more."""

    MATCH_OVER = "match_over"  # the match is over
    OUT_OF_TOKENS = "out_of_tokens"  # the tokens of its settings are spent
    OUT_OF_SECONDS = "out_of_seconds"  # the seconds of its settings are spent
    OUT_OF_MONEY = "out_of_money"  # the money of its settings is spent
    OUT_OF_QUOTA = "out_of_quota"  # the server or the gateway says that its budget is spent
    MODEL_FAILED = "model_failed"  # its server gave no answer, however often it was asked
    REQUEST_REFUSED = "request_refused"  # its server does not take such requests


def price(prompt_tokens: int, answer_tokens: int, prompt_price: float, answer_price: float) -> float:
    """Return what some tokens cost, at prices of a million tokens of prompts and of answers."""
    return (prompt_tokens * prompt_price + answer_tokens * answer_price) / MILLION


@dataclass(slots=True)
class Spending:
    """What one match has taken so far."""

    requests: int = 0  # that were answered
    failures: int = 0  # requests that were not
    prompt_tokens: int = 0  # of those that were answered
    answer_tokens: int = 0  # of the answers
    seconds: float = 0.0  # s in which the model was waited for, pauses between tries included
    calls: int = 0  # that were played
    without_call: int = 0  # answers that no call could be played of

    def add(self, prompt_tokens: int, answer_tokens: int, seconds: float) -> None:
        """Count a request that was answered."""
        self.requests += 1
        self.prompt_tokens += prompt_tokens
        self.answer_tokens += answer_tokens
        self.seconds += seconds

    @property
    def tokens(self) -> int:
        """The tokens of prompts and answers."""
        return self.prompt_tokens + self.answer_tokens

    def money(self, settings: ModelSettings) -> float:
        """Return what they cost."""
        return price(self.prompt_tokens, self.answer_tokens, settings.prompt_price, settings.answer_price)

    def ending(self, settings: ModelSettings) -> Ending | None:
        """Return which budget is spent, or None."""
        if settings.tokens is not None and self.tokens >= settings.tokens:
            return Ending.OUT_OF_TOKENS
        if settings.seconds is not None and self.seconds >= settings.seconds:
            return Ending.OUT_OF_SECONDS
        if settings.money is not None and self.money(settings) >= settings.money:
            return Ending.OUT_OF_MONEY
        return None
