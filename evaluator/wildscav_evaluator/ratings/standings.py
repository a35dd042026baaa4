"""The ratings of a finished tournament as they are stored: the standing of each entrant, and all pairs."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import special

from wildscav_evaluator.output.json_files import FileModel
from wildscav_evaluator.ratings.bands import Ranking, rank_entrants
from wildscav_evaluator.ratings.fit import DECIMALS, ELO, Fit, fit
from wildscav_evaluator.ratings.head_to_head import EntrantRecord, entrant_records, head_to_head
from wildscav_evaluator.ratings.ladder import Skill, ladder
from wildscav_evaluator.ratings.matches import RatedMatch

SHARE_DECIMALS = 4  # of stored shares and mean places
MAX_PAIRED = 100  # entrants whose pairs are stored: the best; a thousand have half a million pairs


class LadderRating(FileModel):
    """An entrant's place on the running ladder after the last match."""

    rating: float  # on the scale of Elo, 1500 for a new entrant
    deviation: float  # standard deviation of the rating
    mu: float  # on OpenSkill's scale, from which a ladder can be continued
    sigma: float


class Standing(FileModel):
    """One entrant in a finished tournament."""

    entrant: str
    group: int  # from 1; entrants of different groups never met, even through others, and cannot be compared
    rank: int  # 1 + the entrants of its group that are significantly better
    last_rank: int  # the entrants of its group, without those that are significantly worse
    bands: tuple[int, ...]  # the bands to which it belongs, numbered from 1
    rating: float  # of all matches at once, on the scale of Elo; the mean of a group is 1500
    low: float | None  # of the 95 % interval of the rating; None after a single game
    high: float | None
    games: int
    matches: int
    wins: int  # matches in which it was first, alone
    shared_wins: int  # matches in which it shared the first place
    mean_place: float
    share: float  # of the points in comparisons with opponents, where a tie is half a point
    expected_share: float  # of the points against every other entrant of its group, according to the ratings
    ladder: LadderRating

    @property
    def ranks(self) -> str:
        """The ranks that the entrant may have, such as "1–3" or "4"."""
        return str(self.rank) if self.rank == self.last_rank else f"{self.rank}–{self.last_rank}"

    @property
    def first_places(self) -> str:
        """The wins, and after a plus the shared ones, such as "7+2" or "7"."""
        return f"{self.wins}+{self.shared_wins}" if self.shared_wins else str(self.wins)


class Pair(FileModel):
    """Two entrants that met."""

    first: str
    second: str
    wins: int  # of the first
    ties: int
    losses: int


class Standings(FileModel):
    """All ratings of a tournament."""

    standings: tuple[Standing, ...]  # by group, and in it by rating; the best first
    bands: tuple[tuple[str, ...], ...]  # every two entrants of a band cannot be told apart; bands may overlap
    pairs: tuple[Pair, ...]  # of the best 100 entrants; by name, each pair once


def rate(matches: Iterable[RatedMatch]) -> Standings:
    """Return all ratings that follow from some matches, if there are any.

    The ladder applies them in the order of the schedule, in which they are given. Nothing else depends on it.
    """
    played = list(matches)
    if not played:
        return Standings(standings=(), bands=(), pairs=())
    fitted = fit(played)
    ranking = rank_entrants(fitted)
    records = entrant_records(played)
    expected = expected_shares(fitted)
    best = {*ranking.names[:MAX_PAIRED]}
    skills = {name: steps[-1].skill for name, steps in ladder(played).items()}
    return Standings(
        standings=tuple(
            _standing(name, fitted, ranking, records[name], expected, skills[name]) for name in ranking.names
        ),
        bands=ranking.bands,
        pairs=tuple(
            Pair(first=first, second=second, wins=one.wins, ties=one.ties, losses=one.losses)
            for (first, second), one in head_to_head(played).items()
            if first < second and {first, second} <= best
        ),
    )


def _standing(
    name: str,
    fitted: Fit,
    ranking: Ranking,
    record: EntrantRecord,
    expected: NDArray[np.float64],
    skill: Skill,
) -> Standing:
    index = fitted.names.index(name)
    low, high = fitted.interval(name) or (None, None)
    rank, last_rank = ranking.ranks[name]
    return Standing(
        entrant=name,
        group=int(fitted.groups[index]) + 1,
        rank=rank,
        last_rank=last_rank,
        bands=tuple(number for number, band in enumerate(ranking.bands, 1) if name in band),
        rating=round(float(fitted.ratings[index]), DECIMALS),
        low=None if low is None else round(low, DECIMALS),
        high=None if high is None else round(high, DECIMALS),
        games=int(fitted.games[index]),
        matches=record.matches,
        wins=record.wins,
        shared_wins=record.shared_wins,
        mean_place=round(record.mean_place, SHARE_DECIMALS),
        share=round(record.share, SHARE_DECIMALS),
        expected_share=round(float(expected[index]), SHARE_DECIMALS),
        ladder=LadderRating(
            rating=round(skill.rating, DECIMALS),
            deviation=round(skill.deviation, DECIMALS),
            mu=skill.mu,
            sigma=skill.sigma,
        ),
    )


def expected_shares(fitted: Fit) -> NDArray[np.float64]:
    """Return an (N,) array: the share of points that each entrant would win against the others of its group.

    It counts every other entrant equally, while the share of points in the matches also depends on the
    opponents that the schedule gave.
    """
    odds = special.expit((fitted.ratings[:, np.newaxis] - fitted.ratings) / ELO)
    others = fitted.groups[:, np.newaxis] == fitted.groups
    np.fill_diagonal(others, val=False)
    return np.asarray((odds * others).sum(axis=1) / others.sum(axis=1))


def ladder_skills(standings: Sequence[Standing]) -> dict[str, Skill]:
    """Return the skills from which a ladder can be continued, by entrant."""
    return {one.entrant: Skill(one.ladder.mu, one.ladder.sigma) for one in standings}
