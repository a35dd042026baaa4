"""The table of a league: its settings, and the results against each opponent, as JSON."""

from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from wildscav_engine.specs.base import Spec

Share = Annotated[float, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=0)]
Weighting = Literal["hard", "variance", "uniform"]


class LeagueError(ValueError):
    """Something is wrong with a league or its table; the message says what and what is allowed."""


class LeagueSettings(Spec):
    """How a league chooses opponents; see ``League``."""

    weighting: Weighting = "hard"
    power: Annotated[float, Field(ge=0, le=100)] = 2.0
    latest_share: Share = 0.3
    robot_share: Share = 0.2
    capacity: Annotated[int, Field(ge=1, le=100_000)] = 32
    memory: Annotated[float, Field(gt=0, le=1)] = 0.98


class Results(Spec):
    """The learner's results against one opponent."""

    name: str
    wins: Count = 0
    draws: Count = 0
    losses: Count = 0
    # Sums in which older results weigh less, for the win rate.
    recent: Annotated[float, Field(ge=0)] = 0.0  # of games
    recent_score: Annotated[float, Field(ge=0)] = 0.0  # of results, 1 for a win and 0.5 for a draw

    @model_validator(mode="after")
    def _score_is_of_the_games(self) -> Self:
        if self.recent_score > self.recent:
            raise ValueError("recent_score is above recent, but a game gives at most 1")
        return self

    @property
    def games(self) -> int:
        """The number of games."""
        return self.wins + self.draws + self.losses

    @property
    def win_rate(self) -> float:
        """The learner's win rate, in which older results weigh less; 0.5 before the first game.

        It is estimated as if one more game had been won and one more lost, so it is never 0 or 1.
        """
        return (self.recent_score + 1.0) / (self.recent + 2.0)

    @property
    def loss_rate(self) -> float:
        """What is left of the win rate; it is above 0 even where rounding makes the win rate 1."""
        return (self.recent - self.recent_score + 1.0) / (self.recent + 2.0)

    def with_result(self, result: float, memory: float) -> "Results":
        """Return the results after one more game (1 won, 0.5 drawn, 0 lost); ``memory`` weighs the others."""
        return self.model_copy(
            update={
                "wins": self.wins + (result > 0.5),
                "draws": self.draws + (result == 0.5),
                "losses": self.losses + (result < 0.5),
                "recent": self.recent * memory + 1.0,
                "recent_score": self.recent_score * memory + result,
            }
        )


class LeagueTable(Spec):
    """Everything in a league but its policies."""

    format: Literal[1] = 1  # raised when older readers would misread a table
    settings: LeagueSettings = LeagueSettings()
    added: Count = 0  # the number of past selves so far, including those that were dropped
    members: tuple[Results, ...] = ()  # oldest first
    robots: tuple[Results, ...] = ()


def priorities(results: Sequence[Results], settings: LeagueSettings) -> list[float]:
    """Return the probability of each opponent by prioritized fictitious self-play.

    With the learner's win rate p, the weight of an opponent is (1 - p) to the given power for "hard", and
    p (1 - p) for "variance". Vinyals et al., "Grandmaster level in StarCraft II using multi-agent
    reinforcement learning", Nature 575, 2019, Methods.
    """
    weights = [_weight(each, settings) for each in results]
    # Relative to the greatest, which is then 1: a high power of small numbers would make all of them 0.
    greatest, power = max(weights), settings.power if settings.weighting == "hard" else 1.0
    powers = [(weight / greatest) ** power for weight in weights]
    total = sum(powers)
    return [value / total for value in powers]


def _weight(results: Results, settings: LeagueSettings) -> float:
    """Return the weight of an opponent before it is raised to a power; it is above 0."""
    if settings.weighting == "uniform":
        return 1.0
    return results.loss_rate * (results.win_rate if settings.weighting == "variance" else 1.0)
