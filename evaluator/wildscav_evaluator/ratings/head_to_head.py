"""The results of every two entrants against each other, and the record of each entrant."""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from wildscav_evaluator.ratings.matches import RatedMatch, mean_places, pairings, points_of


@dataclass(frozen=True)
class PairRecord:
    """The comparisons of an entrant with another one."""

    wins: int = 0  # matches in which its team was placed better
    ties: int = 0
    losses: int = 0

    @property
    def count(self) -> int:
        """The number of comparisons."""
        return self.wins + self.ties + self.losses

    @property
    def share(self) -> float:
        """The share of the points that it won, where a tie is half a point; NaN if they never met."""
        return (self.wins + self.ties / 2) / self.count if self.count else math.nan

    def reversed(self) -> "PairRecord":
        """Return the same comparisons from the other entrant's view."""
        return PairRecord(self.losses, self.ties, self.wins)


def head_to_head(matches: Iterable[RatedMatch]) -> dict[tuple[str, str], PairRecord]:
    """Return the record of every two entrants that met; each pair is contained twice, in both orders."""
    counts: dict[tuple[str, str], list[int]] = {}
    for match in matches:
        for one in pairings(match):
            pair, points = sorted((one.first, one.second)), one.points
            if one.first != pair[0]:
                points = 1.0 - points
            counts.setdefault((pair[0], pair[1]), [0, 0, 0])[round(2 * (1.0 - points))] += 1
    records = {pair: PairRecord(*counts[pair]) for pair in sorted(counts)}
    return records | {(second, first): one.reversed() for (first, second), one in records.items()}


@dataclass(frozen=True)
class EntrantRecord:
    """The results of an entrant over its matches."""

    matches: int
    wins: int  # matches in which its team was first, alone
    shared_wins: int  # matches in which its team shared the first place
    mean_place: float  # of its team; a tie counts as the mean of the places that it covers
    share: float  # of the points in comparisons with opponents, where a tie is half a point


def entrant_records(matches: Iterable[RatedMatch]) -> dict[str, EntrantRecord]:
    """Return the record of each entrant that played, by name."""
    played, wins, shared, compared = Counter[str](), Counter[str](), Counter[str](), Counter[str]()
    places, points = defaultdict[str, float](float), defaultdict[str, float](float)
    for match in matches:
        best, entrants = min(match.places), len(match.entrants)
        for team, place, mean in zip(match.teams, match.places, mean_places(match.places), strict=True):
            won = sum(
                len(other) * points_of(place, theirs)
                for other, theirs in zip(match.teams, match.places, strict=True)
                if other is not team
            )
            for name in team:
                played[name] += 1
                places[name] += mean
                points[name] += won
                compared[name] += entrants - len(team)
                if place == best:
                    (wins if mean == 1.0 else shared)[name] += 1
    return {
        name: EntrantRecord(
            matches=played[name],
            wins=wins[name],
            shared_wins=shared[name],
            mean_place=places[name] / played[name],
            share=points[name] / compared[name],
        )
        for name in sorted(played)
    }
