"""The running ladder: ratings that change after every match, in the order of the schedule.

OpenSkill's ``BradleyTerryFull`` (Weng & Lin, "A Bayesian Approximation Method for Online Ranking", *Journal
of Machine Learning Research* 12, 2011, algorithm 1) compares every two teams of a match as if each
comparison were a match of its own. In matches of many teams, that makes it much too sure: of 32 teams, the
standard deviation falls to almost zero after the first match. Here a match of many teams counts as the
number of comparisons that contain as much information as one place among them (``information``), which
changes nothing for two teams.

Skills are rounded after every match. A ladder that continues from stored skills therefore does the same as
one that never stopped, and the last bits of different processors do not matter.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from openskill.models import BradleyTerryFull, BradleyTerryFullRating

from wildscav_evaluator.ratings.fit import AVERAGE, ELO
from wildscav_evaluator.ratings.matches import RatedMatch

MU, SIGMA, BETA = 25.0, 25.0 / 3.0, 25.0 / 6.0  # OpenSkill's own scale
SCALE = ELO / (math.sqrt(2.0) * BETA)  # points of rating for one of mu, between entrants that are well known
DECIMALS = 6


@dataclass(frozen=True)
class Skill:
    """What a ladder knows about an entrant: a normal distribution, on OpenSkill's scale."""

    mu: float = MU
    sigma: float = SIGMA

    @property
    def rating(self) -> float:
        """The mean on the scale of Elo; a new entrant has 1500.

        It is the mean and not a cautious lower bound, which would mostly measure who has played more; the
        deviation is shown beside it.
        """
        return AVERAGE + SCALE * (self.mu - MU)

    @property
    def deviation(self) -> float:
        """The standard deviation on the scale of Elo."""
        return SCALE * self.sigma


@dataclass(frozen=True)
class LadderStep:
    """An entrant's skill after a match."""

    match: int  # from 0, in the order in which the matches were applied
    skill: Skill


class Ladder:
    """Skills of entrants, to which matches are applied one after the other."""

    def __init__(self, start: Mapping[str, Skill] | None = None) -> None:
        """Start a ladder; entrants whose skills are not given start with the default."""
        self._skills = dict(start or {})
        self._model = BradleyTerryFull(mu=MU, sigma=SIGMA, beta=BETA, gamma=_gamma)

    @property
    def skills(self) -> Mapping[str, Skill]:
        """The current skills of all entrants that have played, by name."""
        return MappingProxyType(self._skills)

    def apply(self, match: RatedMatch) -> dict[str, Skill]:
        """Apply a match, and return the new skills of its entrants."""
        before = [[self._skills.get(name, Skill()) for name in team] for team in match.teams]
        rated = self._model.rate(
            [[self._model.rating(skill.mu, skill.sigma) for skill in team] for team in before],
            ranks=[float(place) for place in match.places],
        )
        part = information(len(match.teams))
        changed = {
            name: Skill(
                mu=round(skill.mu + part * (new.mu - skill.mu), DECIMALS), sigma=round(new.sigma, DECIMALS)
            )
            for names, skills, news in zip(match.teams, before, rated, strict=True)
            for name, skill, new in zip(names, skills, news, strict=True)
        }
        self._skills.update(changed)
        return changed


def ladder(
    matches: Iterable[RatedMatch], start: Mapping[str, Skill] | None = None
) -> dict[str, tuple[LadderStep, ...]]:
    """Apply matches in the order given, and return the history of each entrant that played, by name.

    That is the order of the schedule and never that of their arrival. ``start`` has the skills of entrants
    that have already played.
    """
    running = Ladder(start)
    history: dict[str, list[LadderStep]] = {}
    for index, match in enumerate(matches):
        for name, skill in running.apply(match).items():
            history.setdefault(name, []).append(LadderStep(index, skill))
    return {name: tuple(history[name]) for name in sorted(history)}


@cache
def information(teams: int) -> float:
    """Return how many independent comparisons each of a team's comparisons in a match counts as.

    A place among k equal teams contains 4 · (k - H) / k times as much Fisher information about a team's
    strength as a match of two (Plackett and Luce's model), where H is the k-th harmonic number; it is
    divided among the k - 1 comparisons. This is 1 for two teams.
    """
    harmonic = math.fsum(1.0 / number for number in range(1, teams + 1))
    return 4.0 * (teams - harmonic) / (teams * (teams - 1))


def _gamma(  # its arguments are those with which OpenSkill calls it
    c: float,
    k: int,
    _mu: float,
    sigma_squared: float,
    _team: Sequence[BradleyTerryFullRating],
    _rank: int,
    _weights: list[float] | None = None,
) -> float:
    """Return Weng & Lin's factor for the reduction of the variance, for a part of a comparison."""
    return information(k) * math.sqrt(sigma_squared) / c
