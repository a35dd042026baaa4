"""A finished match among named entrants, and the comparisons of pairs that follow from its places."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple


@dataclass(frozen=True, order=True)
class RatedMatch:
    """A finished match among entrants.

    ValueError if there are fewer than two teams, an empty team, an entrant twice, or places that do not fit.
    """

    game: int  # matches of one game share the map and the match seed, so their results depend on each other
    teams: tuple[tuple[str, ...], ...]  # the entrants of each team; a team that is wholly one entrant has one
    places: tuple[int, ...]  # of each team: 1 is the best, and equal places are ties

    def __post_init__(self) -> None:
        names = self.entrants
        if len(self.teams) < 2 or not all(self.teams):
            raise ValueError(f"a rated match needs two or more teams with entrants, not {self.teams}")
        if len({*names}) < len(names):
            raise ValueError(f"an entrant is named twice in one match: {self.teams}")
        if len(self.places) != len(self.teams) or min(self.places) < 1:
            raise ValueError(f"{len(self.teams)} teams need as many places from 1, not {self.places}")

    @property
    def entrants(self) -> tuple[str, ...]:
        """The names of all entrants, team by team."""
        return tuple(name for team in self.teams for name in team)


class Pairing(NamedTuple):
    """The result of one entrant against another one in a match."""

    first: str
    second: str
    points: float  # of the first: 1 for a better place, 0.5 for the same place, 0 for a worse one


def pairings(match: RatedMatch) -> Iterator[Pairing]:
    """Yield the result of every two entrants of different teams, each pair once."""
    for one, other in combinations(range(len(match.teams)), 2):
        points = points_of(match.places[one], match.places[other])
        for first in match.teams[one]:
            for second in match.teams[other]:
                yield Pairing(first, second, points)


def points_of(place: int, other: int) -> float:
    """Return the points of a place against another one."""
    return 0.5 if place == other else float(place < other)


@lru_cache(maxsize=10_000)  # few orders of few teams are possible
def mean_places(places: tuple[int, ...]) -> tuple[float, ...]:
    """Return the places with each tie replaced by the mean of the places that it covers.

    Two teams that tie for the first of three places have 1.5 each, and the last one has 3.
    """
    return tuple(
        sum(other < place for other in places) + (sum(other == place for other in places) + 1) / 2
        for place in places
    )
